/* terrain/landscape/ground_image.h: appearance of the ground from files, resampled in ENU: land cover classes and a
 * photograph. */
#ifndef TERRAIN_LANDSCAPE_GROUND_IMAGE_H
#define TERRAIN_LANDSCAPE_GROUND_IMAGE_H

#include "terrain/elevation/elevation.h"
#include "terrain/earth/local_frame.h"
#include "terrain/landscape/photo.h"
#include "terrain/surface.h"

enum { cover_windows = 2 };

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

/* Three bands or one, octets (taken as sRGB) or wider (taken as linear, brightest thousandth cut). */
Status photo_read(Photo *out, double *posting_m, const char *paths, const Elevation *elevation,
                  const LocalFrame *frame);

#endif
