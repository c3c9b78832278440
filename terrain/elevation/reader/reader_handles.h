/* terrain/elevation/reader/reader_handles.h: GDAL's handles of a sheet. */
#ifndef TERRAIN_ELEVATION_READER_READER_HANDLES_H
#define TERRAIN_ELEVATION_READER_READER_HANDLES_H

#include <gdal.h>
#include <pthread.h>

#include "terrain/elevation/raster.h"

/* Handles of one file, so that threads read at once and GDAL's cache of blocks lasts from one read to the next. */
enum { handles = 8, most_open_sheets = 48 };
typedef struct RasterOpen {
    pthread_mutex_t lock[handles];
    GDALDatasetH    file[handles];
} RasterOpen;

/* A sheet's handle for a window that begins at row y, locked; NULL, logged: the file cannot be read. */
GDALDatasetH sheet_open(const RasterSheet *s, int row_block, int y, const char *key);
void         sheet_done(const RasterSheet *s, int row_block, int y, GDALDatasetH file);
/* What a sheet and a window have in common, px of the raster. False: nothing. */
bool         common_part(int part[4], const RasterSheet *s, int x0, int y0, int width, int height);

/* reader_sparse.c: pixels of a file whose blocks are there. */
double       reader_data_px(GDALDatasetH file);

#endif
