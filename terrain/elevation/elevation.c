/* terrain/elevation/elevation.c: nested grids of posts: their memory, look-up, tiles, and pyramids. */
#include "terrain/elevation/elevation.h"

#include <stdlib.h>
#include <sys/mman.h>

/* ---- memory and look-up -------------------------------------------------------------------------- */

/* Allocates zeroed heights; NULL: no memory. A ray touches few of hundreds of megabytes, so large arrays use huge pages
 * where available; without them half the time of a look-up would be the TLB miss. */
static void *heights_create(size_t count, size_t size)
{
    static const size_t page = (size_t)1 << 21;
    const size_t        bytes = count * size;
    if (bytes < 2 * page) return calloc(count, size);
    void *heights = aligned_alloc(page, (bytes + page - 1) / page * page);
    if (!heights) return NULL;
    madvise(heights, bytes, MADV_HUGEPAGE); /* advisory: without huge pages only the run time changes */
    return memset(heights, 0, bytes);
}

Status elevation_level_describe(ElevationLevel *out, const ElevationGrid *grid)
{
    const int nx = grid->nx, ny = grid->ny;
    if (nx < 2 || ny < 2 || nx > elevation_most_posts || ny > elevation_most_posts) return STATUS_BAD_VALUE;
    if (!(grid->spacing_m > 0 && grid->step_m > 0) || !isfinite(grid->spacing_m) || !isfinite(grid->step_m))
        return STATUS_BAD_VALUE;
    if (!isfinite(grid->x0_m) || !isfinite(grid->y0_m) || !isfinite(grid->z0_m)) return STATUS_BAD_VALUE;

    ElevationLevel level = {.nx = nx,
                            .ny = ny,
                            .x0_m = grid->x0_m,
                            .y0_m = grid->y0_m,
                            .spacing_m = grid->spacing_m,
                            .z0_m = grid->z0_m,
                            .step_m = grid->step_m,
                            .plain = true};
    level.tiles_x = (nx - 2) / elevation_tile_cells + 1;
    level.tiles_y = (ny - 2) / elevation_tile_cells + 1;
    if (elevation_level_stored(&level) > INT32_MAX) return STATUS_BAD_VALUE;
    for (int k = 0, w = nx - 1, h = ny - 1;; k++, w = (w + 1) / 2, h = (h + 1) / 2) {
        level.pyramid_nx[k] = w;
        level.pyramid_ny[k] = h;
        level.pyramid_count = k + 1;
        if (w == 1 && h == 1 && k >= elevation_pyramid_first) break; /* 65535 cells halve to one in 16 steps */
    }
    *out = level;
    return STATUS_OK;
}

size_t elevation_level_stored(const ElevationLevel *level)
{
    return (size_t)level->tiles_x * (size_t)level->tiles_y * elevation_tile_posts;
}

static void free_arrays(ElevationLevel *level)
{
    if (level->borrowed) return;
    free(level->tile);
    free(level->stored);
    for (int k = 0; k < elevation_pyramid_levels; k++) {
        free(level->pyramid[k]);
        free(level->rise[k]);
    }
}

Status elevation_level_create(Elevation *elevation, int index, const ElevationGrid *grid)
{
    ElevationLevel level;
    if (index < 0 || index >= elevation_max_levels) return STATUS_BAD_VALUE;
    const Status status = elevation_level_describe(&level, grid);
    if (status != STATUS_OK) return status;

    level.tile = calloc((size_t)level.tiles_x * (size_t)level.tiles_y, sizeof *level.tile);
    level.stored = heights_create(elevation_level_stored(&level), sizeof *level.stored);
    bool whole = level.tile && level.stored;
    for (int k = elevation_pyramid_first; k < level.pyramid_count && whole; k++) {
        const size_t nodes = (size_t)level.pyramid_nx[k] * (size_t)level.pyramid_ny[k];
        level.pyramid[k] = heights_create(nodes, sizeof **level.pyramid);
        if (k >= elevation_rise_level) level.rise[k] = heights_create(nodes, sizeof **level.rise);
        whole = level.pyramid[k] && (k < elevation_rise_level || level.rise[k]);
    }
    if (!whole) {
        free_arrays(&level);
        return STATUS_NO_MEMORY;
    }

    elevation->level[index] = level;
    if (elevation->level_count <= index) elevation->level_count = index + 1;
    return STATUS_OK;
}

void elevation_destroy(Elevation *elevation)
{
    if (!elevation) return;
    for (int n = 0; n < elevation_max_levels; n++) free_arrays(&elevation->level[n]);
    *elevation = (Elevation){0};
}

double elevation_height(const Elevation *elevation, double x_m, double y_m, double normal_enu[3])
{
    for (int n = 0; n < elevation->level_count; n++) {
        const ElevationLevel *level = &elevation->level[n];
        const double          fx = (x_m - level->x0_m) / level->spacing_m, fy = (y_m - level->y0_m) / level->spacing_m;
        if (!(fx >= 0 && fy >= 0 && fx <= level->nx - 1 && fy <= level->ny - 1)) continue;

        /* the northern and eastern outline belong to the last cell */
        const int    i = fx < level->nx - 1 ? (int)fx : level->nx - 2;
        const int    j = fy < level->ny - 1 ? (int)fy : level->ny - 2;
        const double u = fx - i, v = fy - j;

        int32_t post[4];
        elevation_cell(post, level, i, j);
        const double sw = level->z0_m + level->step_m * post[0], se = level->z0_m + level->step_m * post[1];
        const double nw = level->z0_m + level->step_m * post[2], ne = level->z0_m + level->step_m * post[3];
        const double du = u >= v ? se - sw : ne - nw, dv = u >= v ? ne - se : nw - sw;
        if (normal_enu) {
            const double s = level->spacing_m, length = sqrt(du * du + dv * dv + s * s);
            normal_enu[0] = -du / length;
            normal_enu[1] = -dv / length;
            normal_enu[2] = s / length;
        }
        return sw + u * du + v * dv;
    }
    return NAN;
}

/* ---- tiles: a base and a shift of each, posts alike on the edges that two share ------------------ */

/* Rounds a post to the nearest multiple of the unit, halves upwards; exact for negative posts too. */
static inline int32_t rounded(int32_t post, int shift)
{
    return shift ? (post + (1 << (shift - 1))) & ~((1 << shift) - 1) : post;
}

ElevationTile elevation_tile_of(int32_t low, int32_t high)
{
    const int32_t last = elevation_base_unit - 1, top = (high + last) & ~last;
    ElevationTile tile = {.base = low & ~last};
    while (top - tile.base > 65535 << tile.shift) tile.shift++;
    return tile;
}

static inline uint16_t stored_of(ElevationTile tile, int32_t post)
{
    const int32_t stored = (post - tile.base) >> tile.shift;
    return (uint16_t)(stored < 0 ? 0 : stored > 65535 ? 65535 : stored);
}

/* The first and the last of the `tiles` tiles along an axis that share line n of posts. */
static inline void sharing(int out[2], int n, int tiles)
{
    const int tile = n / elevation_tile_cells;
    out[1] = tile < tiles ? tile : tiles - 1;
    out[0] = n % elevation_tile_cells == 0 && n > 0 ? tile - 1 : out[1];
}

/* The coarsest shift among a rectangle of tiles, given by first and last along both axes. */
static int coarsest(const ElevationLevel *level, const int a[2], const int b[2])
{
    int shift = 0;
    for (int j = b[0]; j <= b[1]; j++)
        for (int i = a[0]; i <= a[1]; i++) {
            const int s = level->tile[(size_t)j * (size_t)level->tiles_x + (size_t)i].shift;
            shift = s > shift ? s : shift;
        }
    return shift;
}

void elevation_set_post(ElevationLevel *level, int i, int j, int32_t post)
{
    int a[2], b[2];
    sharing(a, i, level->tiles_x);
    sharing(b, j, level->tiles_y);
    post = rounded(post, coarsest(level, a, b));
    for (int tj = b[0]; tj <= b[1]; tj++)
        for (int ti = a[0]; ti <= a[1]; ti++) {
            const size_t tile = (size_t)tj * (size_t)level->tiles_x + (size_t)ti;
            level->stored[tile * elevation_tile_posts + (size_t)(j - tj * elevation_tile_cells) * elevation_tile_side +
                          (size_t)(i - ti * elevation_tile_cells)] = stored_of(level->tile[tile], post);
        }
}

/* Fills up a tile of which only columns x rows posts exist, by repeating the last column and row. */
static void fill_up(uint16_t *stored, int columns, int rows)
{
    for (int j = 0; j < rows && columns < elevation_tile_side; j++) {
        uint16_t *row = stored + (size_t)j * elevation_tile_side;
        for (int i = columns; i < elevation_tile_side; i++) row[i] = row[columns - 1];
    }
    for (int j = rows; j < elevation_tile_side; j++)
        memcpy(stored + (size_t)j * elevation_tile_side, stored + (size_t)(rows - 1) * elevation_tile_side,
               elevation_tile_side * sizeof *stored);
}

static int of_tile(int posts, int tile)
{
    const int left = posts - tile * elevation_tile_cells;
    return left < elevation_tile_side ? left : elevation_tile_side;
}

void elevation_fill_edges(ElevationLevel *level)
{
    for (int tj = 0; tj < level->tiles_y; tj++)
        for (int ti = 0; ti < level->tiles_x;
             ti += tj < level->tiles_y - 1 && ti < level->tiles_x - 1 ? level->tiles_x - 1 - ti : 1)
            fill_up(level->stored + ((size_t)tj * (size_t)level->tiles_x + (size_t)ti) * elevation_tile_posts,
                    of_tile(level->nx, ti), of_tile(level->ny, tj));
}

static void fill_tile(ElevationLevel *level, int ti, int tj, const int32_t *row)
{
    const size_t        tile = (size_t)tj * (size_t)level->tiles_x + (size_t)ti;
    const ElevationTile of = level->tile[tile];
    const int           columns = of_tile(level->nx, ti), rows = of_tile(level->ny, tj);
    uint16_t           *stored = level->stored + tile * elevation_tile_posts;
    for (int j = 0; j < rows; j++) {
        const int32_t *from = row + (size_t)j * (size_t)level->nx + (size_t)ti * elevation_tile_cells;
        uint16_t      *to = stored + (size_t)j * elevation_tile_side;
        for (int i = 0; i < columns; i++) to[i] = stored_of(of, rounded(from[i], of.shift));
    }
    /* edges are rounded to the coarsest unit of the tiles that share them */
    for (int side = 0; side < 4; side++) {
        const bool along_x = side < 2, far_side = side & 1;
        const int  count = along_x ? columns : rows, at = far_side ? elevation_tile_cells : 0;
        if (at >= (along_x ? rows : columns)) continue;
        for (int n = 0; n < count; n++) {
            const int i = along_x ? n : at, j = along_x ? at : n;
            int       a[2], b[2];
            sharing(a, ti * elevation_tile_cells + i, level->tiles_x);
            sharing(b, tj * elevation_tile_cells + j, level->tiles_y);
            const int32_t post = row[(size_t)j * (size_t)level->nx + (size_t)(ti * elevation_tile_cells + i)];
            stored[(size_t)j * elevation_tile_side + (size_t)i] = stored_of(of, rounded(post, coarsest(level, a, b)));
        }
    }
    fill_up(stored, columns, rows);
}

void elevation_fill_tiles(ElevationLevel *level, int tile_j, const int32_t *row)
{
    for (int ti = 0; ti < level->tiles_x; ti++) fill_tile(level, ti, tile_j, row);
}

void elevation_tile_range(int32_t range[2], const ElevationLevel *level, int tile_i, int tile_j, const int32_t *row)
{
    const int columns = of_tile(level->nx, tile_i), rows = of_tile(level->ny, tile_j);
    int32_t   low = INT32_MAX, high = INT32_MIN;
    for (int j = 0; j < rows; j++) {
        const int32_t *from = row + (size_t)j * (size_t)level->nx + (size_t)tile_i * elevation_tile_cells;
        for (int i = 0; i < columns; i++) {
            low = from[i] < low ? from[i] : low;
            high = from[i] > high ? from[i] : high;
        }
    }
    range[0] = low;
    range[1] = high;
}

void elevation_choose_tiles(ElevationLevel *level, int tile_j, const int32_t *row)
{
    for (int ti = 0; ti < level->tiles_x; ti++) {
        int32_t range[2];
        elevation_tile_range(range, level, ti, tile_j, row);
        level->tile[(size_t)tile_j * (size_t)level->tiles_x + (size_t)ti] = elevation_tile_of(range[0], range[1]);
    }
}

Status elevation_fill(ElevationLevel *level, const int32_t *post)
{
    const size_t posts = (size_t)level->nx * (size_t)level->ny, tile_row = (size_t)level->nx * elevation_tile_cells;
    int32_t      low = INT32_MAX, high = INT32_MIN;
    for (size_t n = 0; n < posts; n++) {
        low = post[n] < low ? post[n] : low;
        high = post[n] > high ? post[n] : high;
    }
    if (low < elevation_lowest_post || high > elevation_highest_post) return STATUS_BAD_VALUE;
    level->plain = low >= 0 && high <= 65535;
    memset(level->tile, 0, (size_t)level->tiles_x * (size_t)level->tiles_y * sizeof *level->tile);
    for (int tj = 0; tj < level->tiles_y && !level->plain; tj++)
        elevation_choose_tiles(level, tj, post + (size_t)tj * tile_row);
    for (int tj = 0; tj < level->tiles_y; tj++) elevation_fill_tiles(level, tj, post + (size_t)tj * tile_row);
    return STATUS_OK;
}

/* ---- pyramids: the highest post and the steepest rises of squares of cells ----------------------- */

enum { square = 1 << elevation_pyramid_first, rise_square = 1 << elevation_rise_level };

static inline uint16_t max_u16(uint16_t a, uint16_t b) { return a > b ? a : b; }

/* A height or a rise in units of 1 << shift, rounded up; at most 65535 by the choice of the shift. */
static inline uint16_t rounded_up(int32_t posts, int shift) { return (uint16_t)((posts + (1 << shift) - 1) >> shift); }

static size_t tile_count(const ElevationLevel *level) { return (size_t)level->tiles_x * (size_t)level->tiles_y; }

/* Chooses the finest units that hold the level's heights and rises. */
static void choose_units(ElevationLevel *level)
{
    int32_t base = INT32_MAX, top = INT32_MIN, shift = 0;
    for (size_t t = 0; t < tile_count(level); t++) {
        const ElevationTile tile = level->tile[t];
        const uint16_t     *stored = level->stored + t * elevation_tile_posts;
        uint16_t            most = 0;
        for (int n = 0; n < elevation_tile_posts; n++) most = max_u16(most, stored[n]);
        const int32_t high = tile.base + ((int32_t)most << tile.shift);
        base = tile.base < base ? tile.base : base;
        top = high > top ? high : top;
        shift = tile.shift > shift ? tile.shift : shift;
    }
    level->pyramid_base = base;
    level->rise_shift = shift; /* an edge of a cell lies in one tile, so any tile's unit is exact */
    for (level->pyramid_shift = 0; top - base > 65535 << level->pyramid_shift;) level->pyramid_shift++;
}

/* Computes the first level of maxima, one tile at a time: of the five rows of a square's posts, then of five columns.
 * */
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

/* Each node gets the highest of the up to four nodes below it. All levels of the pyramid share one unit. */
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

/* Adds `count` edges to the steepest rises: from a to b into `to`, from b to a into `from`. */
static void steepest(uint16_t *restrict to, uint16_t *restrict from, const uint16_t *a, const uint16_t *b, int count)
{
    for (int i = 0; i < count; i++) {
        const uint16_t up = (uint16_t)(b[i] > a[i] ? b[i] - a[i] : 0), down = (uint16_t)(a[i] > b[i] ? a[i] - b[i] : 0);
        to[i] = max_u16(to[i], up);
        from[i] = max_u16(from[i], down);
    }
}

/* Computes the first level of rises, one tile at a time: for a row of nodes the steepest of each column of edges, then
 * of each node. */
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
                most.east = max_u16(most.east, part->east);
                most.west = max_u16(most.west, part->west);
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
