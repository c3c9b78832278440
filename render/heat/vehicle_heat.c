/* render/heat/vehicle_heat.c: see vehicle_heat.h. */
#include "render/heat/vehicle_heat.h"

#include "render/heat/vehicle_near.h"
#include "render/heat/work_window.h"

#include <stdlib.h>

struct VehicleHeat {
    VehicleHeatConfig   config;
    VehicleHeatWorld    world;
    VehicleShape       *shape;    /* [models] */
    bool               *shaped;
    double             *met_s;    /* [models]: when it was first met, while its patches are cut; NAN: not */
    int                 models, count, room, waiting;
    VehicleState      **state, **was; /* [count], by id; of the tick before */
    VehicleState      **due;      /* [room]: those whose work waits, of a tick */
    NearBody           *body;     /* [room] */
    NearScene           near;     /* of a tick */
    bool                bodied;   /* its bodies are filled in */
    WorkWindow          window;
    Arena              *arena;    /* of one entity's step */
    VehicleHeatCounters counters;
};

Status vehicle_heat_create(VehicleHeat **out, const VehicleHeatConfig *config, const VehicleHeatWorld *world)
{
    VehicleHeat *h = calloc(1, sizeof *h);
    if (!h) return STATUS_NO_MEMORY;
    h->config = *config;
    h->world  = *world;
    h->models = catalog_model_count(world->catalog);
    h->shape  = calloc((size_t)h->models + 1, sizeof *h->shape);
    h->shaped = calloc((size_t)h->models + 1, sizeof *h->shaped);
    h->met_s  = malloc(((size_t)h->models + 1) * sizeof *h->met_s);
    h->arena  = arena_create();
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
    if (status == STATUS_OK) status = patch_set_need(h->world.patches, m, tracer_model(h->world.tracer, m));
    if (status == STATUS_OK)
        status = vehicle_shape_create(&h->shape[m], &h->world.patches->of[m], tracer_model(h->world.tracer, m), m,
                                      h->world.table, h->world.materials);
    h->shaped[m] = status == STATUS_OK;
    return status;
}

/* The network of a model that is met at t_s. After the first tick its patches are cut by another thread while
 * entities wait, for a time that follows from its size: some 10 us a triangle (entities/models/patches.h), and half
 * as much again. */
static Status shape_at(bool *ready, VehicleHeat *h, int m, double t_s)
{
    *ready = true;
    if (!h->shaped[m] && h->window.metered && isfinite(h->config.window_us)) {
        if (isnan(h->met_s[m])) {
            const Status status = tracer_need(h->world.tracer, m);
            if (status != STATUS_OK) return status;
            h->met_s[m] = t_s;
            patch_set_begin(h->world.patches, m, tracer_model(h->world.tracer, m));
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

bool vehicle_heat_waits(const VehicleHeat *h) { return h->waiting > 0; }

const VehicleHeatCounters *vehicle_heat_counters(const VehicleHeat *h) { return &h->counters; }

/* ---- work, in pieces ---------------------------------------------------------------------- */

/* What pieces cost, microseconds of one core of 2024: units of account, so that every machine does the same work at the
 * same time (`bench speed` holds them against the clock). */
static const double look_us = 45; /* of a patch */
static const double pose_us = 10, jet_us = 60; /* of a neighbour: posed; its exhaust followed */
static const double near_us = 3, near_fill_us = 12; /* of a patch that looks at neighbours: at all; by what they fill */

static double past_us(const VehicleShape *shape) { return 2.0 * shape->patches->count + 0.6 * shape->nodes; }

static double advance_us(const VehicleShape *shape) { return 3.0 * shape->patches->count + shape->nodes; }

/* Whether there is room for a piece. */
static bool take(VehicleHeat *h, double us) { return work_window_take(&h->window, us, h->config.window_us); }

/* ---- an entity now ------------------------------------------------------------------------ */

static Status catch_moment(VehicleMoment *m, VehicleHeat *h, const VehicleState *s)
{
    const Snapshot       *snapshot = h->near.snapshot;
    const int             index = s->index;
    const SnapshotEntity *e = &snapshot->entity[index];
    const LocalFrame     *frame = h->world.frame;
    static const double   origin[3] = {0, 0, 0};
    *m = (VehicleMoment){.entity = e, .model = tracer_model(h->world.tracer, e->model), .shape = &h->shape[e->model]};
    m->node  = arena_alloc(h->arena, (size_t)m->model->node_count, sizeof *m->node);
    m->joint = arena_alloc(h->arena, (size_t)m->model->node_count, sizeof *m->joint);
    m->lit   = arena_alloc(h->arena, (size_t)m->shape->patches->count + 1, sizeof *m->lit);
    m->gas_k = arena_alloc(h->arena, (size_t)m->shape->patches->count + 1, sizeof *m->gas_k);
    m->gas_mps = arena_alloc(h->arena, (size_t)m->shape->patches->count + 1, sizeof *m->gas_mps);
    m->sent_w_m2 = arena_alloc(h->arena, (size_t)m->shape->patches->count + 1, sizeof *m->sent_w_m2);
    m->posed.node = arena_alloc(h->arena, (size_t)parts_node_count(h->world.tracer, e->model) + 1, sizeof *m->posed.node);
    if (!m->node || !m->joint || !m->lit || !m->gas_k || !m->gas_mps || !m->sent_w_m2 || !m->posed.node) return STATUS_NO_MEMORY;
    enu_from_ecef(m->p_enu, frame, e->p_ecef);
    m3_tmul_v3(m->v_enu_mps, frame->r_ecef_from_enu, e->v_ecef_mps);
    m3_tmul(m->pose.r_enu_from_body, frame->r_ecef_from_enu, e->r_ecef_from_body);
    snapshot_pose(m->node, m->joint, snapshot, index, m->model);
    parts_pose(&m->posed, h->world.tracer, e->model, m->node, origin, m->pose.r_enu_from_body, 0);
    m->pose.patches = m->shape->patches, m->pose.model = m->model;
    m->pose.node = m->node;
    return m->posed.model >= 0 && v3_is_finite(m->p_enu) ? STATUS_OK : STATUS_BAD_VALUE;
}

/* Without its sun. */
static Status find_ground(VehicleMoment *m, const VehicleHeat *h, double unix_s, bool present)
{
    const Status status = h->config.place(&m->place, h->config.user, unix_s, m->p_enu, present);
    m->pose.posed   = &m->posed;
    m->pose.above_m = m->place.above_m;
    return status;
}

/* With its sun and its neighbours. t_s: exercise time. lately: engines run as now. */
static Status find_place(VehicleMoment *m, VehicleHeat *h, const VehicleState *s, double t_s, bool present, bool lately)
{
    NearWork work = {0};
    Status   status = find_ground(m, h, h->config.unix_s + t_s, present);
    if (status == STATUS_OK && h->near.count > 1)
        status = vehicle_near_moment(&work, m, &h->near, vehicle_state_find(h->state, h->count, s->id), t_s, !present, lately,
                                     h->arena);
    if (status != STATUS_OK) return status;
    patch_view_sun(m->lit, &m->pose, m->place.sun_d_enu, m->shade, m->shades);
    work_window_spend(&h->window, pose_us * work.poses + jet_us * work.jets);
    return STATUS_OK;
}

/* ---- steps -------------------------------------------------------------------------------- */

static bool is_sound(const double *temp_k, int nodes)
{
    for (int n = 0; n < nodes; n++)
        if (!(temp_k[n] > 0.5 && temp_k[n] < 1e4)) return false;
    return true;
}

/* A step; where the solver gives up, temperatures stay. scratch: [nodes]. */
static void step(VehicleHeat *h, VehicleState *s, double *temp_k, double *heat_in_j, const EntityDrives *d,
                 const NetworkLoad *from, const NetworkLoad *to, double dt_s, double *scratch)
{
    const VehicleShape *shape = &h->shape[s->model];
    const size_t        octets = (size_t)shape->nodes * sizeof *temp_k;
    double              in_j = 0;
    if (!(dt_s > 0)) return;
    vehicle_links(shape, d);
    memcpy(scratch, temp_k, octets);
    h->counters.steps++;
    if (network_step(scratch, &in_j, shape->network, from, to, dt_s) != STATUS_OK || !is_sound(scratch, shape->nodes)) {
        h->counters.failed++;
        return;
    }
    memcpy(temp_k, scratch, octets);
    if (heat_in_j) *heat_in_j += in_j;
}

static void read_surface(float *out_k, const VehicleShape *shape, const double *temp_k)
{
    for (int i = 0; i < shape->patches->count; i++) out_k[i] = (float)temp_k[shape->skin[i].surface];
}

/* Shots since, into the bores. */
static void take_shots(VehicleHeat *h, VehicleState *s, const EntityDrives *d)
{
    const VehicleShape *shape = &h->shape[s->model];
    for (int large = 0; large < 2; large++) {
        const double kg = d->fired_kg[large] - s->drives.fired_kg[large];
        const int    body = shape->gun_body[large];
        if (!(kg > 0) || body < 0) continue;
        for (int i = shape->patches->first_of_body[body]; i < shape->patches->first_of_body[body + 1]; i++) {
            const double j = kg * shape->skin[i].row.drive_value * shape->skin[i].area_m2 / shape->gun_m2[large];
            const int    node = shape->skin[i].inner;
            s->temp_k[node] = fmin(s->temp_k[node] + j / shape->capacity_j_k[node], 2000);
            s->heat_in_j += j;
        }
    }
}

/* ---- states ------------------------------------------------------------------------------- */

/* Where its present loads lead it until its next own time. */
static Status predict(VehicleHeat *h, VehicleState *s, const VehicleMoment *m)
{
    double *temp_k = arena_alloc(h->arena, (size_t)m->shape->nodes, sizeof *temp_k);
    double *scratch = arena_alloc(h->arena, (size_t)m->shape->nodes, sizeof *scratch);
    if (!temp_k || !scratch) return STATUS_NO_MEMORY;
    memcpy(temp_k, s->temp_k, (size_t)m->shape->nodes * sizeof *temp_k);
    step(h, s, temp_k, NULL, &s->drives, s->load, s->load, s->span_s, scratch);
    s->next_s = s->t_s + s->span_s;
    read_surface(s->now_k, m->shape, s->temp_k);
    read_surface(s->next_k, m->shape, temp_k);
    memcpy(s->sent_w_m2, m->sent_w_m2, (size_t)m->shape->patches->count * sizeof *s->sent_w_m2);
    return STATUS_OK;
}

/* ---- the past ----------------------------------------------------------------------------- */

/* A day without its engine, an hour as it is now: steps that shorten towards the present. */
static const double past_span_s[] = {10800, 10800, 10800, 10800, 7200, 7200, 7200, 3600, 3600, 3600, 3600, 3600, 120, 480,
                                     900, 900, 600, 300, 300};
enum { past_steps = sizeof past_span_s / sizeof *past_span_s };

/* Drives d for span_s, from loads of the middle of that. */
static Status live_through(VehicleHeat *h, VehicleState *s, VehicleMoment *m, const EntityDrives *d, double middle_s,
                           double span_s, bool lately)
{
    double      *scratch = arena_alloc(h->arena, (size_t)m->shape->nodes, sizeof *scratch);
    const Status status = scratch ? find_place(m, h, s, middle_s, false, lately) : STATUS_NO_MEMORY;
    const size_t octets = (size_t)m->shape->nodes * sizeof *scratch;
    if (status != STATUS_OK) return status;
    if (!(s->temp_k[0] > 0))
        for (int n = 0; n < m->shape->nodes; n++) s->temp_k[n] = m->place.air_k;
    vehicle_loads(s->load, m, s->view, s->temp_k, d);
    if (h->config.past_parts > 1) {
        step(h, s, s->temp_k, NULL, d, s->load, s->load, span_s, scratch);
        return STATUS_OK;
    }
    vehicle_links(m->shape, d);
    h->counters.steps++;
    memcpy(scratch, s->temp_k, octets);
    if (network_leap(scratch, m->shape->network, s->load, span_s) == STATUS_OK && is_sound(scratch, m->shape->nodes))
        memcpy(s->temp_k, scratch, octets);
    else
        step(h, s, s->temp_k, NULL, d, s->load, s->load, span_s, scratch);
    return STATUS_OK;
}

/* Those of a run before, if they are recent; NULL: there are none. */
static const KeptNodes *kept_of(const VehicleHeat *h, const VehicleState *s)
{
    static const double longest_s = 10800;
    if (!h->world.kept) return NULL;
    const KeptNodes *k = kept_heat_find(h->world.kept, s->id, tracer_model(h->world.tracer, s->model)->name, h->shape[s->model].nodes);
    const double     gap_s = k ? h->config.unix_s + s->seen_s - k->unix_s : 0;
    return k && gap_s >= 0 && gap_s <= longest_s ? k : NULL;
}

/* From kept temperatures until now, in as many steps as a past has. */
static Status live_since(VehicleHeat *h, VehicleState *s, VehicleMoment *m, const KeptNodes *kept)
{
    const double since_s = kept->unix_s - h->config.unix_s, span_s = (s->seen_s - since_s) / past_steps;
    if (!(s->temp_k[0] > 0)) memcpy(s->temp_k, kept->temp_k, (size_t)kept->nodes * sizeof *s->temp_k);
    const double middle_s = since_s + (s->lived + 0.5) * span_s;
    const Status status = span_s > 0 ? live_through(h, s, m, &s->drives, middle_s, span_s, true) : STATUS_OK;
    s->lived++;
    return status;
}

/* One span of its past. */
static Status live_on(VehicleHeat *h, VehicleState *s, VehicleMoment *m)
{
    static const double now_s = 3600;
    const int           parts = h->config.past_parts > 1 ? h->config.past_parts : 1;
    EntityDrives        d = {.alive = s->drives.alive, .flying = s->drives.flying};
    Status              status = STATUS_OK;
    double              before_s = 0;
    const KeptNodes    *kept = kept_of(h, s);
    if (kept) return live_since(h, s, m, kept);
    for (int k = s->lived; k < past_steps; k++) before_s += past_span_s[k];
    const double span_s = past_span_s[s->lived] / parts;
    if (before_s <= now_s) d = s->drives;
    for (int k = 0; k < parts && status == STATUS_OK; k++)
        status = live_through(h, s, m, &d, s->seen_s - before_s + (k + 0.5) * span_s, span_s, before_s <= now_s);
    s->lived++;
    return status;
}

/* The past is over: it is shown from now on. */
static Status appear(VehicleHeat *h, VehicleState *s, VehicleMoment *m, double t_s)
{
    const Status status = find_place(m, h, s, t_s, true, true);
    if (status != STATUS_OK) return status;
    vehicle_state_remember(s, m->shape->patches->count, t_s);
    if (snapshot_is_short_lived(m->entity)) {
        const double speed_mps = v3_length(m->v_enu_mps);
        for (int n = 0; n < m->shape->nodes; n++)
            s->temp_k[n] = m->place.air_k + vehicle_recovery_k(speed_mps);
    }
    vehicle_state_stay(s, m, t_s);
    vehicle_loads(s->load, m, s->view, s->temp_k, &s->drives);
    s->span_s = h->config.first_step_s;
    s->shown  = true;
    h->counters.begun++;
    return predict(h, s, m);
}

/* Its views are to be of this pose: those of another entity of its model that is posed alike, or none yet. */
static void start_looking(VehicleState *s, const VehicleMoment *m, const VehicleHeat *h)
{
    const int patches = m->shape->patches->count;
    vehicle_state_look(s, m);
    for (int i = 0; i < h->count; i++) {
        const VehicleState *o = h->state[i];
        if (o == s || o->model != s->model || o->looked < patches || !vehicle_state_sees(o, m)) continue;
        memcpy(s->view, o->view, (size_t)patches * sizeof *s->view);
        s->looked = patches;
        return;
    }
}

static Status advance(VehicleHeat *h, VehicleState *s, VehicleMoment *m, double t_s)
{
    const EntityDrives *d = &m->entity->drives;
    const int           nodes = m->shape->nodes;
    NetworkLoad        *load = arena_alloc(h->arena, (size_t)nodes, sizeof *load);
    double             *scratch = arena_alloc(h->arena, (size_t)nodes, sizeof *scratch);
    const Status        status = load && scratch ? find_place(m, h, s, t_s, true, true) : STATUS_NO_MEMORY;
    if (status != STATUS_OK) return status;
    vehicle_state_remember(s, m->shape->patches->count, t_s);
    if (!s->changed) vehicle_loads(load, m, s->view, s->temp_k, d);
    step(h, s, s->temp_k, &s->heat_in_j, &s->drives, s->load, s->changed ? s->load : load, t_s - s->t_s, scratch);
    take_shots(h, s, d);
    vehicle_state_stay(s, m, t_s);
    vehicle_loads(s->load, m, s->view, s->temp_k, d);
    s->span_s = s->changed ? h->config.first_step_s : fmin(2 * s->span_s, h->config.step_s);
    s->changed = false;
    if (!vehicle_state_sees(s, m)) start_looking(s, m, h);
    return predict(h, s, m);
}

/* What its neighbours take of its views. False: there is no room for all of it. */
static bool look_about(Status *status, VehicleHeat *h, VehicleState *s, const VehicleMoment *m)
{
    const PatchPose *pose[near_seen_most];
    if (*status != STATUS_OK || !vehicle_near_waits(s, m->shape)) return true;
    if (!take(h, pose_us * s->near->next_seen)) return false;
    *status = vehicle_near_pose(pose, &h->near, s, m, h->arena);
    while (*status == STATUS_OK && vehicle_near_waits(s, m->shape)) {
        if (!take(h, near_us + near_fill_us * s->near->fill)) return false;
        vehicle_near_look(s, m, pose);
    }
    return true;
}

/* As much as there is room for of what waits: a step, views, the past. */
static Status work_on(VehicleHeat *h, VehicleState *s)
{
    const double        t_s = h->near.snapshot->t_s;
    const VehicleShape *shape = &h->shape[s->model];
    const int           patches = shape->patches->count;
    VehicleMoment              m;
    arena_reset(h->arena);
    Status status = catch_moment(&m, h, s);
    if (status == STATUS_BAD_VALUE) s->waits_s = INFINITY; /* not drawable */
    if (status != STATUS_OK) return status == STATUS_BAD_VALUE ? STATUS_OK : status;
    if (s->shown && (s->changed || t_s >= s->next_s)) {
        if (!take(h, advance_us(shape))) return STATUS_OK;
        status = advance(h, s, &m, t_s);
    } else {
        status = find_ground(&m, h, h->config.unix_s + t_s, true);
        if (status == STATUS_OK && s->looked < 0) start_looking(s, &m, h);
    }
    for (; status == STATUS_OK && s->looked < patches; s->looked++) {
        if (!take(h, look_us)) return STATUS_OK;
        patch_view_look(&s->view[s->looked], &m.pose, s->looked);
    }
    if (!look_about(&status, h, s, &m)) return STATUS_OK;
    const int lives = snapshot_is_short_lived(m.entity) ? 0 : past_steps;
    while (status == STATUS_OK && !s->shown && s->lived < lives) {
        if (!take(h, past_us(shape))) return STATUS_OK;
        status = live_on(h, s, &m);
    }
    if (status == STATUS_OK && !s->shown) {
        if (!take(h, advance_us(shape))) return STATUS_OK;
        status = appear(h, s, &m, t_s);
    }
    s->waits_s = INFINITY;
    return status;
}

static void need_bodies(VehicleHeat *h)
{
    if (!h->bodied) near_scene_bodies(&h->near);
    h->bodied = true;
}

/* Its neighbours, once a second. */
static Status check_neighbours(VehicleHeat *h, int at)
{
    VehicleState *s = h->state[at];
    const double  t_s = h->near.snapshot->t_s;
    PlaceHeat     place;
    bool          changed;
    int           left_out;
    if ((h->count < 2 && !s->near) || t_s - s->checked_s < 1) return STATUS_OK;
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
    int            at = 0;
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
        if (e->model < 0 || e->model >= h->models || !catalog_has_shape(h->world.catalog, e->model) ||
            h->count == h->config.capacity) {
            h->counters.left_out += h->count == h->config.capacity;
            vehicle_state_destroy(s);
            continue;
        }
        bool ready = true;
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
    status  = meet(h, snapshot);
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
        if (left == 0) status = work_on(h, h->due[i]);
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

/* By outer area. */
static double mean_of(const Patches *p, const float *value)
{
    double sum = 0, m2 = 0;
    for (int i = 0; i < p->count; i++) sum += patch_open_m2(&p->patch[i]) * (double)value[i], m2 += patch_open_m2(&p->patch[i]);
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
        const int   count = h->shape[s->model].patches->count;
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
            nodes[count++] = (KeptNodes){s->id, tracer_model(h->world.tracer, s->model)->name, h->config.unix_s + s->t_s,
                                         h->shape[s->model].nodes, s->temp_k};
    }
    const Status status = kept_heat_save(nodes, count, path);
    free(nodes);
    return status;
}
