/* terrain/elevation/elevation_tiles.c: posts into tiles: the base and shift of each, and posts rounded so that tiles
 * side by side are equal on the edge they share. */
#include "terrain/elevation/elevation.h"

/* A multiple of the unit next to the post, half a unit up; exact for negative posts too. */
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

/* The tiles that share line n of posts, of `tiles` along this axis: first and last. */
static inline void sharing(int out[2], int n, int tiles)
{
    const int tile = n / elevation_tile_cells;
    out[1] = tile < tiles ? tile : tiles - 1;
    out[0] = n % elevation_tile_cells == 0 && n > 0 ? tile - 1 : out[1];
}

/* The coarsest shift of the tiles from .. to along both axes. */
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
            level->stored[tile * elevation_tile_posts +
                          (size_t)(j - tj * elevation_tile_cells) * elevation_tile_side +
                          (size_t)(i - ti * elevation_tile_cells)] = stored_of(level->tile[tile], post);
        }
}

/* Repeats the last column and row of a tile of which only columns x rows posts exist. */
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
        for (int ti = 0; ti < level->tiles_x; ti += tj < level->tiles_y - 1 && ti < level->tiles_x - 1
                                                        ? level->tiles_x - 1 - ti : 1)
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
    /* edges: to the coarsest unit of those that share them */
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
            low  = from[i] < low ? from[i] : low;
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
        low  = post[n] < low ? post[n] : low;
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
