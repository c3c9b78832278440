/* sensor/node/session.c: the seeker of one host: frames rendered, passed to consumers, and listed. */
#include "sensor/node/session_private.h"

#include "sensor/framefile/frame_save.h"
#include "sensor/world/frame_radar.h"
#include "sensor/node/scene_rate.h"
#include "sensor/publish/pairs.h"
#include "sensor/world/frame_world.h"

#include <errno.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

const char *const session_stage_name[session_stages] = {"frame", "snapshot", "visibility", "shade", "radar", "publish"};

/* A stationary point at the image centre. */
static void rate_of_scene(double rate_px_s[2], const Eye *eye, const Picture *picture)
{
    const size_t middle = (size_t)(picture->height / 2) * (size_t)picture->width + (size_t)(picture->width / 2);
    double       v_cam_mps[3];
    m3_tmul_v3(v_cam_mps, eye->state.r_ecef_from_cam, eye->state.v_ecef_mps);
    scene_rate(rate_px_s, eye->w_cam_rps, v_cam_mps, eye->view.focal_px, picture->range_m[middle]);
}

/* ---- one frame ------------------------------------------------------------------------------ */

static void make_request(RenderRequest *request, const Session *s, const Eye *eye, double t_s)
{
    const Config *config = s->shared->config;
    *request = (RenderRequest){.view = eye->view, .bands = s->shared->bands,
                               .optical = config_optical(config),
                               .lateral = {s->shared->sensors->lateral[0], s->shared->sensors->lateral[1]},
                               .sky_samples = config->sensor.sky_samples,
                               .sky_visibility = strcmp(config->sensor.sky_visibility, "on") == 0,
                               .samples = config->sensor.samples, .hidden_entity = eye->hidden,
                               .t_s = t_s, .low_plants_m = s->shared->world->forest ? config->terrain.woods_low_m : 0,
                               .budget = strcmp(config->quality.budget, "on") == 0,
                               .skips_off = s->shared->no_skip ? skips_all_off : 0};
    for (int b = 0; b < BAND_COUNT; b++) request->hand_over_cells |= s->shared->sensors->has[b];
    if (config_adaptive(config)) {
        request->edge_samples   = config->sensor.edge_samples;
        request->target_samples = config->sensor.target_samples;
    }
    consumers_request(request, s->wants);
    if (s->shared->bands >> BAND_RADAR & 1) {
        double to_aim[3], range_m = 1000;
        if (eye->aim_known) {
            v3_sub(to_aim, eye->p_aim_ecef, eye->state.p_ecef);
            range_m = v3_length(to_aim);
        }
        request->profile_bins   = config->radar.bins;
        request->profile_bin_m  = config->radar.bin_m;
        request->profile_near_m = fmax(0, range_m - 0.5 * config->radar.bins * config->radar.bin_m);
    }
}

/* One rendering. */
static Status look(FrameView *view, const Session *s, const RenderRequest *request, const Air *air,
                   const double r_host_from_enu[9], Arena *arena)
{
    const Status status =
        render(&view->picture, s->shared->world, &view->snapshot, request, air, s->shared->pool, arena);
    if (status != STATUS_OK) return status;
    if (view->picture.normal[0]) turn_normals(&view->picture, r_host_from_enu);
    view->plane_count = frame_planes(view->plane, &view->picture, request);
    return STATUS_OK;
}

/* The same without the target, or without all entities. */
static Status look_without(Frame *f, const Session *s, const Air *air, const double r_host_from_enu[9], int host)
{
    const bool all = strcmp(s->shared->config->publish.pairs, "all") == 0;
    f->without     = arena_alloc(f->arena, 1, sizeof *f->without);
    if (!f->without) return STATUS_NO_MEMORY;
    *f->without->sha256 = 0;
    Status status = pairs_take_away(&f->without->snapshot, &f->taken, &f->taken_count, &f->seen.snapshot, all,
                                          s->plan.aim, host, f->arena);
    HeatScene *heat = NULL;
    if (status == STATUS_OK) /* the ground as it is where it did not stand */
        status = world_heat_at(&heat, s->shared->world, &f->without->snapshot.marks, f->unix_s, f->arena);
    if (status != STATUS_OK) return status;
    Air without = *air;
    without.heat = heat;
    return look(f->without, s, &f->request, &without, r_host_from_enu, f->arena);
}

/* What the radar on the same axis measures. */
static Status measure(Frame *f, Session *s, const Eye *eye)
{
    if (radar_absent_in(s->radar_absent, f->number, f->time_s)) {
        s->result.radar_left_out++;
        return STATUS_OK;
    }
    const LocalFrame *frame = &s->shared->world->frame;
    const Weather     weather = frame_weather_at(s->shared->config, s->shared->world, f->unix_s);
    RadarScene scene = {.world = s->shared->world,
                        .snapshot = &f->seen.snapshot,
                        .view = &eye->view,
                        .hidden = eye->hidden,
                        .reference_m = NAN,
                        .t_s = f->time_s,
                        .weather = &weather,
                        .number = (uint32_t)f->number,
                        .range_m = f->seen.picture.range_m,
                        .entity = f->seen.picture.entity};
    m3_tmul_v3(scene.v_enu_mps, frame->r_ecef_from_enu, eye->state.v_ecef_mps);
    const int aim = dis_entity_id_is_none(s->plan.aim) ? -1 : snapshot_find(&f->seen.snapshot, s->plan.aim);
    if (eye->aim_known) {
        double to_aim[3];
        v3_sub(to_aim, eye->p_aim_ecef, eye->state.p_ecef);
        scene.reference_m = v3_length(to_aim);
    }
    if (aim >= 0)
        m3_tmul_v3(scene.reference_v_enu_mps, frame->r_ecef_from_enu, f->seen.snapshot.entity[aim].v_ecef_mps);
    const Status status = seeker_radar_measure(&f->radar, s->radar, &scene, s->shared->pool, f->arena);
    if (status != STATUS_OK || f->radar) return status;
    s->result.radar_left_out++;
    if (s->shared->note) {
        char text[radar_absent_text_size];
        radar_absent_text(text, f->number, f->time_s);
        s->shared->note(s->shared->user, text);
    }
    return status;
}

/* Targets, and the error budget of the frame. */
static Status know_targets(Frame *f, const Session *s, const Eye *eye)
{
    const SessionShared *shared  = s->shared;
    const FrameView     *seen    = &f->seen;
    FrameRecord         *r       = &f->record;
    Target              *target  = arena_alloc(f->arena, (size_t)seen->snapshot.count, sizeof *target);
    TruthNoise           noise;
    if (!target) return STATUS_NO_MEMORY;
    frame_expose(&noise, s->chain, &seen->picture, shared->config);
    r->target_count = truth_targets(target, &seen->picture, shared->world, &seen->snapshot, &f->request, &eye->state,
                                    &noise);
    if (s->wants & WANT_ERROR &&
        frame_error(&f->error, &seen->picture, shared->world, &seen->snapshot, &f->request, target, r->target_count,
                    shared->config->models.sag_m, shared->contact == GROUND_CONTACT_ALL,
                    world_air_k(shared->world, f->unix_s)))
        r->error = &f->error;
    r->target       = target_records(target, r->target_count, &seen->snapshot, shared->catalog, f->arena);
    if (!r->target) return STATUS_NO_MEMORY;
    if (s->wants & WANT_ERROR && f->request.budget && f->radar) {
        radar_error(&f->radar_error, f->radar, &seen->snapshot);
        r->radar_error = &f->radar_error;
    }
    return STATUS_OK;
}

static void fill_record(Frame *f, const Session *s, const Eye *eye)
{
    FrameRecord *r = &f->record;
    *r = (FrameRecord){.frame = f->number, .time_s = f->time_s, .snapshot = &f->seen.snapshot,
                       .catalog = s->shared->catalog,
                       .host = eye->hidden >= 0 ? &f->seen.snapshot.entity[eye->hidden] : NULL, .request = &f->request,
                       .hfov_rad = s->shared->config->sensor.hfov_deg * rad_per_deg, .gimbal_at_limit = eye->at_limit,
                       .scene_rate_px_s = {f->rate_px_s[0], f->rate_px_s[1]}, .sun = &f->sun};
    memcpy(r->p_eye_ecef, eye->state.p_ecef, sizeof r->p_eye_ecef);
    memcpy(r->v_eye_mps, eye->state.v_ecef_mps, sizeof r->v_eye_mps);
    memcpy(r->r_ecef_from_body, eye->r_ecef_from_body, sizeof r->r_ecef_from_body);
    memcpy(r->r_ecef_from_cam, eye->state.r_ecef_from_cam, sizeof r->r_ecef_from_cam);
}

/* The frame as a frame file, if requested. */
static Status save_frame(const Session *s, const Frame *f, const Eye *eye)
{
    const SessionShared *shared = s->shared;
    for (int i = 0; i < shared->save_count; i++)
        if (shared->save[i] == f->number)
            return frame_save(&(FrameSave){f, shared->config, s->out, &eye->state, shared->unix_s,
                                           shared->contact == GROUND_CONTACT_ALL, shared->pool, shared->woods});
    return STATUS_OK;
}

/* shown: false when the host is absent. left_out: entities that are not in it. */
static Status make_frame(bool *shown, int *left_out, Frame *f, Session *s, int number, double t_s)
{
    const SessionShared *shared = s->shared;
    Eye                  eye;
    *shown                = false;
    f->provenance.begun_s = wall_clock_s();
    Status status = entity_table_snapshot(&f->seen.snapshot, s->table, t_s, f->arena);
    if (status == STATUS_OK && s->vehicles) status = world_vehicles_show(s->vehicles, &f->seen.snapshot, f->arena);
    if (status != STATUS_OK || !session_eye(&eye, s, &f->seen.snapshot, t_s)) return status;
    f->times.posed_s = wall_clock_s();
    *left_out  = f->seen.snapshot.left_out;
    f->number  = number;
    f->time_s  = t_s;
    f->unix_s  = shared->unix_s + t_s;
    f->world   = shared->world;
    memcpy(f->host, s->host_text, sizeof f->host);

    Air            air;
    double         r_host_from_enu[9] = {0};
    const double  *p_ecef = eye.state.p_ecef;
    const FrameEye at = {
        f->unix_s, {p_ecef[0], p_ecef[1], p_ecef[2]}, &eye.view, shared->bands, &f->seen.snapshot.marks};
    status = frame_light(&air, &f->sun, r_host_from_enu, shared->world, shared->config, &at, shared->pool, f->arena);
    make_request(&f->request, s, &eye, t_s);
    const double posed_s = wall_clock_s();
    if (status == STATUS_OK) status = look(&f->seen, s, &f->request, &air, r_host_from_enu, f->arena);
    if (status == STATUS_OK && s->wants & WANT_WITHOUT) status = look_without(f, s, &air, r_host_from_enu, eye.hidden);
    if (status != STATUS_OK) return status;
    if (f->seen.picture.range_m) rate_of_scene(f->rate_px_s, &eye, &f->seen.picture);
    fill_record(f, s, &eye);
    if (s->wants & WANT_FOOTPRINT) {
        footprint_of_view(f->footprint, shared->world, &eye.view);
        f->record.footprint = f->footprint;
    }
    f->radar = NULL;
    if (s->radar) status = measure(f, s, &eye);
    f->record.radar = f->radar;
    if (status == STATUS_OK && s->wants & WANT_TARGETS) status = know_targets(f, s, &eye);
    if (status != STATUS_OK) return status;
    if (shared->world->landscape) {
        const double *p_enu = eye.view.p_enu;
        f->buried = p_enu[2] < elevation_height(&shared->world->landscape->elevation, p_enu[0], p_enu[1], NULL);
    }
    f->provenance = (Provenance){.version = PITVIPER_VERSION, .config_sha256 = shared->config_sha256,
                                 .seed = shared->config->seed, .datagrams = player_counters(s->player)->datagrams,
                                 .begun_s = f->provenance.begun_s, .posed_s = posed_s, .rendered_s = wall_clock_s()};
    f->times.render_s   = posed_s;
    f->times.rendered_s = f->provenance.rendered_s;
    *shown = true;
    status = session_begin_files(s);
    return status == STATUS_OK ? save_frame(s, f, &eye) : status;
}

/* ---- the loop ------------------------------------------------------------------------------- */

static bool observes(const HostPlan *plan) { return dis_entity_id_is_none(plan->host) && !plan->any_munition; }

void session_note_host(Session *s)
{
    SessionResult *r = &s->result;
    for (int i = 0; i < r->host_count; i++)
        if (strcmp(r->host[i], s->host_text) == 0) return;
    if (r->host_count == session_hosts_kept) return;
    _Static_assert(sizeof r->host[0] == sizeof s->host_text, "one text");
    memcpy(r->host[r->host_count++], s->host_text, sizeof s->host_text);
}

static void list_frame(void *user, const Frame *frame);

/* What stood and drove before a restart. */
static Status read_marks(Session *s)
{
    const char *path = s->shared->config->heat.marks;
    if (!*path || access(path, F_OK) != 0) return STATUS_OK;
    return entity_table_marks_load(s->table, s->shared->unix_s, path);
}

/* Temperatures of entities. Of no use where no band shows temperatures. */
static Status open_vehicles(Session *s)
{
    const SessionShared *shared = s->shared;
    if (!shared->world->heat) return STATUS_OK;
    s->vehicle_arena = arena_create();
    if (!s->vehicle_arena) return STATUS_NO_MEMORY;
    const char  *given = shared->config->heat.given;
    const char  *kept = shared->config->heat.vehicles;
    Status       status = *given ? given_heat_open(&s->given, given) : STATUS_OK;
    if (status == STATUS_OK && *kept && access(kept, F_OK) == 0) status = kept_heat_open(&s->kept, kept);
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
    const Status status = radar_absent_read(&s->radar_absent, shared->notes);
    return status == STATUS_OK ? frame_radar_open(&s->radar, shared->config, shared->isa, shared->live) : status;
}

static Status open_session(Session *s)
{
    const SessionShared *shared = s->shared;
    EntityTableConfig    table  = entity_table_default_config();


    table.pool                  = shared->pool;
    table.capacity              = shared->config->entities.capacity;
    table.shown                 = shared->config->entities.shown;
    table.new_per_s             = shared->config->entities.new_per_s;
    table.timeout_s             = shared->config->entities.timeout_s;
    table.timeout_land_v7_s     = shared->config->entities.timeout_land_v7_s;
    table.extrapolation_limit_s = shared->config->entities.extrapolation_limit_s;
    if (shared->contact != GROUND_CONTACT_NONE)
        table.ground = (ContactGround){
            .frame = &shared->world->frame, .elevation = &shared->world->landscape->elevation,
            .landscape = shared->contact == GROUND_CONTACT_INCONSISTENT ? shared->world->landscape : NULL};
    s->seeker.config = (SeekerConfig){shared->config->sensor.gimbal_limit_deg * rad_per_deg,
                                      shared->config->sensor.gimbal_rate_dps * rad_per_deg,
                                      shared->config->sensor.gimbal_lag_s,
                                      shared->config->sensor.mount_roll_deg * rad_per_deg};
    s->mount       = mount_of(shared->config);
    s->mount_model = -1;
    s->limit_tick  = -1;
    s->given_up_reported_s = s->left_out_reported_s = -INFINITY;
    s->tick    = (int64_t)ceil(s->plan.start_s * seeker_ticks_per_s);
    memcpy(s->p_aim_ecef, s->plan.p_aim_ecef, sizeof s->p_aim_ecef);
    if (observes(&s->plan))
        strcpy(s->host_text, "observer");
    else if (s->plan.any_munition)
        strcpy(s->host_text, "munition");
    else
        dis_entity_id_text(s->host_text, s->plan.host);
    if (!s->plan.any_munition) session_note_host(s);

    int most_nodes = 1;
    for (int m = 0; m < catalog_model_count(shared->catalog); m++) {
        const int nodes = catalog_model(shared->catalog, m)->node_count;
        most_nodes      = nodes > most_nodes ? nodes : most_nodes;
    }
    s->node  = calloc((size_t)most_nodes, sizeof *s->node);
    s->joint = calloc((size_t)most_nodes, sizeof *s->joint);
    if (!s->node || !s->joint) return STATUS_NO_MEMORY;

    Status status = entity_table_create(&s->table, &table, shared->catalog);
    if (status == STATUS_OK) status = read_marks(s);
    if (status == STATUS_OK) status = open_vehicles(s);
    if (status == STATUS_OK) status = open_radar(s);
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
    s->fed_s  = -INFINITY;
    s->plan   = *plan;
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

/* ---- frame after frame ------------------------------------------------------------------------ */

static Status room_in_lists(SessionResult *r, int *capacity)
{
    if (r->listed < *capacity) return STATUS_OK;
    const int larger = *capacity ? 2 * *capacity : 1024;
    int (*numbers)   = realloc(r->number, (size_t)larger * sizeof *numbers);
    if (numbers) r->number = numbers;
    char(*hash)[sha256_text_size] = realloc(r->hash, (size_t)larger * sizeof *hash);
    if (hash) r->hash = hash;
    double(*stage_ms)[session_stages] = realloc(r->stage_ms, (size_t)larger * sizeof *stage_ms);
    if (stage_ms) r->stage_ms = stage_ms;
    if (!numbers || !hash || !stage_ms) return STATUS_NO_MEMORY;
    *capacity = larger;
    return STATUS_OK;
}

/* A frame that all consumers have received; called in the publishing thread. */
static void list_frame(void *user, const Frame *f)
{
    Session            *s     = user;
    SessionResult      *r     = &s->result;
    const Provenance   *p     = &f->provenance;
    const RenderTimes  *times = &f->seen.picture.times;
    const double        share = 1.0 / pool_threads(s->shared->pool); /* of a sum over threads: as if evenly spread */
    const double        publish_s = wall_clock_s() - f->publish_begun_s;
    const double ms[session_stages] = {
        1e3 * (p->rendered_s - p->begun_s + publish_s), 1e3 * (p->posed_s - p->begun_s),
        times->prepare_ms + share * (times->visibility_ms + times->shadow_ms), share * times->shade_ms,
        share * times->radar_ms, 1e3 * publish_s};
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

/* Entities that did not fit: reported at once, and then once a minute while there are more. */
static void report_crowd(Session *s, int left_out)
{
    static const double   remind_s = 60;
    const EntityCounters *c        = entity_table_counters(s->table);
    const Config         *config   = s->shared->config;
    const uint64_t        given_up = c->evicted + c->refused;
    const double          now_s    = wall_clock_s();
    DisEntityId           sender;
    if (given_up > s->given_up_reported && !(now_s - s->given_up_reported_s < remind_s)) {
        const int most = entity_table_largest_sender(&sender, s->table);
        log_warn(
            "host %s: the table of %d entities is full: %llu gave way to others, %llu were not taken in; %u:%u has "
            "the most, %d; near the host, and what goes on reporting, stays (entities.capacity)",
            s->host_text, config->entities.capacity, (unsigned long long)c->evicted, (unsigned long long)c->refused,
            sender.site, sender.application, most);
        s->given_up_reported   = given_up;
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

/* The frame into the ledger, before its consumers get it. */
static void begin_latency(Session *s, Frame *f)
{
    const SessionShared *shared = s->shared;
    const double         fed_s  = player_fed_s(s->player);
    if (!s->latency) return;
    f->times.arrived_s = isfinite(fed_s) ? shared->wall_s(shared->clock, fed_s) : 0;
    f->times.fresh     = fed_s > s->fed_s;
    s->fed_s           = fed_s;
    f->latency         = s->latency;
    f->latency_key     = latency_begin(s->latency, &f->times);
}

Status session_frame(bool *shown, Session *s, int number, double t_s)
{
    int    left_out = 0;
    session_advance(s, t_s);
    Status status = s->advance_status;
    *shown = false;
    if (status == STATUS_OK && session_host_is_there(s)) { /* otherwise nothing is extrapolated for it */
        Frame *frame = frame_pool_take(s->frames);
        status       = make_frame(shown, &left_out, frame, s, number, t_s);
        if (status == STATUS_OK && *shown) {
            begin_latency(s, frame);
            status = consumers_put(&s->consumers, frame);
        }
        frame_release(frame);
    }
    report_crowd(s, left_out);
    if (status == STATUS_OK && *shown) s->result.frames++;
    if (status == STATUS_NO_MEMORY)
        log_error("session: out of memory at frame %d; choose a smaller --size or fewer --samples", number);
    return status;
}

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
                 "etc/heat_machines.csv for extreme values", (unsigned long long)c->failed);
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
    s->result.frames         = s->published;
    s->result.files_failed   = s->written.failed + s->lines_failed;
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
    radar_absent_free(s->radar_absent);
    world_vehicles_destroy(s->vehicles);
    given_heat_close(s->given);
    kept_heat_close(s->kept);
    arena_destroy(s->vehicle_arena);
    entity_table_destroy(s->table);
    frame_pool_destroy(s->frames);
    pool_destroy(s->publish_pool);
    free(s->node);
    free(s->joint);
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
