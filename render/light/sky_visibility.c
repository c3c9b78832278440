/* render/light/sky_visibility.c: sample points on the ground about a hit, their refinement, and the cache that keeps
 * them (sky_visibility.h). */
#include "render/light/sky_visibility_private.h"

#include "render/light/optical.h"
#include "render/trace/scenery/scenery_tracer.h"
#include "pitviper_simd.h"

enum {
    ground_directions = 32, /* a place */
    cached_slots = 1 << 15, /* places on the ground, of the frame */
    cached_probes = 16,
    finer_most = 3, /* number of halvings of a ground cell */
};
static const double hidden_share = 0.02; /* of a level plane's light: smaller effects are left out */
static const double fade_share = 0.3;    /* the reach ends over its last 30 % */
static const double differ = 0.15;       /* shares of directions: where points differ more the grid is refined */
static const double cell_reach = 0.45;   /* coarsest cells, of the reach */
static const double lattice_px = 3.5;

/* ---- of a frame ------------------------------------------------------------------------------- */

/* A wall of width w and height h hides w h^2 / (4 pi d^3) of the sky from level ground at a distance d. */
static double reach_of(const PosedEntity *e)
{
    double side_m[3];
    for (int c = 0; c < 3; c++) side_m[c] = fmax(e->box_high[c] - e->box_low[c], 0);
    const double width_m = hypot(side_m[0], side_m[1]), height_m = side_m[2];
    return fmin(cbrt(width_m * height_m * height_m / (4 * pi_rad * hidden_share)), look_m - 10);
}

/* log2 of the coarsest cells about an entity of this reach, m. */
static int8_t first_step_of(double reach_m)
{
    return (int8_t)clamp(floor(log2(fmax(cell_reach * reach_m, 1e-9))), -lattice_steps, coarsest_log2_m);
}

Status sky_visibility_create(SkyVisibility **out, const SkyVisibilityScene *scene, Arena *arena)
{
    SkyVisibility *v = arena_alloc(arena, 1, sizeof *v);
    if (!v) return STATUS_NO_MEMORY;
    *v = (SkyVisibility){.scene = *scene, .count = visibility_count(scene->gather.visibility)};
    v->px_rad = 1 / scene->view->focal_px;
    v->grid_of = arena_alloc(arena, (size_t)v->count + 1, sizeof *v->grid_of);
    if (!v->grid_of) return STATUS_NO_MEMORY;
    for (int k = 0; k < v->count; k++) v->on_image += !isnan(scene->box_px[k][0]);
    v->entity = arena_alloc(arena, (size_t)v->on_image + 1, sizeof *v->entity);
    for (int k = 0; k <= coarsest_log2_m + lattice_steps; k++) v->cells_per_m[k] = ldexp(1, lattice_steps - k);
    v->cached_key = arena_alloc(arena, cached_slots, sizeof *v->cached_key);
    v->cached_done = arena_alloc(arena, cached_slots, sizeof *v->cached_done);
    v->kept = arena_alloc_raw(arena, cached_slots, sizeof *v->kept);
    if (!v->entity || !v->cached_key || !v->cached_done || !v->kept) return STATUS_NO_MEMORY;
    for (int k = 0, at = 0; k < v->count; k++) {
        if (isnan(scene->box_px[k][0])) continue;
        const PosedEntity *posed = visibility_posed(scene->gather.visibility, k);
        v->entity[at].index = k;
        v->grid_of[k] = at + 1;
        if (posed->model >= 0 && sky_entities_grid(&v->entity[at], v, posed, scene->box_px[k], arena) != STATUS_OK)
            return STATUS_NO_MEMORY;
        at++;
    }
    for (int b = 0; b < AIR_BAND_COUNT; b++)
        v->level_w_m2[b] = b >= AIR_MWIR ? scene->gather.air->light.ground_w_m2_sr[b] * pi_rad
                                         : optical_ground_w_m2(b, scene->gather.air, scene->gather.materials);
    const SceneryFrame *scenery = scenery_frame_in(scene->gather.visibility);
    Status              status = sky_entities_tasks(v, arena);
    if (status == STATUS_OK && skips(scene->skips_off, SKIP_KEPT))
        status = sky_kept_begin(&v->keeper, scene->kept, scene->gather.visibility,
                                (uint64_t)(uintptr_t)scene->landscape ^ scenery_frame_hash(scenery), arena);
    if (status == STATUS_OK) *out = v;
    return status;
}

void sky_visibility_close(SkyVisibility *v, VisibilityCounters *counters)
{
    if (v) counters->skipped[SKIP_KEPT] += sky_kept_end(v->keeper);
}

/* ---- keys of sample points ------------------------------------------------------------------------ */

/* Ground: 1, then 31 bits of each coordinate on the lattice. Entities have 2 there: sky_entities.c. */
static uint64_t ground_key(int64_t i, int64_t j)
{
    return (uint64_t)1 << 62 | ((uint64_t)i & 0x7fffffff) << 31 | ((uint64_t)j & 0x7fffffff);
}

static double lattice_m(uint64_t bits)
{
    const int64_t at = (int64_t)(bits & 0x7fffffff);
    return ldexp((double)(at >= 1 << 30 ? at - ((int64_t)1 << 31) : at), -lattice_steps);
}

/* ---- of a block, in a thread ------------------------------------------------------------------------ */

Status sky_worker_create(SkyWorker **out, const SkyVisibility *v, Arena *arena)
{
    SkyWorker *w = *out = arena_alloc(arena, 1, sizeof *w);
    if (!w) return STATUS_NO_MEMORY;
    w->slot = arena_alloc_raw(arena, known_slots, sizeof *w->slot);
    w->slot_block = arena_alloc(arena, known_slots, sizeof *w->slot_block);
    w->near = arena_alloc(arena, (size_t)v->count + 1, sizeof *w->near);
    w->near_reach_m = arena_alloc(arena, (size_t)v->count + 1, sizeof *w->near_reach_m);
    w->near_step = arena_alloc(arena, (size_t)v->count + 1, sizeof *w->near_step);
    if (!w->slot || !w->slot_block || !w->near || !w->near_reach_m || !w->near_step) return STATUS_NO_MEMORY;
    return v->keeper ? sky_notes_create(&w->notes, v->keeper, arena) : STATUS_OK;
}

static uint64_t scramble(uint64_t key)
{
    key = (key ^ key >> 31) * 0x9e3779b97f4a7c15u;
    return key ^ key >> 29;
}

static bool find_cached(SkyAnswer *out, const SkyVisibility *v, uint64_t key)
{
    if (!skips(v->scene.skips_off, SKIP_LIGHT)) return false;
    for (uint64_t n = 0, at = scramble(key); n < cached_probes; n++, at++) {
        const size_t   k = at & (cached_slots - 1);
        const uint64_t there = atomic_load_explicit(&v->cached_key[k], memory_order_relaxed);
        if (there == 0) return false;
        if (there != key) continue;
        if (!atomic_load_explicit(&v->cached_done[k], memory_order_acquire)) return false;
        *out = v->kept[k];
        return true;
    }
    return false;
}

/* The first thread writes; all would write the same. */
static void keep(const SkyVisibility *v, uint64_t key, const SkyAnswer *place)
{
    if (!skips(v->scene.skips_off, SKIP_LIGHT)) return;
    for (uint64_t n = 0, at = scramble(key); n < cached_probes; n++, at++) {
        const size_t k = at & (cached_slots - 1);
        uint64_t     there = 0;
        if (atomic_compare_exchange_strong_explicit(&v->cached_key[k], &there, key, memory_order_relaxed,
                                                    memory_order_relaxed)) {
            v->kept[k] = *place;
            atomic_store_explicit(&v->cached_done[k], 1, memory_order_release);
            return;
        }
        if (there == key) return;
    }
}

/* The cache slot of a point: known, or queued for evaluation. */
static const SkySlot *slot_of(SkyWorker *w, const SkyVisibility *v, uint64_t key)
{
    for (uint64_t at = scramble(key);; at++) {
        const size_t k = at & (known_slots - 1);
        SkySlot     *s = &w->slot[k];
        if (w->slot_block[k] == w->block && s->key == key) return s;
        if (w->slot_block[k] == w->block) continue;
        w->slot_block[k] = w->block;
        s->key = key;
        s->known = find_cached(&s->place, v, key);
        if (!s->known) w->queue[w->queued++] = (int)k;
        return s;
    }
}

/* ---- evaluation -------------------------------------------------------------------------------------- */

static void place_ground(Hits *to, int i, const SkyVisibility *v, uint64_t key)
{
    double n_enu[3];
    to->entity[i] = 0;
    to->p_enu[0][i] = lattice_m(key >> 31);
    to->p_enu[1][i] = lattice_m(key);
    to->p_enu[2][i] = elevation_height(&v->scene.landscape->elevation, to->p_enu[0][i], to->p_enu[1][i], n_enu);
    for (int c = 0; c < 3; c++) to->n_geo[c][i] = to->n_enu[c][i] = (float)n_enu[c];
}

void sky_answer(SkyAnswer *out, const SkyVisibility *v, const double n_enu[3], const HemisphereChange *change)
{
    *out = (SkyAnswer){.blocked = change->blocked, .sunlit = change->sunlit, .inside = change->inside};
    for (int b = 0; b < AIR_BAND_COUNT; b++) {
        out->factor[b] = 1;
        if (!(v->scene.air_bands >> b & 1)) continue;
        const double open_w_m2 =
            daylight_on_plane(&v->scene.gather.air->light, (AirBand)b, n_enu) + v->level_w_m2[b] * 0.5 * (1 - n_enu[2]);
        if (open_w_m2 > 0) out->factor[b] = (float)clamp(1 + (double)change->w_m2[b] / open_w_m2, 0, 100);
    }
}

static void ask_ground(SkyWorker *w, const SkyVisibility *v, const int *slots, int count, const int *list, int listed)
{
    VisibilityCounters unused = {0}; /* the order of threads varies; the result does not */
    Hits              *places = &w->places;
    places->count = count;
    for (int i = 0; i < count; i++) {
        w->key[i] = w->slot[slots[i]].key;
        place_ground(places, i, v, w->key[i]);
    }
    const HemisphereNear near = {.bands = v->scene.air_bands,
                                 .samples = ground_directions,
                                 .reach_m = look_m,
                                 .listed = listed,
                                 .list = list,
                                 .list_reach_m = w->near_reach_m};
    hemisphere_change(w->change, &v->scene.gather, places, &near, w->key, w->notes, &unused);
    for (int i = 0; i < count; i++) {
        SkySlot     *s = &w->slot[slots[i]];
        const double n_enu[3] = {places->n_enu[0][i], places->n_enu[1][i], places->n_enu[2][i]};
        sky_answer(&s->place, v, n_enu, &w->change[i]);
        s->known = true;
        keep(v, s->key, &s->place);
    }
}

/* ---- the ground about a hit ---------------------------------------------------------------------------- */

static bool places_differ(const SkySlot *const s[4])
{
    float low[3] = {1, 1, 1}, high[3] = {0, 0, 0};
    for (int k = 0; k < 4; k++) {
        const float share[3] = {s[k]->place.blocked, s[k]->place.sunlit, s[k]->place.inside > 0.5f};
        for (int c = 0; c < 3; c++) {
            low[c] = fminf(low[c], share[c]);
            high[c] = fmaxf(high[c], share[c]);
        }
    }
    return high[0] - low[0] > (float)differ || high[1] - low[1] > (float)differ || high[2] > low[2];
}

/* The cell about a hit and the weights of its corners, some of which may not be computed yet. */
static const SkyCell *cell_about(double weight[4], SkyWorker *w, const SkyVisibility *v, int step, const Hits *hits,
                                 int i)
{
    const double  per_m = v->cells_per_m[step + lattice_steps];
    const double  x = hits->p_enu[0][i] * per_m, y = hits->p_enu[1][i] * per_m;
    const double  left = floor(x), low = floor(y), fx = x - left, fy = y - low;
    const int64_t column = (int64_t)left, row = (int64_t)low, each = (int64_t)1 << (step + lattice_steps);
    SkyCell      *cell = &w->cell[step + lattice_steps];
    for (int k = 0; k < 4; k++) weight[k] = (k & 1 ? fx : 1 - fx) * (k >> 1 ? fy : 1 - fy);
    if (cell->block != w->block || cell->column != column || cell->row != row) {
        *cell = (SkyCell){.column = column, .row = row, .block = w->block};
        for (int k = 0; k < 4; k++)
            cell->corner[k] = slot_of(w, v, ground_key((column + (k & 1)) * each, (row + (k >> 1)) * each));
    }
    if (!cell->known) {
        cell->known = true;
        for (int k = 0; k < 4; k++) cell->known &= cell->corner[k]->known;
        cell->differ = cell->known && places_differ(cell->corner);
        for (int k = 0; k < 4; k++) cell->any_inside |= cell->known && cell->corner[k]->place.inside > 0.5f;
    }
    return cell;
}

/* In floats, eight bands at a time: the factors are no more accurate. Points inside a body are not used for those
 * beside it. */
static void mix(SkyOpen *out, int i, const SkyVisibility *v, const SkyHit *h, const SkyCell *cell,
                const double weight[4])
{
    F32x8  mean = f32x8_set(0);
    double sum = 1;
    float  factor[8];
    if (cell->any_inside) {
        sum = 0;
        for (int k = 0; k < 4; k++)
            if (cell->corner[k]->place.inside <= 0.5f) sum += weight[k];
    }
    const bool outside = cell->any_inside && sum > 1e-3;
    for (int k = 0; k < 4; k++)
        if (!outside || cell->corner[k]->place.inside <= 0.5f)
            mean += f32x8_set(outside ? weight[k] / sum : weight[k]) * f32x8_load(cell->corner[k]->place.factor);
    f32x8_store(factor, f32x8_set(1) + f32x8_set((double)h->weight) * (mean - f32x8_set(1)));
    for (int b = 0; b < AIR_BAND_COUNT; b++)
        if (v->scene.air_bands >> b & 1) out->factor[b][i] = factor[b];
}

/* True: done. All hits in one of the finest cells that start alike end alike: the last such is cached. */
static bool settle(SkyOpen *out, int i, const SkyVisibility *v, SkyWorker *w, const Hits *hits)
{
    SkyHit      *h = &w->hit[i];
    const double per_m = v->cells_per_m[h->last_step + lattice_steps];
    const SkyEnd like = {.column = floor(hits->p_enu[0][i] * per_m),
                         .row = floor(hits->p_enu[1][i] * per_m),
                         .block = w->block,
                         .from = h->step,
                         .last = h->last_step,
                         .force = h->force};
    if (like.block == w->end.block && like.column == w->end.column && like.row == w->end.row &&
        like.from == w->end.from && like.last == w->end.last && like.force == w->end.force)
        h->step = w->end.step, h->force = false;
    for (;;) {
        double         weight[4];
        const SkyCell *cell = cell_about(weight, w, v, h->step, hits, i);
        if (!cell->known) return false;
        if (h->step > h->last_step && (cell->differ || h->force)) {
            h->step--;
            h->force = false;
            continue;
        }
        mix(out, i, v, h, cell, weight);
        w->end = like, w->end.step = h->step;
        return true;
    }
}

static double box_distance_m(const PosedEntity *e, const double p_enu[3])
{
    double offset[3], p_body[3], square = 0;
    v3_sub(offset, p_enu, e->p_enu);
    m3_tmul_v3(p_body, e->r_enu_from_body, offset);
    for (int c = 0; c < 3; c++) {
        const double below = e->box_low[c] - p_body[c], above = p_body[c] - e->box_high[c];
        const double out = below > 0 ? below : above > 0 ? above : 0;
        square += out * out;
    }
    return sqrt(square);
}

static void find_ground(SkyHit *h, const SkyVisibility *v, const SkyWorker *w, const Hits *hits, int i, int count)
{
    const double p_enu[3] = {hits->p_enu[0][i], hits->p_enu[1][i], hits->p_enu[2][i]};
    double       offset[3], body_m = INFINITY;
    h->weight = 0;
    h->step = coarsest_log2_m;
    for (int k = 0; k < count; k++) {
        const PosedEntity *e = visibility_posed(v->scene.gather.visibility, w->near[k]);
        const double       reach_m = w->near_reach_m[k], far_m = reach_m + e->radius_m;
        v3_sub(offset, p_enu, e->centre_enu);
        if (!(v3_dot(offset, offset) < far_m * far_m)) continue;
        const double distance_m = box_distance_m(e, p_enu);
        const double weight = clamp((1 - distance_m / reach_m) / fade_share, 0, 1);
        if (!(weight > 0)) continue;
        h->weight = fmaxf(h->weight, (float)weight);
        if (w->near_step[k] < h->step) h->step = w->near_step[k];
        body_m = fmin(body_m, distance_m);
    }
    if (!(h->weight > 0)) return;
    int          shown; /* log2 of the picture's resolution there, rounded */
    const double half = frexp(lattice_px * hits->range_m[i] * v->px_rad, &shown);
    if (half <= 0.70710678118654752) shown--;
    h->last_step = (int8_t)clamp(fmax(shown, h->step - finer_most), -lattice_steps, coarsest_log2_m);
    h->force = body_m * v->cells_per_m[h->step + lattice_steps] < 1;
    if (h->last_step > h->step) h->step = h->last_step;
}

void sky_box_grow(double box[2][3], const Hits *hits, int i)
{
    for (int c = 0; c < 3; c++) {
        const double at = hits->p_enu[c][i];
        box[0][c] = at < box[0][c] ? at : box[0][c];
        box[1][c] = at > box[1][c] ? at : box[1][c];
    }
}

int sky_list_near(SkyWorker *w, const SkyVisibility *v, double box[2][3], double more_m, bool with_reach)
{
    int       count = 0;
    const int asked = visibility_near(w->near, v->scene.gather.visibility, box[0], box[1],
                                      more_m + (with_reach ? look_m : 0)); /* upper limit of the reach */
    for (int n = 0; n < asked; n++) {
        const int          k = w->near[n];
        const PosedEntity *e = visibility_posed(v->scene.gather.visibility, k);
        if (e->model < 0) continue;
        const double reach_m = reach_of(e), far_m = e->radius_m + more_m + (with_reach ? reach_m : 0);
        double       square = 0;
        for (int c = 0; c < 3; c++) {
            const double out = fmax(fmax(box[0][c] - e->centre_enu[c], e->centre_enu[c] - box[1][c]), 0);
            square += out * out;
        }
        if (!(square < far_m * far_m)) continue;
        w->near_reach_m[count] = reach_m;
        w->near_step[count] = first_step_of(reach_m);
        w->near[count++] = k;
    }
    return count;
}

/* ---- a block --------------------------------------------------------------------------------------------- */

bool sky_visibility_open(SkyOpen *out, const SkyVisibility *v, SkyWorker *w, const Hits *hits,
                         VisibilityCounters *counters)
{
    double box[2][3] = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    double near_box[2][3];
    int    undone[hits_capacity], left = 0;
    memcpy(near_box, box, sizeof box);
    sky_entities_complete(v, w, hits);
    for (int i = 0; i < hits->count; i++)
        if (hits->range_m[i] < INFINITY) sky_box_grow(box, hits, i);
    int near_count = sky_list_near(w, v, box, 0, true);
    if (near_count == 0) return false;
    out->any_below = false;

    for (int b = 0; b < AIR_BAND_COUNT; b++)
        if (v->scene.air_bands >> b & 1)
            for (int i = 0; i < hits->count; i++) out->factor[b][i] = 1;
    for (int i = 0; i < hits->count; i++) {
        if (!(hits->range_m[i] < INFINITY)) continue;
        if (hits->entity[i]) sky_entities_open(out, i, v, hits);
        if (hits->kind[i] != hit_ground || !v->scene.landscape) continue;
        find_ground(&w->hit[i], v, w, hits, i, near_count);
        if (!(w->hit[i].weight > 0)) continue;
        sky_box_grow(near_box, hits, i);
        undone[left++] = i;
    }
    if (skips(v->scene.skips_off, SKIP_LIGHT)) counters->skipped[SKIP_LIGHT] += (uint64_t)left;
    /* a corner lies within a cell of its hit */
    near_count = sky_list_near(w, v, near_box, paths_m + 32, false);

    w->block++;
    while (left > 0) {
        int still = 0;
        w->queued = 0;
        for (int k = 0; k < left; k++)
            if (!settle(out, undone[k], v, w, hits)) undone[still++] = undone[k];
        for (int first = 0; first < w->queued; first += hits_capacity)
            ask_ground(w, v, w->queue + first, w->queued - first < hits_capacity ? w->queued - first : hits_capacity,
                       w->near, near_count);
        left = still;
    }
    return true;
}
