/* terrain/elevation/raster_patch.h: windows of one raster in memory: averaged to a coarser posting where that is
 * enough, their voids filled from their surroundings, and reduced to mip levels for distant views. */
#ifndef TERRAIN_ELEVATION_RASTER_PATCH_H
#define TERRAIN_ELEVATION_RASTER_PATCH_H

#include "terrain/elevation/raster.h"

enum { raster_patch_most_mips = 20 };

typedef struct RasterPatch {
    int      factor; /* pixels of the raster per side of a patch pixel, a power of two */
    int      x0, y0; /* first raster pixel of the patch */
    int      mips;   /* 0: nothing is valid here */
    int      nx[raster_patch_most_mips], ny[raster_patch_most_mips];
    float   *v[raster_patch_most_mips]; /* [0] finest; each next one the mean of 2 x 2 */
    uint8_t *hole;                      /* [ny[0]][nx[0]] 1: the post was void, and has been filled */
    long     voids;                     /* posts filled within the raster */
    float   *share;                     /* share of filled posts in squares of 8 x 8 posts; NULL: no post was filled */
    /* A coarser patch of a wider window of the same raster, borrowed: its mip 0 continues the mips of this one. NULL:
     * none. */
    const struct RasterPatch *wider;
} RasterPatch;

/* One window to be read: pixels x0 .. x1 - 1, y0 .. y1 - 1 of the raster, averaged over factor x factor. */
typedef struct RasterPatchWindow {
    int x0, y0, x1, y1, factor; /* factor: a power of two */
    const RasterPatch
        *wider; /* a patch whose factor is 2, 4, 8 ... times this one, and which covers the window; NULL: none */
} RasterPatchWindow;

typedef struct RasterPatchSource {
    const Raster *raster;
    int           band;
    double        low, high; /* pixels outside of this range count as void */
    const char   *key;       /* for messages */
    Pool         *pool;      /* NULL: one thread */
} RasterPatchSource;

/* Reads several windows of one raster in one pass over it. out must be zeroed; a patch without any valid post gets mips
 * 0. Files are read by strips, which take some megabytes a thread besides the patches. The result has the same bits for
 * any number of threads. */
Status raster_patches_read(RasterPatch *out, const RasterPatchWindow *window, int count,
                           const RasterPatchSource *source);
void   raster_patch_free(RasterPatch *patch); /* accepts zeroes */

/* Bilinear value at a place in pixels of the raster, held at the edges. mip: how often the patch is halved, 0 .. mips -
 * 1; between two mips it is linear. */
double raster_patch_at(const RasterPatch *patch, double x_px, double y_px, double mip);
/* How far a place is inside a hole: 0 on posts that are valid, and along the rim; 1 where all posts about are void.
 * Small holes stay near 0. */
double raster_patch_hole(const RasterPatch *patch, double x_px, double y_px);

#endif
