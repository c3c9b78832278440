/* terrain/bare_earth/take_apart_ground.c: bare ground below a surface model.
 *
 * Blocks of about 2 m hold their lowest return. Openings by growing squares (progressive morphological filter: Zhang
 * et al., IEEE TGRS 41, 2003) mark blocks that stand out by more than the ground's own slope explains; blocks are taken
 * back where the surface runs on from the ground without a wall. Then cells near the filled ground are ground (SMRF:
 * Pingel et al., ISPRS J. 77, 2013), and the ground is fitted again to them. */
#include "terrain/bare_earth/take_apart_private.h"

#include <float.h>
#include <stdlib.h>

enum { lanes = 32 }; /* columns that are worked on together */

/* ---- least and greatest of a square about each value --------------------------------------------- */

/* Extreme of [x, x + width) for each of count elements of `lane` floats; beyond them stand width - 1 neutral ones.
 * Windows double: O(log width) passes that vectorize. */
static void run_least(float *a, size_t count, size_t width, size_t lane)
{
    size_t w = 1;
    for (; 2 * w <= width; w *= 2)
#pragma GCC ivdep
        for (size_t i = 0; i < (count + width - 2 * w) * lane; i++)
            a[i] = a[i + w * lane] < a[i] ? a[i + w * lane] : a[i];
    if (w == width) return;
#pragma GCC ivdep
    for (size_t i = 0; i < count * lane; i++) {
        const float b = a[i + (width - w) * lane];
        a[i] = b < a[i] ? b : a[i];
    }
}

/* Least or greatest of the (2 radius + 1)^2 square about each value, in place; clipped at the edges. */
static Status take_apart_extreme(float *value, int nx, int ny, int radius, bool greatest)
{
    const size_t r = (size_t)radius, width = 2 * r + 1, n = (size_t)nx, m = (size_t)ny;
    const float  sign = greatest ? -1 : 1;
    if (radius <= 0) return STATUS_OK;
    const size_t row = n + 2 * r, strip = (m + 2 * r) * lanes;
    float       *buffer = malloc((row > strip ? row : strip) * sizeof *buffer);
    if (!buffer) return STATUS_NO_MEMORY;

    for (size_t y = 0; y < m; y++) {
        for (size_t x = 0; x < r; x++) buffer[x] = buffer[n + r + x] = FLT_MAX;
        for (size_t x = 0; x < n; x++) buffer[r + x] = sign * value[y * n + x];
        run_least(buffer, n, width, 1);
        memcpy(value + y * n, buffer, n * sizeof *value);
    }
    for (size_t x0 = 0; x0 < n; x0 += lanes) {
        const size_t some = n - x0 < lanes ? n - x0 : lanes;
        for (size_t i = 0; i < r * lanes; i++) buffer[i] = buffer[(m + r) * lanes + i] = FLT_MAX;
        for (size_t y = 0; y < m; y++)
            for (size_t x = 0; x < lanes; x++) buffer[(r + y) * lanes + x] = x < some ? value[y * n + x0 + x] : FLT_MAX;
        run_least(buffer, m, width, lanes);
        for (size_t y = 0; y < m; y++)
            for (size_t x = 0; x < some; x++) value[y * n + x0 + x] = sign * buffer[y * lanes + x];
    }
    free(buffer);
    return STATUS_OK;
}

/* ---- the ground ---------------------------------------------------------------------------------- */

enum { regrow_steps = 20, scales = 7 };

static const double radius_m[scales] = {2, 4, 8, 14, 22, 34, 52};

typedef struct Ground {
    Blocks   blocks;
    size_t   count;
    float   *low;  /* lowest return of each block, NAN: void [ny][nx] */
    float   *high; /* highest                                        */
    float   *opened;
    float   *slope;  /* greatest slope of the wide ground nearby */
    float   *height; /* height of the ground, with gaps filled */
    float   *work;
    uint8_t *object; /* marks blocks that are not ground */
} Ground;

static void ground_destroy(Ground *g)
{
    free(g->low), free(g->high), free(g->opened), free(g->slope), free(g->height), free(g->work), free(g->object);
    *g = (Ground){0};
}

static int64_t floor_mod(int64_t a, int64_t b) { return ((a % b) + b) % b; }

static Status ground_create(Ground *out, const SurfaceModel *model)
{
    Ground  g = {0};
    Blocks *b = &g.blocks;
    b->size = (int)floor(2 / model->cell_m + 0.01);
    if (b->size < 1) b->size = 1;
    b->block_m = b->size * model->cell_m;
    int lattice = b->size; /* cells of the coarsest level of the filling */
    for (double side_m = b->block_m; side_m < 12; side_m *= 2) lattice *= 2;
    b->left = (int)floor_mod(model->column, lattice), b->below = (int)floor_mod(model->row, lattice);
    const int many = lattice / b->size;
    b->nx = ((model->nx + b->left + lattice - 1) / lattice) * many;
    b->ny = ((model->ny + b->below + lattice - 1) / lattice) * many;
    const size_t n = g.count = (size_t)b->nx * (size_t)b->ny;
    g.low = malloc(n * sizeof *g.low), g.high = malloc(n * sizeof *g.high), g.opened = malloc(n * sizeof *g.opened);
    g.slope = malloc(n * sizeof *g.slope), g.height = malloc(n * sizeof *g.height);
    g.work = malloc(n * sizeof *g.work), g.object = calloc(n, 1);
    if (!g.low || !g.high || !g.opened || !g.slope || !g.height || !g.work || !g.object) {
        ground_destroy(&g);
        return STATUS_NO_MEMORY;
    }
    *out = g;
    return STATUS_OK;
}

static size_t block_of(const Blocks *b, int x, int y)
{
    return (size_t)((y + b->below) / b->size) * (size_t)b->nx + (size_t)((x + b->left) / b->size);
}

static void lows(Ground *g, const SurfaceModel *model, const float *surface_m)
{
    for (size_t c = 0; c < g->count; c++) g->low[c] = FLT_MAX, g->high[c] = -FLT_MAX;
    for (int y = 0; y < model->ny; y++)
        for (int x = 0; x < model->nx; x++) {
            const float  z = surface_m[(size_t)y * (size_t)model->nx + (size_t)x];
            const size_t c = block_of(&g->blocks, x, y);
            if (z < g->low[c]) g->low[c] = z;
            if (z > g->high[c]) g->high[c] = z;
        }
}

/* Opens `from` into `to`: the least, then the greatest of what is not void; FLT_MAX: void. */
static Status opening(float *to, const float *from, const Ground *g, int radius)
{
    const Blocks *b = &g->blocks;
    if (to != from) memcpy(to, from, g->count * sizeof *to);
    Status status = take_apart_extreme(to, b->nx, b->ny, radius, false);
    for (size_t c = 0; c < g->count; c++)
        if (to[c] == FLT_MAX) to[c] = -FLT_MAX;
    if (status == STATUS_OK) status = take_apart_extreme(to, b->nx, b->ny, radius, true);
    for (size_t c = 0; c < g->count; c++)
        if (to[c] == -FLT_MAX) to[c] = FLT_MAX;
    return status;
}

static int blocks_in(const Blocks *b, double m)
{
    const int n = (int)floor(m / b->block_m + 0.5);
    return n < 1 ? 1 : n;
}

/* Whether a square of `radius` blocks about the block is clipped by the window's edge. */
static bool clipped(const Blocks *b, const SurfaceModel *model, int x, int y, int radius)
{
    const int x0 = b->left / b->size, y0 = b->below / b->size;
    const int x1 = (b->left + model->nx - 1) / b->size, y1 = (b->below + model->ny - 1) / b->size;
    return x - radius < x0 || y - radius < y0 || x + radius > x1 || y + radius > y1;
}

/* Computes into `slope` the ground's slope over 16 m, from an opening; with `edge` only for the clipped blocks. */
static Status slope_of_opening(Ground *g, const SurfaceModel *model, int radius, bool edge, int edge_radius)
{
    const Blocks *b = &g->blocks;
    const int     step = blocks_in(b, 8);
    Status        status = opening(g->opened, g->low, g, radius);
    if (status != STATUS_OK) return status;
    for (int y = 0; y < b->ny; y++)
        for (int x = 0; x < b->nx; x++) {
            if (edge && !clipped(b, model, x, y, edge_radius)) continue;
            const int    x0 = x > step ? x - step : 0, x1 = x + step < b->nx ? x + step : b->nx - 1;
            const int    y0 = y > step ? y - step : 0, y1 = y + step < b->ny ? y + step : b->ny - 1;
            const float *row = g->opened + (size_t)y * (size_t)b->nx;
            const float  w = row[x0], e = row[x1], s = g->opened[(size_t)y0 * (size_t)b->nx + (size_t)x],
                        n = g->opened[(size_t)y1 * (size_t)b->nx + (size_t)x];
            double gx = 0, gy = 0;
            if (w != FLT_MAX && e != FLT_MAX && x1 > x0) gx = fabs((double)e - w) / ((x1 - x0) * b->block_m);
            if (s != FLT_MAX && n != FLT_MAX && y1 > y0) gy = fabs((double)n - s) / ((y1 - y0) * b->block_m);
            const double steep = sqrt(gx * gx + gy * gy);
            float       *slope = &g->slope[(size_t)y * (size_t)b->nx + (size_t)x];
            const float  least = edge ? *slope : 0;
            *slope = (float)(steep < 1 ? steep : 1);
            if (*slope < least) *slope = least;
        }
    return STATUS_OK;
}

/* Finds the slope of the wide ground, the greatest within 12 m. Where the window's edge clips its square an opening
 * flattens a slope; there a narrower opening gives the slope. */
static Status find_slope(Ground *g, const SurfaceModel *model)
{
    const int widest = blocks_in(&g->blocks, radius_m[scales - 1]), narrow = blocks_in(&g->blocks, 16);
    Status    status = slope_of_opening(g, model, widest, false, 0);
    if (status == STATUS_OK) status = slope_of_opening(g, model, narrow, true, widest);
    if (status != STATUS_OK) return status;
    return take_apart_extreme(g->slope, g->blocks.nx, g->blocks.ny, blocks_in(&g->blocks, 12), true);
}

/* Drops returns that are below everything within 14 m but their own neighbours: multipath, wells. */
static Status drop_low_points(Ground *g)
{
    const Blocks *b = &g->blocks;
    const int     far = blocks_in(b, 14);
    memcpy(g->work, g->low, g->count * sizeof *g->work);
    /* closing by a hole: the least of the far square without the 3 x 3 in its middle, as the least of four oblongs
     * would need; the least of the squares at its four sides and corners is enough */
    Status status = take_apart_extreme(g->work, b->nx, b->ny, far / 2 > 0 ? far / 2 : 1, false);
    if (status != STATUS_OK) return status;
    const int away = far / 2 + 2;
    for (int y = 0; y < b->ny; y++)
        for (int x = 0; x < b->nx; x++) {
            const size_t c = (size_t)y * (size_t)b->nx + (size_t)x;
            float        least = FLT_MAX;
            for (int k = 0; k < 9; k++) {
                const int i = x + (k % 3 - 1) * away, j = y + (k / 3 - 1) * away;
                if (k == 4 || i < 0 || j < 0 || i >= b->nx || j >= b->ny) continue;
                const float v = g->work[(size_t)j * (size_t)b->nx + (size_t)i];
                if (v < least) least = v;
            }
            g->height[c] = least != FLT_MAX && g->low[c] < least - 5 ? FLT_MAX : g->low[c];
        }
    memcpy(g->low, g->height, g->count * sizeof *g->low);
    return STATUS_OK;
}

/* Marks the blocks that openings take away. */
static Status mark_objects(Ground *g, const SurfaceModel *model, double first_radius_m)
{
    Status status = STATUS_OK;
    memcpy(g->height, g->low, g->count * sizeof *g->height);
    double before_m = 0;
    for (int k = 0; k < scales && status == STATUS_OK; k++) {
        if (radius_m[k] < first_radius_m) continue;
        const int    radius = blocks_in(&g->blocks, radius_m[k]);
        const size_t nx = (size_t)g->blocks.nx;
        status = opening(g->opened, g->height, g, radius);
        const float wider_m = (float)(radius_m[k] - before_m);
        before_m = radius_m[k];
        for (size_t c = 0; c < g->count; c++) {
            const float steep = g->slope[c] > 0.05F ? g->slope[c] - 0.05F : 0;
            float       most = 0.6F + 0.5F * steep * wider_m;
            /* a square clipped by the edge cuts slopes by its whole width */
            if (clipped(&g->blocks, model, (int)(c % nx), (int)(c / nx), radius)) most += 1.0F * steep * wider_m;
            if (g->height[c] - g->opened[c] > most) g->object[c] = 1;
            if (g->low[c] == FLT_MAX) g->object[c] = 1;
            g->height[c] = g->opened[c];
        }
    }
    return status;
}

/* Whether the lowest returns run on in a straight line through q and p to c, which follow one another, no steeper than
 * 50 degrees, and c is as smooth as its slope. */
static bool runs_on(const Ground *g, size_t q, size_t p, size_t c)
{
    const float size_m = (float)g->blocks.block_m;
    const float rise = g->low[c] - g->low[p], before = g->low[p] - g->low[q];
    return fabsf(rise) <= 1.2F * size_m && fabsf(rise - before) <= 0.25F + 0.15F * fabsf(before) &&
           g->high[c] - g->low[c] <= 0.5F + 2 * fabsf(rise) + 0.3F * size_m * g->slope[c];
}

/* Takes blocks back, a step of one block at a time, where the lowest returns run on in a straight line from two blocks
 * of ground, no steeper than 50 degrees, and the block is as smooth as its slope: hills and ridges that a square
 * flattened, but no roof behind its wall. */
static void regrow(Ground *g)
{
    const Blocks    *b = &g->blocks;
    const int        nx = b->nx, ny = b->ny;
    static const int di[4] = {1, -1, 0, 0}, dj[4] = {0, 0, 1, -1};
    /* object: 0 ground, 1 not, k + 2: taken back in step k */
    for (int step = 0; step < regrow_steps; step++) {
        bool any = false;
        for (int y = 2; y < ny - 2; y++)
            for (int x = 2; x < nx - 2; x++) {
                const size_t c = (size_t)y * (size_t)nx + (size_t)x;
                if (g->object[c] != 1 || g->low[c] == FLT_MAX) continue;
                for (int k = 0; k < 4; k++) {
                    const ptrdiff_t d = di[k] + (ptrdiff_t)dj[k] * nx;
                    const size_t    p = (size_t)((ptrdiff_t)c + d), q = (size_t)((ptrdiff_t)c + 2 * d);
                    if (g->object[p] == 1 || g->object[q] == 1 || g->object[p] == step + 2 || g->object[q] == step + 2)
                        continue;
                    if (!runs_on(g, q, p, c)) continue;
                    g->object[c] = (uint8_t)(step + 2), any = true;
                    break;
                }
            }
        if (!any) break;
    }
}

/* Replaces each value by the sum over the square of 2 radius + 1 blocks about it. */
static void square_sums(float *v, const Blocks *b, int radius, float *line)
{
    for (int along = 0; along < 2; along++) {
        const int    n = along ? b->ny : b->nx, lines = along ? b->nx : b->ny;
        const size_t step = along ? (size_t)b->nx : 1, next = along ? 1 : (size_t)b->nx;
        for (int l = 0; l < lines; l++) {
            float *at = v + (size_t)l * next, sum = 0; /* sums of whole numbers are exact */
            for (int i = 0; i < n; i++) line[i] = at[(size_t)i * step];
            for (int i = 0; i < n + radius; i++) {
                if (i < n) sum += line[i];
                if (i - 2 * radius - 1 >= 0) sum -= line[i - 2 * radius - 1];
                if (i >= radius) at[(size_t)(i - radius) * step] = sum;
            }
        }
    }
}

/* How what was taken back ends at block c: counts of its four sides where it joins the ground, where it drops, and
 * where a smooth surface that is no ground goes on from it with a kink or a step. */
typedef struct Ends {
    int joins, drops, kinks;
} Ends;

static const float wall_m = 2.5F, smooth = 0.8F, bank_m = 10, many = 0.15F;

static Ends ends_of(const Ground *g, size_t c)
{
    const Blocks    *b = &g->blocks;
    static const int di[4] = {1, -1, 0, 0}, dj[4] = {0, 0, 1, -1};
    const float      step_m = (float)(1.2 * b->block_m);
    Ends             ends = {0};
    for (int k = 0; k < 4; k++) {
        /* a wall's own block may hold both heights, so the comparison goes one block further */
        const ptrdiff_t d = di[k] + (ptrdiff_t)dj[k] * b->nx;
        const size_t    p = (size_t)((ptrdiff_t)c + d), q = (size_t)((ptrdiff_t)c + 2 * d);
        if (g->low[p] == FLT_MAX || g->low[q] == FLT_MAX) continue;
        if (g->object[p] == 0 && fabsf(g->low[p] - g->low[c]) <= step_m) ends.joins++;
        else if (g->object[q] < 2 && g->low[c] - g->low[q] > wall_m + 2 * step_m * g->slope[c]) ends.drops++;
        else if (g->object[p] == 1 && g->object[q] == 1 && fabsf(g->low[q] - g->low[c]) <= 2 * step_m &&
                 g->high[q] - g->low[q] <= smooth * (float)b->block_m && !runs_on(g, (size_t)((ptrdiff_t)c - d), c, p))
            ends.kinks++;
    }
    return ends;
}

/* Gives up blocks taken back where what was taken back nearby ends otherwise than on ground. A hill that a square
 * flattened ends on ground all around.
 *
 * Seats of a stadium, and embankments against a hall, end in drops. Seats on a bank of earth end where the next tier, a
 * rim or a roof goes on with a kink or a step: a smooth surface, which a wooded top is not. Dams and the flat tops of
 * banks have such ends too, so only what is higher over the widest opening than banks are built is given up: its foot
 * stays ground. */
static Status give_up_stands(Ground *g)
{
    const Blocks *b = &g->blocks;
    const int     nx = b->nx, ny = b->ny, radius = blocks_in(b, 60);
    const float   wide_m = (float)radius_m[scales - 1], few = (float)(40 / b->block_m);
    float        *drops = g->work, *joins = g->opened, *kinks = g->high;
    float        *line = malloc((size_t)(nx > ny ? nx : ny) * sizeof *line);
    if (!line) return STATUS_NO_MEMORY;
    memset(drops, 0, g->count * sizeof *drops), memset(joins, 0, g->count * sizeof *joins);
    for (int y = 2; y < ny - 2; y++)
        for (int x = 2; x < nx - 2; x++) {
            const size_t c = (size_t)y * (size_t)nx + (size_t)x;
            if (g->object[c] < 2) continue;
            const Ends ends = ends_of(g, c);
            joins[c] = (float)ends.joins, drops[c] = (float)(ends.drops + 8 * ends.kinks);
        }
    for (size_t c = 0; c < g->count; c++) { /* the highest returns are no longer needed */
        kinks[c] = floorf(drops[c] / 8);
        drops[c] -= 8 * kinks[c];
    }
    square_sums(drops, b, radius, line);
    square_sums(joins, b, radius, line);
    square_sums(kinks, b, radius, line);
    for (size_t c = 0; c < g->count; c++) {
        if (g->object[c] < 2) continue;
        const float ends = drops[c] + kinks[c], over_m = g->low[c] - g->height[c];
        const float ground_m = g->slope[c] > 0.05F ? wide_m * (g->slope[c] - 0.05F) : 0; /* by the slope alone */
        const bool  stands = drops[c] >= 6 && drops[c] > many * (drops[c] + joins[c]) && over_m > wall_m;
        const bool  tiers = ends >= few && ends > many * (ends + joins[c]) && over_m > bank_m + ground_m;
        if (stands || tiers) g->object[c] = 1;
    }
    for (size_t c = 0; c < g->count; c++) g->object[c] = g->object[c] == 1;
    free(line);
    return STATUS_OK;
}

/* Height of the filled ground at a cell's centre, linear between blocks' centres, and its slope. */
static float ground_at(float *slope, const Ground *g, int x, int y)
{
    const Blocks *b = &g->blocks;
    const float   u = ((float)(x + b->left) + 0.5F) / (float)b->size - 0.5F,
                v = ((float)(y + b->below) + 0.5F) / (float)b->size - 0.5F;
    int i = (int)floorf(u), j = (int)floorf(v);
    i = i < 0 ? 0 : i > b->nx - 2 ? b->nx - 2 : i;
    j = j < 0 ? 0 : j > b->ny - 2 ? b->ny - 2 : j;
    float s = u - (float)i, t = v - (float)j;
    s = s < 0 ? 0 : s > 1 ? 1 : s, t = t < 0 ? 0 : t > 1 ? 1 : t;
    const float *h = g->height + (size_t)j * (size_t)b->nx + (size_t)i;
    const float  south = h[0] + s * (h[1] - h[0]), north = h[b->nx] + s * (h[b->nx + 1] - h[b->nx]);
    if (slope) {
        const float gx = (h[1] - h[0] + h[b->nx + 1] - h[b->nx]) / 2, gy = north - south;
        *slope = sqrtf(gx * gx + gy * gy) / (float)b->block_m;
    }
    return south + t * (north - south);
}

/* Marks cells that are near the ground of the blocks' lowest returns. */
static void near_cells(uint8_t *is_ground, const Ground *g, const SurfaceModel *model, const float *surface_m,
                       float below_m, float above_m, float above_slope_m)
{
    for (int y = 0; y < model->ny; y++)
        for (int x = 0; x < model->nx; x++) {
            const size_t c = (size_t)y * (size_t)model->nx + (size_t)x;
            float        slope;
            const float  over = surface_m[c] - ground_at(&slope, g, x, y);
            if (slope > 1.2F) slope = 1.2F;
            is_ground[c] = over > -below_m - above_slope_m * slope && over < above_m + above_slope_m * slope;
        }
}

/* Corrects the ground by the mean difference of its cells, block by block, spread over 5 x 5 blocks. */
static Status correct(Ground *g, const SurfaceModel *model, const float *surface_m, const uint8_t *is_ground)
{
    const Blocks *b = &g->blocks;
    memset(g->work, 0, g->count * sizeof *g->work);
    memset(g->opened, 0, g->count * sizeof *g->opened);
    for (int y = 0; y < model->ny; y++)
        for (int x = 0; x < model->nx; x++) {
            const size_t c = (size_t)y * (size_t)model->nx + (size_t)x;
            if (!is_ground[c]) continue;
            const size_t at = block_of(b, x, y);
            g->work[at] += surface_m[c] - ground_at(NULL, g, x, y);
            g->opened[at] += 1;
        }
    for (int y = 0; y < b->ny; y++)
        for (int x = 0; x < b->nx; x++) {
            const size_t at = (size_t)y * (size_t)b->nx + (size_t)x;
            float        sum = 0, count = 0;
            /* a block with enough ground cells uses only its own */
            const int r = 4 * g->opened[at] >= (float)(b->size * b->size) && g->opened[at] > 0 ? 0 : 2;
            for (int j = y - r; j <= y + r; j++)
                for (int i = x - r; i <= x + r; i++) {
                    if (i < 0 || j < 0 || i >= b->nx || j >= b->ny) continue;
                    sum += g->work[(size_t)j * (size_t)b->nx + (size_t)i];
                    count += g->opened[(size_t)j * (size_t)b->nx + (size_t)i];
                }
            g->high[at] = g->height[at] + (count > 0 ? sum / count : 0);
        }
    memcpy(g->height, g->high, g->count * sizeof *g->height);
    return STATUS_OK;
}

Status take_apart_ground(float *bare_m, uint8_t *is_ground, const SurfaceModel *model, const float *surface_m,
                         double first_radius_m)
{
    Ground g;
    Status status = ground_create(&g, model);
    if (status != STATUS_OK) return status;
    lows(&g, model, surface_m);
    status = drop_low_points(&g);
    if (status == STATUS_OK) status = find_slope(&g, model);
    if (status == STATUS_OK) status = mark_objects(&g, model, first_radius_m);
    if (status == STATUS_OK) {
        regrow(&g);
        status = give_up_stands(&g);
    }
    if (status == STATUS_OK) {
        for (size_t c = 0; c < g.count; c++) g.height[c] = g.object[c] ? NAN : g.low[c];
        status = take_apart_fill(g.height, &g.blocks);
    }
    if (status == STATUS_OK) {
        const float size = (float)g.blocks.block_m;
        near_cells(is_ground, &g, model, surface_m, 1.0F, 0.4F, size);
        correct(&g, model, surface_m, is_ground);
        near_cells(is_ground, &g, model, surface_m, 0.4F, 0.4F, 0.5F * size);
        correct(&g, model, surface_m, is_ground);
        near_cells(is_ground, &g, model, surface_m, 0.4F, 0.4F, 0.5F * size);
        for (int y = 0; y < model->ny; y++)
            for (int x = 0; x < model->nx; x++) {
                const size_t c = (size_t)y * (size_t)model->nx + (size_t)x;
                bare_m[c] = is_ground[c] ? surface_m[c] : ground_at(NULL, &g, x, y);
            }
    }
    ground_destroy(&g);
    return status;
}
