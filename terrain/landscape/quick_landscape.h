/* terrain/landscape/quick_landscape.h: a large synthetic terrain, quickly: what frames are measured on. */
#ifndef TERRAIN_LANDSCAPE_QUICK_LANDSCAPE_H
#define TERRAIN_LANDSCAPE_QUICK_LANDSCAPE_H

#include "terrain/landscape/landscape.h"

static const double quick_landscape_step_m = 1.0 / 64;

/* One level of posts 1 m apart, east_m x north_m about the frame's origin (200 .. 32000, whole metres): eroded hills of
 * some 250 m from valley to top, at the origin's tangent plane. The surface, from fields to rock, is that of any
 * synthetic terrain. The same posts for any number of threads. times_s: for the posts, and for their pyramid. */
Status quick_landscape_create(Landscape *out, double times_s[2], const LocalFrame *frame, double east_m, double north_m,
                           Pool *pool);
/* Bytes of posts, and of the pyramids above them: of heights, and of rises. */
void   quick_landscape_bytes(size_t *posts, size_t *pyramids, const Elevation *elevation);

#endif
