/* render/frame/error_estimate.h: the error estimate as a pass of a frame; its meaning: error_budget.h. */
#ifndef RENDER_FRAME_ERROR_ESTIMATE_H
#define RENDER_FRAME_ERROR_ESTIMATE_H

#include "render/frame/passes.h"

/* The last pass: fills picture->budget. STATUS_NO_MEMORY. */
Status error_estimate(const Job *job, Pool *pool, Arena *arena);

#endif
