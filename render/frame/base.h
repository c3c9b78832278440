/* render/frame/base.h: every pixel of a frame, with the samples that all pixels get. */
#ifndef RENDER_FRAME_BASE_H
#define RENDER_FRAME_BASE_H

#include "render/frame/passes.h"

/* A pool task: a tile's planes, truth and sums. */
void base_tile(void *job, int worker, int task);

#endif
