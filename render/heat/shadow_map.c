/* render/heat/shadow_map.c: a map of what shades the ground, for several directions of the sun (heat.h). */
#include "render/heat/heat.h"
#include "pitviper_simd.h"

#include <stdlib.h>

struct ShadowMap {
    int          nx, ny, slots, stride; /* stride: slots, padded */
    double       x0_m, y0_m, cell_m;
    float       *z_m; /* while it is made, as all of these */
    ShadowStand *stand;
    float        most_m; /* highest plant */
    float   *line_m[2];  /* z_m column by column; tops of plants over the ground, row by row, then column by column */
    uint8_t *shadow;     /* [ny][nx][stride] */
    uint8_t *open;       /* [ny][nx] of 255 */
    uint8_t *shaded;     /* [ny][nx] 1: not lit and open all day at this cell and those to its north and east */
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
    s.to = major > 0 ? -1 : (int)rows;
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

static const float no_plant_m = -1e6f;

typedef struct Job {
    ShadowMap    *map;
    ShadowPlants *plants;
    const void   *user;
    float (*d_enu)[shadow_most_slots];
    const float     *clumped;
    const Elevation *elevation;
    bool             failed[shadow_most_slots];
} Job;

static double larger(double a, double b) { return a > b ? a : b; } /* not fmax, which compiles to a call */

/* Heights in the order in which sweeps along x meet them too: a column's cells lie far apart. */
static void turn_column(void *user, int worker, int i)
{
    const ShadowMap *m = ((const Job *)user)->map;
    const size_t     cells = (size_t)m->nx * (size_t)m->ny;
    (void)worker;
    for (int j = 0; j < m->ny; j++) {
        const size_t cell = (size_t)j * (size_t)m->nx + (size_t)i, turned = (size_t)i * (size_t)m->ny + (size_t)j;
        m->line_m[0][turned] = m->z_m[cell];
        if (!m->stand) continue;
        const float top_m = m->stand[cell].leaf_area > 0 ? m->stand[cell].top_m : no_plant_m;
        m->line_m[1][cell] = m->line_m[1][cells + turned] = top_m;
    }
}

static double area_above(const ShadowStand *s, double height_m)
{
    if (height_m >= (double)s->top_m) return 0;
    return (double)s->leaf_area *
           (height_m <= (double)s->base_m ? 1 : ((double)s->top_m - height_m) / (double)(s->top_m - s->base_m));
}

/* Direct light that plants let through on its way to the ground of a cell: a cell's width at a time. */
static double light_through(const ShadowMap *m, int i, int j, double x, double y, double up, double clumped)
{
    const double level = hypot(x, y), ground_m = (double)m->z_m[(size_t)j * (size_t)m->nx + (size_t)i];
    const double most = (double)m->most_m / up, stride_m = level > 1e-3 ? fmin(m->cell_m / level, most) : most;
    double       depth = 0;
    for (double way_m = 0; way_m < most && clumped * depth < 8; way_m += stride_m) {
        const double ci = i + (way_m + 0.5 * stride_m) * x / m->cell_m,
                     cj = j + (way_m + 0.5 * stride_m) * y / m->cell_m;
        if (!(ci >= 0 && cj >= 0 && ci <= m->nx - 1 && cj <= m->ny - 1)) break;
        const size_t       there = (size_t)(cj + 0.5) * (size_t)m->nx + (size_t)(ci + 0.5);
        const ShadowStand *stand = &m->stand[there];
        if (stand->leaf_area == 0) continue;
        const double low_m = ground_m + way_m * up - (double)m->z_m[there];
        depth += 0.5 * (area_above(stand, low_m) - area_above(stand, low_m + stride_m * up)) / up;
    }
    return exp(-clumped * depth);
}

/* Height of a shadow's edge at cell k of a row, from the edges of the row before, less what it drops. */
static double edge_at(const double *before, const Sweep *s, int k, int wide)
{
    const double at = k + s->across;
    const int    low = (int)floor(at);
    if (low >= 0 && low + 1 < wide) return before[low] + (at - low) * (before[low + 1] - before[low]) - s->drop_m;
    return low == wide - 1 && at == low ? before[low] - s->drop_m : -1e9;
}

static void fill_slot(void *user, int worker, int slot)
{
    Job         *job = user;
    ShadowMap   *m = job->map;
    const double x = (double)job->d_enu[0][slot], y = (double)job->d_enu[1][slot], up = (double)job->d_enu[2][slot];
    const double clumped = job->clumped ? (double)job->clumped[slot] : 1;
    const Sweep  s = sweep_of(m, x, y, up);
    const int    wide = s.along_x ? m->ny : m->nx;
    double      *edge = malloc(4 * (size_t)wide * sizeof *edge); /* of the ground and of plants, two rows of each */
    (void)worker;
    job->failed[slot] = !edge;
    if (!edge) return;
    double *ground[2] = {edge, edge + wide}, *plants[2] = {edge + 2 * wide, edge + 3 * wide};
    for (int k = 0; k < 4 * wide; k++) edge[k] = -1e9;
    for (int row = s.from; row != s.to; row += s.step) {
        const size_t first = (size_t)row * (size_t)wide, cells = (size_t)m->nx * (size_t)m->ny;
        const float *z = (s.along_x ? m->line_m[0] : m->z_m) + first;
        const float *top = m->stand ? m->line_m[1] + (s.along_x ? cells : 0) + first : NULL;
        for (int k = 0; k < wide; k++) {
            const double z_m = (double)z[k], shade_m = edge_at(ground[0], &s, k, wide);
            double       lit = clamp(0.5 - (shade_m - z_m) / s.soft_m, 0, 1);
            ground[1][k] = larger(z_m, shade_m);
            if (m->most_m > 0) {
                const double crowns_m = larger(edge_at(plants[0], &s, k, wide), z_m + (double)top[k]);
                if (lit > 0 && crowns_m > z_m - s.drop_m)
                    lit *= light_through(m, s.along_x ? row : k, s.along_x ? k : row, x, y, up, clumped);
                plants[1][k] = crowns_m;
            }
            m->shadow[cell_at(m, &s, row, k) * (size_t)m->stride + (size_t)slot] = (uint8_t)lround(255 * (1 - lit));
        }
        double *swap = ground[0];
        ground[0] = ground[1], ground[1] = swap;
        swap = plants[0];
        plants[0] = plants[1], plants[1] = swap;
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
        if (job->plants) job->plants(&m->stand[cell], job->user, x_m, y_m);
        m->open[cell] = (uint8_t)(job->plants ? lround(255 * clamp((double)m->stand[cell].open, 0, 1)) : 255);
    }
}

static void run(Pool *pool, int count, PoolTask *task, void *user)
{
    if (pool) pool_run(pool, count, task, user);
    else
        for (int i = 0; i < count; i++) task(user, 0, i);
}

/* Everything that the shadows follow from. */
static CacheKey key_of(const ShadowMap *m, const ShadowOf *of)
{
    const size_t  cells = (size_t)m->nx * (size_t)m->ny;
    const int32_t whole[] = {m->nx, m->ny, m->slots, m->stand != NULL};
    CacheKey      key = cache_key("shadow map");
    cache_key_add(&key, whole, sizeof whole);
    cache_key_add(&key, &m->cell_m, sizeof m->cell_m);
    for (int k = 0; k < 3; k++) cache_key_add(&key, of->d_enu[k], (size_t)m->slots * sizeof **of->d_enu);
    if (of->clumped) cache_key_add(&key, of->clumped, (size_t)m->slots * sizeof *of->clumped);
    cache_key_add(&key, m->z_m, cells * sizeof *m->z_m);
    _Static_assert(sizeof *m->stand == 4 * sizeof(float), "no padding");
    if (m->stand) cache_key_add(&key, m->stand, cells * sizeof *m->stand);
    return key;
}

/* Takes the shadows from the cache; any octets are shadows. */
static bool fetch(ShadowMap *m, Cache *cache, CacheKey *key, size_t octets)
{
    void  *kept;
    size_t count;
    if (!cache_fetch(&kept, &count, cache, key)) return false;
    const bool fits = count == octets;
    if (fits) memcpy(m->shadow, kept, octets);
    free(kept);
    return fits;
}

static Status cast(ShadowMap *m, Job *job, const ShadowOf *of, Pool *pool)
{
    const size_t cells = (size_t)m->nx * (size_t)m->ny, octets = cells * (size_t)m->stride;
    CacheKey     key = {.digest = NULL};
    run(pool, m->ny, fill_row, job);
    if (of->raise) of->raise(m->z_m, &(ShadowGrid){m->nx, m->ny, m->x0_m, m->y0_m, m->cell_m}, of->raise_user);
    if (of->cache) key = key_of(m, of);
    if (of->cache && fetch(m, of->cache, &key, octets)) return STATUS_OK;
    for (size_t k = 0; of->plants && k < cells; k++)
        m->most_m = fmaxf(m->most_m, m->stand[k].leaf_area > 0 ? m->stand[k].top_m : 0);
    m->line_m[0] = malloc(cells * sizeof **m->line_m);
    m->line_m[1] = m->stand ? malloc(2 * cells * sizeof **m->line_m) : NULL;
    if (!m->line_m[0] || (m->stand && !m->line_m[1])) return STATUS_NO_MEMORY;
    run(pool, m->nx, turn_column, job);
    run(pool, m->slots, fill_slot, job);
    for (int s = 0; s < m->slots; s++)
        if (job->failed[s]) return STATUS_NO_MEMORY;
    cache_keep(of->cache, &key, m->shadow, octets);
    return STATUS_OK;
}

static bool is_shaded(const ShadowMap *m, size_t cell)
{
    uint8_t any = 0;
    for (size_t s = cell * (size_t)m->stride; s < (cell + 1) * (size_t)m->stride; s++) any |= m->shadow[s];
    return any != 0 || m->open[cell] != 255;
}

static void mark_row(void *user, int worker, int j)
{
    const ShadowMap *m = ((const Job *)user)->map;
    const size_t     row = (size_t)j * (size_t)m->nx, rows = j + 1 < m->ny ? 2 : 1;
    (void)worker;
    memset(m->shaded + row, 0, (size_t)m->nx);
    for (size_t k = 0; k < rows; k++)
        for (size_t i = 0; i < (size_t)m->nx; i++) {
            if (!is_shaded(m, row + k * (size_t)m->nx + i)) continue;
            m->shaded[row + i] = 1;
            if (i > 0) m->shaded[row + i - 1] = 1;
        }
}

static void free_heights(ShadowMap *m)
{
    free(m->z_m);
    free(m->stand);
    for (int k = 0; k < 2; k++) free(m->line_m[k]);
    m->z_m = m->line_m[0] = m->line_m[1] = NULL, m->stand = NULL;
}

Status heat_shadow_create(ShadowMap **out, const ShadowOf *of, Pool *pool)
{
    const Elevation *elevation = of->elevation;
    double           cell_m = of->cell_m;
    const int        slots = of->slots;
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
    m->z_m = malloc(cells * sizeof *m->z_m);
    m->stand = of->plants ? malloc(cells * sizeof *m->stand) : NULL;
    m->open = malloc(cells);
    m->shaded = malloc(cells);
    m->shadow = calloc(cells, (size_t)(m->stride > 0 ? m->stride : 1));
    Job    job = {m, of->plants, of->user, of->d_enu, of->clumped, elevation, {false}};
    Status status =
        m->z_m && (m->stand || !of->plants) && m->open && m->shaded && m->shadow ? STATUS_OK : STATUS_NO_MEMORY;
    if (status == STATUS_OK) status = cast(m, &job, of, pool);
    if (status == STATUS_OK) run(pool, m->ny, mark_row, &job);
    free_heights(m);
    if (status == STATUS_OK) *out = m;
    else heat_shadow_destroy(m);
    return status;
}

void heat_shadow_destroy(ShadowMap *m)
{
    if (!m) return;
    free_heights(m);
    free(m->open);
    free(m->shaded);
    free(m->shadow);
    free(m);
}

/* lround of 0 .. 2^31, which compiles to a call. */
static inline unsigned nearest(double x)
{
    const unsigned whole = (unsigned)x;
    return whole + (unsigned)(x - whole >= 0.5);
}

static inline __m128i eight_shares(const uint8_t *of, unsigned weight)
{
    return _mm_mullo_epi16(_mm_cvtepu8_epi16(_mm_loadl_epi64((const __m128i *)of)), _mm_set1_epi16((short)weight));
}

bool heat_shadow_at(uint8_t shadow[shadow_most_slots], double *open, const ShadowMap *m, double x_m, double y_m)
{
    const double x = (x_m - m->x0_m) / m->cell_m, y = (y_m - m->y0_m) / m->cell_m;
    if (!(x >= 0 && y >= 0 && x <= m->nx - 1 && y <= m->ny - 1)) {
        memset(shadow, 0, shadow_most_slots);
        *open = 1;
        return false;
    }
    const int    i = x < m->nx - 2 ? (int)x : m->nx - 2, j = y < m->ny - 2 ? (int)y : m->ny - 2;
    const size_t cell = (size_t)j * (size_t)m->nx + (size_t)i;
    if (!m->shaded[cell]) {
        memset(shadow, 0, (size_t)m->stride);
        *open = 1;
        return false;
    }
    const unsigned u = nearest(16 * (x - i)), v = nearest(16 * (y - j));
    const unsigned w00 = (16 - u) * (16 - v), w01 = u * (16 - v), w10 = (16 - u) * v, w11 = u * v; /* 256 in all */
    const size_t   above = cell + (size_t)m->nx, stride = (size_t)m->stride;
    const uint8_t *a = m->shadow + cell * stride, *b = a + stride, *c = m->shadow + above * stride, *d = c + stride;
    for (size_t s = 0; s < stride; s += 8) { /* sums of 255 times 256 and 128 fit in 16 bits */
        const __m128i sum = _mm_add_epi16(_mm_add_epi16(eight_shares(a + s, w00), eight_shares(b + s, w01)),
                                          _mm_add_epi16(eight_shares(c + s, w10), eight_shares(d + s, w11)));
        const __m128i share = _mm_srli_epi16(_mm_add_epi16(sum, _mm_set1_epi16(128)), 8);
        _mm_storel_epi64((__m128i *)(shadow + s), _mm_packus_epi16(share, share));
    }
    *open = (m->open[cell] * w00 + m->open[cell + 1] * w01 + m->open[above] * w10 + m->open[above + 1] * w11) /
            (255.0 * 256);
    return true;
}

size_t heat_shadow_bytes(const ShadowMap *m) { return (size_t)m->nx * (size_t)m->ny * (size_t)(m->stride + 2); }
double heat_shadow_cell_m(const ShadowMap *m) { return m->cell_m; }
