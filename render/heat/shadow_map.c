/* render/heat/shadow_map.c: see shadow_map.h. */
#include "render/heat/shadow_map.h"

#include <stdlib.h>

struct ShadowMap {
    int      nx, ny, slots, stride; /* stride: slots, padded */
    double   x0_m, y0_m, cell_m;
    float   *z_m, *leaf_area;       /* while it is made */
    uint8_t *shadow;                /* [ny][nx][stride] */
    uint8_t *open;                  /* [ny][nx] of 255 */
};

/* Unit direction from cell to cell, along the axis on which the sun stands nearer. */
typedef struct Sweep {
    bool   along_x;
    int    from, to, step; /* of the rows, from the sun's side */
    double across;         /* cells sideways from a row to the one before */
    double drop_m;         /* of the shadow's edge from row to row */
    double soft_m;         /* height over which a cell goes from lit to shaded */
} Sweep;

static Sweep sweep_of(const ShadowMap *m, double x, double y, double up)
{
    const double level = hypot(x, y), tangent = level > 1e-9 ? up / level : 1e9;
    Sweep        s = {.along_x = fabs(x) >= fabs(y)};
    const double major = s.along_x ? x : y, minor = s.along_x ? y : x, rows = s.along_x ? m->nx : m->ny;
    s.from = major > 0 ? (int)rows - 1 : 0;
    s.to   = major > 0 ? -1 : (int)rows;
    s.step = major > 0 ? -1 : 1;
    s.across = fabs(major) > 1e-12 ? minor / fabs(major) : 0;
    s.drop_m = m->cell_m * hypot(1, s.across) * tangent;
    s.soft_m = m->cell_m * tangent;
    return s;
}

static size_t cell_at(const ShadowMap *m, const Sweep *s, int row, int k)
{
    return s->along_x ? (size_t)k * (size_t)m->nx + (size_t)row : (size_t)row * (size_t)m->nx + (size_t)k;
}

typedef struct Job {
    ShadowMap          *map;
    const ShadowPlants *plants;
    float             (*d_enu)[shadow_most_slots];
    const Elevation    *elevation;
    bool                failed[shadow_most_slots];
} Job;

/* Direct light that plants let through on its way to the ground of a cell. */
static double light_through(const ShadowMap *m, const ShadowPlants *plants, int i, int j, double x, double y, double up)
{
    const double level = hypot(x, y), x_m = m->x0_m + i * m->cell_m, y_m = m->y0_m + j * m->cell_m;
    const double ground_m = (double)m->z_m[(size_t)j * (size_t)m->nx + (size_t)i];
    const double along_m = 0.5 * m->cell_m, most = plants->most_m / up, stride_m = level > 1e-3 ? fmin(along_m / level, most) : most;
    double       depth = 0;
    for (double way_m = 0; way_m < most && depth < 8; way_m += stride_m) {
        const double at_x = x_m + (way_m + 0.5 * stride_m) * x, at_y = y_m + (way_m + 0.5 * stride_m) * y;
        const double ci = (at_x - m->x0_m) / m->cell_m, cj = (at_y - m->y0_m) / m->cell_m;
        if (!(ci >= 0 && cj >= 0 && ci <= m->nx - 1 && cj <= m->ny - 1)) break;
        const size_t there = (size_t)lround(cj) * (size_t)m->nx + (size_t)lround(ci);
        if (m->leaf_area[there] == 0) continue;
        const double there_m = (double)m->z_m[there];
        const double low_m = ground_m + way_m * up - there_m, high_m = low_m + stride_m * up;
        depth += 0.5 * (plants->area_above(plants->user, at_x, at_y, fmax(low_m, 0)) -
                        plants->area_above(plants->user, at_x, at_y, fmax(high_m, 0))) / up;
    }
    return exp(-depth);
}

static void fill_slot(void *user, int worker, int slot)
{
    Job          *job = user;
    ShadowMap    *m = job->map;
    const double  x = (double)job->d_enu[0][slot], y = (double)job->d_enu[1][slot], up = (double)job->d_enu[2][slot];
    const Sweep   s = sweep_of(m, x, y, up);
    const int     wide = s.along_x ? m->ny : m->nx;
    double       *edge = malloc(2 * (size_t)wide * sizeof *edge), *before = edge, *here = edge ? edge + wide : NULL;
    (void)worker;
    job->failed[slot] = !edge;
    if (!edge) return;
    for (int k = 0; k < wide; k++) before[k] = -INFINITY;
    for (int row = s.from; row != s.to; row += s.step) {
        for (int k = 0; k < wide; k++) {
            const size_t cell = cell_at(m, &s, row, k);
            const double at = k + s.across, z_m = (double)m->z_m[cell];
            const int    low = (int)floor(at);
            double       shade_m = -INFINITY;
            if (low >= 0 && low + 1 < wide) shade_m = before[low] + (at - low) * (before[low + 1] - before[low]) - s.drop_m;
            else if (low == wide - 1 && at == low) shade_m = before[low] - s.drop_m;
            double lit = isfinite(shade_m) ? clamp(0.5 - (shade_m - z_m) / s.soft_m, 0, 1) : 1;
            if (job->plants && lit > 0)
                lit *= light_through(m, job->plants, s.along_x ? row : k, s.along_x ? k : row, x, y, up);
            m->shadow[cell * (size_t)m->stride + (size_t)slot] = (uint8_t)lround(255 * (1 - lit));
            here[k] = fmax(z_m, isfinite(shade_m) ? shade_m : z_m);
        }
        double *swap = before;
        before = here, here = swap;
    }
    free(edge);
}

static void fill_row(void *user, int worker, int j)
{
    Job       *job = user;
    ShadowMap *m = job->map;
    (void)worker;
    for (int i = 0; i < m->nx; i++) {
        const double x_m = m->x0_m + i * m->cell_m, y_m = m->y0_m + j * m->cell_m;
        const size_t cell = (size_t)j * (size_t)m->nx + (size_t)i;
        m->z_m[cell] = (float)elevation_height(job->elevation, x_m, y_m, NULL);
        m->open[cell] = (uint8_t)(job->plants ? lround(255 * clamp(job->plants->open(job->plants->user, x_m, y_m), 0, 1)) : 255);
        m->leaf_area[cell] = job->plants ? (float)job->plants->area_above(job->plants->user, x_m, y_m, 0) : 0;
    }
}

static void run(Pool *pool, int count, PoolTask *task, void *user)
{
    if (pool) pool_run(pool, count, task, user);
    else
        for (int i = 0; i < count; i++) task(user, 0, i);
}

Status shadow_map_create(ShadowMap **out, const Elevation *elevation, double cell_m, int slots,
                         float d_enu[3][shadow_most_slots], const ShadowPlants *plants, Pool *pool)
{
    if (elevation->level_count < 1 || !(cell_m > 0) || slots < 0 || slots > shadow_most_slots) return STATUS_BAD_VALUE;
    const ElevationLevel *level = &elevation->level[0];
    const double          wide_m = (level->nx - 1) * level->spacing_m, high_m = (level->ny - 1) * level->spacing_m;
    while ((wide_m / cell_m + 1) * (high_m / cell_m + 1) > shadow_most_cells) cell_m *= 2;
    ShadowMap *m = calloc(1, sizeof *m);
    if (!m) return STATUS_NO_MEMORY;
    m->cell_m = cell_m;
    m->nx = (int)floor(wide_m / cell_m) + 1, m->ny = (int)floor(high_m / cell_m) + 1;
    m->x0_m = level->x0_m, m->y0_m = level->y0_m;
    m->slots = slots, m->stride = (slots + 7) / 8 * 8;
    const size_t cells = (size_t)m->nx * (size_t)m->ny;
    m->z_m    = malloc(cells * sizeof *m->z_m);
    m->open   = malloc(cells);
    m->shadow = calloc(cells, (size_t)(m->stride > 0 ? m->stride : 1));
    Job    job = {m, plants, d_enu, elevation, {false}};
    Status status = m->z_m && m->leaf_area && m->open && m->shadow ? STATUS_OK : STATUS_NO_MEMORY;
    if (status == STATUS_OK) {
        run(pool, m->ny, fill_row, &job);
        run(pool, slots, fill_slot, &job);
        for (int s = 0; s < slots; s++)
            if (job.failed[s]) status = STATUS_NO_MEMORY;
    }
    free(m->z_m);
    free(m->leaf_area);
    m->z_m = m->leaf_area = NULL;
    if (status == STATUS_OK) *out = m;
    else shadow_map_destroy(m);
    return status;
}

void shadow_map_destroy(ShadowMap *m)
{
    if (!m) return;
    free(m->z_m);
    free(m->leaf_area);
    free(m->open);
    free(m->shadow);
    free(m);
}

void shadow_map_at(uint8_t shadow[shadow_most_slots], double *open, const ShadowMap *m, double x_m, double y_m)
{
    const double x = (x_m - m->x0_m) / m->cell_m, y = (y_m - m->y0_m) / m->cell_m;
    if (!(x >= 0 && y >= 0 && x <= m->nx - 1 && y <= m->ny - 1)) {
        memset(shadow, 0, shadow_most_slots);
        *open = 1;
        return;
    }
    const int      i = (int)fmin(x, m->nx - 2), j = (int)fmin(y, m->ny - 2);
    const unsigned u = (unsigned)lround(16 * (x - i)), v = (unsigned)lround(16 * (y - j));
    const unsigned w00 = (16 - u) * (16 - v), w01 = u * (16 - v), w10 = (16 - u) * v, w11 = u * v; /* 256 in all */
    const size_t   cell = (size_t)j * (size_t)m->nx + (size_t)i, above = cell + (size_t)m->nx, stride = (size_t)m->stride;
    const uint8_t *a = m->shadow + cell * stride, *b = a + stride, *c = m->shadow + above * stride, *d = c + stride;
    for (size_t s = 0; s < stride; s++)
        shadow[s] = (uint8_t)((a[s] * w00 + b[s] * w01 + c[s] * w10 + d[s] * w11 + 128) >> 8);
    *open = (m->open[cell] * w00 + m->open[cell + 1] * w01 + m->open[above] * w10 + m->open[above + 1] * w11) / (255.0 * 256);
}

size_t shadow_map_bytes(const ShadowMap *m) { return (size_t)m->nx * (size_t)m->ny * (size_t)(m->stride + 1); }
double shadow_map_cell_m(const ShadowMap *m) { return m->cell_m; }
