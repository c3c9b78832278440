/* render/light/canopy_private.h: the grid of a canopy, shared by canopy.c and canopy_grid.c. */
#ifndef RENDER_LIGHT_CANOPY_PRIVATE_H
#define RENDER_LIGHT_CANOPY_PRIVATE_H

#include "render/light/canopy.h"

static const double canopy_cell_m = 8;
static const double leaf_area_step = 1.0 / 16, top_step_m = 0.25, clumped_step = 1.0 / 128;

typedef struct CanopyCell {
    uint8_t leaf_area; /* of leaf_area_step */
    uint8_t top, base; /* of top_step_m, above the ground */
    uint8_t
        clumped; /* leaf area at random that hides as much of light from nearly overhead, over its own: of 1 / 128 */
} CanopyCell;

/* What the ground of a cell sees of an even sky past the plants about it. */
typedef struct CanopySky {
    uint8_t area;       /* leaf area at random, of sky_area_step, that hides as much of it */
    int8_t  towards[2]; /* east, north: light on a wall that faces there less that on one that faces away, of what a sky
                         * without plants gives level ground, of sky_towards_step */
} CanopySky;
static const double sky_area_step = 1.0 / 32, sky_towards_step = 0.5 / 127;

typedef struct CanopyPages CanopyPages; /* canopy_grid.c */

enum { gap_steps = 512 };
static const double gap_most = 16; /* 2 E3 of it is 1e-8 */

struct Canopy {
    int          nx, ny;
    double       x0_m, y0_m;
    CanopyCell  *cell;
    CanopySky   *sky;                        /* of the same cells */
    CanopyCell   mean;                       /* of all leaves: heights alone */
    float        gap[gap_steps + 2];         /* canopy_gap, of clumped leaves */
    float        low_gap[gap_steps + 2];     /* the same of the sky that a wall sees */
    double       clumping[plant_shade_ways]; /* as clumped, over that from nearly overhead */
    double       above[plant_shade_heights]; /* shares of what hides all the sky, by height from base to top */
    double       below[plant_shade_heights]; /* and of what hides all the ground */
    double       own;                        /* hides of a plant's own shadow about it, the mean; 0: none is known */
    double       open_up, open_down;         /* of a leaf or branch, the mean of all */
    double       scattered[optical_channel_count]; /* w */
    CanopyPages *pages;                            /* NULL: none */
};

/* canopy_shade.c. Fills in gap, clumping, above and below. */
void canopy_find_shade(Canopy *c, const Woods *woods, const Plants *plants, bool leaves);
/* Fills in sky, once the cells are. */
void canopy_find_sky(Canopy *c, const Plants *plants);
/* Leaf area at random that hides as much as a plant, m2, where shadows fall anywhere; the area over which its shadow is
 * spread, and that of the shadow, of light from nearly overhead. */
typedef struct PlantArea {
    double hides, spread, shadow;
} PlantArea;
PlantArea canopy_plant_area(const Plants *plants, int kind, double height_m, double wide);
/* The same index of plants that stand apart. */
double canopy_apart(double hides, double spread_m2, double shadow_m2);

/* Canopy.above or below at a height in the crowns, 0 .. 1. */
static inline double canopy_share_at(const double by_height[plant_shade_heights], double x)
{
    const double at = x * (plant_shade_heights - 1);
    const int    i = at < plant_shade_heights - 2 ? (int)at : plant_shade_heights - 2;
    return by_height[i] + (at - i) * (by_height[i + 1] - by_height[i]);
}

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
