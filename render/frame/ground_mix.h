/* render/frame/ground_mix.h: splits samples that cover several ground classes into one return for each. */
#ifndef RENDER_FRAME_GROUND_MIX_H
#define RENDER_FRAME_GROUND_MIX_H

#include "render/frame/passes.h"

enum {
    ground_mix_places = 256,  /* most points a sample at which the class is looked up */
    ground_mix_most   = 4,    /* most classes that a sample is split into */
    corner_capacity   = (tile_side_samples + 1) * (tile_side_samples + 1),
    material_unknown  = 0xffff,
};

/* Materials of the ground at the corners of the pixels x0 .. x1 - 1, y0 .. y1 - 1, (x1 - x0 + 1) a row;
 * material_unknown where the pixel right and below shows no ground. Reads the truth planes. */
void corner_materials(uint16_t out[corner_capacity], const Job *job, int x0, int y0, int x1, int y1);
/* Whether one of the four corners from `corner` on is of another material than that. columns: corners a row. */
bool corners_differ(const uint16_t *corner, int columns, uint32_t material);
/* Splits the block's samples of ground by the surface classes within their squares of 1 / n px, several returns each:
 * looked up at side x side points, at most `most` classes kept. hits.count x most <= hits_capacity; side <= 16,
 * most <= ground_mix_most. */
void split_ground(Worker *w, const Job *job, int side, int most);

#endif
