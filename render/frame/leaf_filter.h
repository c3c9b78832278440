/* render/frame/leaf_filter.h: radiance of plants, smoothed from pixel to pixel.
 *
 * One sample a pixel shows one leaf, lit or shaded, or the ground in a gap: it has more contrast than the pixel's mean.
 * Neighbouring samples know more of that mean than a single one does: the weighted mean over 3 x 3 pixels (11 parts for
 * the pixel, 2 for those beside it, 1 for those at its corners) of those that show plants, or ground beside a plant. It
 * costs no ray. Beside 144 rays a pixel, in three frames of the demonstration: rms 15 % of the mean in red (23 % smoothed
 * among leaves alone), 3.7 and 1.9 % in 3.4-4.8 and 8-12 um, deviations 0.99, 1.01 and 1.02 of the true ones; where a
 * pixel is far larger than a leaf the deviation stays too large (tests/render/test_leaf_filter.c). The radar's picture
 * keeps its own samples. */
#ifndef RENDER_FRAME_LEAF_FILTER_H
#define RENDER_FRAME_LEAF_FILTER_H

#include "render/frame/passes.h"

/* Memory for it where the picture has plants, one sample a pixel, and edges that are refined: Job.smoothed.
 * STATUS_NO_MEMORY. */
Status leaf_filter_prepare(Job *job, Arena *arena);
/* After the edges: smooths those pixels that were not refined. */
void   leaf_filter(Job *job, Pool *pool);

#endif
