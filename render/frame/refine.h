/* render/frame/refine.h: pixels at edges, sampled again. */
#ifndef RENDER_FRAME_REFINE_H
#define RENDER_FRAME_REFINE_H

#include "render/frame/passes.h"

/* A pool task: decides what a tile's pixels need (edges.h), and does it. */
void refine_tile(void *job, int worker, int task);

#endif
