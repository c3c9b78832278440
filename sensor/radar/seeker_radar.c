/* sensor/radar/seeker_radar.c: a seeker's radar: its tables and memory, and the order of work in one shot, from
 * points to detections. */
#include "sensor/radar/seeker_radar_private.h"
#include "render/scattering/paths/attenuation.h"
#include "render/scattering/paths/radar_path.h"
#include "sensor/radar/detect_private.h"

#include <stdlib.h>

enum { fine_nice = 15, detections_most = 256, stream_noise = 0x3d000000 };
static const double fog_top_m = 300;       /* above the ground; of fogs 100 .. 500 m deep: estimate */
static const double no_reference_m = 1000; /* where there is neither an aim nor ground ahead */

/* ---- what lasts -------------------------------------------------------------------------------- */

static Status open_tables(SeekerRadar *r, const SeekerRadarConfig *config)
{
    char       path[4096], water[4096];
    const bool own = config->table && *config->table;
    Status     status = own || etc_path(path, sizeof path, "radars.csv")
                            ? radar_preset_read(&r->preset, own ? config->table : path, config->preset)
                            : STATUS_BAD_VALUE;
    if (status != STATUS_OK) return status;
    r->in_band = clutter_band_of(&r->band, r->preset.wave.centre_hz);
    if (!r->in_band && config->ground) {
        log_error("radar: %s: no ground is known at %g GHz (etc/radar/clutter.csv: 12-18, 27-40, 75-110); set "
                  "radar.ground: false",
                  r->preset.name, 1e-9 * r->preset.wave.centre_hz);
        return STATUS_BAD_VALUE;
    }
    if (!etc_path(path, sizeof path, "radar/clutter.csv")) return STATUS_BAD_VALUE;
    status = clutter_table_open(&r->clutter, path);
    if (status == STATUS_OK) status = radar_materials_load(&r->materials);
    if (status == STATUS_OK)
        status =
            etc_path(path, sizeof path, "radar/ground.csv") ? ground_table_open(&r->mirror, path) : STATUS_BAD_VALUE;
    if (status == STATUS_OK && config->scenery)
        status =
            etc_path(path, sizeof path, "radar/facades.csv") ? facade_table_open(&r->facades, path) : STATUS_BAD_VALUE;
    if (status == STATUS_OK && config->scenery)
        status =
            etc_path(path, sizeof path, "radar/things.csv") ? thing_table_open(&r->things, path) : STATUS_BAD_VALUE;
    if (status != STATUS_OK) return status;
    if (!etc_path(path, sizeof path, "radar/oxygen_lines.csv") ||
        !etc_path(water, sizeof water, "radar/water_lines.csv"))
        return STATUS_BAD_VALUE;
    return gas_lines_read(&r->gases, path, water);
}

SignaturesConfig seeker_radar_signatures(const RadarPreset *preset, double warp_m, const char *isa)
{
    return (SignaturesConfig){.frequency_hz = preset->wave.centre_hz,
                              .bandwidth_hz = preset->wave.bandwidth_hz,
                              .aspect_rad = 0.3 * rad_per_deg,
                              .interval_s = preset->wave.pulses / preset->wave.repeat_hz,
                              .rays_per_wavelength = 0.5,
                              .warp_m = warp_m,
                              .most_octets = (size_t)1 << 30,
                              .isa = isa};
}

Status seeker_radar_create(SeekerRadar **out, const SeekerRadarConfig *config)
{
    SeekerRadar *r = calloc(1, sizeof *r);
    if (!r) return STATUS_NO_MEMORY;
    r->ground = config->ground;
    r->ground_bounce = config->ground_bounce;
    r->scenery = config->scenery;
    r->wind_mps = config->wind_mps;
    r->seed = config->seed;
    r->chaff_dipoles = config->chaff_dipoles;
    Status          status = open_tables(r, config);
    const Waveform *wave = &r->preset.wave;
    if (status == STATUS_OK) status = catalog_open(&r->catalog, config->catalog, radar_sag_m(wave->centre_hz));
    SignaturesConfig signatures = seeker_radar_signatures(&r->preset, config->warp_m, config->isa);
    if (status == STATUS_OK && config->library && *config->library)
        status = signature_library_open(&r->library, config->library, &signatures, &r->materials);
    else if (status == STATUS_OK && config->cache)
        status = signature_library_of_cache(&r->library, config->cache, &signatures, &r->materials);
    if (r->library) signatures.store = signature_library_store(r->library);
    signatures.background = config->background;
    signatures.nice = fine_nice;
    if (status == STATUS_OK) status = signatures_create(&r->signatures, &signatures, r->catalog, &r->materials);
    r->fine = signatures;
    snprintf(r->catalog_path, sizeof r->catalog_path, "%s", config->catalog);
    if (status == STATUS_OK && config->background) status = radar_coarse_open(r);
    if (status == STATUS_OK && config->given && *config->given) status = given_list_open(&r->given, config->given);
    if (status == STATUS_OK && r->ground) status = clutter_cache_create(&r->drawn);
    if (status == STATUS_OK) status = echo_grid_create(&r->echoes, wave);
    if (status == STATUS_OK)
        status = interval_plan_create(&r->plan, wave, &r->preset.range_window, &r->preset.doppler_window);
    if (status == STATUS_OK) status = radar_sector_plan(&r->sector, &r->preset, config->scan_rad, config->scan_step);
    if (status == STATUS_OK) {
        const size_t samples = (size_t)r->sector.positions * (size_t)wave->pulses * (size_t)wave->samples;
        r->batch = malloc(beam_batch * sizeof *r->batch);
        if (config->scan_rad > 0) r->sector_pulse = malloc(samples * sizeof *r->sector_pulse);
        if (config->scan_rad > 0) r->position = arena_create();
        if (!r->batch || (config->scan_rad > 0 && (!r->sector_pulse || !r->position))) status = STATUS_NO_MEMORY;
    }
    r->cells = (ClutterGrid){.side_m = 0.25 * light_mps / wave->bandwidth_hz, .seed = config->seed};
    if (status == STATUS_OK) *out = r;
    else seeker_radar_destroy(r);
    return status;
}

void seeker_radar_destroy(SeekerRadar *r)
{
    if (!r) return;
    interval_plan_destroy(r->plan);
    echo_grid_destroy(r->echoes);
    centres_free(&r->centres);
    clutter_cache_destroy(r->drawn);
    radar_points_free(&r->points);
    free(r->batch);
    free(r->sector_pulse);
    if (r->position) arena_destroy(r->position);
    radar_coarse_close(r);
    signatures_destroy(r->signatures);
    signature_library_close(r->library);
    given_list_close(r->given);
    leaf_cache_destroy(r->leaves);
    foliage_destroy(r->foliage);
    radar_materials_close(&r->materials);
    if (r->catalog) catalog_close(r->catalog);
    free(r);
}

/* ---- where the window is, and the air ------------------------------------------------------------ */

/* Range to the ground along the boresight; NAN: there is none. */
static double range_ahead(const RadarShot *shot)
{
    static _Thread_local Rays rays;
    static _Thread_local Hits hits;
    VisibilityCounters        counters = {0};
    rays.count = 1;
    rays.columns = 0;
    rays.bent = true;
    rays.far_m[0] = INFINITY;
    for (int k = 0; k < 3; k++) {
        rays.o_enu[k][0] = shot->scene->view->p_enu[k];
        rays.d_enu[k][0] = shot->ahead[k];
    }
    visibility_first_hit(&hits, shot->visibility, &rays, visibility_all_but(shot->scene->hidden), &counters);
    return hits.count > 0 && isfinite(hits.range_m[0]) ? hits.range_m[0] : NAN;
}

/* Sets what the window is about, and what is kept for positions of the beam before and after. */
static void aim_window(RadarShot *shot)
{
    RadarFrame *f = shot->frame;
    f->reference_m = shot->scene->reference_m;
    if (!isfinite(f->reference_m)) f->reference_m = range_ahead(shot);
    if (!isfinite(f->reference_m)) f->reference_m = no_reference_m;
    double v[3], end[3], ground_m = 0;
    v3_sub(v, shot->scene->reference_v_enu_mps, shot->scene->v_enu_mps);
    f->reference_rate_mps = v3_dot(v, shot->ahead);
    v3_add_scaled(end, shot->scene->view->p_enu, f->reference_m, shot->ahead);
    if (shot->scene->world->landscape)
        ground_m = elevation_height(&shot->scene->world->landscape->elevation, end[0], end[1], NULL);
    shot->base_m = isfinite(ground_m) ? ground_m : 0;
    shot->aim_m = f->reference_m;
    shot->reference_rate_mps = f->reference_rate_mps;
    const SectorPlan *sector = &shot->radar->sector;
    const double      half_s = sector->positions / 2 * sector->interval_s;
    shot->sector_half_rad = sector->positions / 2 * sector->step_rad;
    shot->sweep_m = half_s * (v3_length(v) + v3_length(shot->scene->v_enu_mps));
}

/* Sets near_m and far_m about reference_m. */
static void set_reach(RadarShot *shot)
{
    const double far_m = shot->preset->far_m;
    shot->near_m = far_m > 0 ? 0 : fmax(shot->reference_m - shot->half_window_m, 0);
    shot->far_m = fmax(far_m, shot->reference_m + shot->half_window_m);
}

/* Sets the window, and what the receiver follows. */
static void follow(RadarShot *shot)
{
    RadarFrame   *f = shot->frame;
    const double  row_s = 1 / shot->preset->wave.repeat_hz;
    const bool    fmcw = shot->preset->wave.kind == WAVEFORM_FMCW;
    const double *right = shot->right, *down = shot->down, *v = shot->scene->v_enu_mps;
    if (fmcw) f->reference_m = shot->half_window_m;
    shot->reference_m = f->reference_m;
    shot->window_rate_mps = fmcw ? 0 : shot->reference_rate_mps;
    set_reach(shot);
    echo_unfollowed(shot->radar->echoes, shot->preset->wave.uncompensated ? 2 * shot->reference_rate_mps * row_s : 0);
    f->ground_rate_mps = -v3_dot(v, shot->ahead);
    /* the range rates of the ground over the beam: within its width on either side, and two cells of Doppler for the
     * window */
    f->notch_mps = hypot(v3_dot(v, right), v3_dot(v, down)) * antenna_width_rad(&shot->preset->antenna) +
                   2 * f->timing.blind_mps / shot->preset->wave.pulses;
}

/* Computes the loss by the air over the reference range; it is taken to be even along it. */
static Status air_between(RadarShot *shot)
{
    const World  *world = shot->scene->world;
    const double *p = shot->scene->view->p_enu;
    double        end[3];
    RadarLoss     loss;
    if (!world->atmosphere) return STATUS_OK;
    const Status status = radar_air_of(&shot->radar->air, world->atmosphere, shot->scene->weather);
    if (status != STATUS_OK) return status;
    if (shot->preset->wave.centre_hz <= 200e9 && shot->scene->weather->fog != WEATHER_FOG_NONE) /* P.840's range */
        shot->radar->air.liquid[0] = (RadarLiquid){0, fog_top_m, fog_liquid_g_m3(shot->scene->weather->visibility_m)};
    v3_add_scaled(end, p, shot->frame->reference_m, shot->ahead);
    const RadarPath path = {.a_m = clamp(p[2] - shot->base_m, 0, 20000),
                            .b_m = clamp(end[2] - shot->base_m, 0, 20000),
                            .range_m = fmin(shot->frame->reference_m, 1e6),
                            .f_ghz = 1e-9 * shot->preset->wave.centre_hz,
                            .tilt_rad = shot->preset->transmits_h ? 0 : 0.5 * pi_rad};
    radar_path_loss(&loss, &path, &shot->radar->gases, &shot->radar->air);
    shot->frame->air_db = radar_loss_db(&loss);
    if (!isfinite(shot->frame->air_db)) shot->frame->air_db = 0;
    shot->air_np_m = shot->frame->air_db * log(10) / 10 / shot->frame->reference_m;
    return STATUS_OK;
}

/* ---- the echoes of a position of the beam ------------------------------------------------------------ */

/* What one position receives of a frame's points.
 *
 * A position is a RadarShot with an axis of its own, an instant of its own (after_s, from the frame's time) and the
 * antenna where it is then; points have moved by their own velocities. A path and its growth are those at the frame's
 * time plus the change of the range of the point since: exact for what moves evenly. Entities are seen anew, as their
 * aspect changes; so is rain. */

enum { block = 1024 };

void shot_position(RadarShot *out, const RadarShot *shot, double azimuth_rad, double after_s)
{
    const double c = cos(azimuth_rad), s = sin(azimuth_rad);
    *out = *shot;
    out->sector_half_rad = out->sweep_m = 0;
    out->after_s = after_s;
    out->reference_m = shot->reference_m + shot->window_rate_mps * after_s;
    set_reach(out);
    for (int k = 0; k < 3; k++) {
        out->p_enu[k] = shot->p_enu[k] + shot->scene->v_enu_mps[k] * after_s;
        out->right[k] = c * shot->right[k] - s * shot->ahead[k];
        out->ahead[k] = c * shot->ahead[k] + s * shot->right[k];
    }
}

bool shot_echo(Echo *e, const RadarShot *beam, const RadarPoint *q)
{
    double p[3];
    Sight  sight;
    v3_add_scaled(p, q->p_enu, q->own ? 0 : beam->after_s, q->v_enu_mps);
    shot_sight(&sight, beam, p, q->room_m);
    if (!sight.within || shot_off_axis(beam, &sight) > q->widest) return false;
    const double volume_np = shot_volume_np(beam, &sight);
    if (volume_np > gone_np) return false;
    const ScatterMatrix s = {.hh = q->same, .vv = q->same, .hv = q->other, .vh = q->other};
    shot_amplitudes_through(e->amplitude, beam, &sight, &s, volume_np);
    for (int k = 0; k < interval_channels; k++) e->amplitude[k] *= q->share;
    e->path_m = q->path_m;
    e->path_per_pulse_m = q->path_per_pulse_m;
    if (beam->after_s == 0 || q->own) return true;
    double at_frame[3];
    v3_sub(at_frame, q->p_enu, beam->scene->view->p_enu);
    const double was_m = v3_length(at_frame), rate_mps = shot_range_rate(beam, &sight, q->v_enu_mps);
    v3_scale(at_frame, 1 / fmax(was_m, 1e-3), at_frame);
    const double was_mps = v3_dot(at_frame, q->v_enu_mps) - v3_dot(at_frame, beam->scene->v_enu_mps);
    e->path_m += 2 * ((sight.range_m - was_m) - beam->window_rate_mps * beam->after_s);
    e->path_per_pulse_m += 2 * (rate_mps - was_mps) / beam->preset->wave.repeat_hz;
    return true;
}

typedef struct BeamJob {
    const RadarShot *beam;
    int              first, end;
    bool             sum_alone;
    Echo            *echo; /* echoes of block b begin at b * block */
    int              kept[beam_batch / block];
} BeamJob;

static void echo_block(void *user, int worker, int task)
{
    BeamJob  *job = user;
    const int first = job->first + task * block, end = first + block < job->end ? first + block : job->end;
    Echo     *e = job->echo + (size_t)task * block;
    (void)worker;
    int kept = 0;
    for (int i = first; i < end; i++) {
        if (!shot_echo(&e[kept], job->beam, &job->beam->radar->points.point[i])) continue;
        if (job->sum_alone)
            for (int c = CHANNEL_SUM + 1; c < interval_channels; c++) e[kept].amplitude[c] = 0;
        kept++;
    }
    job->kept[task] = kept;
}

Status shot_echoes(RadarShot *beam, bool sum_alone)
{
    SeekerRadar *r = beam->radar;
    const int    lasting = r->points.count, from = beam->after_s == 0 ? 0 : r->target_points;
    Status       status = shot_rain(beam);
    if (beam->after_s != 0) shot_volume_fan(beam);
    if (status == STATUS_OK && beam->after_s != 0) status = shot_targets_anew(beam);
    if (status != STATUS_OK || beam->missing > 0) return status;
    for (int first = from; first < r->points.count; first += beam_batch) {
        const int end = first + beam_batch < r->points.count ? first + beam_batch : r->points.count;
        const int blocks = (end - first + block - 1) / block;
        BeamJob   job = {.beam = beam, .first = first, .end = end, .sum_alone = sum_alone, .echo = r->batch};
        if (beam->pool) pool_run(beam->pool, blocks, echo_block, &job);
        else
            for (int b = 0; b < blocks; b++) echo_block(&job, 0, b);
        int kept = 0; /* moved together: one call for all */
        for (int b = 0; b < blocks; b++) {
            if (kept != b * block)
                memmove(r->batch + kept, r->batch + (size_t)b * block, (size_t)job.kept[b] * sizeof *r->batch);
            kept += job.kept[b];
        }
        echo_add(r->echoes, r->batch, kept, beam->pool);
    }
    r->points.count = lasting;
    return echo_status(r->echoes);
}

/* ---- moving targets --------------------------------------------------------------------------------- */

/* Makes the profile behind the canceller, and says of each detection whether it moves against the ground. */
static Status indicate_moving(RadarShot *shot, Detection *detection)
{
    RadarFrame     *f = shot->frame;
    const Waveform *wave = &shot->preset->wave;
    f->mti_w = arena_alloc(shot->arena, (size_t)wave->samples, sizeof *f->mti_w);
    if (!f->mti_w) return STATUS_NO_MEMORY;
    detect_mti_profile(f->mti_w, interval_pulses(shot->radar->plan, CHANNEL_SUM), wave, shot->preset->mti_rows,
                       2 * (f->ground_rate_mps - f->reference_rate_mps) / wave->repeat_hz);
    for (int i = 0; i < f->detections; i++) {
        Detection   *d = &detection[i];
        const double along = sqrt(fmax(0, 1 - d->cos_right * d->cos_right - d->cos_down * d->cos_down));
        const double ground_mps = along * f->ground_rate_mps -
                                  d->cos_right * v3_dot(shot->scene->v_enu_mps, shot->right) -
                                  d->cos_down * v3_dot(shot->scene->v_enu_mps, shot->down);
        d->moving = detect_moves(d->range_rate_mps, ground_mps, f->notch_mps, f->timing.blind_mps);
    }
    return STATUS_OK;
}

/* ---- one interval --------------------------------------------------------------------------------- */

/* Processes the samples of an interval into its map, profiles and detections. */
static Status process(RadarShot *shot, const Interval *interval)
{
    RadarFrame        *f = shot->frame;
    const RadarPreset *p = shot->preset;
    const size_t       plane = (size_t)p->wave.pulses * (size_t)p->wave.samples, all = interval_channels * plane;
    Detection         *detection = arena_alloc(shot->arena, detections_most, sizeof *detection);
    f->map.cell = arena_alloc(shot->arena, all, sizeof *f->map.cell);
    f->profile = arena_alloc(shot->arena, 2 * (size_t)p->wave.samples, sizeof *f->profile);
    f->profile_w = arena_alloc(shot->arena, (size_t)p->wave.samples, sizeof *f->profile_w);
    if (!detection || !f->map.cell || !f->profile || !f->profile_w) return STATUS_NO_MEMORY;
    interval_process(&f->map, shot->radar->plan, interval, shot->pool);
    interval_profile(f->profile_w, shot->radar->plan, CHANNEL_SUM);
    interval_pulse(f->profile, shot->radar->plan, CHANNEL_SUM, p->wave.pulses / 2);
    interval_pulse(f->profile + p->wave.samples, shot->radar->plan, CHANNEL_CROSS, p->wave.pulses / 2);

    const RadarLink   link = {p->power_w, 1, 1, p->antenna.wavelength_m, 1, p->loss};
    const DetectScale scale = {.range_m = f->reference_m,
                               .range_rate_mps = f->reference_rate_mps,
                               .unit_w = radar_received_w(&link, 1),
                               .air_np_m = shot->air_np_m};
    /* guards as wide as a vehicle's own returns, 6 m, and the Doppler main lobe */
    const int        extent = (int)clamp(ceil(6 / f->map.metre_per_column), 2, p->wave.samples / 8);
    const CfarConfig cfar = {
        .pfa = p->pfa, .guard = {2, extent}, .training = {p->wave.pulses >= 32 ? 3 : 0, extent}, .wrap_rows = true};
    f->detections_in_all = detect(detection, detections_most, &f->map, shot->radar->plan, &cfar, &p->antenna, &scale);
    if (f->detections_in_all < 0) return STATUS_NO_MEMORY;
    f->detections = f->detections_in_all < detections_most ? f->detections_in_all : detections_most;
    f->detection = detection;
    const Status status = shot_tell(shot, detection);
    return status == STATUS_OK ? indicate_moving(shot, detection) : status;
}

/* Says when a step is over; *begun_s: when it began. */
static void note_step(RadarShot *shot, RadarStep step, double *begun_s)
{
    const double now_s = wall_clock_s();
    shot->frame->step_s[step] = now_s - *begun_s;
    *begun_s = now_s;
}

/* The order of work in a shot. */
static Status make(RadarShot *shot)
{
    double                 begun_s = wall_clock_s();
    const RadarScene      *scene = shot->scene;
    const Waveform        *wave = &shot->preset->wave;
    Interval               interval = {.wave = *wave, .pool = shot->pool};
    Visibility            *visibility;
    const double          *p = scene->view->p_enu;
    const VisibilityConfig seen = {.tracer = scene->world->tracer,
                                   .ground = scene->world->landscape,
                                   .frame = &scene->world->frame,
                                   .snapshot = scene->snapshot,
                                   .skips_off = scene->skips_off,
                                   .eye_enu = {p[0], p[1], p[2]},
                                   .bend_per_m = scene->refraction ? world_bend(scene->world, REFRACTION_RADAR, p) : 0};
    Status                 status = visibility_create_seen(&visibility, &seen, shot->arena);
    if (status != STATUS_OK) return status;
    visibility_materials(visibility, &scene->world->materials);
    status = world_scenery_join(visibility, scene->world, scene->t_s, &seen, shot->arena);
    if (status != STATUS_OK) return status;
    shot->visibility = visibility;
    shot->radar->points.count = 0;
    interval.sample = arena_alloc(shot->arena, interval_channels * (size_t)wave->pulses * (size_t)wave->samples,
                                  sizeof *interval.sample);
    if (!interval.sample) return STATUS_NO_MEMORY;
    aim_window(shot);
    follow(shot);
    status = air_between(shot);
    if (status == STATUS_OK) status = shot_volume_open(shot);
    note_step(shot, RADAR_PREPARE, &begun_s);
    if (status == STATUS_OK) status = shot_targets(shot);
    note_step(shot, RADAR_TARGETS, &begun_s);
    if (shot->missing > 0) return status;
    if (status == STATUS_OK) status = shot_scenery_open(shot);
    if (status == STATUS_OK && shot->radar->ground && scene->world->landscape) status = shot_ground(shot);
    if (status == STATUS_OK) status = shot_scenery(shot);
    note_step(shot, RADAR_GROUND, &begun_s);
    if (status == STATUS_OK) status = shot_volume(shot);
    if (status == STATUS_OK) status = visibility_status(visibility);
    note_step(shot, RADAR_VOLUMES, &begun_s);
    if (status != STATUS_OK) return status;
    RadarShot beam;
    shot_position(&beam, shot, 0, 0);
    status = shot_echoes(&beam, false);
    if (status != STATUS_OK) return status;
    echo_sum(interval.sample, shot->radar->echoes);
    note_step(shot, RADAR_ECHOES, &begun_s);
    if (wave->uncompensated) shot->frame->reference_rate_mps = 0; /* it is in every echo */
    interval_receive(&shot->frame->receiver, &interval, &shot->preset->receiver, shot->radar->seed, stream_noise,
                     scene->number);
    status = process(shot, &interval);
    if (status == STATUS_OK && shot->radar->sector_pulse) status = shot_sector(shot, &interval);
    note_step(shot, RADAR_PROCESS, &begun_s);
    return status;
}

Status seeker_radar_measure(const RadarFrame **out, SeekerRadar *radar, const RadarScene *scene, Pool *pool,
                            Arena *arena)
{
    const double       begun_s = wall_clock_s();
    const RadarPreset *p = &radar->preset;
    RadarFrame        *frame = arena_alloc(arena, 1, sizeof *frame);
    if (!frame) return STATUS_NO_MEMORY;
    RadarShot shot = {.radar = radar,
                      .scene = scene,
                      .preset = p,
                      .frame = frame,
                      .pool = pool,
                      .arena = arena,
                      .half_window_m = p->wave.samples * light_mps / (4 * p->wave.bandwidth_hz),
                      .reach = scene->reach > 0 ? scene->reach : 1};
    shot.widest = shot.reach * 16 / antenna_u_per_sine(&p->antenna);
    *frame = (RadarFrame){.preset = p, .aim_m = scene->reference_m, .number = scene->number};
    memcpy(frame->v_enu_mps, scene->v_enu_mps, sizeof frame->v_enu_mps);
    memcpy(frame->aim_v_enu_mps, scene->reference_v_enu_mps, sizeof frame->aim_v_enu_mps);
    waveform_timing(&frame->timing, &p->wave);
    const double *r = scene->view->r_enu_from_cam;
    for (int k = 0; k < 3; k++) {
        shot.p_enu[k] = scene->view->p_enu[k];
        shot.right[k] = r[3 * k];
        shot.down[k] = r[3 * k + 1];
        shot.ahead[k] = r[3 * k + 2];
    }
    Status status = scene->coarse ? radar_coarse_open(radar) : STATUS_OK;
    shot.coarse = scene->coarse;
    if (status == STATUS_OK) status = make(&shot);
    if (status == STATUS_OK && shot.missing > 0 && !shot.coarse) { /* then all targets by coarse ones */
        echo_forget(radar->echoes);
        shot.coarse = true;
        shot.missing = 0;
        status = make(&shot);
    }
    frame->coarse = shot.coarse;
    if (status != STATUS_OK || shot.missing > 0) echo_forget(radar->echoes);
    frame->spent_s = wall_clock_s() - begun_s;
    radar->left_out += shot.missing > 0;
    if (status == STATUS_OK) *out = shot.missing > 0 ? NULL : frame;
    return status;
}
