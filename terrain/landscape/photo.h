/* terrain/landscape/photo.h: a photograph of the ground in ENU, stored in blocks of 4 x 4 pixels in 8 octets.
 *
 * A block is that of BC1 (S3TC, DXT1): two colours of 5, 6 and 5 bits and 2 bits a pixel. first > second: a pixel is
 * one of first, second, (2 first + second) / 3, (first + 2 second) / 3; else first, second, their mean, or not covered.
 * Colours are mixed as encoded (sRGB). Source of the layout: Khronos Data Format Specification 1.3, section 18.1
 * (BC1). Half an octet a pixel, 0.67 with the mips. Errors: tests/terrain/test_photo.c. */
#ifndef TERRAIN_LANDSCAPE_PHOTO_H
#define TERRAIN_LANDSCAPE_PHOTO_H

#include "terrain/surface.h"

enum { ground_image_mips = 16 };

enum { photo_red, photo_green, photo_blue, photo_channels };

/* Sixteen pixels. */
typedef struct PhotoBlock {
    uint16_t first, second; /* colours of 5, 6 and 5 bits */
    uint32_t index;         /* 2 bits a pixel, row by row from the south-west, the first lowest */
} PhotoBlock;

/* A photograph: linear light encoded as sRGB, and coverage, in blocks of 4 x 4 pixels. */
typedef struct Photo {
    int      mips;         /* 0: none */
    int      nx[ground_image_mips], ny[ground_image_mips];
    double   x0_m, y0_m, cell_m; /* corner; of mip 0 */
    PhotoBlock *block[ground_image_mips]; /* [(ny + 3) / 4][(nx + 3) / 4] */
    bool     borrowed;     /* the blocks are another's: not freed */
    float    mean[SURFACE_COUNT][photo_channels]; /* linear, over each class: filled in by the caller, which has the
                                                   * classes */
} Photo;

void   photo_free(Photo *photo);
/* Linear light averaged over the footprint, and how much of it the photograph covers (0 .. 1). */
double photo_at(double linear[photo_channels], const Photo *photo, double x_m, double y_m, double footprint_m);
/* The second of these alone, of the finest pixels. */
double photo_cover_at(const Photo *photo, double x_m, double y_m);

/* ---- storage ----------------------------------------------------------------------------------- */

/* IEC 61966-2-1, of an octet; and the nearest octet, linear in 0 .. 1. */
float   photo_linear(uint8_t encoded);
uint8_t photo_encoded(float linear);

/* Four pixels by four, row by row from the south: sRGB and coverage, which counts from 128 on. */
PhotoBlock photo_block(const uint8_t rgba[16][4]);
/* One row of blocks, (nx + 3) / 4, of up to four rows of pixels, [rows][nx][4]. Missing pixels repeat the last. */
void photo_block_row(PhotoBlock *out, const uint8_t *rgba, int nx, int rows);
/* One row of the next mip, (nx + 1) / 2 pixels: the mean of the covered linear light. north NULL: there is none. */
void photo_halve_row(uint8_t *out, const uint8_t *south, const uint8_t *north, int nx);
/* Sizes of all mips from those of the first; returns their count. */
int  photo_mips(int nx[ground_image_mips], int ny[ground_image_mips]);
static inline size_t photo_blocks_across(int n) { return ((size_t)n + 3) / 4; }
/* Blocks of one mip. */
static inline size_t photo_block_count(const Photo *p, int k)
{
    return photo_blocks_across(p->nx[k]) * photo_blocks_across(p->ny[k]);
}

#endif
