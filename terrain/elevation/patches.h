/* terrain/elevation/patches.h: windows of one raster in memory: averaged to a coarser posting where that is enough,
 * their voids filled from their surroundings, and reduced to mip levels for distant views. */
#ifndef TERRAIN_ELEVATION_PATCHES_H
#define TERRAIN_ELEVATION_PATCHES_H

#include "terrain/elevation/raster.h"

enum { patch_most_mips = 20 };

typedef struct Patch {
    int      factor; /* pixels of the raster per side of a patch pixel, a power of two */
    int      x0, y0; /* first raster pixel of the patch */
    int      mips;   /* 0: nothing is valid here */
    int      nx[patch_most_mips], ny[patch_most_mips];
    float   *v[patch_most_mips]; /* [0] finest; each next one the mean of 2 x 2 */
    uint8_t *hole;               /* [ny[0]][nx[0]] 1: was void, and is filled */
    long     voids;              /* posts filled within the raster */
    float   *share;              /* of holes in squares of 8 x 8 posts; NULL: no hole */
    /* A coarser patch of a wider window of the same raster: its mip 0 continues the mips here. NULL: none. Borrowed. */
    const struct Patch *wider;
} Patch;

/* One window to be read: pixels x0 .. x1 - 1, y0 .. y1 - 1 of the raster, averaged over factor x factor. */
typedef struct PatchWindow {
    int          x0, y0, x1, y1, factor; /* factor: a power of two */
    const Patch *wider;                  /* of a factor 2, 4 or 8 ... times as large, covering the window; NULL: none */
} PatchWindow;

typedef struct PatchSource {
    const Raster *raster;
    int           band;
    double        low, high; /* values outside count as void */
    const char   *key;       /* for messages */
    Pool         *pool;      /* NULL: one thread */
} PatchSource;

/* Several windows of one raster in one pass over it. out starts zeroed; a patch without any valid post has mips 0.
 * Reads by strips: beyond the patches it takes some megabytes a thread. The same bits for any number of threads. */
Status patches_read(Patch *out, const PatchWindow *window, int count, const PatchSource *source);
void   patch_free(Patch *patch); /* accepts zeroes */

/* Bilinear between posts, held at the edges, at a place in pixels of the raster. mip: how often halved, 0 .. mips - 1,
 * between two of them linearly. */
double patch_at(const Patch *patch, double x_px, double y_px, double mip);
/* How far a place is inside a hole: 0 on posts that are valid, and along the rim; 1 where all posts about are void.
 * Small holes stay near 0. */
double patch_hole(const Patch *patch, double x_px, double y_px);

#endif
