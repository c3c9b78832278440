/* render/footprint_private.h: a small target on the image: its cells (footprint_cells.c), and what they add up to
 * (footprint.c). */
#ifndef RENDER_FOOTPRINT_PRIVATE_H
#define RENDER_FOOTPRINT_PRIVATE_H

#include "render/render_private.h"

/* Cells of level 0 are two of the fine a side, those of level 1. */
enum { footprint_levels = 2, footprint_coarse = 2 };

/* The target's sample nearest the centre of a pixel. */
typedef struct FootprintTruth {
    double   square_px; /* of its distance */
    float    range_m, temp_k, normal[3];
    uint16_t part, material;
} FootprintTruth;

struct Footprint {
    int     entity;                    /* snapshot index */
    double  box[4];                    /* of all its vertices, px */
    int     columns, rows;             /* fine cells, in twos; 0: seen edge-on, nothing to sample */
    int     x0, y0, x1, y1;            /* pixels that it may touch */
    double *sum[picture_plane_count];  /* of area x radiance, a pixel [(y1 - y0) (x1 - x0)] */
    double *area;                      /* px, a pixel */
    FootprintTruth *truth;             /* a pixel; NULL: not wanted */
    /* over the target, px within the image */
    double  visible, amodal, hidden_ground, hidden_entity;
    double  veiled[BAND_COUNT];          /* area x what the veil takes */
    double  square[picture_plane_count]; /* area x radiance^2 */
    double *hidden_by;                 /* [snapshot count], px; NULL: not wanted */
    int     amodal_box[4];
};

/* visit(user, pixel of the footprint, area) for each pixel that a cell lies over. */
typedef void VisitPixel(void *user, const Footprint *f, int pixel, int x, int y, double area);

/* Takes the pixel (x, y) into a box of pixels, int[4]; a VisitPixel. */
void footprint_grow_box(void *box, const Footprint *f, int pixel, int x, int y, double area);

#endif
