/* terrain/elevation/elevation.h: the ground as nested regular grids in ENU, out to the horizon.
 *
 * Level 0 is the finest and innermost; each further level is coarser and encloses the one before. A post
 * is u16 (z_m = z0_m + step_m * post, in double: one product, one sum). The surface of a level inside the
 * one before it does not exist.
 *
 * A cell is two triangles, split along the diagonal from its south-west (i, j) to its north-east (i+1, j+1)
 * post. With u = (x - x_i) / spacing, v = (y - y_j) / spacing and the four dequantised heights:
 *
 *     u >= v, south-east:  SW SE NE    z = sw + u (se - sw) + v (ne - se)
 *     u <  v, north-west:  SW NE NW    z = sw + u (ne - nw) + v (nw - sw)
 *
 * Seams. The spacing of level k+1 is a whole multiple of that of level k, and the outline of level k runs
 * along cell edges of level k+1: the hole is a whole number of cells. A landscape of Pitviper goes further:
 * steps, origins and spacings are dyadic, and each edge post of level k is *exactly* on the straight edge
 * between two posts of level k+1, so the two surfaces are equal along the seam to the last bit and there is
 * neither crack nor skirt. What remains is a tracer's own rounding, and one rule closes it (it also closes
 * the seams of a terrain that only has the first property):
 *
 *     The ground is solid. A ray that is below the surface at the place where it enters a cell, from a
 *     neighbour, from another level, or at a level's outline from outside, hits there: range at the entry,
 *     normal of the triangle entered. Compare the ray's z with the surface at the entry; do not require a proper
 *     crossing of a triangle.
 *
 * Beyond the outermost level there is nothing: such rays see the sky. */
#ifndef TERRAIN_ELEVATION_ELEVATION_H
#define TERRAIN_ELEVATION_ELEVATION_H

#include "pitviper.h"

enum { elevation_max_levels = 4, elevation_pyramid_levels = 16, elevation_rise_level = 3 };

/* The steepest rise of any edge of a square's cells, each way: posts a cell, 0 where the ground only falls. */
typedef struct ElevationRise {
    uint16_t east, west, north, south;
} ElevationRise;

typedef struct ElevationLevel {
    int       nx, ny;          /* posts, >= 2; post (i, j) at (x0 + i spacing, y0 + j spacing) */
    double    x0_m, y0_m, spacing_m;
    double    z0_m, step_m;    /* dequantisation */
    uint16_t *post;            /* [ny][nx], row j northwards */
    /* Highest post of a square of cells. pyramid[0] has one entry a cell (nx-1 by ny-1: the maximum of its
     * four posts); each next one halves, rounding up, to a single entry. Cells of the hole are included. */
    int       pyramid_count;
    uint16_t *pyramid[elevation_pyramid_levels];
    int       pyramid_nx[elevation_pyramid_levels], pyramid_ny[elevation_pyramid_levels];
    ElevationRise *rise[elevation_pyramid_levels]; /* as the pyramid, from elevation_rise_level on; else NULL */
} ElevationLevel;

typedef struct Elevation {
    int            level_count;
    ElevationLevel level[elevation_max_levels];
} Elevation;

/* Allocates level `index` and its pyramid; posts zero. The elevation starts zeroed; a level is created once.
 * STATUS_BAD_VALUE: 2 <= nx, ny <= 32768, spacing and step positive and finite. */
Status elevation_level_create(Elevation *elevation, int index, int nx, int ny, double x0_m, double y0_m,
                              double spacing_m, double z0_m, double step_m);
void   elevation_build_pyramids(Elevation *elevation);
void   elevation_destroy(Elevation *elevation); /* accepts a half-built one */

/* Height of the surface and (if not NULL) its upward unit normal at an ENU place, on the triangle the
 * tracer would hit. NaN beyond the outermost level (the normal is then unchanged). */
double elevation_height(const Elevation *elevation, double x_m, double y_m, double normal_enu[3]);

#endif
