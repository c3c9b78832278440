/* sensor/verify/saved_frame/ground_cutout.c: grids by tiles, of which those around given positions are kept. */
#include "sensor/verify/saved_frame/ground_cutout_private.h"

#include <stdlib.h>

typedef struct Tiles {
    int      nx, ny;
    uint8_t *kept; /* a bit each */
    size_t   octets;
} Tiles;

static Tiles tiles_of(const CutoutGrid *grid)
{
    Tiles t = {.nx = (grid->nx + cutout_tile - 1) / cutout_tile, .ny = (grid->ny + cutout_tile - 1) / cutout_tile};
    t.octets = ((size_t)t.nx * (size_t)t.ny + 7) / 8;
    return t;
}

static bool is_kept(const uint8_t *kept, size_t tile) { return kept[tile / 8] >> tile % 8 & 1; }

/* Finds the first and last tile of one axis that hold the values next to a position. False: there are none. */
static bool tiles_about(int range[2], double at_m, double x0_m, double spacing_m, int n)
{
    const double at = floor((at_m - x0_m) / spacing_m), low = at - 1, high = at + 2;
    if (!(high >= 0 && low <= n - 1)) return false;
    range[0] = low > 0 ? (int)low / cutout_tile : 0;
    range[1] = high < n - 1 ? (int)high / cutout_tile : (n - 1) / cutout_tile;
    return true;
}

/* Marks grow by `more` tiles each way along one axis; stride: between tiles of the axis. */
static void grow(uint8_t *mark, int n, size_t stride, int more)
{
    int from = -1; /* last mark in ascending order, then in descending order */
    for (int i = 0; i < n; i++) {
        uint8_t *m = &mark[(size_t)i * stride];
        if (*m == 1) from = i;
        else if (from >= 0 && i - from <= more) *m = 2;
    }
    from = -1;
    for (int i = n - 1; i >= 0; i--) {
        uint8_t *m = &mark[(size_t)i * stride];
        if (*m == 1) from = i;
        else if (from >= 0 && from - i <= more) *m = 2;
    }
    for (int i = 0; i < n; i++) mark[(size_t)i * stride] = mark[(size_t)i * stride] != 0;
}

static bool keep_tiles(Tiles *t, const CutoutGrid *grid, const GroundCutout *kept)
{
    const size_t tiles = (size_t)t->nx * (size_t)t->ny;
    const double reach_m = !kept ? INFINITY : grid->octets == 2 ? kept->reach_m : kept->looks_reach_m;
    if (!isfinite(reach_m)) {
        memset(t->kept, 0xff, t->octets);
        return true;
    }
    uint8_t *mark = calloc(tiles, 1);
    if (!mark) return false;
    for (int p = 0; p < kept->count; p++) {
        int x[2], y[2];
        if (!tiles_about(x, kept->p_m[p][0], grid->x0_m, grid->spacing_m, grid->nx) ||
            !tiles_about(y, kept->p_m[p][1], grid->y0_m, grid->spacing_m, grid->ny))
            continue;
        for (int j = y[0]; j <= y[1]; j++)
            for (int i = x[0]; i <= x[1]; i++) mark[(size_t)j * (size_t)t->nx + (size_t)i] = 1;
    }
    const int more = (int)fmin(ceil(reach_m / (cutout_tile * grid->spacing_m)), t->nx + t->ny);
    for (int j = 0; j < t->ny; j++) grow(mark + (size_t)j * (size_t)t->nx, t->nx, 1, more);
    for (int i = 0; i < t->nx; i++) grow(mark + i, t->ny, (size_t)t->nx, more);
    for (size_t tile = 0; tile < tiles; tile++)
        if (mark[tile]) t->kept[tile / 8] |= (uint8_t)(1u << tile % 8);
    free(mark);
    return true;
}

/* Part of the grid that tile `tile` holds. */
typedef struct TileBox {
    int    i0, j0, nx, ny;
    size_t values;
} TileBox;

static TileBox box_of(const Tiles *t, const CutoutGrid *grid, size_t tile)
{
    TileBox b = {.i0 = (int)(tile % (size_t)t->nx) * cutout_tile, .j0 = (int)(tile / (size_t)t->nx) * cutout_tile};
    b.nx = grid->nx - b.i0 < cutout_tile ? grid->nx - b.i0 : cutout_tile;
    b.ny = grid->ny - b.j0 < cutout_tile ? grid->ny - b.j0 : cutout_tile;
    b.values = (size_t)b.nx * (size_t)b.ny;
    return b;
}

/* Differences along a tile's values, low octets first: neighbours are similar, and high octets hardly change. */
static void pack_u16(uint8_t *out, const uint16_t *value, size_t count)
{
    uint16_t before = 0;
    for (size_t n = 0; n < count; n++) {
        const uint16_t step = (uint16_t)(value[n] - before);
        out[n] = (uint8_t)step;
        out[count + n] = (uint8_t)(step >> 8);
        before = value[n];
    }
}

static void unpack_u16(uint16_t *value, const uint8_t *in, size_t count)
{
    uint16_t before = 0;
    for (size_t n = 0; n < count; n++) {
        before = (uint16_t)(before + (in[n] | in[count + n] << 8));
        value[n] = before;
    }
}

enum { tile_values = cutout_tile * cutout_tile, most_octets = 8 };

void ground_cutout_put(ByteSink *sink, const CutoutGrid *grid, const void *values, const GroundCutout *kept)
{
    uint8_t  tile_bytes[tile_values * most_octets], packed[tile_values * most_octets];
    uint16_t words[tile_values];
    Tiles    t = tiles_of(grid);
    t.kept = calloc(t.octets, 1);
    sink->failed |= !t.kept;
    if (sink->failed) goto done;
    sink->failed |= !keep_tiles(&t, grid, kept);
    if (sink->failed) goto done;
    sink_bytes(sink, t.kept, t.octets);
    for (size_t tile = 0; tile < (size_t)t.nx * (size_t)t.ny; tile++) {
        if (!is_kept(t.kept, tile)) continue;
        const TileBox b = box_of(&t, grid, tile);
        const size_t  row = (size_t)b.nx * (size_t)grid->octets;
        for (int j = 0; j < b.ny; j++)
            memcpy(tile_bytes + (size_t)j * row,
                   (const uint8_t *)values +
                       ((size_t)(b.j0 + j) * (size_t)grid->nx + (size_t)b.i0) * (size_t)grid->octets,
                   row);
        if (grid->octets == 2) {
            memcpy(words, tile_bytes, 2 * b.values);
            pack_u16(packed, words, b.values);
        }
        sink_bytes(sink, grid->octets == 2 ? packed : tile_bytes, b.values * (size_t)grid->octets);
    }
done:
    free(t.kept);
}

void ground_cutout_get(ByteSource *source, const CutoutGrid *grid, void *values)
{
    uint16_t       words[tile_values];
    const Tiles    t = tiles_of(grid);
    const uint8_t *kept = source_bytes(source, t.octets);
    for (size_t tile = 0; kept && tile < (size_t)t.nx * (size_t)t.ny; tile++) {
        if (!is_kept(kept, tile)) continue;
        const TileBox  b = box_of(&t, grid, tile);
        const size_t   row = (size_t)b.nx * (size_t)grid->octets;
        const uint8_t *bytes = source_bytes(source, b.values * (size_t)grid->octets);
        if (!bytes) return;
        if (grid->octets == 2) {
            unpack_u16(words, bytes, b.values);
            bytes = (const uint8_t *)words;
        }
        for (int j = 0; j < b.ny; j++)
            memcpy((uint8_t *)values + ((size_t)(b.j0 + j) * (size_t)grid->nx + (size_t)b.i0) * (size_t)grid->octets,
                   bytes + (size_t)j * row, row);
    }
}
