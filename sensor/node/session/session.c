/* sensor/node/session/session.c: the seeker of one host: frames rendered, passed to consumers, and listed. */
#include "sensor/node/session/session_private.h"

#include "sensor/frame/frame_world.h"

#include <errno.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

const char *const session_stage_name[session_stages] = {"frame", "snapshot", "visibility", "shade", "radar", "publish"};

/* ---- its state, at the beginning -------------------------------------------------------------------- */

static void list_frame(void *user, const Frame *frame);

/* Reads the ground marks of what stood and drove before a restart. */
static Status read_marks(Session *s)
{
    const char *path = s->shared->config->heat.marks;
    if (!*path || access(path, F_OK) != 0) return STATUS_OK;
    return entity_table_marks_load(s->table, s->shared->unix_s, path);
}

/* Opens the temperatures of entities; without a band that shows temperatures there are none. */
static Status open_vehicles(Session *s)
{
    const SessionShared *shared = s->shared;
    if (!shared->world->heat) return STATUS_OK;
    s->vehicle_arena = arena_create();
    if (!s->vehicle_arena) return STATUS_NO_MEMORY;
    const char *given = shared->config->heat.given;
    const char *kept = shared->config->heat.vehicles;
    Status      status = *given ? given_heat_open(&s->given, given) : STATUS_OK;
    if (status == STATUS_OK && *kept && access(kept, F_OK) == 0) status = heat_kept_open(&s->kept, kept);
    if (status != STATUS_OK) return status;
    return world_vehicles_create(&s->vehicles, shared->world,
                                 &(WorldVehiclesConfig){.step_s = shared->config->heat.vehicle_step_s,
                                                        .window_us = vehicle_window_us,
                                                        .given = s->given,
                                                        .kept = s->kept});
}

static Status open_radar(Session *s)
{
    const SessionShared *shared = s->shared;
    if (strcmp(shared->config->radar.preset, "none") == 0) return STATUS_OK;
    return frame_radar_open(&s->radar, shared->config, shared->isa, shared->live);
}

static Status open_session(Session *s)
{
    const SessionShared *shared = s->shared;
    EntityTableConfig    table = entity_table_default_config();

    table.pool = shared->pool;
    table.capacity = shared->config->entities.capacity;
    table.shown = shared->config->entities.shown;
    table.new_per_s = shared->config->entities.new_per_s;
    table.timeout_s = shared->config->entities.timeout_s;
    table.timeout_land_v7_s = shared->config->entities.timeout_land_v7_s;
    table.extrapolation_limit_s = shared->config->entities.extrapolation_limit_s;
    if (shared->contact != GROUND_CONTACT_NONE)
        table.ground = (ContactGround){
            .frame = &shared->world->frame,
            .elevation = &shared->world->landscape->elevation,
            .landscape = shared->contact == GROUND_CONTACT_INCONSISTENT ? shared->world->landscape : NULL};
    s->given_up_reported_s = s->left_out_reported_s = -INFINITY;
    s->tick = (int64_t)ceil(s->plan.start_s * seeker_ticks_per_s);
    memcpy(s->p_aim_ecef, s->plan.p_aim_ecef, sizeof s->p_aim_ecef);
    const bool observes = dis_entity_id_is_none(s->plan.host) && !s->plan.any_munition;
    Status     status = observes ? session_host_observer(&s->host, s) : session_host_entity(&s->host, s);
    if (status == STATUS_OK) status = entity_table_create(&s->table, &table, shared->catalog);
    if (status == STATUS_OK) status = read_marks(s);
    if (status == STATUS_OK) status = open_vehicles(s);
    if (status == STATUS_OK) status = open_radar(s);
    if (status == STATUS_OK) status = frame_verdicts_read(&s->verdicts, shared->notes);
    if (status == STATUS_OK) session_keep(s);
    if (status == STATUS_OK) status = sensors_chains(s->chain, shared->sensors, shared->config);
    return status == STATUS_OK ? session_consumers(s, list_frame) : status;
}

Status session_open(Session **out, const SessionShared *shared, const HostPlan *plan, Player *player,
                    const char *folder)
{
    char     earlier[frame_path_size];
    Session *s = calloc(1, sizeof *s);
    if (!s) return STATUS_NO_MEMORY;
    s->shared = shared;
    s->fed_s = -INFINITY;
    s->plan = *plan;
    s->player = player;
    Status status = STATUS_OK;
    if (snprintf(s->out, sizeof s->out, "%s", folder) >= (int)sizeof s->out) status = STATUS_BAD_VALUE;
    if (status == STATUS_OK) status = open_session(s);
    if (status == STATUS_OK && !frame_files_earlier(earlier, s->out)) status = session_begin_files(s);
    s->opened = status == STATUS_OK;
    if (s->opened) *out = s;
    else session_close(s, NULL);
    return status;
}

/* ---- frame after frame ------------------------------------------------------------------------------ */

static Status room_in_lists(SessionResult *r, int *capacity)
{
    if (r->listed < *capacity) return STATUS_OK;
    const int larger = *capacity ? 2 * *capacity : 1024;
    int(*numbers) = realloc(r->number, (size_t)larger * sizeof *numbers);
    if (numbers) r->number = numbers;
    char(*hash)[sha256_text_size] = realloc(r->hash, (size_t)larger * sizeof *hash);
    if (hash) r->hash = hash;
    double(*stage_ms)[session_stages] = realloc(r->stage_ms, (size_t)larger * sizeof *stage_ms);
    if (stage_ms) r->stage_ms = stage_ms;
    if (!numbers || !hash || !stage_ms) return STATUS_NO_MEMORY;
    *capacity = larger;
    return STATUS_OK;
}

/* Lists a frame that all consumers have received; called in the publishing thread. */
static void list_frame(void *user, const Frame *f)
{
    Session           *s = user;
    SessionResult     *r = &s->result;
    const Provenance  *p = &f->provenance;
    const RenderTimes *times = &f->seen.picture.times;
    const double       share = 1.0 / pool_threads(s->shared->pool); /* of a sum over threads: as if evenly spread */
    const double       publish_s = wall_clock_s() - f->publish_begun_s;
    const double       ms[session_stages] = {1e3 * (p->rendered_s - p->begun_s + publish_s),
                                             1e3 * (p->posed_s - p->begun_s),
                                             times->prepare_ms + share * (times->visibility_ms + times->shadow_ms),
                                             share * times->shade_ms,
                                             share * times->radar_ms,
                                             1e3 * publish_s};
    s->published++;
    r->at_limit += f->record.gimbal_at_limit;
    r->buried += f->buried;
    render_counters_add(&r->counters, &f->seen.picture.counters);
    if (r->listed == session_frames_kept || s->listed != STATUS_OK) return;
    s->listed = room_in_lists(r, &s->capacity);
    if (s->listed != STATUS_OK) return;
    r->number[r->listed] = f->number;
    memcpy(r->hash[r->listed], f->seen.sha256, sizeof f->seen.sha256);
    memcpy(r->stage_ms[r->listed], ms, sizeof ms);
    r->listed++;
}

/* Reports entities that did not fit: at once, and then once a minute while there are more. */
static void report_crowd(Session *s, int left_out)
{
    static const double   remind_s = 60;
    const EntityCounters *c = entity_table_counters(s->table);
    const Config         *config = s->shared->config;
    const uint64_t        given_up = c->evicted + c->refused;
    const double          now_s = wall_clock_s();
    DisEntityId           sender;
    if (given_up > s->given_up_reported && !(now_s - s->given_up_reported_s < remind_s)) {
        const int most = entity_table_largest_sender(&sender, s->table);
        log_warn(
            "host %s: the table of %d entities is full: %llu gave way to others, %llu were not taken in; %u:%u has "
            "the most, %d; near the host, and what goes on reporting, stays (entities.capacity)",
            s->host_text, config->entities.capacity, (unsigned long long)c->evicted, (unsigned long long)c->refused,
            sender.site, sender.application, most);
        s->given_up_reported = given_up;
        s->given_up_reported_s = now_s;
    }
    if (left_out == 0) return;
    if (!(now_s - s->left_out_reported_s < remind_s)) {
        log_warn(
            "host %s: %d entities are not in the pictures, the farthest from it; the nearest %d are (entities.shown)",
            s->host_text, left_out, config->entities.shown);
        s->left_out_reported_s = now_s;
    }
    s->result.frames_crowded++;
    if (left_out > s->result.most_left_out) s->result.most_left_out = left_out;
}

/* Enters the frame into the latency ledger, before its consumers get it. */
static void begin_latency(Session *s, Frame *f)
{
    const SessionShared *shared = s->shared;
    const double         fed_s = player_fed_s(s->player);
    if (!s->latency) return;
    f->times.arrived_s = isfinite(fed_s) ? shared->clock->wall_s(shared->clock, fed_s) : 0;
    f->times.fresh = fed_s > s->fed_s;
    s->fed_s = fed_s;
    f->latency = s->latency;
    f->latency_key = latency_begin(s->latency, &f->times);
}

Status session_frame(bool *shown, Session *s, const FrameTime *at)
{
    int left_out = 0;
    session_advance(s, at->t_s);
    Status status = s->advance_status;
    *shown = false;
    if (status == STATUS_OK && s->host->is_there(s->host)) { /* otherwise nothing is extrapolated for it */
        Frame *frame = frame_pool_take(s->frames);
        status = session_make_frame(shown, &left_out, frame, s, at);
        if (status == STATUS_OK && *shown) {
            begin_latency(s, frame);
            status = consumers_put(&s->consumers, frame);
        }
        frame_release(frame);
    }
    report_crowd(s, left_out);
    if (status == STATUS_OK && *shown) s->result.frames++;
    if (status == STATUS_NO_MEMORY)
        log_error("session: out of memory at frame %d; choose a smaller --size or fewer --samples", at->number);
    return status;
}

/* ---- the end ---------------------------------------------------------------------------------------- */

const SessionResult *session_result(const Session *s) { return &s->result; }
int                  session_entities(const Session *s) { return entity_table_count(s->table); }
uint64_t             session_over_rate(const Session *s) { return entity_table_counters(s->table)->over_rate; }
const char          *session_host(const Session *s) { return s->host_text; }

static void report_vehicles(const Session *s)
{
    if (!s->vehicles) return;
    const VehicleHeat         *heat = world_vehicles_heat(s->vehicles);
    const VehicleHeatCounters *c = vehicle_heat_counters(heat);
    log_detail("heat of vehicles: %llu begun, %llu steps, %.0f ms in all, %.1f ms the longest tick, %.2f MB",
               (unsigned long long)c->begun, (unsigned long long)c->steps, 1e3 * c->spent_s, 1e3 * c->longest_s,
               1e-6 * (double)vehicle_heat_bytes(heat));
    if (c->neighbours_left_out > 0)
        log_detail("heat of vehicles: %llu times a neighbour was one too many for another entity's heat",
                   (unsigned long long)c->neighbours_left_out);
    if (c->left_out > 0)
        log_warn(
            "heat of vehicles: too many entities: those with the highest ids were as warm as the air (entities.shown)");
    if (c->failed > 0)
        log_warn("heat of vehicles: %llu steps were given up, and temperatures kept; look at etc/heat.csv and "
                 "etc/heat_machines.csv for extreme values",
                 (unsigned long long)c->failed);
}

Status session_close(Session *s, SessionResult *result)
{
    report_vehicles(s);
    Status status = consumers_close(&s->consumers); /* the last frames are published before */
    detections_close(s->detections, &s->result.answers);
    geoid_close(&s->geoid);
    if (status == STATUS_OK) status = s->listed;
    /* of a session that could not be opened nothing is written over what it could not read */
    if (s->opened && *s->shared->config->heat.marks && status == STATUS_OK)
        status = entity_table_marks_save(s->table, s->shared->unix_s, s->shared->config->heat.marks);
    if (s->opened && s->vehicles && *s->shared->config->heat.vehicles && status == STATUS_OK)
        status = vehicle_heat_keep(world_vehicles_heat(s->vehicles), s->shared->config->heat.vehicles);
    s->result.frames = s->published;
    s->result.files_failed = s->written.failed + s->lines_failed;
    s->result.files_left_out = s->written.left_out;
    player_forgotten(&s->result.shots_forgotten, &s->result.munitions_forgotten, s->player);
    if (s->table) s->result.entities = *entity_table_counters(s->table);
    if (s->table) s->result.effects = *entity_table_effect_counters(s->table);
    if (s->latency) latency_summary(&s->result.latency, s->latency);
    latency_destroy(s->latency);
    if (result) *result = s->result;
    else session_result_free(&s->result);
    for (int b = 0; b < BAND_COUNT; b++) chain_destroy(s->chain[b]);
    seeker_radar_destroy(s->radar);
    frame_verdicts_free(s->verdicts);
    world_vehicles_destroy(s->vehicles);
    given_heat_close(s->given);
    heat_kept_close(s->kept);
    arena_destroy(s->vehicle_arena);
    entity_table_destroy(s->table);
    frame_pool_destroy(s->frames);
    pool_destroy(s->publish_pool);
    if (s->host) s->host->destroy(s->host);
    free(s);
    return status;
}

void session_result_free(SessionResult *result)
{
    free(result->number);
    free(result->hash);
    free(result->stage_ms);
    memset(result, 0, sizeof *result);
}
