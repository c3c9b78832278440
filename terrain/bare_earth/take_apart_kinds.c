/* terrain/bare_earth/take_apart_kinds.c: which cells above the ground are building and which are tree. A roof holds
 * straight lines: a plane in all directions, a gable along its ridge; crowns and hedges hold none. */
#include "terrain/bare_earth/take_apart_private.h"

#include <stdlib.h>

/* ---- connected components ------------------------------------------------------------------------ */

static int32_t root_of(int32_t *parent, int32_t c)
{
    while (parent[c] != c) parent[c] = parent[parent[c]], c = parent[c];
    return c;
}

/* Connected components, edges touching: label[c] is the first cell of c's component, area[label[c]] its cells. Both are
 * allocated, [ny][nx]; NULL on failure. `joins` says whether the neighbours c and d belong together. */
typedef bool  JoinCells(const void *user, size_t c, size_t d);
static Status take_apart_components(int32_t **label, int32_t **area, int nx, int ny, JoinCells *joins, const void *user)
{
    const size_t n = (size_t)nx * (size_t)ny;
    int32_t     *parent = malloc(n * sizeof *parent), *count = calloc(n, sizeof *count);
    *label = NULL, *area = NULL;
    if (!parent || !count) {
        free(parent), free(count);
        return STATUS_NO_MEMORY;
    }
    for (size_t c = 0; c < n; c++) {
        parent[c] = (int32_t)c;
        const bool west = c % (size_t)nx && joins(user, c, c - 1);
        const bool south = c >= (size_t)nx && joins(user, c, c - (size_t)nx);
        if (west) parent[c] = root_of(parent, (int32_t)c - 1);
        if (!south) continue;
        /* the least cell is the root: the labels do not depend on the order of joining */
        const int32_t a = root_of(parent, (int32_t)c), b = root_of(parent, (int32_t)(c - (size_t)nx));
        if (a < b) parent[b] = a;
        else parent[a] = b;
    }
    for (size_t c = 0; c < n; c++) {
        parent[c] = parent[parent[c]];
        count[parent[c]]++;
    }
    *label = parent, *area = count;
    return STATUS_OK;
}

/* ---- kinds --------------------------------------------------------------------------------------- */

/* 2 m: the usual least height of canopy in lidar forestry (Naesset 1997, FUSION's cover), and of a shed's roof. */
static const float  least_height_m = 2, straight_m = 0.12F, most_pitch = 1.3F;
static const double least_roof_m2 = 12, most_gap_m2 = 30, least_width_m = 3, least_crown_m2 = 5;

enum { directions = 8, most_samples = 7 };

static const int direction[directions][2] = {{1, 0}, {0, 1}, {1, 1}, {-1, 1}, {2, 1}, {1, 2}, {-1, 2}, {-2, 1}};

typedef struct Kinds {
    int          nx, ny;
    const float *surface_m;
    uint8_t     *object; /* 0 ground, 1 above it, 2 holds a straight line */
    uint8_t     *kind;
} Kinds;

/* Marks the cells of straight lines that lie on objects. */
static void mark_straight(const Kinds *k, const SurfaceModel *model)
{
    const int nx = k->nx, ny = k->ny, spacing = (int)fmax(1, floor(1 / model->cell_m + 0.5));
    for (int d = 0; d < directions; d++) {
        const double step_m = spacing * model->cell_m * hypot(direction[d][0], direction[d][1]);
        int          half = (int)floor(3 / step_m + 0.5);
        half = half < 2 ? 2 : half;
        const int       dx = direction[d][0] * spacing, dy = direction[d][1] * spacing;
        const ptrdiff_t step = dx + (ptrdiff_t)dy * nx;
        float           sxx = 0;
        for (int i = -half; i <= half; i++) sxx += (float)(i * i);
        const float count = (float)(2 * half + 1), most = straight_m * straight_m * count;
        for (int y = half * abs(dy); y < ny - half * abs(dy); y++)
            for (int x = half * abs(dx); x < nx - half * abs(dx); x++) {
                const size_t c = (size_t)y * (size_t)nx + (size_t)x;
                if (!k->object[c] || !k->object[(ptrdiff_t)c + half * step] || !k->object[(ptrdiff_t)c - half * step])
                    continue;
                const float *z = k->surface_m + c;
                float        s = 0, sx = 0, ss = 0;
                bool         inside = true;
                for (int i = -half; i <= half; i++) {
                    const float v = z[i * step] - z[0];
                    inside = inside && k->object[(ptrdiff_t)c + i * step];
                    s += v, sx += (float)i * v, ss += v * v;
                }
                const float rest = ss - s * s / count - sx * sx / sxx;
                if (!inside || !(rest <= most) || fabsf(sx / sxx) > most_pitch * (float)step_m) continue;
                for (int i = -half; i <= half; i++) k->object[(ptrdiff_t)c + i * step] = 2;
            }
    }
}

/* Counts a mask over squares, by running sums: `sum`, [ny][nx]. */
static Status square_counts(uint16_t *sum, const uint8_t *mask, uint8_t least, int nx, int ny, int r)
{
    int32_t *column = calloc((size_t)nx + 1, sizeof *column);
    if (!column) return STATUS_NO_MEMORY;
    for (int y = -r; y < ny; y++) {
        if (y + r < ny)
            for (int x = 0; x < nx; x++) column[x] += mask[(size_t)(y + r) * (size_t)nx + (size_t)x] >= least;
        if (y - r - 1 >= 0)
            for (int x = 0; x < nx; x++) column[x] -= mask[(size_t)(y - r - 1) * (size_t)nx + (size_t)x] >= least;
        if (y < 0) continue;
        int32_t s = 0;
        for (int x = 0; x < r && x < nx; x++) s += column[x];
        for (int x = 0; x < nx; x++) {
            if (x + r < nx) s += column[x + r];
            if (x - r - 1 >= 0) s -= column[x - r - 1];
            sum[(size_t)y * (size_t)nx + (size_t)x] = (uint16_t)s;
        }
    }
    free(column);
    return STATUS_OK;
}

static int cells_in(const SurfaceModel *model, double m)
{
    const int n = (int)floor(m / model->cell_m + 0.5);
    return n < 1 ? 1 : n;
}

static bool same_kind(const void *user, size_t c, size_t d)
{
    const Kinds *k = user;
    return (k->kind[c] == CELL_BUILDING) == (k->kind[d] == CELL_BUILDING);
}

/* Buildings too small become trees, gaps in buildings too small become building. */
static Status drop_small(const Kinds *k, const SurfaceModel *model)
{
    int32_t *label, *area;
    Status   status = take_apart_components(&label, &area, k->nx, k->ny, same_kind, k);
    if (status != STATUS_OK) return status;
    const double cell_m2 = model->cell_m * model->cell_m;
    /* a gap that touches the window's edge may be larger, so it is not filled */
    for (int y = 0; y < k->ny; y++)
        for (int x = 0; x<k->nx; x += y> 0 && y < k->ny - 1 && k->nx > 1 ? k->nx - 1 : 1) {
            const size_t c = (size_t)y * (size_t)k->nx + (size_t)x;
            if (k->kind[c] != CELL_BUILDING) area[label[c]] = INT32_MAX;
        }
    for (size_t c = 0; c < (size_t)k->nx * (size_t)k->ny; c++) {
        const double m2 = area[label[c]] * cell_m2;
        if (k->kind[c] == CELL_BUILDING && m2 < least_roof_m2) k->kind[c] = k->object[c] ? CELL_TREE : CELL_BARE;
        else if (k->kind[c] != CELL_BUILDING && m2 < most_gap_m2) k->kind[c] = CELL_BUILDING;
    }
    free(label), free(area);
    return STATUS_OK;
}

static bool both_trees(const void *user, size_t c, size_t d)
{
    const Kinds *k = user;
    return k->kind[c] == CELL_TREE && k->kind[d] == CELL_TREE;
}

/* Drops patches too small for a crown: they belong to the building that they touch (its corners), or are bare (poles,
 * wires). */
static Status drop_small_trees(const Kinds *k, const SurfaceModel *model)
{
    int32_t *label, *area;
    Status   status = take_apart_components(&label, &area, k->nx, k->ny, both_trees, k);
    if (status != STATUS_OK) return status;
    const double cell_m2 = model->cell_m * model->cell_m;
    const size_t nx = (size_t)k->nx, n = nx * (size_t)k->ny;
    for (size_t c = 0; c < n; c++) {
        if (k->kind[c] != CELL_TREE || area[label[c]] < 0 || area[label[c]] * cell_m2 >= least_crown_m2) continue;
        const bool roof = (c % nx && k->kind[c - 1] == CELL_BUILDING && label[c - 1] != label[c]) ||
                          ((c + 1) % nx && k->kind[c + 1] == CELL_BUILDING && label[c + 1] != label[c]) ||
                          (c >= nx && k->kind[c - nx] == CELL_BUILDING && label[c - nx] != label[c]) ||
                          (c + nx < n && k->kind[c + nx] == CELL_BUILDING && label[c + nx] != label[c]);
        if (roof) area[label[c]] = -1;
    }
    for (size_t c = 0; c < n; c++) {
        if (k->kind[c] != CELL_TREE) continue;
        if (area[label[c]] < 0) k->kind[c] = CELL_BUILDING;
        else if (area[label[c]] * cell_m2 < 2) k->kind[c] = CELL_BARE;
    }
    free(label), free(area);
    return STATUS_OK;
}

/* Sets the kind of those cells of `mask` whose surrounding square has at least `share` of it. */
static void threshold(const Kinds *k, const uint16_t *sum, double share, int r, bool grow)
{
    const double all = (2 * r + 1) * (2 * r + 1);
    for (size_t c = 0; c < (size_t)k->nx * (size_t)k->ny; c++) {
        const bool most = sum[c] >= share * all;
        if (most && grow) k->kind[c] = CELL_BUILDING;
        else if (!most && k->kind[c] == CELL_BUILDING) k->kind[c] = k->object[c] ? CELL_TREE : CELL_BARE;
    }
}

Status take_apart_kinds(SurfaceParts *out, const SurfaceModel *model, const float *surface_m)
{
    const int    nx = model->nx, ny = model->ny;
    const size_t n = (size_t)nx * (size_t)ny;
    Kinds        k = {nx, ny, surface_m, malloc(n), out->kind};
    uint16_t    *lines = malloc(n * sizeof *lines), *objects = malloc(n * sizeof *objects);
    Status       status = k.object && lines && objects ? STATUS_OK : STATUS_NO_MEMORY;
    if (status == STATUS_OK) {
        for (size_t c = 0; c < n; c++) k.object[c] = surface_m[c] - out->bare_m[c] > least_height_m;
        mark_straight(&k, model);
        const int r = cells_in(model, 3);
        status = square_counts(lines, k.object, 2, nx, ny, r);
        if (status == STATUS_OK) status = square_counts(objects, k.object, 1, nx, ny, r);
        for (size_t c = 0; c < n; c++)
            k.kind[c] = !k.object[c] ? CELL_BARE : lines[c] > 0.6 * objects[c] ? CELL_BUILDING : CELL_TREE;
    }
    /* an opening by the least width, then a majority that smooths the outline */
    const int r = cells_in(model, least_width_m / 2 - 0.5 * model->cell_m);
    if (status == STATUS_OK) status = square_counts(lines, k.kind, 3, nx, ny, r);
    for (int pass = 0; pass < 2 && status == STATUS_OK; pass++) {
        for (size_t c = 0; c < n; c++) k.object[c] = (uint8_t)((k.object[c] != 0) | (k.kind[c] == CELL_BUILDING) << 1);
        status = square_counts(lines, k.object, 2, nx, ny, r);
        if (status == STATUS_OK) threshold(&k, lines, 0.5, r, true);
        for (size_t c = 0; c < n; c++) k.object[c] &= 1;
    }
    if (status == STATUS_OK) status = drop_small(&k, model);
    if (status == STATUS_OK) status = drop_small_trees(&k, model);
    free(lines), free(objects), free(k.object);
    return status;
}
