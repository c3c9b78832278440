/* render/light/sky_entities.c: sample points on the visible surface of an entity: their grid, their light, and the
 * interpolation at a hit. See sky_visibility.h. */
#include "render/light/sky_visibility_private.h"

#include "pitviper_simd.h"

#include <sched.h>

enum { grid_directions = 28 /* a point */, grid_least = 3, grid_most = 48 /* places over an entity's box, a side */ };
enum { task_places = 32 }; /* points that are traced together */
enum { aspect_bins = 12 }; /* a quarter of the way round: 5 to 10 degrees each */
static const double grid_px = 2.75;

/* Middle of the bin of a direction: a cube about it has so many a side on each face. Exact operations alone: the same
 * on every machine. */
static void middle_of_bin(double out[3], const double d[3])
{
    int axis = 0;
    for (int c = 1; c < 3; c++)
        if (fabs(d[c]) > fabs(d[axis])) axis = c;
    for (int c = 0; c < 3; c++) {
        const double at = floor(0.5 * (d[c] / fabs(d[axis]) + 1) * aspect_bins);
        out[c] = (clamp(at, 0, aspect_bins - 1) + 0.5) * 2 / aspect_bins - 1;
    }
    out[axis] = d[axis] < 0 ? -1 : 1;
    v3_normalize(out, out);
}

/* The nearest of 2^(n / 2). */
static double nearest_step(double x)
{
    int          exponent;
    const double half = frexp(x * 1.1892071150027210667, &exponent);
    return ldexp(half < 0.70710678118654752 ? 0.5 : 0.70710678118654752, exponent);
}

/* A grid that stands on the entity's body while the eye stays within a bin of aspects and of distances. */
static void grid_of_body(SkyEntity *e, const SkyVisibility *v, const PosedEntity *posed, const double offset_enu[3])
{
    double towards[3], from[3], across[2][3], low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    m3_tmul_v3(towards, posed->r_enu_from_body, offset_enu);
    v3_scale(towards, -1, towards);
    middle_of_bin(from, towards);
    across[0][0] = from[1], across[0][1] = -from[0], across[0][2] = 0; /* level */
    if (!(v3_dot(across[0], across[0]) > 1e-6)) across[0][0] = 1, across[0][1] = 0;
    v3_normalize(across[0], across[0]);
    v3_cross(across[1], from, across[0]);
    for (int corner = 0; corner < 8; corner++)
        for (int k = 0; k < 2; k++) {
            double at = 0;
            for (int c = 0; c < 3; c++) at += across[k][c] * (corner >> c & 1 ? posed->box_high[c] : posed->box_low[c]);
            low[k] = fmin(low[k], at), high[k] = fmax(high[k], at);
        }
    const double pitch_m = nearest_step(fmax(v3_length(offset_enu), 1) * v->px_rad * grid_px);
    e->of_body = true;
    e->columns = (int)clamp(ceil((high[0] - low[0]) / pitch_m), grid_least, grid_most);
    e->rows = (int)clamp(ceil((high[1] - low[1]) / pitch_m), grid_least, grid_most);
    for (int k = 0; k < 2; k++) {
        e->low[k] = low[k], e->step[k] = (high[k] - low[k]) / (k == 0 ? e->columns : e->rows);
        m3_mul_v3(e->across_enu[k], posed->r_enu_from_body, across[k]);
    }
    m3_mul_v3(e->from_enu, posed->r_enu_from_body, from);
    e->pitch_m = fmax(e->step[0], e->step[1]);
}

Status sky_entities_grid(SkyEntity *e, const SkyVisibility *v, const PosedEntity *posed, const double box_px[4],
                         Arena *arena)
{
    const View  *view = v->scene.view;
    const double x0 = fmax(box_px[0], 0), x1 = fmin(box_px[2], view->width);
    const double y0 = fmax(box_px[1], 0), y1 = fmin(box_px[3], view->height);
    double       offset_enu[3];
    if (!(x1 > x0 && y1 > y0)) return STATUS_OK;
    v3_sub(offset_enu, posed->centre_enu, view->p_enu);
    if (fmax(box_px[2] - box_px[0], box_px[3] - box_px[1]) <= grid_most * grid_px) {
        grid_of_body(e, v, posed, offset_enu);
    } else {
        e->columns = (int)clamp(ceil((x1 - x0) / grid_px), grid_least, grid_most);
        e->rows = (int)clamp(ceil((y1 - y0) / grid_px), grid_least, grid_most);
        e->low[0] = x0, e->low[1] = y0;
        e->step[0] = (x1 - x0) / e->columns, e->step[1] = (y1 - y0) / e->rows;
        e->pitch_m = fmax(v3_length(offset_enu), 1) * v->px_rad * fmax(e->step[0], e->step[1]);
    }
    const size_t spots = (size_t)(e->columns * e->rows) + 8;
    bool         got = (e->spot.factor = arena_alloc(arena, spots, sizeof *e->spot.factor)) != NULL &&
               (e->spot.below = arena_alloc(arena, spots, sizeof *e->spot.below)) != NULL;
    for (int k = 0; k < spot_values; k++)
        got = (e->spot.value[k] = arena_alloc(arena, spots, sizeof *e->spot.value[k])) != NULL && got;
    return got ? STATUS_OK : STATUS_NO_MEMORY;
}

Status sky_entities_tasks(SkyVisibility *v, Arena *arena)
{
    int count = 0;
    for (int k = 0; k < v->on_image; k++)
        count += (v->entity[k].columns * v->entity[k].rows + task_places - 1) / task_places;
    v->task_entity = arena_alloc(arena, (size_t)count + 1, sizeof *v->task_entity);
    v->task_first = arena_alloc(arena, (size_t)count + 1, sizeof *v->task_first);
    if (!v->task_entity || !v->task_first) return STATUS_NO_MEMORY;
    for (int k = 0; k < v->on_image; k++) {
        SkyEntity *e = &v->entity[k];
        e->first_task = v->tasks;
        for (int first = 0; first < e->columns * e->rows; first += task_places) {
            v->task_entity[v->tasks] = k;
            v->task_first[v->tasks++] = first;
        }
        e->tasks = v->tasks - e->first_task;
    }
    return STATUS_OK;
}

/* Key of the point: 2, the entity, the cell of its grid. Keys of ground points: sky_visibility.c. */
static uint64_t spot_key(int entity, int spot) { return (uint64_t)2 << 62 | (uint64_t)entity << 20 | (uint64_t)spot; }

int sky_visibility_tasks(const SkyVisibility *v) { return v->tasks; }

/* Leaves out the rays that would miss the entity if it were alone, and ends the others just beyond it: the tree is not
 * followed behind it. Returns their number. */
static int keep_meeting(Rays *rays, int point[task_places], const Visibility *v, int index, bool ask_all)
{
    double              z_m[task_places];
    const double *const o[3] = {rays->o_enu[0], rays->o_enu[1], z_m};
    const double *const d[3] = {rays->d_enu[0], rays->d_enu[1], rays->d_enu[2]};
    double              range_m[task_places];
    PartHit             hit[task_places];
    int                 all[task_places], kept = 0;
    const double        lift_m = rays->bent ? visibility_lift(v, index) : 0;
    for (int i = 0; i < rays->count; i++) range_m[i] = INFINITY, all[i] = i, z_m[i] = rays->o_enu[2][i] - lift_m;
    parts_first_hits(range_m, hit, visibility_posed(v, index), o, d, rays->far_m, all, rays->count, ask_all);
    for (int i = 0; i < rays->count; i++) {
        if (!(range_m[i] < INFINITY)) continue;
        for (int c = 0; c < 3; c++) {
            rays->o_enu[c][kept] = rays->o_enu[c][i];
            rays->d_enu[c][kept] = rays->d_enu[c][i];
        }
        rays->far_m[kept] = range_m[i] * (1 + 1e-9) + 1e-3;
        point[kept++] = point[i];
    }
    return rays->count = kept;
}

static void leave_eye(Rays *rays, int i, const View *view, const double at_px[2])
{
    double d_enu[3];
    view_ray(d_enu, view, at_px[0], at_px[1]);
    for (int c = 0; c < 3; c++) rays->o_enu[c][i] = view->p_enu[c], rays->d_enu[c][i] = d_enu[c];
    rays->far_m[i] = INFINITY;
}

/* Parallel rays from look_m beside the body. */
static void leave_body(Rays *rays, int i, const SkyEntity *e, const PosedEntity *posed, const double at_m[2])
{
    double to_centre[3];
    v3_sub(to_centre, posed->centre_enu, posed->p_enu);
    const double away_m = v3_dot(to_centre, e->from_enu) + posed->radius_m + look_m;
    for (int c = 0; c < 3; c++) {
        rays->o_enu[c][i] =
            posed->p_enu[c] + at_m[0] * e->across_enu[0][c] + at_m[1] * e->across_enu[1][c] + away_m * e->from_enu[c];
        rays->d_enu[c][i] = -e->from_enu[c];
    }
    rays->far_m[i] = INFINITY;
}

/* Traces the visible surface of the entity at some points of its grid, and computes the light there. */
static void ask_points(const SkyVisibility *v, SkyWorker *w, int task)
{
    const SkyEntity       *e = &v->entity[v->task_entity[task]];
    const int              index = e->index, first = v->task_first[task];
    const View            *view = v->scene.view;
    const int              all = e->columns * e->rows;
    const HemisphereScene *scene = &v->scene.gather;
    VisibilityCounters     unused = {0};
    Rays                  *rays = &w->rays;
    Hits                  *met = &w->met, *places = &w->places;
    int    of[task_places], point[task_places], count = all - first < task_places ? all - first : task_places;
    double box[2][3] = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    rays->count = count, rays->columns = 0, rays->bent = !e->of_body;
    for (int i = 0; i < count; i++) {
        const double at[2] = {e->low[0] + e->step[0] * ((first + i) % e->columns + 0.5),
                              e->low[1] + e->step[1] * ((first + i) / e->columns + 0.5)};
        point[i] = first + i;
        if (e->of_body) leave_body(rays, i, e, visibility_posed(scene->visibility, index), at);
        else leave_eye(rays, i, view, at);
    }
    if (skips(v->scene.skips_off, SKIP_LIGHT))
        count = keep_meeting(rays, point, scene->visibility, index, !skips(v->scene.skips_off, SKIP_PART));
    if (count == 0) return;
    if (e->of_body) {
        /* what stands before it from there hides points of it */
        const double *c = visibility_posed(scene->visibility, index)->centre_enu;
        const int     near = visibility_near(w->near, scene->visibility, c, c,
                                             look_m + 2 * visibility_posed(scene->visibility, index)->radius_m);
        visibility_first_part(met, scene->visibility, rays, visibility_listed(w->near, near, -1), &unused);
    } else {
        /* those that the rows of these points may see: with many entities a fraction of all */
        const double y_px = e->low[1] + e->step[1] * (point[0] / e->columns),
                     end_px = e->low[1] + e->step[1] * (point[count - 1] / e->columns + 1);
        const double box_px[4] = {e->low[0], y_px, e->low[0] + e->step[0] * e->columns, end_px};
        const int    seen =
            visibility_block_entities(w->near, scene->visibility, view, box_px, v->scene.hidden_entity, &unused);
        visibility_first_hit(met, scene->visibility, rays, visibility_listed(w->near, seen, v->scene.hidden_entity),
                             &unused);
    }
    places->count = 0;
    for (int i = 0; i < count; i++) {
        if (met->entity[i] != (uint32_t)index + 1) continue;
        const int to = places->count++;
        of[to] = point[i];
        w->key[to] = spot_key(index, point[i]);
        places->entity[to] = met->entity[i], places->part[to] = met->part[i];
        for (int c = 0; c < 3; c++) {
            places->p_enu[c][to] = met->p_enu[c][i];
            places->n_geo[c][to] = places->n_enu[c][to] = met->n_geo[c][i];
        }
        sky_box_grow(box, places, to);
    }
    if (places->count == 0) return;
    const int            listed = sky_list_near(w, v, box, paths_m, false);
    const HemisphereNear near = {.bands = v->scene.air_bands,
                                 .samples = grid_directions,
                                 .reach_m = look_m,
                                 .listed = listed,
                                 .list = w->near,
                                 .list_reach_m = w->near_reach_m};
    hemisphere_change(w->change, scene, places, &near, w->key, w->notes, &unused);
    for (int k = 0; k < places->count; k++) {
        const double *centre_enu = visibility_posed(scene->visibility, index)->centre_enu;
        SkyAnswer     found;
        double        n_enu[3];
        for (int c = 0; c < 3; c++) {
            n_enu[c] = places->n_geo[c][k];
            e->spot.value[SPOT_NORMAL_X + c][of[k]] = (float)n_enu[c];
            e->spot.value[SPOT_X + c][of[k]] = (float)(places->p_enu[c][k] - centre_enu[c]);
        }
        sky_answer(&found, v, n_enu, &w->change[k]);
        memcpy(e->spot.factor[of[k]], found.factor, sizeof found.factor);
        for (int b = 0; b < AIR_BAND_COUNT; b++)
            e->spot.below[of[k]][b] =
                (float)hemisphere_below((double)w->change[k].below_w_m2[b], v->level_w_m2[b] / pi_rad, n_enu[2]);
        e->spot.value[SPOT_PART][of[k]] = places->part[k];
    }
}

void sky_visibility_task(const SkyVisibility *v, SkyWorker *w, int task)
{
    SkyEntity *e = &v->entity[v->task_entity[task]];
    ask_points(v, w, task);
    atomic_fetch_add_explicit(&e->taken, 1, memory_order_relaxed);
    atomic_fetch_add_explicit(&e->done, 1, memory_order_release);
}

/* Each thread takes tasks that no other has taken, then waits for those that others are at. A task itself waits for
 * nothing. */
static void complete(const SkyVisibility *v, SkyWorker *w, SkyEntity *e)
{
    if (atomic_load_explicit(&e->done, memory_order_acquire) == e->tasks) return;
    for (;;) {
        const int k = atomic_fetch_add_explicit(&e->taken, 1, memory_order_relaxed);
        if (k >= e->tasks) break;
        ask_points(v, w, e->first_task + k);
        atomic_fetch_add_explicit(&e->done, 1, memory_order_release);
    }
    while (atomic_load_explicit(&e->done, memory_order_acquire) < e->tasks) sched_yield();
}

void sky_entities_complete(const SkyVisibility *v, SkyWorker *w, const Hits *hits)
{
    uint32_t before = 0;
    for (int i = 0; i < hits->count; i++) {
        const uint32_t entity = hits->entity[i];
        if (entity == 0 || entity == before || !(hits->range_m[i] < INFINITY)) continue;
        const int of = v->grid_of[entity - 1];
        if (of > 0) complete(v, w, &v->entity[of - 1]);
        before = entity;
    }
}

/* Weighted sums over grid points, by AirBand. */
typedef struct SpotSums {
    F32x8 factor, below;
    float weight;
} SpotSums;

/* Sums of grid points of columns and rows from, to (exclusive), each `step` of the rows, weighted by similarity to a
 * hit: same part, same orientation, same plane, and near. Eight points of a row at a time. */
static SpotSums sum_spots(const SkyEntity *e, const int span[4], int step, const float p_m[3], const float n_enu[3],
                          uint16_t part)
{
    static const float  other_part = 0.05f;
    const float         pitch_m2 = (float)(e->pitch_m * e->pitch_m);
    const float *const *value = (const float *const *)e->spot.value;
    const F32x8         square_m2 = _mm256_set1_ps(pitch_m2), least_m2 = _mm256_set1_ps(0.1f * pitch_m2);
    const F32x8         zero = _mm256_setzero_ps(), of_part = _mm256_set1_ps(part);
    float               all = 0, each[8];
    F32x8               p[3], n[3], factor = zero, below = zero;
    for (int c = 0; c < 3; c++) p[c] = _mm256_set1_ps(p_m[c]), n[c] = _mm256_set1_ps(n_enu[c]);
    for (int row = span[1]; row < span[3]; row += step)
        for (int column = span[0]; column < span[2]; column += 8) {
            const int   at = row * e->columns + column;
            const int   lanes = span[2] - column < 8 ? span[2] - column : 8;
            const F32x8 along = n[0] * f32x8_load(value[SPOT_NORMAL_X] + at) +
                                n[1] * f32x8_load(value[SPOT_NORMAL_Y] + at) +
                                n[2] * f32x8_load(value[SPOT_NORMAL_Z] + at);
            const F32x8 x = f32x8_load(value[SPOT_X] + at) - p[0], y = f32x8_load(value[SPOT_Y] + at) - p[1];
            const F32x8 z = f32x8_load(value[SPOT_Z] + at) - p[2], off = n[0] * x + n[1] * y + n[2] * z;
            const F32x8 facing = _mm256_max_ps(along, zero), a2 = facing * facing, a4 = a2 * a2;
            const F32x8 same = _mm256_cmp_ps(f32x8_load(value[SPOT_PART] + at), of_part, _CMP_EQ_OQ);
            const F32x8 share = _mm256_blendv_ps(_mm256_set1_ps(other_part), _mm256_set1_ps(1), same);
            f32x8_store(each, share * a4 * a4 * square_m2 * square_m2 /
                                  ((least_m2 + x * x + y * y + z * z) * (square_m2 + 16 * off * off)));
            for (int k = 0; k < lanes; k++) {
                if (!(each[k] > 0)) continue; /* faces away, or is empty */
                all += each[k];
                factor += _mm256_set1_ps(each[k]) * f32x8_load(e->spot.factor[at + k]);
                below += _mm256_set1_ps(each[k]) * f32x8_load(e->spot.below[at + k]);
            }
        }
    return (SpotSums){factor, below, all};
}

static void span_about(int span[4], const SkyEntity *e, int column, int row, int more)
{
    span[0] = column > more ? column - more : 0, span[1] = row > more ? row - more : 0;
    span[2] = column + more + 1 < e->columns ? column + more + 1 : e->columns;
    span[3] = row + more + 1 < e->rows ? row + more + 1 : e->rows;
}

static void place_on_grid(double at[2], const SkyEntity *e, const SkyVisibility *v, const double p_enu[3])
{
    const View *view = v->scene.view;
    double      offset_enu[3], p_cam[3];
    if (e->of_body) {
        v3_sub(offset_enu, p_enu, visibility_posed(v->scene.gather.visibility, e->index)->p_enu);
        for (int k = 0; k < 2; k++) at[k] = v3_dot(offset_enu, e->across_enu[k]);
        return;
    }
    v3_sub(offset_enu, p_enu, view->p_enu);
    offset_enu[2] += visibility_lift(v->scene.gather.visibility, e->index);
    m3_tmul_v3(p_cam, view->r_enu_from_cam, offset_enu);
    view_project(at, view, p_cam);
}

void sky_entities_open(SkyOpen *out, int i, const SkyVisibility *v, const Hits *hits)
{
    static const float enough = 0.3f; /* one point of the part two steps away */
    const int          index = (int)hits->entity[i] - 1;
    if (v->grid_of[index] == 0) return;
    const SkyEntity *e = &v->entity[v->grid_of[index] - 1];
    const double    *centre_enu = visibility_posed(v->scene.gather.visibility, index)->centre_enu;
    const float      n_enu[3] = {hits->n_geo[0][i], hits->n_geo[1][i], hits->n_geo[2][i]};
    double           at[2];
    float            p_m[3], factor[8], below[8];
    int              span[4];
    if (e->columns == 0) return;
    const double p_enu[3] = {hits->p_enu[0][i], hits->p_enu[1][i], hits->p_enu[2][i]};
    for (int c = 0; c < 3; c++) p_m[c] = (float)(p_enu[c] - centre_enu[c]);
    place_on_grid(at, e, v, p_enu);
    const int column = (int)clamp(floor((at[0] - e->low[0]) / e->step[0]), 0, e->columns - 1);
    const int row = (int)clamp(floor((at[1] - e->low[1]) / e->step[1]), 0, e->rows - 1);
    SpotSums  sum = {.weight = 0};
    for (int more = 1; more <= 4 && !(sum.weight > enough); more += 3) {
        span_about(span, e, column, row, more);
        sum = sum_spots(e, span, 1, p_m, n_enu, hits->part[i]);
    }
    if (!(sum.weight > 1e-4f)) { /* no similar point was found nearby */
        span_about(span, e, 0, 0, grid_most);
        sum = sum_spots(e, span, e->rows > 16 ? 3 : 1, p_m, n_enu, hits->part[i]);
    }
    if (!(sum.weight > 1e-12f)) return;
    const F32x8 per = f32x8_set(1 / (double)sum.weight);
    f32x8_store(factor, sum.factor * per), f32x8_store(below, sum.below * per);
    for (int b = 0; b < AIR_BAND_COUNT && !out->any_below; b++)
        for (int k = 0; k < hits->count && v->scene.air_bands >> b & 1; k++) out->below[b][k] = 1;
    out->any_below = true;
    for (int b = 0; b < AIR_BAND_COUNT; b++)
        if (v->scene.air_bands >> b & 1) out->factor[b][i] = factor[b], out->below[b][i] = below[b];
}
