/* render/trace/scenery/scenery_planes_private.h: planes about rays that have a point or a direction in common. */
#ifndef RENDER_TRACE_SCENERY_SCENERY_PLANES_PRIVATE_H
#define RENDER_TRACE_SCENERY_SCENERY_PLANES_PRIVATE_H

#include "pitviper.h"

/* Rays of a block, or towards the sun. */
typedef struct Bundle {
    const double *const *o, *const *d; /* [3][count] */
    int  count, columns;
    bool bent;
} Bundle;

/* What they may meet is where dot(n, p) >= d of each plane (n, d), n unit. */
typedef struct Planes {
    double plane[6][4];
    int    count;
} Planes;

/* A pyramid about rays that leave one point, up to the farthest limit; false: they leave several, or go all ways. axis:
 * unit, amid their directions. */
bool scenery_pyramid(Planes *out, double axis[3], const Bundle *b, const double *limit_m);
/* A prism about rays in one direction. */
void scenery_prism(Planes *out, const Bundle *b, const double way[3]);

#endif
