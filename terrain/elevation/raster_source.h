/* terrain/elevation/raster_source.h: which files GDAL may be given. */
#ifndef TERRAIN_ELEVATION_RASTER_SOURCE_H
#define TERRAIN_ELEVATION_RASTER_SOURCE_H

#include "pitviper.h"

/* GDAL opens by name and waits for a FIFO: a name is good when it is a regular file within the folder of raster_stay_within,
 * and what lies beside it is one too, or when it is no file's (a subdataset, a file in an archive), which is GDAL's own. Else it
 * is logged as key's. */
bool raster_file_allowed(const char *path, const char *key); /* for raster.c */
/* From here on only files below this folder are opened, links followed, and none that name others outside it. NULL:
 * anywhere. Of the whole process: set before threads read. */
void raster_stay_within(const char *folder);
/* Whether it named a folder. */
bool raster_stays_within(void);

#endif
