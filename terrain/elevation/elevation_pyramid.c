/* terrain/elevation/elevation_pyramid.c: the highest post and the steepest rises of squares of cells, rounded up. */
#include "terrain/elevation/elevation.h"

enum { square = 1 << elevation_pyramid_first, rise_square = 1 << elevation_rise_level };

static inline uint16_t max_u16(uint16_t a, uint16_t b)
{
    return a > b ? a : b;
}

/* A height or a rise in units of 1 << shift, rounded up; at most 65535 by the choice of the shift. */
static inline uint16_t rounded_up(int32_t posts, int shift)
{
    return (uint16_t)((posts + (1 << shift) - 1) >> shift);
}

static size_t tile_count(const ElevationLevel *level)
{
    return (size_t)level->tiles_x * (size_t)level->tiles_y;
}

/* Finest units that hold the level's heights and rises. */
static void choose_units(ElevationLevel *level)
{
    int32_t base = INT32_MAX, top = INT32_MIN, shift = 0;
    for (size_t t = 0; t < tile_count(level); t++) {
        const ElevationTile tile = level->tile[t];
        const uint16_t     *stored = level->stored + t * elevation_tile_posts;
        uint16_t            most = 0;
        for (int n = 0; n < elevation_tile_posts; n++) most = max_u16(most, stored[n]);
        const int32_t high = tile.base + ((int32_t)most << tile.shift);
        base  = tile.base < base ? tile.base : base;
        top   = high > top ? high : top;
        shift = tile.shift > shift ? tile.shift : shift;
    }
    level->pyramid_base = base;
    level->rise_shift   = shift; /* an edge lies in one tile */
    for (level->pyramid_shift = 0; top - base > 65535 << level->pyramid_shift;) level->pyramid_shift++;
}

/* The first maxima, a tile at a time: of the five rows of a square's posts, then of five columns. */
static void tile_maxima(ElevationLevel *level, int ti, int tj)
{
    enum { k = elevation_pyramid_first, squares = elevation_tile_cells / square };
    const size_t        t = (size_t)tj * (size_t)level->tiles_x + (size_t)ti;
    const ElevationTile tile = level->tile[t];
    const int           nx = level->pyramid_nx[k], wide = nx - ti * squares, tall = level->pyramid_ny[k] - tj * squares;
    for (int j = 0; j < squares && j < tall; j++) {
        const uint16_t *row = level->stored + t * elevation_tile_posts + (size_t)(j * square * elevation_tile_side);
        uint16_t       *out = level->pyramid[k] + (size_t)(tj * squares + j) * (size_t)nx + (size_t)(ti * squares);
        uint16_t        most[elevation_tile_side];
        memcpy(most, row, sizeof most);
        for (int n = 1; n <= square; n++)
            for (int i = 0; i < elevation_tile_side; i++) most[i] = max_u16(most[i], row[n * elevation_tile_side + i]);
        for (int i = 0; i < squares && i < wide; i++) {
            uint16_t high = most[i * square];
            for (int n = 1; n <= square; n++) high = max_u16(high, most[i * square + n]);
            const int32_t above = tile.base - level->pyramid_base + ((int32_t)high << tile.shift);
            out[i] = rounded_up(above, level->pyramid_shift);
        }
    }
}

/* A node's highest of up to four below it; equal for all levels, since they share one unit. */
static void halve_maxima(uint16_t *restrict out, int out_w, int out_h, const uint16_t *restrict in, int w, int h)
{
    for (int j = 0; j < out_h; j++) {
        const uint16_t *a = in + (size_t)(2 * j) * (size_t)w;
        const uint16_t *b = 2 * j + 1 < h ? a + w : a;
        uint16_t       *to = out + (size_t)j * (size_t)out_w;
        for (int i = 0; i < w / 2; i++)
            to[i] = max_u16(max_u16(a[2 * i], a[2 * i + 1]), max_u16(b[2 * i], b[2 * i + 1]));
        if (w % 2) to[out_w - 1] = max_u16(a[w - 1], b[w - 1]);
    }
}

/* Rise from a to b into `to`, from b to a into `from`, of count edges. */
static void steepest(uint16_t *restrict to, uint16_t *restrict from, const uint16_t *a, const uint16_t *b, int count)
{
    for (int i = 0; i < count; i++) {
        const uint16_t up = (uint16_t)(b[i] > a[i] ? b[i] - a[i] : 0), down = (uint16_t)(a[i] > b[i] ? a[i] - b[i] : 0);
        to[i]   = max_u16(to[i], up);
        from[i] = max_u16(from[i], down);
    }
}

/* The first rises, a tile at a time: a row of nodes' steepest of each column of edges, then of a node's. */
static void tile_rises(ElevationLevel *level, int ti, int tj)
{
    enum { k = elevation_rise_level, side = elevation_tile_side, squares = elevation_tile_cells / rise_square };
    const size_t t = (size_t)tj * (size_t)level->tiles_x + (size_t)ti;
    const int    shift = level->tile[t].shift, nx = level->pyramid_nx[k];
    const int    wide = nx - ti * squares, tall = level->pyramid_ny[k] - tj * squares;
    for (int j = 0; j < squares && j < tall; j++) {
        const uint16_t *row = level->stored + t * elevation_tile_posts + (size_t)(j * rise_square * side);
        ElevationRise  *out = level->rise[k] + (size_t)(tj * squares + j) * (size_t)nx + (size_t)(ti * squares);
        uint16_t        steep[4][side] = {{0}};
        for (int n = 0; n <= rise_square; n++, row += side) {
            steepest(steep[0], steep[1], row, row + 1, side - 1);
            if (n < rise_square) steepest(steep[2], steep[3], row, row + side, side);
        }
        for (int i = 0; i < squares && i < wide; i++) {
            uint16_t most[4] = {0};
            for (int c = 0; c < 4; c++) {
                for (int n = 0; n < rise_square + (c >= 2); n++)
                    most[c] = max_u16(most[c], steep[c][i * rise_square + n]);
                most[c] = rounded_up((int32_t)most[c] << shift, level->rise_shift);
            }
            out[i] = (ElevationRise){most[0], most[1], most[2], most[3]};
        }
    }
}

static void halve_rises(ElevationLevel *level, int k)
{
    const int w = level->pyramid_nx[k - 1], h = level->pyramid_ny[k - 1];
    for (int j = 0; j < level->pyramid_ny[k]; j++)
        for (int i = 0; i < level->pyramid_nx[k]; i++) {
            ElevationRise most = {0};
            for (int n = 0; n < 4; n++) {
                const int at_i = 2 * i + n % 2, at_j = 2 * j + n / 2;
                if (at_i >= w || at_j >= h) continue;
                const ElevationRise *part = &level->rise[k - 1][(size_t)at_j * (size_t)w + (size_t)at_i];
                most.east  = max_u16(most.east, part->east);
                most.west  = max_u16(most.west, part->west);
                most.north = max_u16(most.north, part->north);
                most.south = max_u16(most.south, part->south);
            }
            level->rise[k][(size_t)j * (size_t)level->pyramid_nx[k] + (size_t)i] = most;
        }
}

void elevation_build_pyramid_tiles(ElevationLevel *level, int tile_j)
{
    for (int ti = 0; ti < level->tiles_x; ti++) {
        tile_maxima(level, ti, tile_j);
        if (level->pyramid_count > elevation_rise_level) tile_rises(level, ti, tile_j);
    }
}

void elevation_begin_pyramid(ElevationLevel *level)
{
    elevation_fill_edges(level);
    level->pyramid_base = level->pyramid_shift = level->rise_shift = 0;
    if (!level->plain) choose_units(level);
}

void elevation_finish_pyramid(ElevationLevel *level)
{
    for (int k = elevation_pyramid_first + 1; k < level->pyramid_count; k++)
        halve_maxima(level->pyramid[k], level->pyramid_nx[k], level->pyramid_ny[k], level->pyramid[k - 1],
                     level->pyramid_nx[k - 1], level->pyramid_ny[k - 1]);
    for (int k = elevation_rise_level + 1; k < level->pyramid_count; k++) halve_rises(level, k);
}

void elevation_build_pyramids(Elevation *elevation)
{
    for (int n = 0; n < elevation->level_count; n++) {
        ElevationLevel *level = &elevation->level[n];
        if (!level->stored || level->borrowed) continue;
        elevation_begin_pyramid(level);
        for (int tj = 0; tj < level->tiles_y; tj++) elevation_build_pyramid_tiles(level, tj);
        elevation_finish_pyramid(level);
    }
}
