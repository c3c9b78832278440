/* render/trace/scenery/scenery_heights.c: how high what stands reaches, over cells of the ground: which rays that rise
 * pass above all of it. Conservative: a ray that is said to pass meets nothing. */
#include "render/trace/scenery/scenery_heights_private.h"

enum { side = 16, cells = side * side, most_tiles = 1 << 20 };
static const double finest_m = 2;
static const float  nothing_m = -INFINITY;

/* Heights are of all that stands over a cell and those about it, so that a ray may go the side of a cell any way from
 * there; of a tile likewise. */
struct SceneryHeights {
    double x0_m, y0_m, cell_m;
    int    tiles_x, tiles_y;
    float  highest_m;
    int   *tile_of;  /* [tiles_y][tiles_x]; -1: nothing stands over it, nor over a cell beside it */
    float *coarse_m; /* [tiles_y][tiles_x] */
    float *top_m;    /* [tiles][side][side] */
};

/* ---- made once ---------------------------------------------------------------------------------- */

typedef struct Making {
    SceneryHeights *h;
    int             tiles;
    bool            mark; /* tiles are marked, heights are not raised yet */
} Making;

/* A box about a part of what stands: it raises every cell that it may touch, and those about them. */
static void raise_box(Making *m, const double low[3], const double high[3])
{
    static const double room_m = 0.01; /* ample: floats, and what passes by within 20 um */
    SceneryHeights     *h = m->h;
    const float         top_m = (float)(high[2] + room_m);
    const int           nx = h->tiles_x * side, ny = h->tiles_y * side;
    const int           x0 = (int)clamp((low[0] - room_m - h->x0_m) / h->cell_m - 1, 0, nx - 1);
    const int           x1 = (int)clamp((high[0] + room_m - h->x0_m) / h->cell_m + 1, 0, nx - 1);
    const int           y0 = (int)clamp((low[1] - room_m - h->y0_m) / h->cell_m - 1, 0, ny - 1);
    const int           y1 = (int)clamp((high[1] + room_m - h->y0_m) / h->cell_m + 1, 0, ny - 1);
    if (m->mark) {
        for (int y = y0 / side; y <= y1 / side; y++)
            for (int x = x0 / side; x <= x1 / side; x++) {
                int *tile = &h->tile_of[y * h->tiles_x + x];
                if (*tile < 0) *tile = m->tiles++;
            }
        return;
    }
    h->highest_m = top_m > h->highest_m ? top_m : h->highest_m;
    for (int y = y0; y <= y1; y++)
        for (int x = x0; x <= x1; x++) {
            const int tile = h->tile_of[y / side * h->tiles_x + x / side];
            float    *to = &h->top_m[(size_t)tile * cells + (size_t)(y % side * side + x % side)];
            if (*to < top_m) *to = top_m;
        }
}

/* A box along east, north and up about one in a node's axes. */
static void turn_box(double low[3], double high[3], const PosedNode *node, const double box[2][3])
{
    for (int r = 0; r < 3; r++) {
        double middle = node->p_enu[r], half = 0;
        for (int c = 0; c < 3; c++) {
            middle += node->r_enu_from_node[3 * r + c] * 0.5 * (box[0][c] + box[1][c]);
            half += fabs(node->r_enu_from_node[3 * r + c]) * 0.5 * (box[1][c] - box[0][c]);
        }
        low[r] = middle - half, high[r] = middle + half;
    }
}

/* What is small by its box, all else piece by piece. */
static void raise_object(Making *m, const PosedEntity *e)
{
    double low[3], high[3], box[2][3];
    if (!parts_posed_box(low, high, e)) return;
    if (high[0] - low[0] < 3 * m->h->cell_m && high[1] - low[1] < 3 * m->h->cell_m) {
        raise_box(m, low, high);
        return;
    }
    for (int n = 0; n < e->node_count; n++)
        for (int k = 0; parts_node_patch(box, &e->node[n], k); k++) {
            if (!(box[0][0] <= box[1][0])) continue; /* nothing to meet */
            turn_box(low, high, &e->node[n], (const double(*)[3])box);
            raise_box(m, low, high);
        }
}

static void raise_objects(Making *m, const PosedEntity *posed, int objects)
{
    for (int k = 0; k < objects; k++)
        if (posed[k].model >= 0) raise_object(m, &posed[k]);
}

/* False: there is nothing. */
static bool bounds_of(double low[2], double high[2], const PosedEntity *posed, int objects)
{
    for (int c = 0; c < 2; c++) low[c] = INFINITY, high[c] = -INFINITY;
    for (int k = 0; k < objects; k++) {
        double box[2][3];
        if (!parts_posed_box(box[0], box[1], &posed[k])) continue;
        for (int c = 0; c < 2; c++) low[c] = fmin(low[c], box[0][c]), high[c] = fmax(high[c], box[1][c]);
    }
    return low[0] <= high[0];
}

/* Of each tile and those about it. */
static void raise_coarse(SceneryHeights *h)
{
    for (int t = 0; t < h->tiles_x * h->tiles_y; t++) {
        float highest_m = nothing_m;
        for (int k = 0; k < cells && h->tile_of[t] >= 0; k++) {
            const float top_m = h->top_m[(size_t)h->tile_of[t] * cells + (size_t)k];
            highest_m = top_m > highest_m ? top_m : highest_m;
        }
        if (!(highest_m > nothing_m)) continue;
        const int x = t % h->tiles_x, y = t / h->tiles_x;
        for (int j = y > 0 ? y - 1 : 0; j <= y + 1 && j < h->tiles_y; j++)
            for (int i = x > 0 ? x - 1 : 0; i <= x + 1 && i < h->tiles_x; i++) {
                float *to = &h->coarse_m[j * h->tiles_x + i];
                if (*to < highest_m) *to = highest_m;
            }
    }
}

Status scenery_heights_create(SceneryHeights **out, const PosedEntity *posed, int objects, Arena *arena)
{
    double low[2], high[2];
    *out = NULL;
    if (!bounds_of(low, high, posed, objects)) return STATUS_OK;
    SceneryHeights *h = arena_alloc(arena, 1, sizeof *h);
    if (!h) return STATUS_NO_MEMORY;
    *h = (SceneryHeights){.cell_m = finest_m, .highest_m = nothing_m};
    double wide[2];
    for (;;) { /* a tile about all on each side */
        for (int c = 0; c < 2; c++) wide[c] = ceil((high[c] - low[c]) / (side * h->cell_m)) + 2;
        if (wide[0] * wide[1] <= most_tiles) break;
        h->cell_m *= 2;
        if (!(h->cell_m < 1e6)) return STATUS_OK; /* farther apart than any ground is wide */
    }
    h->x0_m = low[0] - side * h->cell_m, h->y0_m = low[1] - side * h->cell_m;
    h->tiles_x = (int)wide[0], h->tiles_y = (int)wide[1];
    const size_t all = (size_t)(h->tiles_x * h->tiles_y);
    h->tile_of = arena_alloc(arena, all, sizeof *h->tile_of);
    h->coarse_m = arena_alloc(arena, all, sizeof *h->coarse_m);
    if (!h->tile_of || !h->coarse_m) return STATUS_NO_MEMORY;
    for (size_t t = 0; t < all; t++) h->tile_of[t] = -1, h->coarse_m[t] = nothing_m;
    Making making = {.h = h, .mark = true};
    raise_objects(&making, posed, objects);
    h->top_m = arena_alloc(arena, (size_t)making.tiles * cells, sizeof *h->top_m);
    if (!h->top_m) return STATUS_NO_MEMORY;
    for (size_t k = 0; k < (size_t)making.tiles * cells; k++) h->top_m[k] = nothing_m;
    making.mark = false;
    raise_objects(&making, posed, objects);
    raise_coarse(h);
    *out = h;
    return STATUS_OK;
}

/* ---- asked for a ray ---------------------------------------------------------------------------- */

/* A way over the cells: one cell along x or y, and no more along the other, at a time. */
typedef struct Way {
    double x, y, rise_m; /* cells, cells, m: a step */
} Way;

static bool passes(const SceneryHeights *h, const double o_enu[3], const Way *way)
{
    enum { most_steps = 64 };
    double x = (o_enu[0] - h->x0_m) / h->cell_m, y = (o_enu[1] - h->y0_m) / h->cell_m, z_m = o_enu[2];
    for (int step = 0; step < most_steps; step++) {
        if (z_m > (double)h->highest_m) return true;
        double far = side;
        if (x >= 0 && y >= 0 && x < h->tiles_x * side && y < h->tiles_y * side) {
            const unsigned i = (unsigned)x, j = (unsigned)y;
            const unsigned tile = j / side * (unsigned)h->tiles_x + i / side;
            if (!(z_m > (double)h->coarse_m[tile])) {
                const size_t at = (size_t)h->tile_of[tile] * cells + (size_t)(j % side * side + i % side);
                if (h->tile_of[tile] >= 0 && !(z_m > (double)h->top_m[at])) return false;
                far = 1;
            }
        } else if ((x < 0 && way->x <= 0) || (y < 0 && way->y <= 0) || (x >= h->tiles_x * side && way->x >= 0) ||
                   (y >= h->tiles_y * side && way->y >= 0)) {
            return true; /* it leaves */
        }
        x += far * way->x, y += far * way->y, z_m += far * way->rise_m;
    }
    return false;
}

int scenery_heights_below(int *list, const SceneryHeights *h, const double *const o_enu[3], int count,
                          const double d_enu[3])
{
    const double wide = fmax(fabs(d_enu[0]), fabs(d_enu[1]));
    int          left = 0;
    if (!h || !(d_enu[2] > 0)) {
        for (int k = 0; k < count; k++) list[k] = k;
        return count;
    }
    /* straight up, the first cell is all that it goes over; steps as long as a cell whatever they rise */
    const Way way = wide > 1e-9 * d_enu[2] ? (Way){d_enu[0] / wide, d_enu[1] / wide, h->cell_m * d_enu[2] / wide}
                                           : (Way){0, 0, 1e9};
    for (int k = 0; k < count; k++) {
        const double o[3] = {o_enu[0][k], o_enu[1][k], o_enu[2][k]};
        list[left] = k;
        left += !passes(h, o, &way);
    }
    return left;
}
