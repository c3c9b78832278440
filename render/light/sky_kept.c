/* render/light/sky_kept.c: a table of sample points with what their paths met; see sky_visibility.h. */
#include "render/light/sky_visibility.h"

#include "render/trace/parts/parts.h"

#include <stdatomic.h>
#include <stdlib.h>

typedef struct SkyPoint SkyPoint;
struct SkyPoint {
    SkyPoint        *next; /* of a thread's list */
    uint64_t         key, stamp;
    double           p_enu[3], box[2][3]; /* of its rays */
    float            n_enu[3];
    int              samples, count;
    _Atomic uint32_t used;  /* number of the frame that used it last */
    SkyMet           met[]; /* [count], and one that ends them */
};

struct SkyKept {
    atomic_flag busy;
    uint32_t    frame;
    size_t      most_octets, octets, points;
    size_t      slots; /* a power of two, of which at most half are taken */
    SkyPoint  **slot;
    int         stood;    /* entities of the frame before */
    uint64_t   *stood_as; /* [stood]: their hashes; 0: not known */
};

struct SkyKeptFrame {
    SkyKept          *kept;
    const Visibility *visibility;
    uint64_t          world;
    int               count;
    _Atomic uint64_t *stamp; /* [count]: hash of an entity's pose; 0: not known yet */
    SkyNotes         *first; /* of its threads */
};

static const double near_miss_m = 1e-3; /* ample: near misses of 20 um may count as hits */

enum { notes_most = 1 << 13 }; /* meetings of all points that are traced together */

typedef struct Note {
    int    point;
    SkyMet met;
} Note;

struct SkyNotes {
    SkyNotes     *next;
    SkyKeptFrame *frame;
    SkyPoint     *made;          /* a list */
    int          *near, nears;   /* [entities]: list_near */
    int           points, count; /* count above notes_most: some were lost */
    Note          note[notes_most];
    int           met[hits_capacity + 1]; /* of each point: how many, then where they begin */
    double        box[hits_capacity][2][3];
};

/* ---- hashes ------------------------------------------------------------------------------------ */

static uint64_t stir(uint64_t h, uint64_t x)
{
    h = (h ^ x) * 0x9e3779b97f4a7c15u;
    return h ^ h >> 32;
}

static uint64_t stir_doubles(uint64_t h, const double *x, int count)
{
    for (int k = 0; k < count; k++) {
        uint64_t bits;
        memcpy(&bits, &x[k], sizeof bits);
        h = stir(h, bits);
    }
    return h;
}

/* Hash of an entity as it is posed, and of its place in the snapshot, never 0. Any thread finds the same. */
static uint64_t stamp_of(SkyKeptFrame *frame, int index)
{
    uint64_t h = atomic_load_explicit(&frame->stamp[index], memory_order_relaxed);
    if (h) return h;
    const PosedEntity *e = visibility_posed(frame->visibility, index);
    h = stir(frame->world, (uint64_t)index);
    h = stir(h, (uint64_t)(uint32_t)e->model << 32 | (uint32_t)e->damage);
    if (e->model >= 0) {
        h = stir_doubles(h, e->p_enu, 3);
        h = stir_doubles(h, e->r_enu_from_body, 9);
        for (int k = 0; k < e->node_count; k++) {
            h = stir(h, (uint64_t)(uintptr_t)e->node[k].mesh);
            h = stir_doubles(h, e->node[k].p_enu, 3);
            h = stir_doubles(h, e->node[k].r_enu_from_node, 9);
        }
    }
    h |= 1;
    atomic_store_explicit(&frame->stamp[index], h, memory_order_relaxed);
    return h;
}

/* Lists the entities that may touch a box. */
static void list_near(SkyNotes *notes, double box[2][3])
{
    notes->nears = visibility_near(notes->near, notes->frame->visibility, box[0], box[1], near_miss_m);
}

/* Hash of those listed whose spheres touch a box, which lies in the listed one; *stand: all of them are as they were in
 * the frame before. */
static uint64_t stamp_about(bool *stand, const SkyNotes *notes, double box[2][3])
{
    SkyKeptFrame  *frame = notes->frame;
    const SkyKept *kept = frame->kept;
    uint64_t       h = frame->world;
    *stand = true;
    for (int k = 0; k < notes->nears; k++) {
        const int          index = notes->near[k];
        const PosedEntity *e = visibility_posed(frame->visibility, index);
        const double       far_m = e->radius_m + near_miss_m;
        double             square = 0;
        if (e->model < 0) continue;
        for (int c = 0; c < 3; c++) {
            const double below = box[0][c] - e->centre_enu[c], above = e->centre_enu[c] - box[1][c];
            const double out = below > 0 ? below : above > 0 ? above : 0;
            square += out * out;
        }
        if (square > far_m * far_m) continue;
        const uint64_t of = stamp_of(frame, index);
        *stand &= index < kept->stood && kept->stood_as[index] == of;
        h = stir(h, of);
    }
    return h;
}

static uint64_t point_hash(uint64_t key, const double p_enu[3], const float n_enu[3], int samples)
{
    const double n[3] = {(double)n_enu[0], (double)n_enu[1], (double)n_enu[2]};
    return stir_doubles(stir_doubles(stir(key, (uint64_t)samples), p_enu, 3), n, 3);
}

static bool same_point(const SkyPoint *a, uint64_t key, const double p_enu[3], const float n_enu[3], int samples)
{
    return a->key == key && a->samples == samples && memcmp(a->p_enu, p_enu, sizeof a->p_enu) == 0 &&
           memcmp(a->n_enu, n_enu, sizeof a->n_enu) == 0;
}

static size_t octets_of(const SkyPoint *p) { return sizeof *p + (size_t)(p->count + 1) * sizeof *p->met; }

/* ---- the table --------------------------------------------------------------------------------- */

Status sky_kept_create(SkyKept **out, size_t octets)
{
    SkyKept *kept = calloc(1, sizeof *kept);
    if (!kept) return STATUS_NO_MEMORY;
    atomic_flag_clear(&kept->busy);
    kept->most_octets = octets;
    *out = kept;
    return STATUS_OK;
}

void sky_kept_destroy(SkyKept *kept)
{
    if (!kept) return;
    for (size_t k = 0; k < kept->slots; k++) free(kept->slot[k]);
    free(kept->slot);
    free(kept->stood_as);
    free(kept);
}

void sky_kept_size(size_t out[2], SkyKept *kept)
{
    while (atomic_flag_test_and_set(&kept->busy)) continue;
    out[0] = kept->points, out[1] = kept->octets;
    atomic_flag_clear(&kept->busy);
}

/* Finds the slot that holds a point, or the free one for it; the table must have one of the two. */
static SkyPoint **place_of(const SkyKept *kept, uint64_t key, const double p_enu[3], const float n_enu[3], int samples)
{
    for (uint64_t at = point_hash(key, p_enu, n_enu, samples);; at++) {
        SkyPoint **slot = &kept->slot[at & (kept->slots - 1)];
        if (!*slot || same_point(*slot, key, p_enu, n_enu, samples)) return slot;
    }
}

static SkyPoint **place_for(const SkyKept *kept, const SkyPoint *p)
{
    return place_of(kept, p->key, p->p_enu, p->n_enu, p->samples);
}

/* A table for so many points, without those that `since` and later frames did not use. False: no memory, and the table
 * is as it was. */
static bool rebuild(SkyKept *kept, size_t points, uint32_t since)
{
    size_t slots = 1024;
    while (slots < 2 * points) slots *= 2;
    SkyPoint   **of = calloc(slots, sizeof *of), **old = kept->slot;
    const size_t before = kept->slots;
    if (!of) return false;
    kept->slot = of, kept->slots = slots;
    kept->points = kept->octets = 0;
    for (size_t k = 0; k < before; k++) {
        SkyPoint *p = old[k];
        if (!p) continue;
        if (atomic_load_explicit(&p->used, memory_order_relaxed) < since) {
            free(p);
            continue;
        }
        *place_for(kept, p) = p;
        kept->points++;
        kept->octets += octets_of(p);
    }
    free(old);
    return true;
}

/* Takes the point. */
static void keep(SkyKept *kept, SkyPoint *p)
{
    if (2 * (kept->points + 1) > kept->slots && !rebuild(kept, 2 * (kept->points + 1), 0)) {
        free(p);
        return;
    }
    SkyPoint   **at = place_for(kept, p);
    const size_t gone = *at ? octets_of(*at) : 0;
    if (kept->octets - gone + octets_of(p) > kept->most_octets) {
        free(p);
        return;
    }
    kept->points += !*at;
    kept->octets += octets_of(p) - gone;
    free(*at);
    *at = p;
}

/* ---- a frame ----------------------------------------------------------------------------------- */

Status sky_kept_begin(SkyKeptFrame **out, SkyKept *kept, const Visibility *visibility, uint64_t world, Arena *arena)
{
    *out = NULL;
    if (!kept) return STATUS_OK;
    SkyKeptFrame *frame = arena_alloc(arena, 1, sizeof *frame);
    if (!frame) return STATUS_NO_MEMORY;
    *frame = (SkyKeptFrame){
        .kept = kept, .visibility = visibility, .world = stir(1, world), .count = visibility_count(visibility)};
    frame->stamp = arena_alloc(arena, (size_t)frame->count + 1, sizeof *frame->stamp);
    if (!frame->stamp) return STATUS_NO_MEMORY;
    if (atomic_flag_test_and_set(&kept->busy)) return STATUS_OK;
    kept->frame++;
    *out = frame;
    return STATUS_OK;
}

Status sky_notes_create(SkyNotes **out, SkyKeptFrame *frame, Arena *arena)
{
    SkyNotes *notes = arena_alloc_raw(arena, 1, sizeof *notes);
    if (!notes || !(notes->near = arena_alloc(arena, (size_t)frame->count + 1, sizeof *notes->near)))
        return STATUS_NO_MEMORY;
    notes->frame = frame;
    notes->made = NULL;
    notes->next = frame->first;
    frame->first = notes;
    *out = notes;
    return STATUS_OK;
}

static void remember_stood(SkyKeptFrame *frame)
{
    SkyKept  *kept = frame->kept;
    uint64_t *of = realloc(kept->stood_as, ((size_t)frame->count + 1) * sizeof *of);
    kept->stood = 0;
    if (!of) return;
    kept->stood_as = of;
    for (kept->stood = 0; kept->stood < frame->count; kept->stood++)
        of[kept->stood] = atomic_load_explicit(&frame->stamp[kept->stood], memory_order_relaxed);
}

static uint64_t count_used(const SkyKept *kept)
{
    uint64_t count = 0;
    for (size_t k = 0; k < kept->slots; k++)
        count += kept->slot[k] && atomic_load_explicit(&kept->slot[k]->used, memory_order_relaxed) == kept->frame;
    return count;
}

uint64_t sky_kept_end(SkyKeptFrame *frame)
{
    if (!frame) return 0;
    SkyKept       *kept = frame->kept;
    const uint64_t found = count_used(kept);
    size_t         more = 0;
    for (const SkyNotes *notes = frame->first; notes; notes = notes->next)
        for (const SkyPoint *p = notes->made; p; p = p->next) more += octets_of(p);
    if (kept->octets + more > kept->most_octets) rebuild(kept, kept->points, kept->frame);
    for (SkyNotes *notes = frame->first; notes; notes = notes->next)
        for (SkyPoint *p = notes->made, *next; p; p = next) {
            next = p->next;
            keep(kept, p);
        }
    remember_stood(frame);
    atomic_flag_clear(&kept->busy);
    return found;
}

/* ---- of a thread ------------------------------------------------------------------------------- */

static void grow(double box[2][3], const double p[3])
{
    for (int c = 0; c < 3; c++) {
        box[0][c] = p[c] < box[0][c] ? p[c] : box[0][c];
        box[1][c] = p[c] > box[1][c] ? p[c] : box[1][c];
    }
}

static void empty_box(double box[2][3])
{
    for (int c = 0; c < 3; c++) box[0][c] = INFINITY, box[1][c] = -INFINITY;
}

void sky_notes_find(const SkyMet *known[hits_capacity], SkyNotes *notes, const Hits *hits, const uint64_t *key,
                    int samples)
{
    const SkyKept *kept = notes->frame->kept;
    SkyPoint      *point[hits_capacity];
    double         box[2][3];
    int            found = 0;
    empty_box(box);
    for (int i = 0; i < hits->count; i++) {
        const double p_enu[3] = {hits->p_enu[0][i], hits->p_enu[1][i], hits->p_enu[2][i]};
        const float  n_enu[3] = {hits->n_enu[0][i], hits->n_enu[1][i], hits->n_enu[2][i]};
        known[i] = NULL;
        point[i] = kept->points > 0 ? *place_of(kept, key[i], p_enu, n_enu, samples) : NULL;
        if (!point[i]) continue;
        grow(box, point[i]->box[0]);
        grow(box, point[i]->box[1]);
        found++;
    }
    if (found == 0) return;
    list_near(notes, box);
    for (int i = 0; i < hits->count; i++) {
        bool stand;
        if (!point[i] || stamp_about(&stand, notes, point[i]->box) != point[i]->stamp) continue;
        atomic_store_explicit(&point[i]->used, kept->frame, memory_order_relaxed);
        known[i] = point[i]->met;
    }
}

void sky_met_load(Hits *hits, Rays *rays, int i, const SkyMet *met)
{
    for (int k = 0; k < 3; k++) {
        hits->p_enu[k][i] = met->p_enu[k];
        hits->n_geo[k][i] = met->n_geo[k];
        hits->n_enu[k][i] = met->n_enu[k];
        rays->d_enu[k][i] = met->d_enu[k];
    }
    hits->range_m[i] = 0; /* not INFINITY: no more is asked */
    hits->kind[i] = met->kind;
    hits->material[i] = met->material;
    hits->facet[i] = met->facet;
    hits->entity[i] = met->entity;
    hits->part[i] = met->part;
    hits->model[i] = met->model;
    hits->inside[i] = met->inside;
    hits->surface[i] = met->surface;
    hits->instance[i] = met->instance;
}

void sky_notes_begin(SkyNotes *notes, int points)
{
    notes->points = points, notes->count = 0;
    for (int k = 0; k < points; k++) empty_box(notes->box[k]);
}

void sky_notes_ray(SkyNotes *notes, int point, const double o_enu[3], const double d_enu[3], double reach_m)
{
    double end[3];
    v3_add_scaled(end, o_enu, reach_m, d_enu);
    grow(notes->box[point], o_enu);
    grow(notes->box[point], end);
}

void sky_notes_met(SkyNotes *notes, int point, int sample, int bounce, const Hits *hits, const Rays *rays, int i)
{
    if (notes->count++ >= notes_most) return;
    Note *note = &notes->note[notes->count - 1];
    note->point = point;
    note->met = (SkyMet){.facet = hits->facet[i],
                         .entity = hits->entity[i],
                         .instance = hits->instance[i],
                         .material = hits->material[i],
                         .part = hits->part[i],
                         .model = hits->model[i],
                         .kind = hits->kind[i],
                         .inside = hits->inside[i],
                         .surface = hits->surface[i],
                         .sample = (uint8_t)sample,
                         .bounce = (uint8_t)bounce};
    for (int k = 0; k < 3; k++) {
        note->met.p_enu[k] = hits->p_enu[k][i];
        note->met.n_geo[k] = hits->n_geo[k][i];
        note->met.n_enu[k] = hits->n_enu[k][i];
        note->met.d_enu[k] = rays->d_enu[k][i];
    }
}

/* Path by path: they come bounce by bounce. */
static void sort_paths(SkyMet *met, int count)
{
    for (int n = 1; n < count; n++) {
        const SkyMet of = met[n];
        int          at = n;
        for (; at > 0; at--) {
            const SkyMet *before = &met[at - 1];
            if (before->sample != of.sample ? before->sample < of.sample : before->bounce < of.bounce) break;
            met[at] = *before;
        }
        met[at] = of;
    }
}

void sky_notes_keep(SkyNotes *notes, const Hits *hits, const uint64_t *key, int samples, double reach_m,
                    const SkyMet *const *known)
{
    SkyPoint *made[hits_capacity];
    double    all[2][3];
    int       missing = 0;
    if (notes->count > notes_most) return;
    empty_box(all);
    for (int i = 0; i < notes->points; i++) {
        double low[3], high[3];
        if (known[i]) continue;
        for (int c = 0; c < 3; c++) low[c] = hits->p_enu[c][i] - reach_m, high[c] = hits->p_enu[c][i] + reach_m;
        grow(notes->box[i], low);
        grow(notes->box[i], high);
        grow(all, notes->box[i][0]);
        grow(all, notes->box[i][1]);
        missing++;
    }
    if (missing == 0) return;
    list_near(notes, all);
    memset(notes->met, 0, ((size_t)notes->points + 1) * sizeof *notes->met);
    for (int n = 0; n < notes->count; n++) notes->met[notes->note[n].point]++;
    for (int i = 0; i < notes->points; i++) {
        const double p_enu[3] = {hits->p_enu[0][i], hits->p_enu[1][i], hits->p_enu[2][i]};
        bool         stand;
        made[i] = NULL;
        if (known[i]) continue;
        const uint64_t stamp = stamp_about(&stand, notes, notes->box[i]);
        if (!stand) continue;
        SkyPoint *p = malloc(sizeof *p + ((size_t)notes->met[i] + 1) * sizeof *p->met);
        if (!p) continue;
        *p = (SkyPoint){
            .next = notes->made, .key = key[i], .stamp = stamp, .samples = samples, .used = notes->frame->kept->frame};
        for (int c = 0; c < 3; c++) p->p_enu[c] = p_enu[c], p->n_enu[c] = hits->n_enu[c][i];
        memcpy(p->box, notes->box[i], sizeof p->box);
        notes->made = made[i] = p;
    }
    for (int n = 0; n < notes->count; n++) {
        SkyPoint *p = made[notes->note[n].point];
        if (p) p->met[p->count++] = notes->note[n].met;
    }
    for (int i = 0; i < notes->points; i++) {
        if (!made[i]) continue;
        sort_paths(made[i]->met, made[i]->count);
        made[i]->met[made[i]->count] = (SkyMet){.bounce = sky_met_end};
    }
}
