/* render/frame/pixels.h: pixels as a block of samples, and samples averaged to pixels. */
#ifndef RENDER_FRAME_PIXELS_H
#define RENDER_FRAME_PIXELS_H

#include "render/frame/picture.h"

/* Pixels of n x n samples, all samples of a pixel together. */
typedef struct PixelBlock {
    int      n, pixels;
    int      columns;                            /* of a whole tile with n = 1: its pixels lie in rows; else 0 */
    uint16_t x[hits_capacity], y[hits_capacity]; /* of each pixel */
} PixelBlock;

static inline void pixels_add(PixelBlock *block, int x, int y)
{
    block->x[block->pixels]   = (uint16_t)x;
    block->y[block->pixels++] = (uint16_t)y;
}

/* The pixel of a hit, index into x and y; and the hit's share of it. */
static inline int hit_pixel(const PixelBlock *block, const Hits *hits, int i)
{
    return hit_ray(hits, i) / (block->n * block->n);
}
static inline double hit_share(const PixelBlock *block, const Hits *hits, int i)
{
    return (double)hit_weight(hits, i) * (1.0 / (block->n * block->n));
}

/* Place of sample s of n x n in its pixel, 0 .. 1. A grid rotated by atan(1 / n), so that an edge along the rows or
 * columns is met in n^2 steps and not in n; the one sample of n = 1 is the centre. */
static inline void sample_place(double place[2], int n, int s)
{
    const int column = s % n, row = s / n;
    place[0] = (column + (row + 0.5) / n) / n;
    place[1] = (row + (n - column - 0.5) / n) / n;
}

/* view_ray for all samples, in arrays. */
void pixels_rays(Rays *rays, const PixelBlock *block, const View *view);
/* Columns and rows from, to, of all pixels. */
void pixels_box(double box_px[4], const PixelBlock *block);
/* A key for each hit that seeds its random choices: from its position on the picture, independent of the block. */
void pixels_keys(uint64_t *key, const PixelBlock *block, const Hits *hits, int width);
/* How many pixels of the block from p on lie side by side. */
int  pixels_run(const PixelBlock *block, int p);
/* The sample nearest a pixel's centre; of equals, the first. */
int  pixels_centre_sample(int n);
/* Mean of a value over each pixel's hits, with this share, and what the plane holds there with the rest, into a plane of
 * this width. */
void pixels_average(float *plane, int width, const PixelBlock *block, const Hits *hits, const float *value,
                    double share);

#endif
