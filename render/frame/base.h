/* render/frame/base.h: the base pass: every pixel of a frame with the sample count that all pixels have. */
#ifndef RENDER_FRAME_BASE_H
#define RENDER_FRAME_BASE_H

#include "render/frame/passes.h"

/* A pool task: planes, truth and sums of a tile. */
void base_tile(void *job, int worker, int task);

#endif
