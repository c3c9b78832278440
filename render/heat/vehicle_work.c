/* render/heat/vehicle_work.c: the work on one entity, in pieces: its views, its past, its steps; and the account of
 * it. */
#include "render/heat/vehicle_heat_private.h"

/* ---- the account of work --------------------------------------------------------------------- */

static int place_of(double tick) { return ((int)fmod(tick, window_ticks) + window_ticks) % window_ticks; }

void work_window_open(WorkWindow *w, double t_s)
{
    const double tick = floor(t_s * 100 + 0.5);
    w->metered = w->metered || (w->started && tick != w->tick);
    w->started = true;
    if (tick - w->tick >= window_ticks) memset(w->spent_us, 0, sizeof w->spent_us);
    for (double k = fmax(w->tick + 1, tick - window_ticks + 1); k <= tick; k++) w->spent_us[place_of(k)] = 0;
    w->tick = tick;
}

/* Whether there is room for a piece in this tick; then it is counted. */
static bool work_window_take(WorkWindow *w, double us, double limit_us)
{
    double spent_us = 0;
    for (int k = 0; k < window_ticks; k++) spent_us += w->spent_us[k];
    if (w->metered && spent_us > 0 && spent_us + us > limit_us) return false;
    w->spent_us[place_of(w->tick)] += us;
    return true;
}

/* Counts what a piece that is done came to beyond that. */
static void work_window_spend(WorkWindow *w, double us) { w->spent_us[place_of(w->tick)] += us; }

/* ---- work, in pieces ---------------------------------------------------------------------- */

/* What pieces cost, microseconds of one core of 2024: units of account, so that every machine does the same work at the
 * same time (`bench speed` holds them against the clock). */
static const double look_us = 45;                   /* of a patch */
static const double pose_us = 10, jet_us = 60;      /* of a neighbour: posed; its exhaust followed */
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
    m->node = arena_alloc(h->arena, (size_t)m->model->node_count, sizeof *m->node);
    m->joint = arena_alloc(h->arena, (size_t)m->model->node_count, sizeof *m->joint);
    m->lit = arena_alloc(h->arena, (size_t)m->shape->patches->count + 1, sizeof *m->lit);
    m->gas_k = arena_alloc(h->arena, (size_t)m->shape->patches->count + 1, sizeof *m->gas_k);
    m->gas_mps = arena_alloc(h->arena, (size_t)m->shape->patches->count + 1, sizeof *m->gas_mps);
    m->sent_w_m2 = arena_alloc(h->arena, (size_t)m->shape->patches->count + 1, sizeof *m->sent_w_m2);
    m->posed.node =
        arena_alloc(h->arena, (size_t)parts_node_count(h->world.tracer, e->model) + 1, sizeof *m->posed.node);
    if (!m->node || !m->joint || !m->lit || !m->gas_k || !m->gas_mps || !m->sent_w_m2 || !m->posed.node)
        return STATUS_NO_MEMORY;
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
    m->pose.posed = &m->posed;
    m->pose.above_m = m->place.above_m;
    return status;
}

/* Fills in the place of an entity with its sun and its neighbours. t_s: exercise time. lately: engines run as now. */
static Status find_place(VehicleMoment *m, VehicleHeat *h, const VehicleState *s, double t_s, bool present, bool lately)
{
    NearWork work = {0};
    Status   status = find_ground(m, h, h->config.unix_s + t_s, present);
    if (status == STATUS_OK && h->near.count > 1 && !h->config.alone)
        status = vehicle_near_moment(&work, m, &h->near, vehicle_state_find(h->state, h->count, s->id), t_s, !present,
                                     lately, h->arena);
    if (status != STATUS_OK) return status;
    const size_t     octets = (size_t)m->shape->patches->count * sizeof *m->lit;
    const KnownViews seen =
        view_memory_of(h->world.patches->seen, &m->pose, m->shade, m->shades, m->place.sun_d_enu, sizeof *m->lit);
    if (seen.known && *seen.known) {
        memcpy(m->lit, seen.record, octets);
    } else {
        vehicle_view_sun(m->lit, &m->pose, m->place.sun_d_enu, m->shade, m->shades);
        if (seen.known) *seen.known = true, memcpy(seen.record, m->lit, octets);
    }
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
    if (heat_network_step(scratch, &in_j, shape->network, from, to, dt_s) != STATUS_OK ||
        !is_sound(scratch, shape->nodes)) {
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

/* Predicts the temperatures at the entity's next own time from its present loads. */
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
static const double past_span_s[] = {10800, 10800, 10800, 10800, 7200, 7200, 7200, 3600, 3600, 3600,
                                     3600,  3600,  120,   480,   900,  900,  600,  300,  300};
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
    if (heat_network_leap(scratch, m->shape->network, s->load, span_s) == STATUS_OK &&
        is_sound(scratch, m->shape->nodes))
        memcpy(s->temp_k, scratch, octets);
    else step(h, s, s->temp_k, NULL, d, s->load, s->load, span_s, scratch);
    return STATUS_OK;
}

/* Those of a run before, if they are recent; NULL: there are none. */
static const KeptNodes *kept_of(const VehicleHeat *h, const VehicleState *s)
{
    static const double longest_s = 10800;
    if (!h->world.kept) return NULL;
    const KeptNodes *k =
        heat_kept_find(h->world.kept, s->id, tracer_model(h->world.tracer, s->model)->name, h->shape[s->model].nodes);
    const double gap_s = k ? h->config.unix_s + s->seen_s - k->unix_s : 0;
    return k && gap_s >= 0 && gap_s <= longest_s ? k : NULL;
}

/* Steps an entity from kept temperatures until now, in as many steps as a past has. */
static Status live_since(VehicleHeat *h, VehicleState *s, VehicleMoment *m, const KeptNodes *kept)
{
    const double since_s = kept->unix_s - h->config.unix_s, span_s = (s->seen_s - since_s) / past_steps;
    if (!(s->temp_k[0] > 0)) memcpy(s->temp_k, kept->temp_k, (size_t)kept->nodes * sizeof *s->temp_k);
    const double middle_s = since_s + (s->lived + 0.5) * span_s;
    const Status status = span_s > 0 ? live_through(h, s, m, &s->drives, middle_s, span_s, true) : STATUS_OK;
    s->lived++;
    return status;
}

/* Steps an entity through one span of its past. */
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
        for (int n = 0; n < m->shape->nodes; n++) s->temp_k[n] = m->place.air_k + vehicle_recovery_k(speed_mps);
    }
    vehicle_state_stay(s, m, t_s);
    vehicle_loads(s->load, m, s->view, s->temp_k, &s->drives);
    s->span_s = h->config.first_step_s;
    s->shown = true;
    h->counters.begun++;
    return predict(h, s, m);
}

/* Begins the views of this pose: copies those of another entity of its model that is posed alike, or has none yet. */
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

/* Finds what an entity's patches see, or remembers it. False: the work budget has no room for all of it. */
static bool look(VehicleHeat *h, VehicleState *s, const VehicleMoment *m)
{
    const int  patches = m->shape->patches->count;
    KnownViews seen = {NULL, NULL};
    if (s->looked < patches) seen = view_memory_of(h->world.patches->seen, &m->pose, NULL, 0, NULL, sizeof *s->view);
    for (; s->looked < patches; s->looked++) {
        const int i = s->looked;
        char     *record = seen.known ? seen.record + (size_t)i * sizeof *s->view : NULL;
        if (!take(h, look_us)) return false;
        if (record && seen.known[i]) {
            memcpy(&s->view[i], record, sizeof *s->view);
            continue;
        }
        vehicle_view_look(&s->view[i], &m->pose, i);
        if (record) seen.known[i] = true, memcpy(record, &s->view[i], sizeof *s->view);
    }
    return true;
}

/* Finds what the neighbours hide of an entity's views. False: the work budget has no room for all of it. */
static bool look_about(Status *status, VehicleHeat *h, VehicleState *s, const VehicleMoment *m)
{
    const PatchPose *pose[near_seen_most];
    if (*status != STATUS_OK || !vehicle_near_waits(s, m->shape)) return true;
    if (!take(h, pose_us * s->near->next_seen)) return false;
    *status = vehicle_near_pose(pose, &h->near, s, m, h->arena);
    const PosedEntity *posed[near_seen_most];
    for (int k = 0; k < s->near->next_seen && *status == STATUS_OK; k++) posed[k] = pose[k] ? pose[k]->posed : NULL;
    KnownViews seen = {NULL, NULL};
    if (*status == STATUS_OK)
        seen = view_memory_of(h->world.patches->seen, &m->pose, posed, s->near->next_seen, NULL, sizeof(NearView));
    while (*status == STATUS_OK && vehicle_near_waits(s, m->shape)) {
        if (!take(h, near_us + near_fill_us * s->near->fill)) return false;
        vehicle_near_look(s, m, pose, &seen);
    }
    return true;
}

/* Does as much of the waiting work as the budget has room for: a step, views, the past. */
Status vehicle_work_on(VehicleHeat *h, VehicleState *s)
{
    const double        t_s = h->near.snapshot->t_s;
    const VehicleShape *shape = &h->shape[s->model];
    VehicleMoment       m;
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
    if (status == STATUS_OK && !look(h, s, &m)) return STATUS_OK;
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
