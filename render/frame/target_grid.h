/* render/frame/target_grid.h: targets that are small on the image, sampled over their own boxes. */
#ifndef RENDER_FRAME_TARGET_GRID_H
#define RENDER_FRAME_TARGET_GRID_H

#include "render/frame/passes.h"

/* Which targets are small, and room for their footprints. */
Status target_grids_plan(Job *job, Arena *arena);
/* A pool task: samples one of them. */
void   target_grid_task(void *job, int worker, int index);
/* After all tasks: which pixels they cover. */
void   target_grids_cover(Job *job);
/* Of every footprint, by its samples' variance, before they are put on: into Job.target_variance and the targets. */
void   target_grids_error(Job *job);
/* Over the finished pixels, in order of entity. */
void   target_grids_composite(Job *job);
/* Their areas and radiance into the picture's targets, after target_sums_gather. */
void   target_grids_sample(const Job *job);

#endif
