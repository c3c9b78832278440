/* render/frame/edges.h: which pixels one sample does not speak for. */
#ifndef RENDER_FRAME_EDGES_H
#define RENDER_FRAME_EDGES_H

#include "render/frame/passes.h"

/* What a pixel needs. What only the bands that show shadows see must not touch the others, whose bits would then
 * depend on what else is asked for; and bare ground must stay cheap. */
typedef enum RefineFlag {
    refine_all    = 1, /* edge_samples a side, every band */
    refine_step   = 2, /* 2 a side, each by kinds of ground; every band: a crest of the ground, the horizon */
    refine_sun    = 4, /* edge_samples a side, optical and MWIR: the edge of a shadow */
    refine_ground = 8, /* the plane of the hit there is, by kinds of ground, no ray; not the radar */
} RefineFlag;

/* Marks what must be refined whatever its neighbours are: boxes of targets of middling size, and where a target's
 * shadow falls. */
void mark_boxes(Job *job);
/* The flags of a tile's pixels, row by row, those marked included. Reads the truth planes and the plane of sunlight. */
void refine_flags(uint8_t flags[hits_capacity], const Job *job, int x0, int y0, int x1, int y1);
/* The block's pixels as their planes say what their hits were, which are of ground: rays, hits and sun; n is 1. */
void recall_ground(Worker *w, const Job *job);

#endif
