#include "sensor/node/session_private.h"

#include "sensor/node/scene_rate.h"

#include <errno.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

const char *const session_stage_name[session_stages] = {"frame", "snapshot", "visibility", "shade", "radar", "publish"};

/* A thing at rest where the middle of the picture looks. */
static void rate_of_scene(double rate_px_s[2], const Eye *eye, const Picture *picture)
{
    const size_t middle = (size_t)(picture->height / 2) * (size_t)picture->width + (size_t)(picture->width / 2);
    double       v_cam_mps[3];
    m3_tmul_v3(v_cam_mps, eye->state.r_ecef_from_cam, eye->state.v_ecef_mps);
    scene_rate(rate_px_s, eye->w_cam_rps, v_cam_mps, eye->view.focal_px, picture->range_m[middle]);
}

/* ---- one frame ------------------------------------------------------------------------------ */

/* Sun at the eye's own place, its direction turned into the world's frame. */
static Status light_at(Air *air, Sun *sun, double r_host_from_enu[9], const Session *s, const Eye *eye, double t_s,
                       Arena *arena)
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
    return air_at(air, &source, &weather, &local, &air_eye, shared->pool, arena);
}

void turn_normals(Picture *picture, const double r_host_from_enu[9])
{
    const size_t count = (size_t)picture->width * (size_t)picture->height;
    for (size_t i = 0; i < count; i++) {
        const double n[3] = {picture->normal[0][i], picture->normal[1][i], picture->normal[2][i]};
        double       turned[3];
        m3_mul_v3(turned, r_host_from_enu, n);
        for (int k = 0; k < 3; k++) picture->normal[k][i] = (float)turned[k];
    }
}

static void make_request(RenderRequest *request, const Session *s, const Eye *eye)
{
    const Config *config = s->shared->config;
    *request = (RenderRequest){.view = eye->view, .bands = s->shared->bands, .truth = true,
                               .optical = config_optical(config),
                               .lateral = {s->shared->sensors->lateral[0], s->shared->sensors->lateral[1]},
                               .sky_samples = config->sensor.sky_samples,
                               .sky_visibility = strcmp(config->sensor.sky_visibility, "on") == 0,
                               .samples = config->sensor.samples, .hidden_entity = eye->hidden,
                               .budget = strcmp(config->quality.budget, "on") == 0,
                               .skips_off = s->shared->no_skip ? skips_all_off : 0};
    for (int b = 0; b < BAND_COUNT; b++) request->hand_over_cells |= s->shared->sensors->has[b];
    if (config_adaptive(config)) {
        request->edge_samples   = config->sensor.edge_samples;
        request->target_samples = config->sensor.target_samples;
    }
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

typedef struct FrameDone {
    bool           shown;
    int            left_out;
    char           hash[sha256_text_size];
    double         stage_ms[session_stages];
    RenderCounters counters;
} FrameDone;

/* Hash, picture files and the line of truth. Live, the files are handed over, and a disk that takes nothing ends
 * nothing. */
static Status write_files(char hash[sha256_text_size], Session *s, const FrameFiles *files, FrameRecord *record)
{
    const bool live = s->shared->live;
    Status     status = s->shared->config->publish.files && !live ? frame_files_write(hash, files, s->shared->pool)
                                                                  : frame_files_hash(hash, files);
    record->frame_sha256 = hash;
    if (status != STATUS_OK) return status;
    if (s->writer) frame_writer_put(s->writer, files);
    if (!live) return record_write_frame(s->truth, record);

    const bool due = patience_due(&s->truth_patience);
    if (due) status = record_write_frame(s->truth, record);
    patience_over(&s->truth_patience, due, due ? status : STATUS_IO);
    clearerr(s->truth);
    return status == STATUS_IO ? STATUS_OK : status;
}

static Status make_frame(FrameDone *done, Session *s, int frame, double t_s)
{
    const SessionShared *shared = s->shared;
    const double         start_s = wall_clock_s();
    Snapshot             snapshot;
    Eye                  eye;

    *done = (FrameDone){0};
    if (!session_host_is_there(s)) return STATUS_OK; /* nor is anything extrapolated for it */
    Arena *arena = s->writer ? frame_writer_arena(s->writer) : s->frame_arena;
    arena_reset(arena);
    Status status = entity_table_snapshot(&snapshot, s->table, t_s, arena);
    if (status != STATUS_OK) return status;
    if (!session_eye(&eye, s, &snapshot, t_s)) return STATUS_OK;
    done->left_out = snapshot.left_out;

    Air           air;
    Sun           sun;
    double        r_host_from_enu[9] = {0};
    Picture       picture;
    RenderRequest request;
    status = light_at(&air, &sun, r_host_from_enu, s, &eye, t_s, arena);
    make_request(&request, s, &eye);
    const double posed_s = wall_clock_s();
    if (status == STATUS_OK)
        status = render(&picture, shared->world, &snapshot, &request, &air, shared->pool, arena);
    if (status != STATUS_OK) return status;
    turn_normals(&picture, r_host_from_enu);

    Target          *target = arena_alloc(arena, (size_t)snapshot.count, sizeof *target);
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
                                .unix_s = shared->unix_s + t_s, .png = shared->config->publish.png, .chain = s->chain,
                                .level = s->level, .rate_px_s = {rate_px_s[0], rate_px_s[1]}};
    FrameRecord       record = {.frame = frame, .time_s = t_s, .snapshot = &snapshot, .catalog = shared->catalog,
                                .host = eye.hidden >= 0 ? &snapshot.entity[eye.hidden] : NULL, .request = &request,
                                .hfov_rad = shared->config->sensor.hfov_deg * rad_per_deg,
                                .gimbal_at_limit = eye.at_limit,
                                .scene_rate_px_s = {rate_px_s[0], rate_px_s[1]}, .sun = &sun,
                                .target = target, .target_count = targets};
    FrameError error;
    if (frame_error(&error, &picture, shared->world, &snapshot, &request, target, targets,
                    shared->config->models.sag_m, shared->contact == GROUND_CONTACT_ALL))
        record.error = &error;
    memcpy(record.p_eye_ecef, eye.state.p_ecef, sizeof record.p_eye_ecef);
    memcpy(record.v_eye_mps, eye.state.v_ecef_mps, sizeof record.v_eye_mps);
    memcpy(record.r_ecef_from_body, eye.r_ecef_from_body, sizeof record.r_ecef_from_body);
    memcpy(record.r_ecef_from_cam, eye.state.r_ecef_from_cam, sizeof record.r_ecef_from_cam);
    if (shared->publish) shared->publish(shared->user, &record); /* before the disk has its turn */
    status = write_files(done->hash, s, &files, &record);
    if (status == STATUS_OK && s->coco) status = coco_frame(s->coco, &record, picture.entity);
    if (status == STATUS_OK && s->pairs)
        status = pairs_frame(s->pairs, &files, done->hash, &air, r_host_from_enu, s->plan.aim, eye.hidden, arena);
    if (status != STATUS_OK) return status;

    const double end_s = wall_clock_s();
    const double share = 1.0 / pool_threads(shared->pool); /* of a sum over threads: as if evenly spread */
    const double ms[session_stages] = {
        1e3 * (end_s - start_s), 1e3 * (posed_s - start_s),
        picture.times.prepare_ms + share * (picture.times.visibility_ms + picture.times.shadow_ms),
        share * picture.times.shade_ms, share * picture.times.radar_ms, 1e3 * (end_s - rendered_s)};
    memcpy(done->stage_ms, ms, sizeof ms);
    done->counters = picture.counters;
    done->shown    = true;
    s->result.at_limit += eye.at_limit;
    if (shared->world->landscape) {
        const double *p_enu = eye.view.p_enu;
        s->result.buried += p_enu[2] < elevation_height(&shared->world->landscape->elevation, p_enu[0], p_enu[1], NULL);
    }
    return STATUS_OK;
}

/* ---- the loop ------------------------------------------------------------------------------- */

/* After the folders are there. */
static Status open_writer(Session *s)
{
    Chain *chain[BAND_COUNT] = {NULL};
    Status status = sensors_chains(chain, s->shared->sensors, s->shared->config);
    if (status == STATUS_OK) return frame_writer_create(&s->writer, chain, s->shared->config);
    for (int b = 0; b < BAND_COUNT; b++) chain_destroy(chain[b]);
    return status;
}

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

static Status open_session(Session *s)
{
    const SessionShared *shared = s->shared;
    EntityTableConfig    table  = entity_table_default_config();
    char                 path[sizeof s->out + 16];

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
            .landscape = shared->contact == GROUND_CONTACT_MISFITS ? shared->world->landscape : NULL};
    s->seeker.config = (SeekerConfig){shared->config->sensor.gimbal_limit_deg * rad_per_deg,
                                      shared->config->sensor.gimbal_rate_dps * rad_per_deg,
                                      shared->config->sensor.gimbal_lag_s,
                                      shared->config->sensor.mount_roll_deg * rad_per_deg};
    s->mount       = mount_of(shared->config);
    s->mount_model = -1;
    s->limit_tick  = -1;
    s->given_up_said_s = s->left_out_said_s = -INFINITY;
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

    s->frame_arena = arena_create();
    if (!s->frame_arena) return STATUS_NO_MEMORY;
    if (!etc_path(path, sizeof path, "heat.csv")) return STATUS_BAD_VALUE;
    Status        status = entity_table_create(&s->table, &table, shared->catalog, path);
    const Config *config = shared->config;
    unsigned      raw = 0;
    if (status == STATUS_OK) session_keep(s);
    if (status == STATUS_OK) status = sensors_chains(s->chain, shared->sensors, config);
    for (int b = 0; b < BAND_COUNT; b++)
        if (s->chain[b] && config->detector.raw && config->publish.files) raw |= 1u << b;
    const unsigned kept = shared->bands | (frame_files_truth(config) ? frame_truth : 0);
    if (status == STATUS_OK) status = frame_files_prepare(s->out, config->publish.files ? kept : 0, raw);
    if (status != STATUS_OK) return status;
    snprintf(path, sizeof path, "%s/truth.jsonl", s->out);
    s->truth = fopen(path, "w");
    if (!s->truth) {
        log_error("session: cannot write %s: %s; choose another place with --out", path, strerror(errno));
        return STATUS_IO;
    }
    s->truth_patience = (Patience){.what = "lines in truth.jsonl"};
    if (shared->live) return config->publish.files ? open_writer(s) : STATUS_OK;
    if (config->publish.coco)
        status = coco_open(&s->coco, s->out, config->publish.png ? "png" : "exr",
                           (CocoLimits){config->publish.coco_min_pixels, config->publish.coco_min_visible},
                           shared->config_sha256, config->seed);
    if (status == STATUS_OK && strcmp(config->publish.pairs, "off") != 0)
        status = pairs_open(&s->pairs, shared, s->out, raw);
    return status;
}

Status session_open(Session **out, const SessionShared *shared, const HostPlan *plan, Player *player,
                    const char *folder)
{
    Session *s = calloc(1, sizeof *s);
    if (!s) return STATUS_NO_MEMORY;
    s->shared = shared;
    s->plan   = *plan;
    s->player = player;
    Status status = STATUS_OK;
    if (snprintf(s->out, sizeof s->out, "%s", folder) >= (int)sizeof s->out) status = STATUS_BAD_VALUE;
    if (status == STATUS_OK) status = open_session(s);
    if (status == STATUS_OK) *out = s;
    else session_close(s, NULL);
    return status;
}

/* ---- frame after frame ------------------------------------------------------------------------ */

static Status list_frame(SessionResult *r, int *capacity, int number, const FrameDone *done)
{
    r->frames++;
    render_counters_add(&r->counters, &done->counters);
    if (r->listed == session_frames_kept) return STATUS_OK;
    if (r->listed == *capacity) {
        const int larger = *capacity ? 2 * *capacity : 1024;
        int (*numbers)   = realloc(r->number, (size_t)larger * sizeof *numbers);
        if (numbers) r->number = numbers;
        char(*hash)[sha256_text_size] = realloc(r->hash, (size_t)larger * sizeof *hash);
        if (hash) r->hash = hash;
        double(*stage_ms)[session_stages] = realloc(r->stage_ms, (size_t)larger * sizeof *stage_ms);
        if (stage_ms) r->stage_ms = stage_ms;
        if (!numbers || !hash || !stage_ms) return STATUS_NO_MEMORY;
        *capacity = larger;
    }
    r->number[r->listed] = number;
    memcpy(r->hash[r->listed], done->hash, sizeof done->hash);
    memcpy(r->stage_ms[r->listed], done->stage_ms, sizeof done->stage_ms);
    r->listed++;
    return STATUS_OK;
}

/* What did not fit: at once, and then once a minute where there is more. */
static void say_crowd(Session *s, const FrameDone *done)
{
    static const double   remind_s = 60;
    const EntityCounters *c        = entity_table_counters(s->table);
    const Config         *config   = s->shared->config;
    const uint64_t        given_up = c->evicted + c->refused;
    const double          now_s    = wall_clock_s();
    DisEntityId           sender;
    if (given_up > s->given_up_said && !(now_s - s->given_up_said_s < remind_s)) {
        const int most = entity_table_largest_sender(&sender, s->table);
        log_warn("host %s: the table of %d entities is full: %llu gave way to others, %llu were not taken in; %u:%u has "
                 "the most, %d; near the host, and what goes on reporting, stays (entities.capacity)",
                 s->host_text, config->entities.capacity, (unsigned long long)c->evicted, (unsigned long long)c->refused,
                 sender.site, sender.application, most);
        s->given_up_said   = given_up;
        s->given_up_said_s = now_s;
    }
    if (done->left_out == 0) return;
    if (!(now_s - s->left_out_said_s < remind_s)) {
        log_warn("host %s: %d entities are not in the pictures, the farthest from it; the nearest %d are (entities.shown)",
                 s->host_text, done->left_out, config->entities.shown);
        s->left_out_said_s = now_s;
    }
    s->result.frames_crowded++;
    if (done->left_out > s->result.most_left_out) s->result.most_left_out = done->left_out;
}

Status session_frame(bool *shown, Session *s, int number, double t_s)
{
    FrameDone done;
    session_advance(s, t_s);
    Status status = make_frame(&done, s, number, t_s);
    *shown        = done.shown;
    say_crowd(s, &done);
    if (status == STATUS_OK && done.shown) status = list_frame(&s->result, &s->capacity, number, &done);
    if (status == STATUS_NO_MEMORY)
        log_error("session: out of memory at frame %d; choose a smaller --size or fewer --samples", number);
    return status;
}

const SessionResult *session_result(const Session *s) { return &s->result; }
int                  session_entities(const Session *s) { return entity_table_count(s->table); }
uint64_t             session_over_rate(const Session *s) { return entity_table_counters(s->table)->over_rate; }
const char          *session_host(const Session *s) { return s->host_text; }

Status session_close(Session *s, SessionResult *result)
{
    Status status = STATUS_OK;
    const FrameWriterCounters written = frame_writer_destroy(s->writer);
    s->result.files_failed   = written.failed + s->truth_patience.lacking;
    s->result.files_left_out = written.left_out;
    player_forgotten(&s->result.shots_forgotten, &s->result.munitions_forgotten, s->player);
    if (s->table) s->result.entities = *entity_table_counters(s->table);
    if (s->table) s->result.effects = *entity_table_effect_counters(s->table);
    if (s->truth && fclose(s->truth) != 0) {
        log_error("session: cannot write truth.jsonl: %s", strerror(errno));
        status = STATUS_IO;
    }
    const Status coco = coco_close(s->coco), pairs = pairs_close(s->pairs);
    if (status == STATUS_OK) status = coco != STATUS_OK ? coco : pairs;
    if (result) *result = s->result;
    else session_result_free(&s->result);
    for (int b = 0; b < BAND_COUNT; b++) chain_destroy(s->chain[b]);
    entity_table_destroy(s->table);
    arena_destroy(s->frame_arena);
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
