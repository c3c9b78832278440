/* render/frame/target_grid.h: targets that are small on the image, each sampled on a grid over its own box. */
#ifndef RENDER_FRAME_TARGET_GRID_H
#define RENDER_FRAME_TARGET_GRID_H

#include "render/frame/passes.h"

/* Selects the small targets and allocates their grids. */
Status target_grids_plan(Job *job, Arena *arena);
/* A pool task: samples one grid. */
void   target_grid_task(void *job, int worker, int index);
/* After all tasks: whether an entity has a grid, all of which is hidden. */
bool   target_grid_hidden(const Job *job, int entity);
/* After all tasks: the pixels that the grids cover. */
void   target_grids_cover(Job *job);
/* Errors of every grid, from its samples' variance, before compositing: into Job.target_variance and the targets. */
void   target_grids_error(Job *job);
/* Composites the grids over the finished pixels, in order of entity. */
void   target_grids_composite(Job *job);
/* Their areas and radiance into the picture's targets, after target_sums_gather. */
void   target_grids_sample(const Job *job);

#endif
