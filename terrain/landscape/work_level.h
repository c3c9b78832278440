/* terrain/landscape/work_level.h: posts of a level while they are made, and the levels stored: heights in float, before
 * they are quantised. */
#ifndef TERRAIN_LANDSCAPE_WORK_LEVEL_H
#define TERRAIN_LANDSCAPE_WORK_LEVEL_H

#include "terrain/elevation/elevation.h"

/* Values at places ((i0 + i) spacing, (j0 + j) spacing) of ENU: control points of a cubic B-spline, or posts. */
typedef struct Field {
    double spacing_m;
    int    i0, j0, nx, ny;
    float *v; /* [ny][nx] */
} Field;

Status field_create(Field *out, double spacing_m, int i0, int j0, int nx, int ny);
void   field_destroy(Field *field);

enum { level_ratio = 8 }; /* 2^3 between the spacings of neighbouring levels */

typedef struct WorkLevel {
    Field z;    /* ENU z of the surface; starts as height above the ellipsoid */
    float *cap; /* highest z allowed by clear lines, NULL: no line is near */
    /* posts of the hole, inclusive, in this level's own index; hole_i1 < hole_i0: none */
    int hole_i0, hole_i1, hole_j0, hole_j1;
    bool outermost;
    uint8_t *water; /* posts of the sea, which nothing moves; NULL: none */
} WorkLevel;

/* Blends the posts within `band` of the outline into the surface of the enclosing level, on which the outline lies. */
void levels_join(WorkLevel *level, const WorkLevel *outer, int band);
/* Quantises all levels and builds their pyramids; keeps both promises of terrain/elevation/elevation.h on seams. */
Status levels_store(Elevation *out, const WorkLevel *level, int count);
/* The same for heights from files: steps of 1/2048 m for all levels (where they are less than 16 km apart in height),
 * shifted in tiles whose heights are more than 31 m apart (in those along a seam, 23 m). */
Status levels_store_fine(Elevation *out, const WorkLevel *level, int count);

#endif
