/* terrain/elevation/gdal_library.h: GDAL, loaded when files of terrain are first opened. */
#ifndef TERRAIN_ELEVATION_GDAL_LIBRARY_H
#define TERRAIN_ELEVATION_GDAL_LIBRARY_H

#include "pitviper_library.h"

extern Library gdal_library;

#endif
