/* render/frame/target_grid_private.h: a small target, shared by target_grid.c (sampling) and target_grid_picture.c
 * (compositing). */
#ifndef RENDER_FRAME_TARGET_GRID_PRIVATE_H
#define RENDER_FRAME_TARGET_GRID_PRIVATE_H

#include "render/frame/target_grid.h"

/* The target's sample nearest the centre of a pixel. */
typedef struct TargetGridTruth {
    double   square_px; /* of its distance */
    float    range_m, temp_k, normal[3];
    uint16_t part, material;
} TargetGridTruth;

struct TargetGrid {
    int     entity;                    /* snapshot index */
    double  box[4];                    /* of all its vertices, px */
    int     columns, rows;             /* cells; 0: seen edge-on, nothing to sample */
    int     x0, y0, x1, y1;            /* pixels that it may touch */
    double *sum[picture_plane_count];  /* of area x radiance, a pixel [(y1 - y0) (x1 - x0)] */
    double *area;                      /* px, a pixel */
    double *before_sum[picture_plane_count], *before; /* the same of what hides the target, a pixel that shows some of it */
    TargetGridTruth *truth;             /* [pixels]; NULL: not needed */
    /* over the target, px within the image */
    double  visible, amodal, hidden_ground, hidden_entity, hidden_plants;
    double  veiled[BAND_COUNT];          /* area x the share that smoke absorbs */
    double  square[picture_plane_count]; /* area x radiance^2 */
    float  *cell[picture_plane_count]; /* radiance of each; NULL: neither needed for the budget nor for a detector */
    float  *behind[picture_plane_count]; /* [pixels], before small targets are composited; NULL: not needed for a
                                          * detector */
    bool   *met;                       /* cells that show the target */
    int     amodal_box[4];
};

/* The first and last pixels, of a box that is all 0 at first. */
static inline void grow_pixel_box(int box[4], int x, int y)
{
    box[0] = box[2] == 0 || x < box[0] ? x : box[0];
    box[1] = box[3] == 0 || y < box[1] ? y : box[1];
    box[2] = x + 1 > box[2] ? x + 1 : box[2];
    box[3] = y + 1 > box[3] ? y + 1 : box[3];
}

#endif
