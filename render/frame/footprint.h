/* render/frame/footprint.h: targets that are small on the image, sampled over their own boxes. */
#ifndef RENDER_FRAME_FOOTPRINT_H
#define RENDER_FRAME_FOOTPRINT_H

#include "render/frame/passes.h"

/* Which targets are small, and room for their footprints. */
Status footprints_plan(Job *job, Arena *arena);
/* A pool task: samples one of them. */
void   footprint_task(void *job, int worker, int index);
/* After all tasks: which pixels they cover. */
void   footprints_cover(Job *job);
/* Of every footprint, by its samples' variance, before they are put on: into Job.footprint_law and the targets. */
void   footprints_error(Job *job);
/* Over the finished pixels, in order of entity. */
void   footprints_put_on(Job *job);
/* Their areas and radiance into the picture's targets, after target_sums_gather. */
void   footprints_gather(const Job *job);

#endif
