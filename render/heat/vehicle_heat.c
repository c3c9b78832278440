/* render/heat/vehicle_heat.c: see vehicle_heat.h. */
#include "render/heat/vehicle_heat.h"

#include <stdlib.h>

enum { window_ticks = 10 }; /* of 10 ms */

typedef struct VehicleState {
    DisEntityId  id;
    double       since_s;
    int          model;
    double       t_s, next_s, span_s;
    EntityDrives drives;
    double       up_body[3], ahead_enu[3];
    double       heat_in_j;
    double      *temp_k;          /* [nodes] at t_s; zeroes: its past has not begun */
    float       *now_k, *next_k;  /* [patches] at t_s, next_s */
    double      *joint;           /* [model nodes]: as view saw them */
    double       view_up_body[3];
    PatchView   *view;            /* [patches] */
    double       view_above_m;
    int          looked, lived;   /* patches whose view is of that pose; steps of its past that are done */
    bool         shown, changed;  /* its past is over; its drives are others than those of t_s */
    double       seen_s, waits_s; /* first seen; since when work waits, INFINITY: none does */
    NetworkLoad *load;            /* [nodes] at t_s */
    int         *given;           /* [patches] of GivenHeat, -1: none */
    double       ground_k;        /* in the open, at t_s */
} VehicleState;

/* An entity whose work waits. */
typedef struct Due {
    VehicleState *state;
    int           index; /* in the snapshot */
} Due;

struct VehicleHeat {
    VehicleHeatConfig   config;
    VehicleHeatWorld    world;
    VehicleShape       *shape;    /* [models] */
    bool               *shaped;
    int                 models, count, room, waiting;
    VehicleState      **state, **was; /* [count], by id; of the tick before */
    Due                *due;      /* [room]: of a tick */
    double              tick, spent_us[window_ticks]; /* the last, of 10 ms; work of those up to it, in turn */
    bool                started, metered; /* metered: after the first tick */
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
    h->arena  = arena_create();
    if (!h->shape || !h->shaped || !h->arena) {
        vehicle_heat_destroy(h);
        return STATUS_NO_MEMORY;
    }
    *out = h;
    return STATUS_OK;
}

void vehicle_heat_destroy(VehicleHeat *h)
{
    if (!h) return;
    for (int i = 0; i < h->count; i++) free(h->state[i]);
    for (int m = 0; h->shape && m < h->models; m++) vehicle_shape_destroy(&h->shape[m]);
    arena_destroy(h->arena);
    free(h->state);
    free(h->was);
    free(h->due);
    free(h->shape);
    free(h->shaped);
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

/* One block: the state and all its arrays. */
static VehicleState *new_state(const VehicleShape *shape, const Model *model)
{
    const size_t n = (size_t)shape->nodes, p = (size_t)shape->patches->count, j = (size_t)model->node_count;
    const size_t doubles = sizeof(VehicleState) + n * sizeof(double) + j * sizeof(double) + n * sizeof(NetworkLoad);
    char        *at = calloc(1, doubles + p * sizeof(PatchView) + 2 * p * sizeof(float) + p * sizeof(int));
    if (!at) return NULL;
    VehicleState *s = (VehicleState *)(void *)at;
    s->temp_k = (double *)(void *)(at + sizeof *s);
    s->joint  = s->temp_k + n;
    s->load   = (NetworkLoad *)(void *)(s->joint + j);
    s->view   = (PatchView *)(void *)(at + doubles);
    s->now_k  = (float *)(void *)(s->view + p);
    s->next_k = s->now_k + p;
    s->given  = (int *)(void *)(s->next_k + p);
    return s;
}

static size_t state_bytes(const VehicleShape *shape, const Model *model)
{
    const size_t n = (size_t)shape->nodes, p = (size_t)shape->patches->count;
    return sizeof(VehicleState) + (n + (size_t)model->node_count) * sizeof(double) + n * sizeof(NetworkLoad) +
           p * (sizeof(PatchView) + 2 * sizeof(float) + sizeof(int));
}

size_t vehicle_heat_bytes(const VehicleHeat *h)
{
    size_t bytes = sizeof *h + (size_t)h->room * sizeof *h->state;
    for (int i = 0; i < h->count; i++)
        bytes += state_bytes(&h->shape[h->state[i]->model], tracer_model(h->world.tracer, h->state[i]->model));
    return bytes;
}

bool vehicle_heat_waits(const VehicleHeat *h) { return h->waiting > 0; }

const VehicleHeatCounters *vehicle_heat_counters(const VehicleHeat *h) { return &h->counters; }

/* ---- an entity now ------------------------------------------------------------------------ */

static Status catch_moment(VehicleMoment *m, VehicleHeat *h, const Snapshot *snapshot, int index)
{
    const SnapshotEntity *e = &snapshot->entity[index];
    const LocalFrame     *frame = h->world.frame;
    static const double   origin[3] = {0, 0, 0};
    *m = (VehicleMoment){.entity = e, .model = tracer_model(h->world.tracer, e->model), .shape = &h->shape[e->model]};
    m->node  = arena_alloc(h->arena, (size_t)m->model->node_count, sizeof *m->node);
    m->joint = arena_alloc(h->arena, (size_t)m->model->node_count, sizeof *m->joint);
    m->lit   = arena_alloc(h->arena, (size_t)m->shape->patches->count + 1, sizeof *m->lit);
    m->gas_k = arena_alloc(h->arena, (size_t)m->shape->patches->count + 1, sizeof *m->gas_k);
    m->gas_mps = arena_alloc(h->arena, (size_t)m->shape->patches->count + 1, sizeof *m->gas_mps);
    m->posed.node = arena_alloc(h->arena, (size_t)parts_node_count(h->world.tracer, e->model) + 1, sizeof *m->posed.node);
    if (!m->node || !m->joint || !m->lit || !m->gas_k || !m->gas_mps || !m->posed.node) return STATUS_NO_MEMORY;
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

static Status find_place(VehicleMoment *m, const VehicleHeat *h, double unix_s, bool present)
{
    const Status status = find_ground(m, h, unix_s, present);
    if (status == STATUS_OK) patch_view_sun(m->lit, &m->pose, m->place.sun_d_enu);
    return status;
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

static const double turned_cos = 0.985; /* 10 degrees */

static bool joints_moved(const VehicleMoment *m, const VehicleState *s)
{
    static const double moved = 0.17; /* rad, m */
    for (int n = 0; n < m->model->node_count; n++) {
        const ModelNode *node = &m->model->node[n];
        if (node->spin_rps_moving != 0 || node->roll_radius_m > 0) continue;
        if (fabs(m->joint[n] - s->joint[n]) > moved) return true;
    }
    return false;
}

static void up_in_body(double up_body[3], const double r_enu_from_body[9])
{
    for (int k = 0; k < 3; k++) up_body[k] = r_enu_from_body[6 + k];
}

static void ahead_in_enu(double ahead_enu[3], const double r_enu_from_body[9])
{
    for (int k = 0; k < 3; k++) ahead_enu[k] = r_enu_from_body[3 * k];
}

/* Whether the views of an entity are of this pose. */
static bool sees_as(const VehicleState *s, const VehicleMoment *m)
{
    static const double near_m = 0.3, high_m = 1.5; /* above it nothing is under it: patch_view.c */
    double              up_body[3];
    up_in_body(up_body, m->pose.r_enu_from_body);
    const double above_m = fmin(m->place.above_m, high_m), viewed_m = fmin(s->view_above_m, high_m);
    return v3_dot(up_body, s->view_up_body) >= turned_cos && fabs(above_m - viewed_m) <= near_m && !joints_moved(m, s);
}

static void stay(VehicleState *s, const VehicleMoment *m, double t_s)
{
    s->t_s    = t_s;
    s->drives = m->entity->drives;
    s->ground_k = m->place.ground_k;
    ahead_in_enu(s->ahead_enu, m->pose.r_enu_from_body);
    up_in_body(s->up_body, m->pose.r_enu_from_body);
}

static bool differs(double a, double b, double share, double least) { return fabs(a - b) > fmax(share * fmax(fabs(a), fabs(b)), least); }

/* Whether what heats it has changed so that its step must end. */
static bool drives_changed(const EntityDrives *a, const EntityDrives *b)
{
    return differs((double)a->engine, (double)b->engine, 0, 0.05) || differs((double)a->speed_mps, (double)b->speed_mps, 0.1, 1) ||
           a->burning != b->burning || a->motor != b->motor || a->flare != b->flare || a->alive != b->alive ||
           a->flying != b->flying || a->fired_kg[0] != b->fired_kg[0] || a->fired_kg[1] != b->fired_kg[1];
}

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
    return STATUS_OK;
}

/* ---- work, in pieces ---------------------------------------------------------------------- */

/* A day without its engine, an hour as it is now: steps that shorten towards the present. */
static const double past_span_s[] = {10800, 10800, 10800, 10800, 7200, 7200, 7200, 3600, 3600, 3600, 3600, 3600, 120, 480,
                                     900, 900, 600, 300, 300};
enum { past_steps = sizeof past_span_s / sizeof *past_span_s };

/* What pieces cost, microseconds of one core of 2024: units of account, so that every machine does the same work at the
 * same time (`bench speed` holds them against the clock). */
static const double look_us = 45; /* of a patch */

static double past_us(const VehicleShape *shape) { return 2.0 * shape->patches->count + 0.6 * shape->nodes; }

static double advance_us(const VehicleShape *shape) { return 3.0 * shape->patches->count + shape->nodes; }

static int window_place(double tick) { return ((int)fmod(tick, window_ticks) + window_ticks) % window_ticks; }

static void open_window(VehicleHeat *h, double t_s)
{
    const double tick = floor(t_s * 100 + 0.5);
    h->metered = h->metered || (h->started && tick != h->tick);
    h->started = true;
    if (tick - h->tick >= window_ticks) memset(h->spent_us, 0, sizeof h->spent_us);
    for (double k = fmax(h->tick + 1, tick - window_ticks + 1); k <= tick; k++) h->spent_us[window_place(k)] = 0;
    h->tick = tick;
}

/* Whether there is room for a piece in this tick; in an empty window there always is. */
static bool take(VehicleHeat *h, double us)
{
    double spent_us = 0;
    for (int k = 0; k < window_ticks; k++) spent_us += h->spent_us[k];
    if (h->metered && spent_us > 0 && spent_us + us > h->config.window_us) return false;
    h->spent_us[window_place(h->tick)] += us;
    return true;
}

/* Drives d for span_s, from loads of the middle of that. */
static Status live_through(VehicleHeat *h, VehicleState *s, VehicleMoment *m, const EntityDrives *d, double middle_s, double span_s)
{
    double      *scratch = arena_alloc(h->arena, (size_t)m->shape->nodes, sizeof *scratch);
    const Status status = scratch ? find_place(m, h, h->config.unix_s + middle_s, false) : STATUS_NO_MEMORY;
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
    const Status status = span_s > 0 ? live_through(h, s, m, &s->drives, since_s + (s->lived + 0.5) * span_s, span_s) : STATUS_OK;
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
        status = live_through(h, s, m, &d, s->seen_s - before_s + (k + 0.5) * span_s, span_s);
    s->lived++;
    return status;
}

/* The past is over: it is shown from now on. */
static Status appear(VehicleHeat *h, VehicleState *s, VehicleMoment *m, double t_s)
{
    const Status status = find_place(m, h, h->config.unix_s + t_s, true);
    if (status != STATUS_OK) return status;
    if (snapshot_is_short_lived(m->entity)) {
        const double speed_mps = v3_length(m->v_enu_mps);
        for (int n = 0; n < m->shape->nodes; n++)
            s->temp_k[n] = m->place.air_k + vehicle_recovery_k(speed_mps);
    }
    stay(s, m, t_s);
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
    s->looked = 0;
    s->view_above_m = m->place.above_m;
    up_in_body(s->view_up_body, m->pose.r_enu_from_body);
    memcpy(s->joint, m->joint, (size_t)m->model->node_count * sizeof *s->joint);
    for (int i = 0; i < h->count; i++) {
        const VehicleState *o = h->state[i];
        if (o == s || o->model != s->model || o->looked < patches || !sees_as(o, m)) continue;
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
    const Status        status = load && scratch ? find_place(m, h, h->config.unix_s + t_s, true) : STATUS_NO_MEMORY;
    if (status != STATUS_OK) return status;
    if (!s->changed) vehicle_loads(load, m, s->view, s->temp_k, d);
    step(h, s, s->temp_k, &s->heat_in_j, &s->drives, s->load, s->changed ? s->load : load, t_s - s->t_s, scratch);
    take_shots(h, s, d);
    stay(s, m, t_s);
    vehicle_loads(s->load, m, s->view, s->temp_k, d);
    s->span_s = s->changed ? h->config.first_step_s : fmin(2 * s->span_s, h->config.step_s);
    s->changed = false;
    if (!sees_as(s, m)) start_looking(s, m, h);
    return predict(h, s, m);
}

/* As much as there is room for of what waits: a step, views, the past. */
static Status work_on(VehicleHeat *h, VehicleState *s, const Snapshot *snapshot, int index)
{
    const double        t_s = snapshot->t_s;
    const VehicleShape *shape = &h->shape[s->model];
    const int           patches = shape->patches->count;
    VehicleMoment              m;
    arena_reset(h->arena);
    Status status = catch_moment(&m, h, snapshot, index);
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

/* Whether an entity has work to wait for. */
static bool is_due(VehicleState *s, const VehicleHeat *h, const SnapshotEntity *e, double t_s)
{
    double r_enu_from_body[9], ahead_enu[3], up_body[3];
    if (!s->shown) return true;
    m3_tmul(r_enu_from_body, h->world.frame->r_ecef_from_enu, e->r_ecef_from_body);
    ahead_in_enu(ahead_enu, r_enu_from_body);
    up_in_body(up_body, r_enu_from_body);
    s->changed = s->changed || drives_changed(&s->drives, &e->drives) || v3_dot(ahead_enu, s->ahead_enu) < turned_cos ||
                 v3_dot(up_body, s->up_body) < turned_cos;
    return s->changed || t_s >= s->next_s || s->looked < h->shape[s->model].patches->count;
}

/* Those that have waited longest, first. */
static int by_wait(const void *a, const void *b)
{
    const VehicleState *p = ((const Due *)a)->state, *q = ((const Due *)b)->state;
    if (p->waits_s != q->waits_s) return p->waits_s < q->waits_s ? -1 : 1;
    return dis_entity_id_compare(p->id, q->id);
}

/* Of all parts of a body, what names one the closest. */
static void find_given(VehicleState *s, const VehicleHeat *h)
{
    const Patches *patches = h->shape[s->model].patches;
    const Model   *model = tracer_model(h->world.tracer, s->model);
    int            best[patches_most];
    for (int i = 0; i < patches->count; i++) s->given[i] = best[i] = -1;
    for (int part = 0; h->world.given && part < model->part_count; part++) {
        const int body = patches->body_of_part[part], first = patches->first_of_body[body], end = patches->first_of_body[body + 1];
        int       rank;
        const int found = given_heat_find(&rank, h->world.given, s->id, model, part);
        if (first == end || rank <= best[first]) continue;
        best[first] = rank;
        for (int i = first; i < end; i++) s->given[i] = found;
    }
}

static Status first_sight(VehicleState **out, const VehicleHeat *h, const SnapshotEntity *e, double t_s)
{
    VehicleState *s = new_state(&h->shape[e->model], tracer_model(h->world.tracer, e->model));
    if (!s) return STATUS_NO_MEMORY;
    s->id = e->id, s->since_s = e->drives.since_s, s->model = e->model;
    s->drives = e->drives;
    s->seen_s = t_s, s->waits_s = INFINITY, s->looked = -1;
    find_given(s, h);
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
    Due *due = also ? realloc(h->due, (size_t)room * sizeof *due) : NULL;
    if (also) h->was = also;
    if (!due) return STATUS_NO_MEMORY;
    h->due = due, h->room = room;
    return STATUS_OK;
}

static bool is_same(const VehicleState *s, const SnapshotEntity *e)
{
    return s->since_s == e->drives.since_s && s->model == e->model;
}

Status vehicle_heat_tick(VehicleHeat *h, const Snapshot *snapshot)
{
    const double began_s = wall_clock_s();
    Status       status = make_room(h, snapshot->count < h->config.capacity ? snapshot->count : h->config.capacity);
    if (status != STATUS_OK) return status;
    VehicleState **was = h->was;
    const int      before = h->count;
    if (before > 0) memcpy(was, h->state, (size_t)before * sizeof *was);
    h->count = 0;
    int at = 0, due = 0;
    for (int i = 0; i < snapshot->count; i++) {
        const SnapshotEntity *e = &snapshot->entity[i];
        VehicleState         *s = NULL;
        while (at < before && dis_entity_id_compare(was[at]->id, e->id) < 0) free(was[at++]);
        if (at < before && dis_entity_id_compare(was[at]->id, e->id) == 0) {
            s = was[at++];
            if (!is_same(s, e)) free(s), s = NULL;
        }
        if (e->model < 0 || e->model >= h->models || !catalog_has_shape(h->world.catalog, e->model) ||
            h->count == h->config.capacity) {
            h->counters.left_out += h->count == h->config.capacity;
            free(s);
            continue;
        }
        if (!s && status == STATUS_OK) status = need_shape(h, e->model);
        if (!s && status == STATUS_OK && h->shape[e->model].patches->count > 0) status = first_sight(&s, h, e, snapshot->t_s);
        if (!s) continue;
        h->state[h->count++] = s;
        if (!is_due(s, h, e, snapshot->t_s)) continue;
        s->waits_s = fmin(s->waits_s, snapshot->t_s);
        h->due[due++] = (Due){s, i};
    }
    while (at < before) free(was[at++]);
    if (due > 1) qsort(h->due, (size_t)due, sizeof *h->due, by_wait);
    open_window(h, snapshot->t_s);
    h->waiting = 0;
    for (int i = 0; i < due && status == STATUS_OK; i++) {
        if (h->waiting == 0) status = work_on(h, h->due[i].state, snapshot, h->due[i].index);
        h->waiting += h->due[i].state->waits_s < INFINITY;
    }
    const double spent_s = wall_clock_s() - began_s;
    h->counters.spent_s += spent_s;
    h->counters.longest_s = fmax(h->counters.longest_s, spent_s);
    return status;
}

static const VehicleState *find_state(const VehicleHeat *h, DisEntityId id)
{
    int low = 0, high = h->count;
    while (low < high) {
        const int middle = low + (high - low) / 2, order = dis_entity_id_compare(h->state[middle]->id, id);
        if (order == 0) return h->state[middle];
        if (order < 0) low = middle + 1;
        else high = middle;
    }
    return NULL;
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
        const float share = s->next_s > s->t_s ? (float)clamp((snapshot->t_s - s->t_s) / (s->next_s - s->t_s), 0, 1) : 0;
        e->first_patch = snapshot->patch_count;
        for (int k = 0; k < count; k++) patch_k[e->first_patch + k] = s->now_k[k] + share * (s->next_k[k] - s->now_k[k]);
        for (int k = 0; k < count; k++)
            if (s->given[k] >= 0) patch_k[e->first_patch + k] = (float)given_heat_k(h->world.given, s->given[k], snapshot->t_s);
        e->patches = count;
        e->dt_k = (float)(mean_of(h->shape[s->model].patches, patch_k + e->first_patch) - s->ground_k);
        snapshot->patch_count += count;
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
