/* terrain/elevation/patch.h: a window of one raster in memory: averaged to a coarser posting where that is enough,
 * its voids filled from their surroundings, and reduced to mip levels for distant views. */
#ifndef TERRAIN_ELEVATION_PATCH_H
#define TERRAIN_ELEVATION_PATCH_H

#include "terrain/elevation/raster.h"

enum { patch_most_mips = 20 };

typedef struct Patch {
    int      factor;            /* pixels of the raster per side of a patch pixel, a power of two */
    int      x0, y0;            /* first raster pixel of the patch */
    int      mips;              /* 0: nothing is valid here */
    int      nx[patch_most_mips], ny[patch_most_mips];
    float   *v[patch_most_mips];/* [0] finest; each next one the mean of 2 x 2 */
    uint8_t *hole;              /* [ny[0]][nx[0]] 1: was void, and is filled */
    long     voids;             /* posts filled within the raster */
} Patch;

/* Values outside low .. high count as void. out starts zeroed; a patch without any valid post has mips 0. Reads by
 * strips: beyond the patch itself it takes some megabytes. */
Status patch_read(Patch *out, const Raster *raster, int band, int x0, int y0, int x1, int y1, int factor, double low,
                  double high, const char *key);
void   patch_free(Patch *patch); /* accepts zeroes */

/* Bilinear between posts, held at the edges, at a place in pixels of the raster. mip: how often halved, 0 .. mips - 1,
 * between two of them linearly. */
double patch_at(const Patch *patch, double x_px, double y_px, double mip);

#endif
