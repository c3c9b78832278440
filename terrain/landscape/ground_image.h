/* terrain/landscape/ground_image.h: appearance of the ground from files, resampled in ENU: land cover classes and a
 * photograph. */
#ifndef TERRAIN_LANDSCAPE_GROUND_IMAGE_H
#define TERRAIN_LANDSCAPE_GROUND_IMAGE_H

#include "terrain/elevation/elevation.h"
#include "terrain/earth/local_frame.h"
#include "terrain/surface.h"

enum { ground_image_mips = 16, cover_windows = 2 };

/* Classes by nearest pixel. Window 0 is fine and about the origin, window 1 eight times coarser and wider. */
typedef struct CoverGrid {
    int      nx, ny;       /* 0: none */
    double   x0_m, y0_m, cell_m; /* south-west corner of the first cell */
    uint8_t *surface;      /* [ny][nx]; SURFACE_NONE where the files have no data */
    bool     borrowed;     /* the classes are another's: not freed */
} CoverGrid;

typedef struct CoverReport {
    const char *table;     /* in static storage, or the caller's */
    double      posting_m;
    int         band;
    long        unknown;   /* cells with a code that the table lacks */
    double      share[SURFACE_COUNT]; /* of the cells of window 0 that have a class */
} CoverReport;

/* table: a CSV (code, surface, note), a name such as worldcover, nlcd or fbfm40 for etc/cover_NAME.csv, or empty: the
 * one of these three with the most of the codes found. band 0: the only one, or FBFM's fourth where there are eight or
 * more, as in landscape files. Failures are logged. */
Status cover_grid_read(CoverGrid out[cover_windows], CoverReport *report, const char *paths, const char *table,
                       int band, const Elevation *elevation, const LocalFrame *frame);
/* Whether a table of codes (terrain.cover_table) can be read; logs what is wrong with it. */
Status cover_table_check(const char *path);
void   cover_grid_free(CoverGrid grid[cover_windows]);
SurfaceClass cover_grid_at(const CoverGrid grid[cover_windows], double x_m, double y_m);

enum { photo_red, photo_green, photo_blue, photo_channels };

/* Sixteen pixels: terrain/landscape/photo_blocks.h. */
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

/* Three bands or one, octets (taken as sRGB) or wider (taken as linear, brightest thousandth cut). */
Status photo_read(Photo *out, double *posting_m, const char *paths, const Elevation *elevation,
                  const LocalFrame *frame);
void   photo_free(Photo *photo);
/* Linear light averaged over the footprint, and how much of it the photograph covers (0 .. 1). */
double photo_at(double linear[photo_channels], const Photo *photo, double x_m, double y_m, double footprint_m);
/* The second of these alone, of the finest pixels. */
double photo_cover_at(const Photo *photo, double x_m, double y_m);

#endif
