/* render/frame/refine.h: pixels at edges, sampled again. */
#ifndef RENDER_FRAME_REFINE_H
#define RENDER_FRAME_REFINE_H

#include "render/frame/passes.h"

/* A pool task: selects the pixels of a tile to refine (edges.h), and samples them. */
void refine_tile(void *job, int worker, int task);

#endif
