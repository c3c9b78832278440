/* terrain/ground/ground_image.h: appearance of the ground from files, resampled in ENU: a photograph, and land cover
 * classes. */
#ifndef TERRAIN_GROUND_GROUND_IMAGE_H
#define TERRAIN_GROUND_GROUND_IMAGE_H

#include "terrain/earth/geodesy.h"
#include "terrain/elevation/elevation.h"
#include "terrain/surface.h"

/* ---- a photograph -------------------------------------------------------------------------------- */

/* Stored in blocks of 4 x 4 pixels in 8 octets. A block is that of BC1 (S3TC, DXT1): two colours of 5, 6 and 5 bits
 * and 2 bits a pixel. first > second: a pixel is one of first, second, (2 first + second) / 3, (first + 2 second) / 3;
 * else first, second, their mean, or not covered. Colours are mixed as encoded (sRGB). Source of the layout: Khronos
 * Data Format Specification 1.3, section 18.1 (BC1). Half an octet a pixel, 0.67 with the mips. Errors:
 * tests/terrain/test_photo.c. */

enum { ground_image_mips = 16 };

enum { photo_red, photo_green, photo_blue, photo_channels };

/* Sixteen pixels. */
typedef struct PhotoBlock {
    uint16_t first, second; /* colours of 5, 6 and 5 bits */
    uint32_t index;         /* 2 bits a pixel, row by row from the south-west, the first lowest */
} PhotoBlock;

/* A photograph: linear light encoded as sRGB, and coverage, in blocks of 4 x 4 pixels. */
typedef struct Photo {
    int         mips; /* number of mips; 0: there is no photograph */
    int         nx[ground_image_mips], ny[ground_image_mips];
    double      x0_m, y0_m, cell_m;       /* south-west corner, and pixel size of mip 0 */
    PhotoBlock *block[ground_image_mips]; /* [(ny + 3) / 4][(nx + 3) / 4] */
    bool        borrowed;                 /* the blocks belong to another object: they are not freed */
    float       mean[SURFACE_COUNT]
              [photo_channels]; /* linear mean over each class; set by the caller, which knows the classes */
} Photo;

void photo_free(Photo *photo);
/* Mean linear light over the footprint; returns the share of it that the photograph covers, 0 .. 1. */
double photo_at(double linear[photo_channels], const Photo *photo, double x_m, double y_m, double footprint_m);
/* That share alone, from the finest pixels. */
double photo_cover_at(const Photo *photo, double x_m, double y_m);

/* Its storage. */

/* The curve of sRGB (IEC 61966-2-1): linear light of an octet, and the octet nearest to a linear value in 0 .. 1. */
float   photo_linear(uint8_t encoded);
uint8_t photo_encoded(float linear);

/* The block of four by four pixels, row by row from the south: sRGB, and coverage, which counts from 128 on. */
PhotoBlock photo_block(const uint8_t rgba[16][4]);
/* One row of blocks, (nx + 3) / 4, from up to four rows of pixels, [rows][nx][4]. Missing pixels repeat the last. */
void photo_block_row(PhotoBlock *out, const uint8_t *rgba, int nx, int rows);
/* One row of the next mip, (nx + 1) / 2 pixels: the mean linear light of the covered pixels. north NULL: there is no
 * such row. */
void photo_halve_row(uint8_t *out, const uint8_t *south, const uint8_t *north, int nx);
/* Sets the sizes of all mips from that of the first; returns the number of mips. */
int                  photo_mips(int nx[ground_image_mips], int ny[ground_image_mips]);
static inline size_t photo_blocks_across(int n) { return ((size_t)n + 3) / 4; }
/* Number of blocks of one mip. */
static inline size_t photo_block_count(const Photo *p, int k)
{
    return photo_blocks_across(p->nx[k]) * photo_blocks_across(p->ny[k]);
}

/* Reads a photograph of three bands or one. Octets are taken as sRGB; wider samples as linear, with the brightest
 * thousandth cut off. */
Status photo_read(Photo *out, double *posting_m, const char *paths, const Elevation *elevation,
                  const LocalFrame *frame);

/* ---- classes ------------------------------------------------------------------------------------- */

enum { cover_windows = 2 };

/* Classes by nearest pixel. Window 0 is fine and about the origin, window 1 eight times coarser and wider. */
typedef struct CoverGrid {
    int      nx, ny;             /* 0: there is no grid */
    double   x0_m, y0_m, cell_m; /* south-west corner of the first cell */
    uint8_t *surface;            /* [ny][nx]; SURFACE_NONE where the files have no data */
    bool     borrowed;           /* the classes belong to another object: they are not freed */
} CoverGrid;

typedef struct CoverReport {
    const char *table; /* name of the table, in static storage or the caller's */
    double      posting_m;
    int         band;
    long        unknown;              /* cells with a code that the table lacks */
    double      share[SURFACE_COUNT]; /* shares of each class in those cells of window 0 that have one */
} CoverReport;

/* table: a CSV (code, surface, note), a name such as worldcover, nlcd or fbfm40 for etc/cover_NAME.csv, or empty: the
 * one of these three with the most of the codes found. band 0: the only one, or FBFM's fourth where there are eight or
 * more, as in landscape files. Failures are logged. */
Status       cover_grid_read(CoverGrid out[cover_windows], CoverReport *report, const char *paths, const char *table,
                             int band, const Elevation *elevation, const LocalFrame *frame);
void         cover_grid_free(CoverGrid grid[cover_windows]);
SurfaceClass cover_grid_at(const CoverGrid grid[cover_windows], double x_m, double y_m);

#endif
