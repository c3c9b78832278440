/* render/light/sky_visibility.c: see sky_visibility.h. Places of a hit, rounds of refinement, and what is kept. */
#include "render/light/sky_visibility.h"

#include "render/light/optical.h"
#include "render/parts/parts.h"
#include "pitviper_simd.h"

#include <stdatomic.h>

enum {
    ground_directions = 32, grid_directions = 28, /* a place */
    kept_slots    = 1 << 15,   /* places on the ground, of the frame */
    kept_probes   = 16,
    known_slots   = 1 << 15,   /* of a block: more than 1024 hits x 4 places x 4 levels */
    finer_most    = 3,         /* times that a cell of the ground is halved */
    lattice_steps = 4,         /* the ground's finest lattice: 2^-4 m */
    coarsest_log2_m = 4,
    grid_least = 3, grid_most = 48, /* places over an entity's box, a side */
    task_places = 32,
};
static const double look_m = 50;          /* what is farther from a place changes nothing there */
static const double hidden_share = 0.02;  /* of a level plane's light: less is left out */
static const double fade_share = 0.3;     /* the reach ends over its last 30 % */
static const double differ = 0.15;        /* shares of directions: places that differ more are looked at more finely */
static const double cell_reach = 0.45; /* coarsest cells, of the reach */
static const double grid_px = 2.75, lattice_px = 3.5;

/* What a place answered. */
typedef struct SkyAnswer {
    float factor[8]; /* by AirBand, and one to spare */
    float blocked, sunlit, inside; /* as GatherChange; inside 1: nor is it there */
} SkyAnswer;

/* Places on an entity, in columns; where nothing of it was met the normal is 0. */
enum { SPOT_X, SPOT_Y, SPOT_Z, SPOT_NORMAL_X, SPOT_NORMAL_Y, SPOT_NORMAL_Z, SPOT_PART, spot_values };
typedef struct SkySpots {
    float *value[spot_values]; /* m, ENU, from the entity's centre; and which part */
    float (*factor)[8];        /* by AirBand, and one to spare */
} SkySpots;

/* An entity of the frame. */
typedef struct SkyEntity {
    int      index;          /* in the snapshot */
    int      columns, rows;  /* of its grid; 0: not on the image */
    double   x0_px, y0_px, step_px[2];
    double   pitch_m;        /* of the grid at its distance */
    SkySpots spot;           /* [rows * columns], and eight more */
} SkyEntity;

struct SkyVisibility {
    SkyVisibilityScene scene;
    int                count, on_image;
    int               *grid_of;   /* [entities]: index into entity + 1 of those on the image; 0: of none */
    SkyEntity         *entity;    /* [on_image] */
    double             cells_per_m[coarsest_log2_m + lattice_steps + 1]; /* by step */
    int               *task_entity, *task_first; /* [tasks] */
    int                tasks;
    double             px_rad;
    double             level_w_m2[AIR_BAND_COUNT]; /* of open, level ground */
    _Atomic uint64_t  *kept_key;  /* [kept_slots]; 0: free */
    _Atomic uint8_t   *kept_done; /* [kept_slots]: 1: the place may be read */
    SkyAnswer         *kept;
};

/* ---- the frame -------------------------------------------------------------------------------- */

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

/* The grid over what of the box lies on the image. */
static Status plan_grid(SkyEntity *e, const SkyVisibility *v, const PosedEntity *posed, const double box_px[4],
                        Arena *arena)
{
    const View  *view = v->scene.view;
    const double x0 = fmax(box_px[0], 0), x1 = fmin(box_px[2], view->width);
    const double y0 = fmax(box_px[1], 0), y1 = fmin(box_px[3], view->height);
    double       offset_enu[3];
    if (!(x1 > x0 && y1 > y0)) return STATUS_OK;
    v3_sub(offset_enu, posed->centre_enu, view->p_enu);
    e->columns = (int)clamp(ceil((x1 - x0) / grid_px), grid_least, grid_most);
    e->rows    = (int)clamp(ceil((y1 - y0) / grid_px), grid_least, grid_most);
    e->x0_px = x0, e->y0_px = y0;
    e->step_px[0] = (x1 - x0) / e->columns, e->step_px[1] = (y1 - y0) / e->rows;
    e->pitch_m = fmax(v3_length(offset_enu), 1) * v->px_rad * fmax(e->step_px[0], e->step_px[1]);
    const size_t spots = (size_t)(e->columns * e->rows) + 8;
    bool         got = (e->spot.factor = arena_alloc(arena, spots, sizeof *e->spot.factor)) != NULL;
    for (int k = 0; k < spot_values; k++)
        got = (e->spot.value[k] = arena_alloc(arena, spots, sizeof *e->spot.value[k])) != NULL && got;
    return got ? STATUS_OK : STATUS_NO_MEMORY;
}

static Status plan_tasks(SkyVisibility *v, Arena *arena)
{
    int count = 0;
    for (int k = 0; k < v->on_image; k++)
        count += (v->entity[k].columns * v->entity[k].rows + task_places - 1) / task_places;
    v->task_entity = arena_alloc(arena, (size_t)count + 1, sizeof *v->task_entity);
    v->task_first  = arena_alloc(arena, (size_t)count + 1, sizeof *v->task_first);
    if (!v->task_entity || !v->task_first) return STATUS_NO_MEMORY;
    for (int k = 0; k < v->on_image; k++)
        for (int first = 0; first < v->entity[k].columns * v->entity[k].rows; first += task_places) {
            v->task_entity[v->tasks]  = k;
            v->task_first[v->tasks++] = first;
        }
    return STATUS_OK;
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
    v->kept_key  = arena_alloc(arena, kept_slots, sizeof *v->kept_key);
    v->kept_done = arena_alloc(arena, kept_slots, sizeof *v->kept_done);
    v->kept      = arena_alloc(arena, kept_slots, sizeof *v->kept);
    if (!v->entity || !v->kept_key || !v->kept_done || !v->kept) return STATUS_NO_MEMORY;
    for (int k = 0, at = 0; k < v->count; k++) {
        if (isnan(scene->box_px[k][0])) continue;
        const PosedEntity *posed = visibility_posed(scene->gather.visibility, k);
        v->entity[at].index = k;
        v->grid_of[k] = at + 1;
        if (posed->model >= 0 && plan_grid(&v->entity[at], v, posed, scene->box_px[k], arena) != STATUS_OK)
            return STATUS_NO_MEMORY;
        at++;
    }
    for (int b = 0; b < AIR_BAND_COUNT; b++)
        v->level_w_m2[b] = b >= AIR_MWIR ? scene->gather.air->light.ground_w_m2_sr[b] * pi_rad
                                         : optical_ground_w_m2(b, scene->gather.air, scene->gather.materials);
    *out = v;
    return plan_tasks(v, arena);
}

/* ---- names of places ------------------------------------------------------------------------------ */

/* Ground: 1, then 31 bits of each place on the lattice. Entities: 2, the entity, the spot of its grid. */
static uint64_t ground_key(int64_t i, int64_t j)
{
    return (uint64_t)1 << 62 | ((uint64_t)i & 0x7fffffff) << 31 | ((uint64_t)j & 0x7fffffff);
}

static uint64_t spot_key(int entity, int spot)
{
    return (uint64_t)2 << 62 | (uint64_t)entity << 20 | (uint64_t)spot;
}

static double lattice_m(uint64_t bits)
{
    const int64_t at = (int64_t)(bits & 0x7fffffff);
    return ldexp((double)(at >= 1 << 30 ? at - ((int64_t)1 << 31) : at), -lattice_steps);
}

/* ---- a thread's block ------------------------------------------------------------------------------- */

typedef struct SkySlot {
    uint64_t key;
    uint32_t block;  /* in which it was written: others are free */
    bool     known;
    SkyAnswer place;
} SkySlot;

/* A hit on the ground near an entity. */
typedef struct SkyHit {
    int8_t step, last_step; /* log2 of the cell, m: from the first down to the last */
    bool   force;           /* close to a body: looked at finely whatever the places say */
    float  weight;          /* 0: none near */
} SkyHit;

/* The cell that was asked last of each size: neighbouring hits lie in it. */
typedef struct SkyCell {
    int64_t  column, row;
    uint32_t block;
    bool     known, differ, any_inside; /* all corners; they do; of those */
    const SkySlot *corner[4];
} SkyCell;

/* At which step hits of a finest cell ended. */
typedef struct SkyEnd {
    double   column, row;
    uint32_t block;
    int8_t   from, last, step;
    bool     force;
} SkyEnd;

struct SkyWorker {
    SkyEnd       end;
    SkyCell      cell[coarsest_log2_m + lattice_steps + 1];
    SkySlot      slot[known_slots];
    uint32_t     block;
    int          queue[known_slots], queued; /* slots to be asked */
    SkyHit       hit[hits_capacity];
    Hits         places, met;
    Rays         rays;
    uint64_t     key[hits_capacity];
    GatherChange change[hits_capacity];
    int         *near;       /* [entities] */
    double      *near_reach_m; /* of each: from its box the ground is looked at */
    int8_t      *near_step;  /* of each: first_step_of */
};

Status sky_worker_create(SkyWorker **out, const SkyVisibility *v, Arena *arena)
{
    SkyWorker *w = *out = arena_alloc(arena, 1, sizeof *w);
    if (!w) return STATUS_NO_MEMORY;
    w->near = arena_alloc(arena, (size_t)v->count + 1, sizeof *w->near);
    w->near_reach_m = arena_alloc(arena, (size_t)v->count + 1, sizeof *w->near_reach_m);
    w->near_step    = arena_alloc(arena, (size_t)v->count + 1, sizeof *w->near_step);
    return w->near && w->near_reach_m && w->near_step ? STATUS_OK : STATUS_NO_MEMORY;
}

static uint64_t scramble(uint64_t key)
{
    key = (key ^ key >> 31) * 0x9e3779b97f4a7c15u;
    return key ^ key >> 29;
}

static bool find_kept(SkyAnswer *out, const SkyVisibility *v, uint64_t key)
{
    if (!skips(v->scene.skips_off, SKIP_LIGHT)) return false;
    for (uint64_t n = 0, at = scramble(key); n < kept_probes; n++, at++) {
        const size_t   k = at & (kept_slots - 1);
        const uint64_t there = atomic_load_explicit(&v->kept_key[k], memory_order_relaxed);
        if (there == 0) return false;
        if (there != key) continue;
        if (!atomic_load_explicit(&v->kept_done[k], memory_order_acquire)) return false;
        *out = v->kept[k];
        return true;
    }
    return false;
}

/* The first thread to come writes; all would write the same. */
static void keep(const SkyVisibility *v, uint64_t key, const SkyAnswer *place)
{
    if (!skips(v->scene.skips_off, SKIP_LIGHT)) return;
    for (uint64_t n = 0, at = scramble(key); n < kept_probes; n++, at++) {
        const size_t k = at & (kept_slots - 1);
        uint64_t     there = 0;
        if (atomic_compare_exchange_strong_explicit(&v->kept_key[k], &there, key, memory_order_relaxed,
                                                    memory_order_relaxed)) {
            v->kept[k] = *place;
            atomic_store_explicit(&v->kept_done[k], 1, memory_order_release);
            return;
        }
        if (there == key) return;
    }
}

/* The slot of a place: known, or queued to be asked. */
static const SkySlot *slot_of(SkyWorker *w, const SkyVisibility *v, uint64_t key)
{
    for (uint64_t at = scramble(key);; at++) {
        SkySlot *s = &w->slot[at & (known_slots - 1)];
        if (s->block == w->block && s->key == key) return s;
        if (s->block == w->block) continue;
        s->block = w->block;
        s->key   = key;
        s->known = find_kept(&s->place, v, key);
        if (!s->known) w->queue[w->queued++] = (int)(at & (known_slots - 1));
        return s;
    }
}

/* ---- asking ------------------------------------------------------------------------------------------ */

static void place_ground(Hits *to, int i, const SkyVisibility *v, uint64_t key)
{
    double n_enu[3];
    to->entity[i]  = 0;
    to->p_enu[0][i] = lattice_m(key >> 31);
    to->p_enu[1][i] = lattice_m(key);
    to->p_enu[2][i] = elevation_height(&v->scene.landscape->elevation, to->p_enu[0][i], to->p_enu[1][i], n_enu);
    for (int c = 0; c < 3; c++) to->n_geo[c][i] = to->n_enu[c][i] = (float)n_enu[c];
}

static void answer(SkyAnswer *out, const SkyVisibility *v, const double n_enu[3], const GatherChange *change)
{
    *out = (SkyAnswer){.blocked = change->blocked, .sunlit = change->sunlit, .inside = change->inside};
    for (int b = 0; b < AIR_BAND_COUNT; b++) {
        out->factor[b] = 1;
        if (!(v->scene.air_bands >> b & 1)) continue;
        const double open_w_m2 = daylight_on_plane(&v->scene.gather.air->light, (AirBand)b, n_enu) +
                                 v->level_w_m2[b] * 0.5 * (1 - n_enu[2]);
        if (open_w_m2 > 0) out->factor[b] = (float)clamp(1 + (double)change->w_m2[b] / open_w_m2, 0, 100);
    }
}

static void ask_ground(SkyWorker *w, const SkyVisibility *v, const int *slots, int count, const int *list, int listed)
{
    VisibilityCounters unused = {0}; /* which thread asks first is chance */
    Hits              *places = &w->places;
    places->count = count;
    for (int i = 0; i < count; i++) {
        w->key[i] = w->slot[slots[i]].key;
        place_ground(places, i, v, w->key[i]);
    }
    gather_change(w->change, &v->scene.gather, places, v->scene.air_bands, ground_directions, look_m,
                  w->near_reach_m, w->key, list, listed, &unused);
    for (int i = 0; i < count; i++) {
        SkySlot     *s = &w->slot[slots[i]];
        const double n_enu[3] = {places->n_enu[0][i], places->n_enu[1][i], places->n_enu[2][i]};
        answer(&s->place, v, n_enu, &w->change[i]);
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
            low[c]  = fminf(low[c], share[c]);
            high[c] = fmaxf(high[c], share[c]);
        }
    }
    return high[0] - low[0] > (float)differ || high[1] - low[1] > (float)differ || high[2] > low[2];
}

/* The cell about a hit and the weights of its corners, some of which may not be known yet. */
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

/* In floats, eight bands at a time: factors are no better. Places within a body say nothing about those beside it. */
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

/* True: done. All hits of one of the finest cells that start alike end alike: the last such is remembered. */
static bool settle(SkyOpen *out, int i, const SkyVisibility *v, SkyWorker *w, const Hits *hits)
{
    SkyHit       *h = &w->hit[i];
    const double  per_m = v->cells_per_m[h->last_step + lattice_steps];
    const SkyEnd  like = {.column = floor(hits->p_enu[0][i] * per_m), .row = floor(hits->p_enu[1][i] * per_m),
                          .block = w->block, .from = h->step, .last = h->last_step, .force = h->force};
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
        body_m    = fmin(body_m, distance_m);
    }
    if (!(h->weight > 0)) return;
    int          shown; /* log2 of what the picture shows, rounded */
    const double half = frexp(lattice_px * hits->range_m[i] * v->px_rad, &shown);
    if (half <= 0.70710678118654752) shown--;
    h->last_step = (int8_t)clamp(fmax(shown, h->step - finer_most), -lattice_steps, coarsest_log2_m);
    h->force = body_m * v->cells_per_m[h->step + lattice_steps] < 1;
    if (h->last_step > h->step) h->step = h->last_step;
}

static void grow(double box[2][3], const Hits *hits, int i)
{
    for (int c = 0; c < 3; c++) {
        const double at = hits->p_enu[c][i];
        box[0][c] = at < box[0][c] ? at : box[0][c];
        box[1][c] = at > box[1][c] ? at : box[1][c];
    }
}

/* Entities whose spheres, grown by more_m (and their reach), touch the box, to w->near and what goes with it. */
static int list_near(SkyWorker *w, const SkyVisibility *v, double box[2][3], double more_m, bool with_reach)
{
    int       count = 0;
    const int asked = visibility_near(w->near, v->scene.gather.visibility, box[0], box[1],
                                      more_m + (with_reach ? look_m : 0)); /* no reach is longer */
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
        w->near_step[count]    = first_step_of(reach_m);
        w->near[count++] = k;
    }
    return count;
}

/* ---- entities -------------------------------------------------------------------------------------------- */

int sky_visibility_tasks(const SkyVisibility *v) { return v->tasks; }

/* What the eye sees of the entity on some of its grid, and what light comes there. */
void sky_visibility_task(SkyVisibility *v, SkyWorker *w, int task)
{
    const SkyEntity    *e = &v->entity[v->task_entity[task]];
    const int           index = e->index, first = v->task_first[task];
    const View         *view = v->scene.view;
    const int           all = e->columns * e->rows, count = all - first < task_places ? all - first : task_places;
    const GatherScene  *scene = &v->scene.gather;
    VisibilityCounters  unused = {0};
    Rays               *rays = &w->rays;
    Hits               *met = &w->met, *places = &w->places;
    int                 of[task_places];
    double              box[2][3] = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    for (int i = 0; i < count; i++) {
        double d_enu[3];
        view_ray(d_enu, view, e->x0_px + e->step_px[0] * ((first + i) % e->columns + 0.5),
                 e->y0_px + e->step_px[1] * ((first + i) / e->columns + 0.5));
        for (int c = 0; c < 3; c++) rays->o_enu[c][i] = view->p_enu[c], rays->d_enu[c][i] = d_enu[c];
        rays->far_m[i] = INFINITY;
    }
    rays->count = count, rays->columns = 0;
    /* those that the rows of these places may see: in a crowd a fraction of all */
    const double y_px = e->y0_px + e->step_px[1] * (first / e->columns),
                 end_px = e->y0_px + e->step_px[1] * ((first + count - 1) / e->columns + 1);
    const int    seen = visibility_block_entities(w->near, scene->visibility, view, e->x0_px, y_px,
                                                  e->x0_px + e->step_px[0] * e->columns, end_px, v->scene.hidden_entity,
                                                  &unused);
    visibility_first_hit(met, scene->visibility, rays, w->near, seen, v->scene.hidden_entity, &unused);
    places->count = 0;
    for (int i = 0; i < count; i++) {
        if (met->entity[i] != (uint32_t)index + 1) continue;
        const int to = places->count++;
        of[to] = first + i;
        w->key[to] = spot_key(index, first + i);
        places->entity[to] = met->entity[i], places->part[to] = met->part[i];
        for (int c = 0; c < 3; c++) {
            places->p_enu[c][to] = met->p_enu[c][i];
            places->n_geo[c][to] = places->n_enu[c][to] = met->n_geo[c][i];
        }
        grow(box, places, to);
    }
    if (places->count == 0) return;
    const int listed = list_near(w, v, box, look_m, false);
    gather_change(w->change, scene, places, v->scene.air_bands, grid_directions, look_m, w->near_reach_m, w->key, w->near,
                  listed, &unused);
    for (int k = 0; k < places->count; k++) {
        const double *centre_enu = visibility_posed(scene->visibility, index)->centre_enu;
        SkyAnswer     found;
        double        n_enu[3];
        for (int c = 0; c < 3; c++) {
            n_enu[c] = places->n_geo[c][k];
            e->spot.value[SPOT_NORMAL_X + c][of[k]] = (float)n_enu[c];
            e->spot.value[SPOT_X + c][of[k]] = (float)(places->p_enu[c][k] - centre_enu[c]);
        }
        answer(&found, v, n_enu, &w->change[k]);
        memcpy(e->spot.factor[of[k]], found.factor, sizeof found.factor);
        e->spot.value[SPOT_PART][of[k]] = places->part[k];
    }
}

/* Adds spots of columns and rows from, to (not beyond), each `step` of the rows, by how alike they are to a hit: of its
 * part, facing its way, in its plane, and near. Returns the sum of weights. Eight spots of a row at a time. */
static float add_spots(F32x8 *sum, const SkyEntity *e, const int span[4], int step, const float p_m[3],
                       const float n_enu[3], uint16_t part)
{
    static const float    other_part = 0.05f;
    const float           pitch_m2 = (float)(e->pitch_m * e->pitch_m);
    const float *const   *value = (const float *const *)e->spot.value;
    const F32x8           square_m2 = _mm256_set1_ps(pitch_m2), least_m2 = _mm256_set1_ps(0.1f * pitch_m2);
    const F32x8           zero = _mm256_setzero_ps(), of_part = _mm256_set1_ps(part);
    float                 all = 0, each[8];
    F32x8                 p[3], n[3];
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
                if (!(each[k] > 0)) continue; /* faces away, or is not there */
                all += each[k];
                *sum += _mm256_set1_ps(each[k]) * f32x8_load(e->spot.factor[at + k]);
            }
        }
    return all;
}

static void span_about(int span[4], const SkyEntity *e, int column, int row, int more)
{
    span[0] = column > more ? column - more : 0, span[1] = row > more ? row - more : 0;
    span[2] = column + more + 1 < e->columns ? column + more + 1 : e->columns;
    span[3] = row + more + 1 < e->rows ? row + more + 1 : e->rows;
}

static void open_on_entity(SkyOpen *out, int i, const SkyVisibility *v, const Hits *hits)
{
    static const float enough = 0.3f; /* one spot of the part two steps away */
    const int          index = (int)hits->entity[i] - 1;
    if (v->grid_of[index] == 0) return;
    const SkyEntity   *e = &v->entity[v->grid_of[index] - 1];
    const View        *view = v->scene.view;
    const double      *centre_enu = visibility_posed(v->scene.gather.visibility, index)->centre_enu;
    const float        n_enu[3] = {hits->n_geo[0][i], hits->n_geo[1][i], hits->n_geo[2][i]};
    double             offset_enu[3], p_cam[3], image_px[2];
    float              p_m[3], factor[8];
    int                span[4];
    if (e->columns == 0) return;
    for (int c = 0; c < 3; c++) {
        offset_enu[c] = hits->p_enu[c][i] - view->p_enu[c];
        p_m[c] = (float)(hits->p_enu[c][i] - centre_enu[c]);
    }
    m3_tmul_v3(p_cam, view->r_enu_from_cam, offset_enu);
    view_project(image_px, view, p_cam);
    const int    column = (int)clamp(floor((image_px[0] - e->x0_px) / e->step_px[0]), 0, e->columns - 1);
    const int    row = (int)clamp(floor((image_px[1] - e->y0_px) / e->step_px[1]), 0, e->rows - 1);
    F32x8        sum = f32x8_set(0);
    float        all = 0;
    for (int more = 1; more <= 4 && !(all > enough); more += 3) {
        span_about(span, e, column, row, more);
        sum = f32x8_set(0);
        all = add_spots(&sum, e, span, 1, p_m, n_enu, hits->part[i]);
    }
    if (!(all > 1e-4f)) { /* the like of it was met nowhere near */
        span_about(span, e, 0, 0, grid_most);
        sum = f32x8_set(0);
        all = add_spots(&sum, e, span, e->rows > 16 ? 3 : 1, p_m, n_enu, hits->part[i]);
    }
    if (!(all > 1e-12f)) return;
    f32x8_store(factor, sum * f32x8_set(1 / (double)all));
    for (int b = 0; b < AIR_BAND_COUNT; b++)
        if (v->scene.air_bands >> b & 1) out->factor[b][i] = factor[b];
}

/* ---- a block --------------------------------------------------------------------------------------------- */

bool sky_visibility_open(SkyOpen *out, const SkyVisibility *v, SkyWorker *w, const Hits *hits,
                         VisibilityCounters *counters)
{
    double box[2][3] = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    double near_box[2][3];
    int    undone[hits_capacity], left = 0;
    memcpy(near_box, box, sizeof box);
    for (int i = 0; i < hits->count; i++)
        if (hits->range_m[i] < INFINITY) grow(box, hits, i);
    int near_count = list_near(w, v, box, 0, true);
    if (near_count == 0) return false;

    for (int b = 0; b < AIR_BAND_COUNT; b++)
        if (v->scene.air_bands >> b & 1)
            for (int i = 0; i < hits->count; i++) out->factor[b][i] = 1;
    for (int i = 0; i < hits->count; i++) {
        if (!(hits->range_m[i] < INFINITY)) continue;
        if (hits->entity[i]) open_on_entity(out, i, v, hits);
        if (hits->entity[i] || !v->scene.landscape) continue;
        find_ground(&w->hit[i], v, w, hits, i, near_count);
        if (!(w->hit[i].weight > 0)) continue;
        grow(near_box, hits, i);
        undone[left++] = i;
    }
    if (skips(v->scene.skips_off, SKIP_LIGHT)) counters->skipped[SKIP_LIGHT] += (uint64_t)left;
    /* a corner lies within a cell of its hit */
    near_count = list_near(w, v, near_box, look_m + 32, false);

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
