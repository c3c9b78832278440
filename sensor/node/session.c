#include "sensor/node/session.h"

#include "sensor/node/frame_files.h"
#include "sensor/node/player.h"
#include "sensor/node/scene_rate.h"
#include "sensor/node/seeker.h"
#include "sensor/publish/records.h"

#include <errno.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

const char *const session_stage_name[session_stages] = {"frame", "snapshot", "visibility", "shade", "radar", "publish"};

typedef struct Session {
    const SessionShared *shared;
    const HostPlan      *plan;
    const char          *out;
    char                 host_text[dis_id_text_size];
    EntityTable         *table;
    Player              *player;
    FILE                *truth;
    Seeker               seeker;
    Arena               *frame_arena;
    int64_t              tick;          /* next gimbal tick */
    double               p_aim_ecef[3]; /* last known */
    bool                 aim_known;
    double               r_ecef_from_cam[2][9]; /* of a host's gimbal at the last two ticks */
    int                  ticks;         /* how many there were, to 2 */
    Chain               *chain[BAND_COUNT];  /* of the bands with a sensor of etc/sensors.csv */
    FrameLevel           level[BAND_COUNT];
    int                  buried;        /* frames whose eye was below the ground */
} Session;

/* ---- where the eye is, and where it looks ----------------------------------------------------- */

static void aim_point(Session *s, const EntityTable *table, double t_s)
{
    SnapshotEntity aim;
    if (dis_entity_id_is_none(s->plan->aim) ||
        !entity_table_pose(&aim, table, entity_table_find(table, s->plan->aim), t_s))
        return; /* gone: the last place is kept */
    const double height_m = catalog_model(s->shared->catalog, aim.model)->height_m;
    for (int k = 0; k < 3; k++)
        s->p_aim_ecef[k] = aim.p_ecef[k] - 0.5 * height_m * aim.r_ecef_from_body[3 * k + 2];
    s->aim_known = true;
}

/* Pose of the host at t_s. A replay knows a munition's next report, where there is one, and may interpolate; a
 * causal one may not. */
static bool host_pose(SnapshotEntity *host, const Session *s, double t_s)
{
    const SessionShared *shared = s->shared;
    if (!entity_table_pose(host, s->table, entity_table_find(s->table, s->plan->host), t_s)) return false;
    const Track *track = survey_track(shared->survey, s->plan->host);
    if (s->plan->munition && !shared->config->causal && t_s <= track->point[track->count - 1].t_s) {
        TrackPose pose;
        Origin    origin;
        track_at(&pose, track, t_s);
        const int    model  = catalog_find(shared->catalog, host->type, &origin, NULL);
        const double down_m = origin == ORIGIN_CENTRE ? 0.5 * catalog_model(shared->catalog, model)->height_m : 0;
        for (int k = 0; k < 3; k++) host->p_ecef[k] = pose.p_ecef[k] + down_m * pose.r_ecef_from_body[3 * k + 2];
        memcpy(host->v_ecef_mps, pose.v_ecef_mps, sizeof host->v_ecef_mps);
        memcpy(host->r_ecef_from_body, pose.r_ecef_from_body, sizeof host->r_ecef_from_body);
        host->age_s = 0;
    }
    return true;
}

/* A munition's eye is in its nose, a platform's on its roof. */
static void eye_of(double p_ecef[3], const Session *s, const SnapshotEntity *host)
{
    const Model *model       = catalog_model(s->shared->catalog, host->model);
    double       eye_body[3] = {0, 0, -(model->height_m + 0.3)}, lever_ecef[3];
    if (s->plan->munition) {
        eye_body[0] = model->box_high[0];
        eye_body[2] = -0.5 * model->height_m;
    }
    m3_mul_v3(lever_ecef, host->r_ecef_from_body, eye_body);
    v3_add(p_ecef, host->p_ecef, lever_ecef);
}

static void step_gimbal(Session *s, double t_s)
{
    SnapshotEntity host;
    if (!host_pose(&host, s, t_s)) return;
    aim_point(s, s->table, t_s);
    double d_body[3] = {1, 0, 0};
    if (s->aim_known) {
        double p_ecef[3], d_ecef[3];
        eye_of(p_ecef, s, &host);
        v3_sub(d_ecef, s->p_aim_ecef, p_ecef);
        m3_tmul_v3(d_body, host.r_ecef_from_body, d_ecef);
    }
    seeker_step(&s->seeker, d_body);
    memcpy(s->r_ecef_from_cam[0], s->r_ecef_from_cam[1], sizeof s->r_ecef_from_cam[0]);
    seeker_camera(s->r_ecef_from_cam[1], &s->seeker, host.r_ecef_from_body);
    if (s->ticks < 2) s->ticks++;
}

/* Feeds the log and turns the gimbal up to t_s, on the fixed grid of ticks. */
static void advance(Session *s, double t_s)
{
    /* a quotient is rounded correctly, so that tick 35 is 0.35 to the bit; 35 * 0.01 is more */
    for (double tick_s; (tick_s = (double)s->tick / seeker_ticks_per_s) <= t_s; s->tick++) {
        player_feed(s->player, s->table, tick_s);
        step_gimbal(s, tick_s);
    }
    player_feed(s->player, s->table, t_s);
}

typedef struct Eye {
    EyeState state;
    View     view;
    double   r_ecef_from_body[9];
    int      hidden; /* snapshot index of the host; -1 */
    bool     at_limit;
    double   w_cam_rps[3]; /* how the camera turns, in its own axes */
} Eye;

/* A thing at rest where the middle of the picture looks. */
static void rate_of_scene(double rate_px_s[2], const Eye *eye, const Picture *picture)
{
    const size_t middle = (size_t)(picture->height / 2) * (size_t)picture->width + (size_t)(picture->width / 2);
    double       v_cam_mps[3];
    m3_tmul_v3(v_cam_mps, eye->state.r_ecef_from_cam, eye->state.v_ecef_mps);
    scene_rate(rate_px_s, eye->w_cam_rps, v_cam_mps, eye->view.focal_px, picture->range_m[middle]);
}

static void finish_eye(Eye *eye, const Session *s)
{
    const Config     *config = s->shared->config;
    const LocalFrame *frame  = &s->shared->world->frame;
    eye->view.width          = config->sensor.width_px;
    eye->view.height         = config->sensor.height_px;
    eye->view.focal_px       = view_focal_px(config->sensor.width_px, config->sensor.hfov_deg * rad_per_deg);
    enu_from_ecef(eye->view.p_enu, frame, eye->state.p_ecef);
    m3_mul(eye->state.r_ecef_from_cam, frame->r_ecef_from_enu, eye->view.r_enu_from_cam);
}

static bool host_eye(Eye *eye, const Session *s, Snapshot *snapshot, double t_s)
{
    SnapshotEntity host;
    const int      index = snapshot_find(snapshot, s->plan->host);
    if (index < 0 || !host_pose(&host, s, t_s)) return false;

    /* the interpolated pose is the host's in every product: it casts its shadow from there */
    SnapshotEntity *shown = &snapshot->entity[index];
    memcpy(shown->p_ecef, host.p_ecef, sizeof shown->p_ecef);
    memcpy(shown->v_ecef_mps, host.v_ecef_mps, sizeof shown->v_ecef_mps);
    memcpy(shown->r_ecef_from_body, host.r_ecef_from_body, sizeof shown->r_ecef_from_body);
    shown->age_s = host.age_s;

    double r_enu_from_body[9];
    m3_tmul(r_enu_from_body, s->shared->world->frame.r_ecef_from_enu, host.r_ecef_from_body);
    eye_of(eye->state.p_ecef, s, &host);
    memcpy(eye->state.v_ecef_mps, host.v_ecef_mps, sizeof eye->state.v_ecef_mps);
    memcpy(eye->r_ecef_from_body, host.r_ecef_from_body, sizeof eye->r_ecef_from_body);
    seeker_camera(eye->view.r_enu_from_cam, &s->seeker, r_enu_from_body);
    eye->hidden = eye->state.host_index = index;
    eye->at_limit                       = s->seeker.at_limit;
    if (s->ticks == 2)
        turn_rate(eye->w_cam_rps, s->r_ecef_from_cam[0], s->r_ecef_from_cam[1], 1.0 / seeker_ticks_per_s);
    finish_eye(eye, s);
    return true;
}

/* On a circle about the aim, clockwise from above, starting in the south; never in the ground. */
static void observer_place(double p_ecef[3], double aim_enu[3], Session *s, double t_s)
{
    const Config     *config = s->shared->config;
    const LocalFrame *frame  = &s->shared->world->frame;
    const double      azimuth_rad = pi_rad + config->observer.rate_dps * rad_per_deg * (t_s - s->plan->start_s);
    double            p_enu[3];
    aim_point(s, s->table, t_s);
    enu_from_ecef(aim_enu, frame, s->p_aim_ecef);
    p_enu[0] = aim_enu[0] + config->observer.range_m * sin(azimuth_rad);
    p_enu[1] = aim_enu[1] + config->observer.range_m * cos(azimuth_rad);
    p_enu[2] = aim_enu[2] + config->observer.height_m;
    const double ground_m = elevation_height(&s->shared->world->landscape->elevation, p_enu[0], p_enu[1], NULL);
    if (p_enu[2] < ground_m + 20) p_enu[2] = ground_m + 20;
    ecef_from_enu(p_ecef, frame, p_enu);
}

static void observer_camera(double r_enu_from_cam[9], const double p_ecef[3], const double aim_enu[3],
                            const LocalFrame *frame)
{
    double p_enu[3], d_enu[3];
    enu_from_ecef(p_enu, frame, p_ecef);
    v3_sub(d_enu, aim_enu, p_enu);
    camera_upright(r_enu_from_cam, d_enu);
}

static bool observer_eye(Eye *eye, Session *s, double t_s)
{
    static const double half_s = 0.005; /* velocity by difference: it rides with the aim, and over the hills */
    const LocalFrame   *frame  = &s->shared->world->frame;
    double              before_ecef[3], after_ecef[3], p_enu[3], aim_enu[3], d_enu[3], r_before[9], r_after[9];
    if (!s->aim_known) {
        memcpy(s->p_aim_ecef, s->plan->p_aim_ecef, sizeof s->p_aim_ecef);
        s->aim_known = true;
    }
    observer_place(before_ecef, aim_enu, s, t_s - half_s);
    observer_camera(r_before, before_ecef, aim_enu, frame);
    observer_place(after_ecef, aim_enu, s, t_s + half_s);
    observer_camera(r_after, after_ecef, aim_enu, frame);
    turn_rate(eye->w_cam_rps, r_before, r_after, 2 * half_s);
    observer_place(eye->state.p_ecef, aim_enu, s, t_s);
    for (int k = 0; k < 3; k++) eye->state.v_ecef_mps[k] = (after_ecef[k] - before_ecef[k]) / (2 * half_s);
    enu_from_ecef(p_enu, frame, eye->state.p_ecef);
    v3_sub(d_enu, aim_enu, p_enu);
    if (!v3_normalize(d_enu, d_enu)) return false;
    camera_upright(eye->view.r_enu_from_cam, d_enu);
    eye->hidden = eye->state.host_index = -1;
    finish_eye(eye, s);
    memcpy(eye->r_ecef_from_body, eye->state.r_ecef_from_cam, sizeof eye->r_ecef_from_body);
    return true;
}

/* ---- one frame ------------------------------------------------------------------------------ */

/* Sun at the eye's own place, its direction turned into the world's frame. */
static Status light_at(Air *air, Sun *sun, double r_host_from_enu[9], const Session *s, const Eye *eye, double t_s)
{
    const SessionShared *shared = s->shared;
    const Config        *config = shared->config;
    World               *world = shared->world;
    Weather              weather = {.visibility_m = config->weather.visibility_m,
                                    .air_temp_k = config->weather.air_temp_k,
                                    .pressure_mbar = config->weather.pressure_mbar,
                                    .wind_mps = config->weather.wind_mps,
                                    .wind_from_rad = config->weather.wind_from_deg * rad_per_deg};
    if (isnan(weather.air_temp_k)) weather.air_temp_k = atmosphere_temp_k(world->atmosphere, 0);
    Geodetic place;
    double   p_ecef[3], r_ecef_from_host[9], d_ecef[3];
    Status   status = geodetic_from_ecef(&place, eye->state.p_ecef);
    if (status == STATUS_OK) status = ecef_from_geodetic(p_ecef, r_ecef_from_host, &place);
    if (status == STATUS_OK)
        status = sun_at(sun, shared->unix_s + t_s, &place, weather.pressure_mbar, weather.air_temp_k - 273.15, NAN);
    if (status != STATUS_OK) return status;
    Sun local = *sun;
    m3_mul_v3(d_ecef, r_ecef_from_host, sun->d_enu);
    m3_tmul_v3(local.d_enu, shared->world->frame.r_ecef_from_enu, d_ecef);
    m3_tmul(r_host_from_enu, r_ecef_from_host, shared->world->frame.r_ecef_from_enu);

    /* heights of the air are above the ground at the origin, and the tangent plane leaves the Earth */
    const double     *p_enu = eye->view.p_enu;
    const double      ground_m = world->landscape ? elevation_height(&world->landscape->elevation, 0, 0, NULL) : 0;
    const double      eye_height_m = p_enu[2] - ground_m + (p_enu[0] * p_enu[0] + p_enu[1] * p_enu[1]) / (2 * 6371e3);
    const AirSource   source = {world->atmosphere, world->planck_mwir, world->planck_lwir};
    const AirEye      air_eye = {eye_height_m, render_air_bands(shared->bands, config_optical(config)), &eye->view};
    return air_at(air, &source, &weather, &local, &air_eye, shared->pool, s->frame_arena);
}

/* Products give normals in the host's own ENU. */
static void turn_normals(Picture *picture, const double r_host_from_enu[9])
{
    const size_t count = (size_t)picture->width * (size_t)picture->height;
    for (size_t i = 0; i < count; i++) {
        const double n[3] = {picture->normal[0][i], picture->normal[1][i], picture->normal[2][i]};
        double       turned[3];
        m3_mul_v3(turned, r_host_from_enu, n);
        for (int k = 0; k < 3; k++) picture->normal[k][i] = (float)turned[k];
    }
}

static bool adaptive(const Config *config) { return strcmp(config->sensor.antialias, "adaptive") == 0; }

static void make_request(RenderRequest *request, const Session *s, const Eye *eye)
{
    const Config *config = s->shared->config;
    *request = (RenderRequest){.view = eye->view, .bands = s->shared->bands, .truth = true,
                               .optical = config_optical(config), .sky_samples = config->sensor.sky_samples,
                               .samples = config->sensor.samples, .hidden_entity = eye->hidden,
                               .no_skip = s->shared->no_skip};
    if (adaptive(config)) {
        request->edge_samples   = config->sensor.edge_samples;
        request->target_samples = config->sensor.target_samples;
    }
    if (s->shared->bands >> BAND_RADAR & 1) {
        double to_aim[3], range_m = 1000;
        if (s->aim_known) {
            v3_sub(to_aim, s->p_aim_ecef, eye->state.p_ecef);
            range_m = v3_length(to_aim);
        }
        request->profile_bins   = config->radar.bins;
        request->profile_bin_m  = config->radar.bin_m;
        request->profile_near_m = fmax(0, range_m - 0.5 * config->radar.bins * config->radar.bin_m);
    }
}

/* shown: false when the host is not there at t_s. */
static Status make_frame(bool *shown, char hash[sha256_text_size], double stage_ms[session_stages],
                         RenderCounters *counters, Session *s, int frame, double t_s)
{
    const SessionShared *shared = s->shared;
    const double         start_s = wall_clock_s();
    Snapshot             snapshot;
    Eye                  eye = {.hidden = -1};

    *shown = false;
    arena_reset(s->frame_arena);
    Status status = entity_table_snapshot(&snapshot, s->table, t_s, s->frame_arena);
    if (status != STATUS_OK) return status;
    const bool observer = dis_entity_id_is_none(s->plan->host);
    if (!(observer ? observer_eye(&eye, s, t_s) : host_eye(&eye, s, &snapshot, t_s))) return STATUS_OK;

    Air           air;
    Sun           sun;
    double        r_host_from_enu[9] = {0};
    Picture       picture;
    RenderRequest request;
    status = light_at(&air, &sun, r_host_from_enu, s, &eye, t_s);
    make_request(&request, s, &eye);
    const double posed_s = wall_clock_s();
    if (status == STATUS_OK)
        status = render(&picture, shared->world, &snapshot, &request, &air, shared->pool, s->frame_arena);
    if (status != STATUS_OK) return status;
    turn_normals(&picture, r_host_from_enu);

    Target          *target = arena_alloc(s->frame_arena, (size_t)snapshot.count, sizeof *target);
    TruthNoise       noise;
    frame_expose(&noise, s->chain, &picture, shared->config);
    if (!target) return STATUS_NO_MEMORY;
    const int targets = truth_targets(target, &picture, shared->world, &snapshot, &request, &eye.state, &noise);

    const double      rendered_s = wall_clock_s();
    double            rate_px_s[2];
    rate_of_scene(rate_px_s, &eye, &picture);
    const FrameFiles  files  = {.out = s->out, .config = shared->config, .world = shared->world, .picture = &picture,
                                .snapshot = &snapshot, .request = &request, .host = s->host_text,
                                .config_sha256 = shared->config_sha256, .frame = frame, .time_s = t_s,
                                .unix_s = shared->unix_s + t_s, .png = shared->png, .chain = s->chain,
                                .level = s->level, .rate_px_s = {rate_px_s[0], rate_px_s[1]}};
    FrameRecord       record = {.frame = frame, .time_s = t_s, .snapshot = &snapshot, .catalog = shared->catalog,
                                .host = eye.hidden >= 0 ? &snapshot.entity[eye.hidden] : NULL, .request = &request,
                                .hfov_rad = shared->config->sensor.hfov_deg * rad_per_deg,
                                .gimbal_at_limit = eye.at_limit, .sun = &sun, .target = target, .target_count = targets};
    memcpy(record.p_eye_ecef, eye.state.p_ecef, sizeof record.p_eye_ecef);
    memcpy(record.v_eye_mps, eye.state.v_ecef_mps, sizeof record.v_eye_mps);
    memcpy(record.r_ecef_from_body, eye.r_ecef_from_body, sizeof record.r_ecef_from_body);
    memcpy(record.r_ecef_from_cam, eye.state.r_ecef_from_cam, sizeof record.r_ecef_from_cam);
    status = frame_files_write(hash, &files, shared->pool);
    if (status == STATUS_OK) status = record_write_frame(s->truth, &record);
    if (status != STATUS_OK) return status;

    const double done_s = wall_clock_s();
    const double share = 1.0 / pool_threads(shared->pool); /* of a sum over threads: as if evenly spread */
    const double ms[session_stages] = {
        1e3 * (done_s - start_s), 1e3 * (posed_s - start_s),
        picture.times.prepare_ms + share * (picture.times.visibility_ms + picture.times.shadow_ms),
        share * picture.times.shade_ms, share * picture.times.radar_ms, 1e3 * (done_s - rendered_s)};
    memcpy(stage_ms, ms, sizeof ms);
    *counters = picture.counters;
    *shown    = true;
    if (shared->world->landscape) {
        const double *p_enu = eye.view.p_enu;
        s->buried += p_enu[2] < elevation_height(&shared->world->landscape->elevation, p_enu[0], p_enu[1], NULL);
    }
    return STATUS_OK;
}

/* ---- the loop ------------------------------------------------------------------------------- */

static void show_progress(int frame, int first, int last, double begun_s, bool end)
{
    if (!isatty(STDERR_FILENO)) return;
    const double done = (double)(frame - first + 1) / (last - first + 1), spent_s = wall_clock_s() - begun_s;
    fprintf(stderr, "\r  frame %d of %d  %3.0f %%  %.0f s left   %s", frame - first + 1, last - first + 1, 100 * done,
            spent_s * (1 - done) / done, end ? "\r\x1b[K" : "");
}

/* Waits until the log's own clock, times speed, has come to t_s. */
static void pace(double begun_s, double first_s, double t_s, double speed)
{
    if (!isfinite(speed)) return;
    const double    until_s = begun_s + (t_s - first_s) / speed;
    struct timespec until   = {(time_t)until_s, (long)((until_s - floor(until_s)) * 1e9)};
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, NULL) == EINTR) {}
}

static Status open_session(Session *s)
{
    const SessionShared *shared = s->shared;
    EntityTableConfig    table  = entity_table_default_config();
    char                 path[4096];

    table.capacity              = shared->config->entities.capacity;
    table.timeout_s             = shared->config->entities.timeout_s;
    table.timeout_land_v7_s     = shared->config->entities.timeout_land_v7_s;
    table.extrapolation_limit_s = shared->config->entities.extrapolation_limit_s;
    if (shared->clamp)
        table.ground = (ContactGround){&shared->world->frame, &shared->world->landscape->elevation};
    s->seeker.config = (SeekerConfig){shared->config->sensor.gimbal_limit_deg * rad_per_deg,
                                      shared->config->sensor.gimbal_rate_dps * rad_per_deg,
                                      shared->config->sensor.gimbal_lag_s};
    s->tick    = (int64_t)ceil(s->plan->start_s * seeker_ticks_per_s);
    if (dis_entity_id_is_none(s->plan->host))
        strcpy(s->host_text, "observer");
    else
        dis_entity_id_text(s->host_text, s->plan->host);

    s->frame_arena = arena_create();
    if (!s->frame_arena) return STATUS_NO_MEMORY;
    if (!etc_path(path, sizeof path, "heat.csv")) return STATUS_BAD_VALUE;
    Status status = entity_table_create(&s->table, &table, shared->catalog, path);
    if (status == STATUS_OK)
        status = player_create(&s->player, shared->log, shared->exercise, shared->config->causal);
    const Config *config = shared->config;
    unsigned      raw = 0;
    for (int b = 0; b < BAND_COUNT && status == STATUS_OK; b++) {
        if (!shared->sensors->has[b]) continue;
        status = chain_create(&s->chain[b], &shared->sensors->preset[b], config->sensor.width_px,
                              config->sensor.height_px,
                              render_places(config->sensor.samples, adaptive(config) ? config->sensor.edge_samples : 0),
                              (uint64_t)config->seed);
        raw |= config->detector.raw ? 1u << b : 0;
    }
    if (status == STATUS_OK) status = frame_files_prepare(s->out, shared->bands, raw);
    if (status != STATUS_OK) return status;
    snprintf(path, sizeof path, "%s/truth.jsonl", s->out);
    s->truth = fopen(path, "w");
    if (!s->truth) {
        log_error("replay: cannot write %s: %s; choose another place with --out", path, strerror(errno));
        return STATUS_IO;
    }
    return STATUS_OK;
}

static Status run_frames(SessionResult *result, Session *s)
{
    const SessionShared *shared = s->shared;
    const Config        *config = shared->config;
    double               from_s = s->plan->start_s, to_s = s->plan->end_s;
    if (config->exercise.from_s > from_s) from_s = config->exercise.from_s;
    if (config->exercise.to_s < to_s) to_s = config->exercise.to_s;

    /* frames stand on multiples of the interval, wherever the span begins: a part of a run equals that part
     * of the whole */
    const double  first_d = ceil(from_s * s->plan->rate_hz - 1e-9), last_d = floor(to_s * s->plan->rate_hz + 1e-9);
    const double  origin_d = ceil(s->plan->start_s * s->plan->rate_hz - 1e-9);
    const bool single = to_s >= from_s && !(last_d >= first_d); /* too short for the grid: one frame, at its start */
    if (!(last_d >= first_d || single) || last_d - origin_d > 999999) {
        log_error("replay: %s between %.3f and %.3f s at %g Hz; widen --from and --to or change --rate",
                  last_d >= first_d ? "more than a million frames" : "no frame", from_s, to_s, s->plan->rate_hz);
        return STATUS_BAD_VALUE;
    }
    const int first = (int)(first_d - origin_d), last = single ? first : (int)(last_d - origin_d), capacity = last - first + 1;
    result->hash     = calloc((size_t)capacity, sizeof *result->hash);
    result->stage_ms = calloc((size_t)capacity, sizeof *result->stage_ms);
    if (!result->hash || !result->stage_ms) return STATUS_NO_MEMORY;

    const double begun_s = wall_clock_s();
    for (int frame = first; frame <= last; frame++) {
        const double   t_s = single ? from_s : (origin_d + frame) / s->plan->rate_hz;
        RenderCounters counters;
        bool           shown;
        pace(begun_s, single ? from_s : first_d / s->plan->rate_hz, t_s, shared->speed);
        advance(s, t_s);
        const Status status = make_frame(&shown, result->hash[result->frames], result->stage_ms[result->frames],
                                         &counters, s, frame, t_s);
        if (status == STATUS_NO_MEMORY)
            log_error("replay: out of memory at frame %d; choose a smaller --size or fewer --samples", frame);
        if (status != STATUS_OK) return status;
        if (shown) {
            result->frames++;
            render_counters_add(&result->counters, &counters);
        }
        show_progress(frame, first, last, begun_s, frame == last);
    }
    if (result->frames == 0) {
        log_error("replay: %s was never there at a frame's time; see `pitviper inspect`, --from, --to and --rate",
                  s->host_text);
        return STATUS_BAD_VALUE;
    }
    return STATUS_OK;
}

Status session_run(SessionResult *result, const SessionShared *shared, const HostPlan *plan, const char *out)
{
    Session s = {.shared = shared, .plan = plan, .out = out};
    memset(result, 0, sizeof *result);
    Status status = open_session(&s);
    if (status == STATUS_OK) status = run_frames(result, &s);
    result->buried = s.buried;
    if (s.table) result->entities = *entity_table_counters(s.table);
    if (s.table) result->effects = *entity_table_effect_counters(s.table);
    if (s.truth && fclose(s.truth) != 0 && status == STATUS_OK) {
        log_error("replay: cannot write truth.jsonl: %s", strerror(errno));
        status = STATUS_IO;
    }
    for (int b = 0; b < BAND_COUNT; b++) chain_destroy(s.chain[b]);
    player_destroy(s.player);
    entity_table_destroy(s.table);
    arena_destroy(s.frame_arena);
    return status;
}

void session_result_free(SessionResult *result)
{
    free(result->hash);
    free(result->stage_ms);
    memset(result, 0, sizeof *result);
}
