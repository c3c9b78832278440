/* terrain/import/surface_strip.h: a strip of a surface model, resampled to posts and taken apart on all threads. */
#ifndef TERRAIN_IMPORT_SURFACE_STRIP_H
#define TERRAIN_IMPORT_SURFACE_STRIP_H

#include "terrain/landscape/elevation_stream.h"
#include "terrain/landscape/take_apart.h"

typedef struct SurfaceSources {
    ElevationStream  *surface;
    ElevationStream  *bare;       /* a terrain model over the same levels; NULL: none */
    const RasterSet  *photo;      /* NULL: none */
    const LocalFrame *frame;
    Pool             *pool;
} SurfaceSources;

/* Rows of level 0, [rows][nx]; crowns in ENU, allocated. */
typedef struct SurfaceStrip {
    float   *h_m;       /* above the ellipsoid: bare ground, and roofs where there are buildings */
    uint8_t *kind;      /* CellKind */
    float   *canopy_m;  /* surface above bare ground where kind is CELL_TREE, else 0 */
    int      crowns;
    Crown   *crown;
    long     voids, voids_coarser; /* posts filled from their surroundings; from a coarser file */
} SurfaceStrip;

/* Strips may be of any height and come in any order: the same posts (take_apart_reach_m). */
Status surface_strip_make(SurfaceStrip *out, const SurfaceSources *from, int row0, int rows);
void   surface_strip_free(SurfaceStrip *strip); /* accepts zeroes */

#endif
