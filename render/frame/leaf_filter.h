/* render/frame/leaf_filter.h: radiance of plants, smoothed from pixel to pixel.
 *
 * One sample a pixel shows one leaf, lit or shaded: the picture of a crown has 1.2 to 1.5 times the standard deviation
 * from pixel to pixel that means over the pixels have, and errors of 19 % in red. Neighbouring samples of leaves know more
 * of a pixel's mean than a single sample does: the weighted mean over 3 x 3 pixels (1 / 2 for the pixel, 1 / 12 beside it,
 * 1 / 24 at its corners, of those that show plants) has an error of 12 %, and the standard deviation of the true picture
 * within 2 % (bench precision: rays a pixel, woods). It costs no ray. The radar's picture keeps its own samples. */
#ifndef RENDER_FRAME_LEAF_FILTER_H
#define RENDER_FRAME_LEAF_FILTER_H

#include "render/frame/passes.h"

/* Memory for it where the picture has plants, one sample a pixel, and edges that are refined: Job.smoothed.
 * STATUS_NO_MEMORY. */
Status leaf_filter_prepare(Job *job, Arena *arena);
/* After the edges: smooths pixels of plants that were not refined. */
void   leaf_filter(Job *job, Pool *pool);

#endif
