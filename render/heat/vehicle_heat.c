/* render/heat/vehicle_heat.c: the temperatures of all vehicles: begun, stepped by exercise time, and read. */
#include "render/heat/vehicle_heat_private.h"

#include <stdlib.h>

Status vehicle_heat_create(VehicleHeat **out, const VehicleHeatConfig *config, const VehicleHeatWorld *world)
{
    VehicleHeat *h = calloc(1, sizeof *h);
    if (!h) return STATUS_NO_MEMORY;
    h->config = *config;
    h->world = *world;
    h->models = world->catalog ? catalog_model_count(world->catalog) : tracer_model_count(world->tracer);
    h->shape = calloc((size_t)h->models + 1, sizeof *h->shape);
    h->shaped = calloc((size_t)h->models + 1, sizeof *h->shaped);
    h->met_s = malloc(((size_t)h->models + 1) * sizeof *h->met_s);
    h->arena = arena_create();
    if (!h->shape || !h->shaped || !h->met_s || !h->arena) {
        vehicle_heat_destroy(h);
        return STATUS_NO_MEMORY;
    }
    for (int m = 0; m <= h->models; m++) h->met_s[m] = NAN;
    *out = h;
    return STATUS_OK;
}

void vehicle_heat_destroy(VehicleHeat *h)
{
    if (!h) return;
    for (int i = 0; i < h->count; i++) vehicle_state_destroy(h->state[i]);
    for (int m = 0; h->shape && m < h->models; m++) vehicle_shape_destroy(&h->shape[m]);
    arena_destroy(h->arena);
    free(h->state);
    free(h->was);
    free(h->due);
    free(h->body);
    free(h->shape);
    free(h->shaped);
    free(h->met_s);
    free(h);
}

static Status need_shape(VehicleHeat *h, int m)
{
    if (h->shaped[m]) return STATUS_OK;
    Status status = tracer_need(h->world.tracer, m);
    if (status == STATUS_OK) status = heat_patches_need(h->world.patches, m, tracer_model(h->world.tracer, m));
    if (status == STATUS_OK)
        status = vehicle_shape_create(&h->shape[m], &h->world.patches->of[m], tracer_model(h->world.tracer, m), m,
                                      h->world.table, h->world.materials);
    h->shaped[m] = status == STATUS_OK;
    return status;
}

/* Whether entities are worked out where they are met, without waiting. */
static bool at_once(const VehicleHeat *h) { return !h->window.metered || !isfinite(h->config.window_us); }

static bool has_shape(const VehicleHeat *h, int m)
{
    return h->world.catalog ? catalog_has_shape(h->world.catalog, m) : tracer_model(h->world.tracer, m) != NULL;
}

/* Some models whose patches are needed by entities from *next on are cut by other threads meanwhile. */
static Status cut_ahead(VehicleHeat *h, const Snapshot *snapshot, int *next)
{
    int ahead = 0;
    for (int m = 0; m < h->models; m++) ahead += h->world.patches->ahead[m] != NULL;
    for (; *next < snapshot->count && ahead < thread_processors(); ++*next) {
        const int m = snapshot->entity[*next].model;
        if (m < 0 || m >= h->models || h->shaped[m] || !has_shape(h, m) || h->world.patches->cut[m] ||
            h->world.patches->ahead[m])
            continue;
        const Status status = tracer_need(h->world.tracer, m);
        if (status != STATUS_OK) return status;
        heat_patches_begin(h->world.patches, m, tracer_model(h->world.tracer, m));
        ahead++;
    }
    return STATUS_OK;
}

/* The network of a model that is met at t_s. After the first tick its patches are cut by another thread while
 * entities wait, for a time that follows from its size: some 10 us a triangle (entities/models/patches.h), and half
 * as much again. */
static Status shape_at(bool *ready, VehicleHeat *h, int m, double t_s)
{
    *ready = true;
    if (!h->shaped[m] && !at_once(h)) {
        if (isnan(h->met_s[m])) {
            const Status status = tracer_need(h->world.tracer, m);
            if (status != STATUS_OK) return status;
            h->met_s[m] = t_s;
            heat_patches_begin(h->world.patches, m, tracer_model(h->world.tracer, m));
        }
        *ready = t_s >= h->met_s[m] + 0.1 + 15e-6 * tracer_model(h->world.tracer, m)->triangle_count;
    }
    return *ready ? need_shape(h, m) : STATUS_OK;
}

size_t vehicle_heat_bytes(const VehicleHeat *h)
{
    size_t bytes = sizeof *h + (size_t)h->room * (sizeof *h->state + sizeof *h->body);
    for (int i = 0; i < h->count; i++)
        bytes += vehicle_state_bytes(h->state[i], &h->shape[h->state[i]->model],
                                     tracer_model(h->world.tracer, h->state[i]->model));
    return bytes;
}

void vehicle_heat_limit(VehicleHeat *h, double window_us) { h->config.window_us = window_us; }

bool vehicle_heat_waits(const VehicleHeat *h) { return h->waiting > 0; }

const VehicleHeatCounters *vehicle_heat_counters(const VehicleHeat *h) { return &h->counters; }

static void need_bodies(VehicleHeat *h)
{
    if (!h->bodied) vehicle_near_bodies(&h->near);
    h->bodied = true;
}

/* Searches for an entity's neighbours, once a second. */
static Status check_neighbours(VehicleHeat *h, int at)
{
    VehicleState *s = h->state[at];
    const double  t_s = h->near.snapshot->t_s;
    PlaceHeat     place;
    bool          changed;
    int           left_out;
    if (h->config.alone || (h->count < 2 && !s->near) || t_s - s->checked_s < 1) return STATUS_OK;
    s->checked_s = t_s;
    need_bodies(h);
    Status status = h->config.place(&place, h->config.user, h->config.unix_s + t_s, h->body[at].p_enu, false);
    if (status == STATUS_OK) status = vehicle_near_check(&changed, &left_out, &h->near, at, place.sun_d_enu);
    if (status != STATUS_OK) return status;
    s->changed = s->changed || (changed && s->shown);
    h->counters.neighbours_left_out += (uint64_t)left_out;
    return STATUS_OK;
}

/* Whether an entity has work to wait for. */
static bool is_due(VehicleState *s, const VehicleHeat *h)
{
    const SnapshotEntity *e = &h->near.snapshot->entity[s->index];
    const VehicleShape   *shape = &h->shape[s->model];
    double                r_enu_from_body[9];
    if (!s->shown) return true;
    m3_tmul(r_enu_from_body, h->world.frame->r_ecef_from_enu, e->r_ecef_from_body);
    s->changed = s->changed || vehicle_state_changed(s, e, r_enu_from_body);
    return s->changed || h->near.snapshot->t_s >= s->next_s || s->looked < shape->patches->count ||
           vehicle_near_waits(s, shape);
}

/* Those that have waited longest, first. */
static int by_wait(const void *a, const void *b)
{
    const VehicleState *p = *(VehicleState *const *)a, *q = *(VehicleState *const *)b;
    if (p->waits_s != q->waits_s) return p->waits_s < q->waits_s ? -1 : 1;
    return dis_entity_id_compare(p->id, q->id);
}

static Status first_sight(VehicleState **out, const VehicleHeat *h, const SnapshotEntity *e, double t_s)
{
    const Model  *model = tracer_model(h->world.tracer, e->model);
    VehicleState *s = vehicle_state_create(&h->shape[e->model], model);
    if (!s) return STATUS_NO_MEMORY;
    s->id = e->id, s->since_s = e->drives.since_s, s->model = e->model;
    s->drives = e->drives;
    s->seen_s = t_s, s->waits_s = INFINITY, s->looked = -1;
    vehicle_state_given(s, h->world.given, h->shape[s->model].patches, model);
    *out = s;
    return STATUS_OK;
}

static Status make_room(VehicleHeat *h, int count)
{
    if (count <= h->room) return STATUS_OK;
    const int      room = count < h->config.capacity ? count + count / 2 + 16 : count;
    VehicleState **larger = realloc(h->state, (size_t)room * sizeof *larger);
    if (larger) h->state = larger;
    VehicleState **also = larger ? realloc(h->was, (size_t)room * sizeof *also) : NULL;
    if (also) h->was = also;
    VehicleState **due = also ? realloc(h->due, (size_t)room * sizeof *due) : NULL;
    if (due) h->due = due;
    NearBody *body = due ? realloc(h->body, (size_t)room * sizeof *body) : NULL;
    if (!body) return STATUS_NO_MEMORY;
    h->body = body, h->room = room;
    return STATUS_OK;
}

static bool is_same(const VehicleState *s, const SnapshotEntity *e)
{
    return s->since_s == e->drives.since_s && s->model == e->model;
}

/* States of the snapshot's entities, by id: those of before, and new ones. */
static Status meet(VehicleHeat *h, const Snapshot *snapshot)
{
    VehicleState **was = h->was;
    const int      before = h->count;
    Status         status = STATUS_OK;
    int            at = 0, next = 0;
    h->waiting = 0;
    if (before > 0) memcpy(was, h->state, (size_t)before * sizeof *was);
    h->count = 0;
    for (int i = 0; i < snapshot->count; i++) {
        const SnapshotEntity *e = &snapshot->entity[i];
        VehicleState         *s = NULL;
        while (at < before && dis_entity_id_compare(was[at]->id, e->id) < 0) vehicle_state_destroy(was[at++]);
        if (at < before && dis_entity_id_compare(was[at]->id, e->id) == 0) {
            s = was[at++];
            if (!is_same(s, e)) vehicle_state_destroy(s), s = NULL;
        }
        if (e->model < 0 || e->model >= h->models || !has_shape(h, e->model) || h->count == h->config.capacity) {
            h->counters.left_out += h->count == h->config.capacity;
            vehicle_state_destroy(s);
            continue;
        }
        bool ready = true;
        if (!s && status == STATUS_OK && !h->shaped[e->model] && at_once(h)) status = cut_ahead(h, snapshot, &next);
        if (!s && status == STATUS_OK) status = shape_at(&ready, h, e->model, snapshot->t_s);
        h->waiting += !ready;
        if (!s && ready && status == STATUS_OK && h->shape[e->model].patches->count > 0)
            status = first_sight(&s, h, e, snapshot->t_s);
        if (!s) continue;
        s->index = i;
        h->state[h->count++] = s;
    }
    while (at < before) vehicle_state_destroy(was[at++]);
    return status;
}

Status vehicle_heat_tick(VehicleHeat *h, const Snapshot *snapshot)
{
    const double began_s = wall_clock_s(), t_s = snapshot->t_s;
    Status       status = make_room(h, snapshot->count < h->config.capacity ? snapshot->count : h->config.capacity);
    int          due = 0;
    if (status != STATUS_OK) return status;
    work_window_open(&h->window, t_s);
    status = meet(h, snapshot);
    h->near = (NearScene){snapshot, h->world.tracer, h->shape, h->world.frame, h->state, h->body, h->count};
    h->bodied = false;
    for (int i = 0; i < h->count && status == STATUS_OK; i++) {
        VehicleState *s = h->state[i];
        status = check_neighbours(h, i);
        if (!is_due(s, h)) continue;
        s->waits_s = fmin(s->waits_s, t_s);
        h->due[due++] = s;
    }
    if (due > 1) qsort(h->due, (size_t)due, sizeof(VehicleState *), by_wait);
    int left = 0;
    for (int i = 0; i < due && status == STATUS_OK; i++) {
        need_bodies(h);
        if (left == 0) status = vehicle_work_on(h, h->due[i]);
        left += h->due[i]->waits_s < INFINITY;
    }
    h->waiting += left;
    const double spent_s = wall_clock_s() - began_s;
    h->counters.spent_s += spent_s;
    h->counters.longest_s = fmax(h->counters.longest_s, spent_s);
    return status;
}

static const VehicleState *find_state(const VehicleHeat *h, DisEntityId id)
{
    const int at = vehicle_state_find(h->state, h->count, id);
    return at < 0 ? NULL : h->state[at];
}

/* Mean of the patches' values, weighted by outer area. */
static double mean_of(const Patches *p, const float *value)
{
    double sum = 0, m2 = 0;
    for (int i = 0; i < p->count; i++)
        sum += patch_open_m2(&p->patch[i]) * (double)value[i], m2 += patch_open_m2(&p->patch[i]);
    return m2 > 0 ? sum / m2 : 0;
}

Status vehicle_heat_show(const VehicleHeat *h, Snapshot *snapshot, Arena *arena)
{
    int patches = 0;
    for (int i = 0; i < h->count; i++) patches += h->shape[h->state[i]->model].patches->count;
    float *patch_k = arena_alloc(arena, (size_t)patches + 1, sizeof *patch_k);
    if (!patch_k) return STATUS_NO_MEMORY;
    snapshot->patch_k = patch_k;
    snapshot->patch_count = 0;
    for (int i = 0; i < snapshot->count; i++) {
        SnapshotEntity     *e = &snapshot->entity[i];
        const VehicleState *s = find_state(h, e->id);
        e->first_patch = -1, e->patches = 0, e->dt_k = 0;
        if (!s || !s->shown || !is_same(s, e)) continue;
        const int count = h->shape[s->model].patches->count;
        e->first_patch = snapshot->patch_count;
        for (int k = 0; k < count; k++)
            patch_k[e->first_patch + k] = (float)vehicle_state_k(s, h->world.given, k, snapshot->t_s);
        e->patches = count;
        snapshot->patch_count += count;
        double p_enu[3];
        enu_from_ecef(p_enu, h->world.frame, e->p_ecef);
        if (!v3_is_finite(p_enu)) continue;
        PlaceHeat    place;
        const Status status = h->config.place(&place, h->config.user, h->config.unix_s + snapshot->t_s, p_enu, true);
        if (status != STATUS_OK) return status;
        e->dt_k = (float)(mean_of(h->shape[s->model].patches, patch_k + e->first_patch) - place.ground_k);
    }
    return STATUS_OK;
}

bool vehicle_heat_nodes(VehicleNodes *out, const VehicleHeat *h, DisEntityId id)
{
    const VehicleState *s = find_state(h, id);
    if (!s || !s->shown) return false;
    *out = (VehicleNodes){&h->shape[s->model], s->temp_k, s->heat_in_j, s->t_s};
    return true;
}

Status vehicle_heat_keep(const VehicleHeat *h, const char *path)
{
    KeptNodes *nodes = calloc((size_t)h->count + 1, sizeof *nodes);
    int        count = 0;
    if (!nodes) return STATUS_NO_MEMORY;
    for (int i = 0; i < h->count; i++) {
        const VehicleState *s = h->state[i];
        if (s->shown)
            nodes[count++] = (KeptNodes){s->id, tracer_model(h->world.tracer, s->model)->name,
                                         h->config.unix_s + s->t_s, h->shape[s->model].nodes, s->temp_k};
    }
    const Status status = heat_kept_save(nodes, count, path);
    free(nodes);
    return status;
}
