/* terrain/landscape/raster_window.h: a window of ENU, and the positions of its cells in a raster. */
#ifndef TERRAIN_LANDSCAPE_RASTER_WINDOW_H
#define TERRAIN_LANDSCAPE_RASTER_WINDOW_H

#include "terrain/earth/local_frame.h"
#include "terrain/elevation/elevation.h"
#include "terrain/elevation/raster.h"

/* A window of square cells, and where the corners of blocks of them lie in a raster. */
typedef struct Window {
    double x0_m, y0_m, cell_m;
    int    nx, ny;
} Window;

enum { block_cells = 32 };

/* Pixel of the raster under each cell's centre, a row of blocks at a time: exact at the corners of blocks on the
 * surface itself, linear between (over 32 cells of 1 m the lean of a 100 m cliff 8 km out would show as 0.1 m). */
typedef struct Finder {
    const Raster    *raster;
    const Elevation *elevation;
    const LocalFrame *frame;
    Window           window;
    double          *x, *y; /* [2][blocks + 1] */
    int              blocks, row; /* row of blocks that is loaded */
} Finder;

Status finder_create(Finder *f, const Raster *raster, const Elevation *elevation, const LocalFrame *frame,
                     const Window *window);
void   finder_free(Finder *f);
void   finder_at(double px[2], Finder *f, int i, int j); /* pixel under the centre of a cell */
/* Pixels of the raster that one row of blocks can touch; false: none. Reading row by row keeps memory small. */
bool   finder_bounds(int box[4], Finder *f, int row);
/* ENU rectangle of a raster about the origin, no wider than `half_m` each way, in whole blocks. */
bool   window_of(Window *out, const Raster *raster, const LocalFrame *frame, double cell_m, double half_m);

#endif
