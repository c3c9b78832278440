/* terrain/elevation/elevation.h: the ground as nested regular grids in ENU, out to the horizon.
 *
 * Level 0 is the finest and innermost; each further level is coarser and encloses the one before. A post
 * is an integer (z_m = z0_m + step_m * post, in double: one product, one sum). The surface of a level inside the
 * one before it does not exist.
 *
 * Posts are stored in tiles of 64 x 64 cells, 65 x 65 posts: those on a tile's edge are stored in both tiles, and
 * are equal. post = tile.base + (stored << tile.shift). A base is a multiple of elevation_base_unit and a shift at
 * most elevation_most_shift, so that a post which is a multiple of the coarsest unit (1 << shift) of the tiles that
 * share it is exact in all of them. Stored posts beyond nx, ny repeat the last. The arrays of a level have the same
 * layout whether they were made here or are mapped from a file (borrowed: not freed, never written).
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
 * Beyond the outermost level there is nothing. */
#ifndef TERRAIN_ELEVATION_ELEVATION_H
#define TERRAIN_ELEVATION_ELEVATION_H

#include "pitviper_kept.h"

enum {
    elevation_max_levels = 4,
    elevation_most_posts = 65536, /* most posts along a side of a level */
    elevation_tile_cells = 64,
    elevation_tile_side = 65,
    elevation_tile_posts = 65 * 65,
    elevation_most_shift = 10,
    elevation_base_unit = 1 << elevation_most_shift,
    elevation_lowest_post = -(1 << 25),
    elevation_highest_post = (1 << 25) - elevation_base_unit,
    elevation_pyramid_first = 2, /* finest level of the pyramid: squares of 4 x 4 cells */
    elevation_pyramid_levels = 17,
    elevation_rise_level = 3
};

/* post = base + (stored << shift). A landscape of 0 .. 65535 posts has base 0 and shift 0 everywhere. */
typedef struct ElevationTile {
    int32_t base, shift;
} ElevationTile;

/* The steepest rise of any edge of a square's cells, each way, rounded up: units of (1 << rise_shift) posts a cell, 0
 * where the ground only falls. */
typedef struct ElevationRise {
    uint16_t east, west, north, south;
} ElevationRise;

typedef struct ElevationLevel {
    int            nx, ny; /* posts, >= 2; post (i, j) at (x0 + i spacing, y0 + j spacing) */
    double         x0_m, y0_m, spacing_m;
    double         z0_m, step_m;     /* dequantisation */
    int            tiles_x, tiles_y; /* tiles of elevation_tile_cells a side; the last ones are filled up */
    ElevationTile *tile;             /* [tiles_y][tiles_x] */
    uint16_t      *stored;           /* [tiles_y * tiles_x][65][65], row j northwards */
    bool           plain;            /* every tile has base 0 and shift 0 */
    bool           borrowed;         /* the arrays belong to a mapped file */
    /* Highest post of a square of (1 << k) x (1 << k) cells, rounded up: pyramid_base + (entry << pyramid_shift).
     * NULL below elevation_pyramid_first (a cell's own posts serve); pyramid[pyramid_count - 1] is a single entry.
     * Sizes are given for each k from 0 on. Cells of the hole are included. */
    int            pyramid_count;
    int32_t        pyramid_base, pyramid_shift, rise_shift;
    uint16_t      *pyramid[elevation_pyramid_levels];
    int            pyramid_nx[elevation_pyramid_levels], pyramid_ny[elevation_pyramid_levels];
    ElevationRise *rise[elevation_pyramid_levels]; /* as pyramid, for k from elevation_rise_level on; NULL below */
} ElevationLevel;

typedef struct Elevation {
    int            level_count;
    ElevationLevel level[elevation_max_levels];
} Elevation;

/* Where the posts of a level are: post (i, j) at (x0 + i spacing, y0 + j spacing), its height z0 + step * post. */
typedef struct ElevationGrid {
    int    nx, ny;
    double x0_m, y0_m, spacing_m, z0_m, step_m;
} ElevationGrid;

/* Computes the sizes of a level's arrays, which it does not allocate. STATUS_BAD_VALUE unless 2 <= nx, ny <=
 * elevation_most_posts, stored posts are at most 2^31 - 1 (2.0e9 posts), spacing and step are positive, and all is
 * finite. */
Status elevation_level_describe(ElevationLevel *out, const ElevationGrid *grid);
size_t elevation_level_stored(const ElevationLevel *level); /* elements of `stored` */

/* Allocates level `index` and its pyramid; bases, shifts and posts are zero. The elevation must be zeroed before its
 * first level; each level is created once. */
Status elevation_level_create(Elevation *elevation, int index, const ElevationGrid *grid);
void   elevation_build_pyramids(Elevation *elevation); /* not those of borrowed levels */

/* The same of one level, in parts: begin, the rows of tiles (on any threads), finish. */
void elevation_begin_pyramid(ElevationLevel *level);
void elevation_build_pyramid_tiles(ElevationLevel *level, int tile_j);
void elevation_finish_pyramid(ElevationLevel *level);

void elevation_destroy(Elevation *elevation); /* accepts a half-built one */

/* KeptValues of an Elevation, of zeroes while it is read; after what is wrong it is half built. */
KeptValues elevation_kept_values;

/* ---- writing: first the tiles' bases and shifts, then the posts ------------------------------------ */

/* Base and shift of a tile whose posts are low .. high (within elevation_lowest_post .. elevation_highest_post), so
 * that these posts, rounded to any unit up to elevation_base_unit, fit. */
ElevationTile elevation_tile_of(int32_t low, int32_t high);

/* One post, rounded to the coarsest unit of the (up to four) tiles that share it, in all of them. The tiles must be
 * able to hold it. */
void elevation_set_post(ElevationLevel *level, int i, int j, int32_t post);

/* The tiles tile_j of a level, from rows of posts [rows][nx]: row[0] is the row 64 tile_j of the level; 65 rows, fewer
 * at the northern edge, nothing beyond nx, ny is read. First bases and shifts of all tiles (posts within the range
 * above; set level->plain too), then the posts, rounded as by elevation_set_post: that writes nothing else, so rows of
 * tiles can be filled on several threads. */
void elevation_choose_tiles(ElevationLevel *level, int tile_j, const int32_t *row);
void elevation_fill_tiles(ElevationLevel *level, int tile_j, const int32_t *row);

/* Lowest and highest of those rows' posts within a tile. */
void elevation_tile_range(int32_t range[2], const ElevationLevel *level, int tile_i, int tile_j, const int32_t *row);

/* Stored posts beyond nx, ny repeat the last: after elevation_set_post (elevation_build_pyramids begins with it). */
void elevation_fill_edges(ElevationLevel *level);

/* All of a level from [ny][nx] posts: bases and shifts (0 everywhere where all posts are 0 .. 65535), and posts.
 * STATUS_BAD_VALUE: a post out of range; nothing is written. */
Status elevation_fill(ElevationLevel *level, const int32_t *post);

/* ---- reading --------------------------------------------------------------------------------------- */

/* The tile of cell or post (i, j), 0 <= i < nx, and the index of that post in `stored`; the last post of a full tile
 * is found in the tile before it. */
static inline size_t elevation_tile_index(const ElevationLevel *level, int i, int j)
{
    const int a = i / elevation_tile_cells, b = j / elevation_tile_cells;
    return (size_t)(b < level->tiles_y ? b : b - 1) * (size_t)level->tiles_x + (size_t)(a < level->tiles_x ? a : a - 1);
}

static inline size_t elevation_stored_index(const ElevationLevel *level, int i, int j)
{
    const int a = i / elevation_tile_cells, b = j / elevation_tile_cells;
    const int tile_i = a < level->tiles_x ? a : a - 1, tile_j = b < level->tiles_y ? b : b - 1;
    return ((size_t)tile_j * (size_t)level->tiles_x + (size_t)tile_i) * elevation_tile_posts +
           (size_t)(j - tile_j * elevation_tile_cells) * elevation_tile_side +
           (size_t)(i - tile_i * elevation_tile_cells);
}

/* base + (stored << shift), defined for any tile: one of a mapped file may be damaged. */
static inline int32_t elevation_of_tile(ElevationTile tile, uint16_t stored)
{
    return (int32_t)((uint32_t)tile.base + ((uint32_t)stored << (tile.shift & 31)));
}

/* Post (i, j) in whole steps, and its height in metres. */
static inline int32_t elevation_post(const ElevationLevel *level, int i, int j)
{
    return elevation_of_tile(level->tile[elevation_tile_index(level, i, j)],
                             level->stored[elevation_stored_index(level, i, j)]);
}

static inline double elevation_post_m(const ElevationLevel *level, int i, int j)
{
    return level->z0_m + level->step_m * elevation_post(level, i, j);
}

/* South-west, south-east, north-west and north-east post of cell (i, j), 0 <= i < nx - 1. */
static inline void elevation_cell(int32_t post[4], const ElevationLevel *level, int i, int j)
{
    const size_t tile =
        (size_t)(j / elevation_tile_cells) * (size_t)level->tiles_x + (size_t)(i / elevation_tile_cells);
    const ElevationTile of = level->tile[tile];
    const uint16_t     *south = level->stored + tile * elevation_tile_posts +
                            (size_t)(j % elevation_tile_cells * elevation_tile_side + i % elevation_tile_cells);
    for (int k = 0; k < 4; k++) post[k] = elevation_of_tile(of, south[k % 2 + k / 2 * elevation_tile_side]);
}

/* Highest post under node (i, j) of pyramid level k, rounded up as stored. */
static inline int32_t elevation_highest(const ElevationLevel *level, int k, int i, int j)
{
    return level->pyramid_base +
           ((int32_t)level->pyramid[k][(size_t)j * (size_t)level->pyramid_nx[k] + (size_t)i] << level->pyramid_shift);
}

/* Height of the surface and (if not NULL) its upward unit normal at an ENU place, on the triangle the
 * tracer would hit. NaN beyond the outermost level (the normal is then unchanged). */
double elevation_height(const Elevation *elevation, double x_m, double y_m, double normal_enu[3]);

#endif
