/* render/trace/visibility/visibility_ground.c: the ground among what rays can meet. */
#include "pitviper_simd.h"
#include "render/trace/visibility/visibility_private.h"

enum { clear_rays = 128 }; /* that are tested together */

static void grow_box(double box[2][3], const double p[3])
{
    for (int c = 0; c < 3; c++) {
        box[0][c] = p[c] < box[0][c] ? p[c] : box[0][c];
        box[1][c] = p[c] > box[1][c] ? p[c] : box[1][c];
    }
}

/* Rays of one list. */
typedef struct GroundRays {
    int                  count;
    const double *const *o, *const *d;
    const double *far_m;
} GroundRays;

/* First hits with the ground, straight or bent, with the walk that is shared or without. Returns the rays that shared
 * it. */
static uint64_t ground_hits(double *range_m, GroundHit *hit, const Visibility *v, const Ground *ground,
                            const GroundRays *rays)
{
    const bool together = skips(v->skips_off, SKIP_GROUND_WALK);
    if (together) ground_first_hits_together(range_m, hit, ground, rays->count, rays->o, rays->d, rays->far_m);
    else ground_first_hits(range_m, hit, ground, rays->count, rays->o, rays->d, rays->far_m);
    return together ? (uint64_t)rays->count : 0;
}

/* Whether every ray ends, where it met something or is no longer searched, and all of the ground is below all of them
 * up to there. */
static bool ground_lies_below(const Visibility *v, const TraceBlock *block)
{
    const double *const *const o = block->o_enu, *const *const d = block->d_enu;
    const double *const until_m = block->limit_m;
    const int           count = block->rays->count;
    for (int i = 0; i < count; i++)
        if (!(until_m[i] < INFINITY)) return false;
    for (int first = 0; first < count; first += clear_rays) {
        const int end = first + clear_rays < count ? first + clear_rays : count;
        double    start[2][3] = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}}, end_box[2][3];
        memcpy(end_box, start, sizeof end_box);
        for (int i = first; i < end; i++) {
            const double p[3] = {o[0][i], o[1][i], o[2][i]}, way[3] = {d[0][i], d[1][i], d[2][i]};
            double       at[3];
            v3_add_scaled(at, p, until_m[i], way);
            if (block->rays->bent) at[2] -= ray_drop(v, block->rays, i, until_m[i]); /* its chord is below the ray */
            grow_box(start, p);
            grow_box(end_box, at);
        }
        if (!ground_is_clear(&v->ground, end_box, start)) return false;
    }
    return true;
}

static void ground_first(double *range_m, void *found, const TraceBlock *block, const void *self)
{
    const Visibility   *v = block->v;
    VisibilityCounters *counters = block->counters;
    const int           count = block->rays->count;
    const bool          behind = skips(v->skips_off, SKIP_GROUND_BEHIND);
    (void)self;
    for (int i = 0; i < count; i++) counters->skipped[SKIP_GROUND_BEHIND] += behind && block->met[i];
    counters->rays_ground += (uint64_t)count;
    if (skips(v->skips_off, SKIP_GROUND_BELOW) && ground_lies_below(v, block)) {
        for (int i = 0; i < count; i++) range_m[i] = INFINITY;
        counters->skipped[SKIP_GROUND_BELOW] += (uint64_t)count;
    } else {
        const GroundRays rays = {count, block->o_enu, block->d_enu, behind ? block->limit_m : block->rays->far_m};
        counters->skipped[SKIP_GROUND_WALK] +=
            ground_hits(range_m, found, v, block->rays->bent ? &v->seen : &v->ground, &rays);
    }
}

/* Normals of four hits in a row, stored at once. False: some normal faces away from its ray. */
static bool store_four_normals(Hits *hits, int i, double n_geo[3][4], double n_enu[3][4], const double *const d[3])
{
    F64x4 geo[3], enu[3], way[3];
    for (int c = 0; c < 3; c++)
        geo[c] = f64x4_loadu(n_geo[c]), enu[c] = f64x4_loadu(n_enu[c]), way[c] = f64x4_loadu(d[c] + i);
    const F64x4 none = f64x4_set(0), along = geo[0] * way[0] + geo[1] * way[1] + geo[2] * way[2];
    const F64x4 away = enu[0] * way[0] + enu[1] * way[1] + enu[2] * way[2];
    if (f64x4_bits(f64x4_or(f64x4_less(none, along), f64x4_less(none, away)))) return false;
    for (int c = 0; c < 3; c++) {
        _mm_storeu_ps(hits->n_geo[c] + i, _mm256_cvtpd_ps(geo[c]));
        _mm_storeu_ps(hits->n_enu[c] + i, _mm256_cvtpd_ps(enu[c]));
    }
    return true;
}

/* Normals of the ground at the listed hits; where it was met from below, of its lower side. */
static void complete_normals(Hits *hits, const Visibility *v, const GroundHit *hit, const int *list, int count,
                             const double *const d[3])
{
    enum { lanes = ground_normals_lanes };
    for (int first = 0; first < count; first += lanes) {
        double    n_geo[3][lanes], n_enu[3][lanes];
        const int some = count - first < lanes ? count - first : lanes;
        ground_normals(n_geo, n_enu, &v->ground, hit, list + first, some, hits->p_enu[0], hits->p_enu[1]);
        const bool row = some == lanes && list[first + lanes - 1] == list[first] + lanes - 1; /* ascending */
        if (row && store_four_normals(hits, list[first], n_geo, n_enu, d)) continue;
        for (int k = 0; k < some; k++) {
            const int    i = list[first + k];
            const double d_enu[3] = {d[0][i], d[1][i], d[2][i]};
            double geo[3] = {n_geo[0][k], n_geo[1][k], n_geo[2][k]}, enu[3] = {n_enu[0][k], n_enu[1][k], n_enu[2][k]};
            if (v3_dot(geo, d_enu) > 0) { /* stopped inside the solid ground */
                v3_scale(geo, -1, geo);
                v3_scale(enu, -1, enu);
            }
            visibility_store_normals(hits, i, geo, enu, d_enu);
        }
    }
}

/* Normals, surface class and material. */
static void ground_finish(Hits *hits, const int *list, int count, const void *found, const TraceBlock *block,
                          const void *self)
{
    const Visibility *v = block->v;
    double            x_m[hits_capacity], y_m[hits_capacity], down[hits_capacity];
    (void)self;
    const double *const *d = block->d_enu, *const bent[3] = {d[0], d[1], down};
    const double twice = 2 * v->seen.bend_per_m;
    for (int i = 0; i < hits->count && block->rays->bent; i++) /* where a bent ray goes when it arrives */
        down[i] = d[2][i] - twice * hits->range_m[i] * (d[0][i] * d[0][i] + d[1][i] * d[1][i]);
    complete_normals(hits, v, found, list, count, block->rays->bent ? bent : d);
    for (int i = 0; i < hits->count; i++) x_m[i] = y_m[i] = NAN;
    for (int k = 0; k < count; k++) {
        const int i = list[k];
        hits->kind[i] = hit_ground;
        x_m[i] = hits->p_enu[0][i], y_m[i] = hits->p_enu[1][i];
    }
    surface_cells_at(hits->surface, v->cells, v->landscape, hits->count, x_m, y_m);
    for (int i = 0; i < hits->count && v->materials; i++)
        if (hits->surface[i]) hits->material[i] = (uint16_t)v->materials->surface[hits->surface[i]];
}

/* ---- shadows ---------------------------------------------------------------------------------- */

/* ask: the sun rays from neighbouring hits that the ground might block. */
static void leave_out_clear(uint8_t *ask, const Visibility *v, int count, const double *const o[3], const uint8_t *dark,
                            const double d_enu[3])
{
    for (int first = 0; first < count; first += clear_rays) {
        const int end = first + clear_rays < count ? first + clear_rays : count;
        double    box[2][3] = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
        bool      any = false;
        for (int i = first; i < end; i++) {
            const double p[3] = {o[0][i], o[1][i], o[2][i]};
            if (dark[i]) continue;
            grow_box(box, p);
            any = true;
        }
        memset(ask + first, any && !ground_is_clear_towards(&v->ground, box, d_enu), (size_t)(end - first));
    }
}

/* Traced only for rays that nothing has stopped. */
static void ground_any(const TraceShadow *s, const void *self)
{
    const Visibility *v = s->v;
    double            start[3][hits_capacity], far_m[hits_capacity], range_m[hits_capacity];
    uint8_t           ask[hits_capacity];
    int               ray[hits_capacity], left = 0, lit = 0;
    (void)self;
    if (skips(v->skips_off, SKIP_SUN_CLEAR)) leave_out_clear(ask, v, s->count, s->o_enu, s->dark, s->way_enu);
    else memset(ask, 1, (size_t)s->count);
    for (int i = 0; i < s->count; i++) {
        const bool stopped = s->dark[i] && skips(v->skips_off, SKIP_SUN_STOPPED);
        s->counters->skipped[SKIP_SUN_STOPPED] += stopped;
        s->counters->skipped[SKIP_SUN_CLEAR] += !stopped && !ask[i];
        lit += !stopped;
        if (stopped || !ask[i]) continue;
        for (int c = 0; c < 3; c++) start[c][left] = s->o_enu[c][i];
        far_m[left] = INFINITY;
        ray[left++] = i;
    }
    const double *const o[3] = {start[0], start[1], start[2]};
    s->counters->skipped[SKIP_GROUND_WALK] +=
        ground_hits(range_m, NULL, v, &v->ground, &(GroundRays){left, o, s->d_enu, far_m});
    for (int k = 0; k < left; k++) s->dark[ray[k]] |= range_m[k] < INFINITY;
    s->counters->rays_sun_ground += (uint64_t)lit;
}

const TraceEntry trace_ground = {.turn = 1,
                                 .found_octets = hits_capacity * sizeof(GroundHit),
                                 .first_hits = ground_first,
                                 .finish = ground_finish,
                                 .any_hits = ground_any};
