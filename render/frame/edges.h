/* render/frame/edges.h: selects the pixels that one sample does not represent. */
#ifndef RENDER_FRAME_EDGES_H
#define RENDER_FRAME_EDGES_H

#include "render/frame/passes.h"

/* Refinement that a pixel needs. What only the shadow-sensitive bands need must not affect the others, whose bits
 * would then depend on the requested bands; and bare ground must stay cheap. */
typedef enum RefineFlag {
    refine_all    = 1, /* edge_samples a side, every band */
    refine_step   = 2, /* 2 a side, each split by ground class; every band: a crest of the ground, the horizon */
    refine_sun    = 4, /* edge_samples a side, optical and MWIR: the edge of a shadow */
    refine_ground = 8, /* the plane of the existing hit, split by ground class, no ray; not the radar */
    refine_plants = 16, /* leaf_samples a side, which join the first one; every band: plants about a target */
    refine_leaves = 32, /* a mark: plants are refined here */
} RefineFlag;

/* Marks what is always refined: bounding boxes of medium-sized targets, and the ground where a target's shadow
 * falls; and where plants are refined. After the target grids. */
void mark_boxes(Job *job);
/* The flags of a tile's pixels, row by row, including those marked. Reads the truth planes and the plane of
 * sunlight. */
void refine_flags(uint8_t flags[hits_capacity], const Job *job, int x0, int y0, int x1, int y1);
/* The block's pixels, with rays, hits and sun restored from the planes; all hits are ground; n is 1. */
void recall_ground(Worker *w, const Job *job);

#endif
