/* render/light/canopy_private.h: the grid of a canopy, shared by canopy.c and canopy_grid.c. */
#ifndef RENDER_LIGHT_CANOPY_PRIVATE_H
#define RENDER_LIGHT_CANOPY_PRIVATE_H

#include "render/light/canopy.h"

static const double canopy_cell_m = 8;
static const double leaf_area_step = 1.0 / 16, top_step_m = 0.25;

typedef struct CanopyCell {
    uint8_t leaf_area; /* of leaf_area_step */
    uint8_t top, base; /* of top_step_m, above the ground */
    uint8_t spare;
} CanopyCell;

typedef struct CanopyPages CanopyPages; /* canopy_grid.c */

enum { gap_steps = 512 };
static const double gap_most = 16; /* 2 E3 of it is 1e-8 */

struct Canopy {
    int          nx, ny;
    double       x0_m, y0_m;
    CanopyCell  *cell;
    float        gap[gap_steps + 2];
    double       open_up, open_down;               /* of a leaf or branch, the mean of all */
    double       scattered[optical_channel_count]; /* w */
    CanopyPages *pages;                            /* NULL: none */
};

typedef struct CanopyGrid {
    CanopyCell *cell; /* [nx * ny], of zeroes */
    int         nx, ny;
    double      x0_m, y0_m; /* south-west corner, ENU */
} CanopyGrid;

/* Fills in the cells of plants whose positions are relative to origin_enu; leaves: false: deciduous plants have none.
 * STATUS_NO_MEMORY. */
Status canopy_fill_grid(const CanopyGrid *grid, const double origin_enu[3], const Plant *plant, int count,
                        const Plants *plants, bool leaves);
/* The cell of a page at whole numbers of cells from the woods' corner; NULL: the woods' own is there, or none. c has
 * pages. */
const CanopyCell *canopy_page_cell(const Canopy *c, double i, double j);
double            canopy_pages_reach_m(const Canopy *c);    /* 0: it has none */
void              canopy_pages_destroy(CanopyPages *pages); /* accepts NULL */

#endif
