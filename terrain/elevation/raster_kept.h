/* terrain/elevation/raster_kept.h: rows of a raster that were read once, decoded, in a nameless file. */
#ifndef TERRAIN_ELEVATION_RASTER_KEPT_H
#define TERRAIN_ELEVATION_RASTER_KEPT_H

#include "terrain/elevation/raster.h"

typedef struct RasterKept RasterKept;

bool raster_keeps(const Raster *raster, int band);
/* Whole pieces (raster_piece) of rows into the file; a full disk only costs another reading. */
void raster_keep_rows(const Raster *raster, float *rows, int x0, int y0, int width, int height);
/* False: not all of the window is there. */
bool raster_read_kept(float *out, const Raster *raster, int x0, int y0, int width, int height);
void raster_kept_free(RasterKept *kept); /* accepts NULL */

#endif
