/* terrain/elevation/reader/gdal_library.h: GDAL, loaded into the process that reads rasters. */
#ifndef TERRAIN_ELEVATION_READER_GDAL_LIBRARY_H
#define TERRAIN_ELEVATION_READER_GDAL_LIBRARY_H

#include "pitviper_library.h"

extern Library gdal_library;

#endif
