/* render/heat/scenery_states.c: the heat of clutter: one entity of vehicle_heat.h for each state (scenery_heat.h). */
#include "render/heat/scenery_heat_private.h"

#include <stdlib.h>

static const double apart_m = 1e5;    /* no neighbours */
static const double tick_s = 1;       /* of exercise time */
static const double window_us = 1000; /* of work in 0.1 s of exercise time, once the exercise has begun */

/* ---- what is about them ------------------------------------------------------------------------ */

/* The slot of a time: a table by its bits. */
static TimedPlace *slot_of(SceneryStates *s, double unix_s)
{
    uint64_t bits;
    memcpy(&bits, &unix_s, sizeof bits);
    bits *= UINT64_C(0x9E3779B97F4A7C15);
    return &s->place[bits >> 56];
}

/* Open level grass, whatever the place. */
static Status place_there(PlaceHeat *out, const void *user, double unix_s, const double p_enu[3], bool present)
{
    SceneryStates           *s = (SceneryStates *)user; /* what it remembers alone changes */
    const SceneryHeatConfig *c = s->config;
    TimedPlace              *at = slot_of(s, unix_s);
    _Static_assert(times_kept == 1 << 8, "as many as eight bits say");
    (void)p_enu;
    if (at->unix_s != unix_s) {
        GroundWeather w;
        c->heat.weather(&w, unix_s, c->heat.user);
        at->place = (PlaceHeat){.air_k = w.air.temp_k,
                                .air_density = 1,
                                .direct_w_m2 = w.direct_w_m2,
                                .diffuse_w_m2 = w.diffuse_w_m2,
                                .longwave_w_m2 = w.longwave_w_m2,
                                .ground_rho = 1 - c->ground->kind[SURFACE_GRASS].absorptance,
                                .water_k = fmax(w.air.temp_k, 273.15)};
        memcpy(at->place.sun_d_enu, w.sun_d_enu, sizeof w.sun_d_enu);
        if (c->wind) c->wind(at->place.wind_enu_mps, unix_s, c->heat.user);
        at->unix_s = unix_s;
    }
    *out = at->place;
    const WallsTable *t = s->walls->table;
    const double      share = scenery_walls_share(s->walls, unix_s);
    out->ground_k = out->under_k = out->air_k;
    if (!present) return STATUS_OK;
    out->ground_k = t[0].about_k[about_grass] + share * (t[1].about_k[about_grass] - t[0].about_k[about_grass]);
    out->under_k = t[0].about_k[about_hidden] + share * (t[1].about_k[about_hidden] - t[0].about_k[about_hidden]);
    return STATUS_OK;
}

/* ---- life -------------------------------------------------------------------------------------- */

/* Rows of the parts of the models that have states. */
static Status find_rows(SceneryStates *s, const bool *needed)
{
    const Scenery   *scenery = s->scenery;
    const Materials *from = s->config->materials;
    s->materials = *from;
    s->materials.damaged = NULL, s->materials.parts = NULL;
    s->materials.model_count = scenery->models;
    s->materials.part = calloc((size_t)scenery->models + 1, sizeof *s->materials.part);
    if (!s->materials.part) return STATUS_NO_MEMORY;
    for (int m = 0; m < scenery->models; m++) {
        const Model *model = &scenery->model[m];
        if (!needed[m]) continue;
        s->materials.part[m] = calloc((size_t)model->part_count + 1, sizeof(int));
        if (!s->materials.part[m]) return STATUS_NO_MEMORY;
        for (int p = 0; p < model->part_count; p++) {
            const int row = materials_find(from, model->part[p].material);
            if (row < 0) {
                log_error("scenery: %s: part %s is of %s, which is no row of etc/materials.csv", model->name,
                          model->part[p].name, model->part[p].material);
                return STATUS_BAD_VALUE;
            }
            s->materials.part[m][p] = row;
        }
    }
    return STATUS_OK;
}

static void place_entity(SceneryStates *s, int k, int first_node)
{
    const SceneryState *state = &s->scenery->state[k];
    const LocalFrame   *frame = s->config->frame;
    SnapshotEntity     *e = &s->entity[k];
    const double        north = cos((double)state->heading_rad), east = sin((double)state->heading_rad);
    const double        r_enu_from_body[9] = {east, north, 0, north, -east, 0, 0, 0, -1};
    const double        at_enu[3] = {apart_m * k, 0, 0},
                 v_enu[3] = {east * (double)state->drives.speed_mps, north * (double)state->drives.speed_mps, 0};
    *e = (SnapshotEntity){.id = {1, 1, (uint16_t)(k + 1)},
                          .type = {.kind = 1, .domain = 1},
                          .model = state->model,
                          .first_node = first_node,
                          .first_patch = -1,
                          .drives = state->drives};
    e->drives.since_s = 0;
    ecef_from_enu(e->p_ecef, frame, at_enu);
    m3_mul_v3(e->v_ecef_mps, frame->r_ecef_from_enu, v_enu);
    m3_mul(e->r_ecef_from_body, frame->r_ecef_from_enu, r_enu_from_body);
    model_pose(s->node + first_node, &s->scenery->model[state->model], NULL);
}

static Status tick(SceneryStates *s, double t_s)
{
    s->snapshot.t_s = s->at_s = t_s;
    return vehicle_heat_tick(s->heat, &s->snapshot);
}

static int by_time(const void *a, const void *b)
{
    const double p = *(const double *)a, q = *(const double *)b;
    return p < q ? -1 : p > q;
}

/* Times up to 0: dense where an engine stops. Returns how many; out NULL: counts. */
static int begin_times(double *out, const Scenery *scenery)
{
    static const double first_s = 2, growth = 1.5;
    int                 count = 0;
    for (int k = 0; k < scenery->states; k++) {
        double t_s = -(double)scenery->state[k].stood_s;
        for (double step_s = first_s; t_s < 0; t_s += step_s, step_s *= growth, count++)
            if (out) out[count] = t_s;
    }
    if (out) out[count] = 0, qsort(out, (size_t)count + 1, sizeof *out, by_time);
    return count + 1;
}

/* Those whose engine stopped before the exercise run until then, and cool from there; the others begin with it. */
static Status begin(SceneryStates *s)
{
    const Scenery  *scenery = s->scenery;
    SnapshotEntity *seen = s->snapshot.entity;
    const int       times = begin_times(NULL, scenery);
    double         *time_s = malloc((size_t)times * sizeof *time_s);
    Status          status = time_s ? STATUS_OK : STATUS_NO_MEMORY;
    if (status == STATUS_OK) begin_times(time_s, scenery);
    for (int i = 0; i < times && status == STATUS_OK; i++) {
        if (i > 0 && time_s[i] == time_s[i - 1]) continue;
        s->snapshot.count = 0;
        for (int k = 0; k < scenery->states; k++) {
            const double stopped_s = time_s[i] + (double)scenery->state[k].stood_s;
            if (stopped_s < 0) continue;
            SnapshotEntity *e = &seen[s->snapshot.count++];
            *e = s->entity[k];
            if (scenery->state[k].stood_s > 0 && stopped_s > 0) e->drives.engine = 0;
        }
        status = tick(s, time_s[i]);
    }
    free(time_s);
    return status;
}

static Status restart(SceneryStates *s)
{
    const SceneryHeatConfig *c = s->config;
    const VehicleHeatConfig  config = {.first_step_s = tick_s,
                                       .step_s = clutter_step_s,
                                       .window_us = INFINITY,
                                       .unix_s = c->heat.unix_s,
                                       .capacity = scenery_most_states,
                                       .alone = true,
                                       .place = place_there,
                                       .user = s};
    const VehicleHeatWorld   world = {
          .materials = &s->materials, .table = c->parts, .frame = c->frame, .tracer = s->tracer, .patches = &s->patches};
    vehicle_heat_destroy(s->heat);
    s->heat = NULL;
    for (int k = 0; k < times_kept; k++) s->place[k].unix_s = NAN;
    Status status = vehicle_heat_create(&s->heat, &config, &world);
    if (status == STATUS_OK) status = begin(s);
    if (status == STATUS_OK) vehicle_heat_limit(s->heat, window_us);
    return status;
}

Status scenery_states_open(SceneryStates *s, SceneryWalls *walls)
{
    const Scenery *scenery = s->scenery;
    bool          *needed = calloc((size_t)scenery->models + 1, sizeof *needed);
    const Model  **model = calloc((size_t)scenery->models + 1, sizeof *model);
    int            nodes = 0;
    Status         status = needed && model ? STATUS_OK : STATUS_NO_MEMORY;
    s->walls = walls;
    if (scenery->states == 0 || status != STATUS_OK) goto done;
    for (int k = 0; k < scenery->states; k++) {
        const int m = scenery->state[k].model;
        needed[m] = true, model[m] = &scenery->model[m];
        nodes += scenery->model[m].node_count;
    }
    s->entity = calloc((size_t)scenery->states, sizeof *s->entity);
    s->snapshot.entity = calloc((size_t)scenery->states, sizeof *s->snapshot.entity);
    s->node = calloc((size_t)nodes + 1, sizeof *s->node);
    s->place = calloc(times_kept, sizeof *s->place);
    if (!s->entity || !s->snapshot.entity || !s->node || !s->place) status = STATUS_NO_MEMORY;
    s->snapshot.node = s->node;
    for (int k = 0, first = 0; k < scenery->states && status == STATUS_OK; k++) {
        place_entity(s, k, first);
        first += scenery->model[scenery->state[k].model].node_count;
    }
    if (status == STATUS_OK) status = find_rows(s, needed);
    if (status == STATUS_OK) status = tracer_create_models(&s->tracer, model, scenery->models, s->config->isa);
    if (status == STATUS_OK) status = heat_patches_create(&s->patches, scenery->models);
    s->patches.cache = s->config->heat.cache;
    if (status == STATUS_OK) status = restart(s);
done:
    free(needed);
    free(model);
    return status;
}

void scenery_states_close(SceneryStates *s)
{
    vehicle_heat_destroy(s->heat);
    heat_patches_destroy(&s->patches);
    tracer_destroy(s->tracer);
    for (int m = 0; s->materials.part && m < s->materials.model_count; m++) free(s->materials.part[m]);
    free(s->materials.part), free(s->node), free(s->entity), free(s->snapshot.entity), free(s->place);
    *s = (SceneryStates){0};
}

/* ---- now --------------------------------------------------------------------------------------- */

Status scenery_states_advance(SceneryStates *s, SceneryWalls *walls, double unix_s)
{
    const double t_s = unix_s - s->config->heat.unix_s;
    Status       status = STATUS_OK;
    if (!s->heat) return STATUS_OK;
    if (t_s < s->at_s && s->at_s > 0) {
        scenery_walls_advance(walls, s->config->heat.unix_s);
        status = restart(s);
    }
    while (status == STATUS_OK && s->at_s + tick_s <= t_s) {
        const double next_s = floor(s->at_s / tick_s + 1) * tick_s;
        scenery_walls_advance(walls, s->config->heat.unix_s + next_s);
        status = tick(s, next_s);
    }
    return status;
}

Status scenery_states_show(float **patch_k, int **first, SceneryStates *s, double unix_s, Arena *arena)
{
    const int states = s->scenery->states;
    Snapshot  show = s->snapshot;
    *patch_k = NULL, *first = NULL;
    if (!s->heat) return STATUS_OK;
    *first = arena_alloc(arena, (size_t)states + 1, sizeof **first);
    if (!*first) return STATUS_NO_MEMORY;
    show.t_s = fmax(unix_s - s->config->heat.unix_s, s->at_s);
    const Status status = vehicle_heat_show(s->heat, &show, arena);
    if (status != STATUS_OK) return status;
    for (int k = 0; k < states; k++) (*first)[k] = show.entity[k].first_patch;
    *patch_k = show.patch_k;
    return STATUS_OK;
}

size_t scenery_states_bytes(const SceneryStates *s) { return s->heat ? vehicle_heat_bytes(s->heat) : 0; }
