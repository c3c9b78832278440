/* sensor/radar/seeker_radar.c: see seeker_radar.h. */
#include "sensor/radar/seeker_radar_private.h"

#include "render/radar/cloud_attenuation.h"
#include "render/radar/radar_equation.h"
#include "sensor/radar/mti.h"

#include <stdlib.h>

enum { detections_most = 256, stream_noise = 0x3d000000 };
static const double fog_top_m = 300;       /* above the ground; of fogs 100 .. 500 m deep: estimate */
static const double no_reference_m = 1000; /* where there is neither an aim nor ground ahead */

/* ---- what lasts -------------------------------------------------------------------------------- */

static Status open_tables(SeekerRadar *r, const SeekerRadarConfig *config)
{
    char   path[4096], water[4096];
    const bool own = config->table && *config->table;
    Status status = own || etc_path(path, sizeof path, "radars.csv")
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
    r->wind_mps = config->wind_mps;
    r->seed = config->seed;
    r->chaff_dipoles = config->chaff_dipoles;
    Status status = open_tables(r, config);
    const Waveform *wave = &r->preset.wave;
    if (status == STATUS_OK) status = catalog_open(&r->catalog, config->catalog, radar_sag_m(wave->centre_hz));
    SignaturesConfig signatures = seeker_radar_signatures(&r->preset, config->warp_m, config->isa);
    if (status == STATUS_OK && config->library && *config->library)
        status = signature_library_open(&r->library, config->library, &signatures, &r->materials);
    if (r->library) signatures.store = signature_library_store(r->library);
    signatures.background = config->background;
    if (status == STATUS_OK) status = signatures_create(&r->signatures, &signatures, r->catalog, &r->materials);
    if (status == STATUS_OK && config->given && *config->given) status = given_list_open(&r->given, config->given);
    if (status == STATUS_OK && r->ground) status = clutter_cache_create(&r->drawn);
    if (status == STATUS_OK) status = echo_grid_create(&r->echoes, wave);
    if (status == STATUS_OK)
        status = interval_plan_create(&r->plan, wave, &r->preset.range_window, &r->preset.doppler_window);
    if (status == STATUS_OK) status = scan_plan(&r->scan, &r->preset, config->scan_rad, config->scan_step);
    if (status == STATUS_OK) {
        const size_t samples = (size_t)r->scan.positions * (size_t)wave->pulses * (size_t)wave->samples;
        r->batch = malloc(beam_batch * sizeof *r->batch);
        if (config->scan_rad > 0) r->scan_pulse = malloc(samples * sizeof *r->scan_pulse);
        if (config->scan_rad > 0) r->position = arena_create();
        if (!r->batch || (config->scan_rad > 0 && (!r->scan_pulse || !r->position))) status = STATUS_NO_MEMORY;
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
    points_free(&r->points);
    free(r->batch);
    free(r->scan_pulse);
    if (r->position) arena_destroy(r->position);
    signatures_destroy(r->signatures);
    signature_library_close(r->library);
    given_list_close(r->given);
    foliage_destroy(r->foliage);
    radar_materials_close(&r->materials);
    if (r->catalog) catalog_close(r->catalog);
    free(r);
}

/* ---- geometry and the radar equation ------------------------------------------------------------ */

void making_sight(Sight *out, const Making *m, const double p_enu[3], double more_m)
{
    double to[3];
    v3_sub(to, p_enu, m->p_enu);
    out->range_m = v3_length(to);
    v3_scale(out->d_enu, 1 / fmax(out->range_m, 1e-3), to);
    out->cos_right = v3_dot(out->d_enu, m->right);
    out->cos_down = v3_dot(out->d_enu, m->down);
    const double fold_m = waveform_fold_m(&m->preset->wave);
    double       off_m = out->range_m - m->reference_m;
    if (m->preset->far_m > 0 && out->range_m < m->preset->far_m + more_m) off_m -= fold_m * nearbyint(off_m / fold_m);
    out->within = v3_dot(out->d_enu, m->ahead) > 0 && fabs(off_m) < m->half_window_m + (m->sweep_m + more_m);
}

double making_off_axis(const Making *m, const Sight *sight)
{
    if (!(m->scan_half_rad > 0)) return sqrt(sight->cos_right * sight->cos_right + sight->cos_down * sight->cos_down);
    const double ahead = v3_dot(sight->d_enu, m->ahead), azimuth = atan2(sight->cos_right, ahead);
    const double off = azimuth - clamp(azimuth, -m->scan_half_rad, m->scan_half_rad);
    return hypot(sin(off) * hypot(sight->cos_right, ahead), sight->cos_down);
}

double making_range_rate(const Making *m, const Sight *sight, const double v_enu_mps[3])
{
    return v3_dot(sight->d_enu, v_enu_mps) - v3_dot(sight->d_enu, m->scene->v_enu_mps);
}

double making_appears_m(const Making *m, const Sight *sight, double range_rate_mps)
{
    const double followed_mps = m->preset->wave.uncompensated ? 0 : m->reference_rate_mps, middle_m = m->reference_m;
    return middle_m + waveform_appears_m(&m->preset->wave, sight->range_m - middle_m, range_rate_mps - followed_mps);
}

void making_amplitudes(double complex amplitude[interval_channels], const Making *m, const Sight *sight,
                       const ScatterMatrix *s)
{
    const RadarPreset   *p = m->preset;
    const AntennaGain    gain = antenna_gain(&p->antenna, sight->cos_right, sight->cos_down);
    const RadarLink      link = {p->power_w, 1, 1, p->antenna.wavelength_m, sight->range_m, p->loss};
    const double         through_np = m->air_np_m * sight->range_m + making_volume_np(m, sight);
    const double unit =
        sqrt(radar_received_w(&link, 4 * pi_rad) * exp(-2 * through_np)) * waveform_share(&p->wave, sight->range_m);
    const double complex same = unit * gain.sum * (p->transmits_h ? s->hh : s->vv);
    const double complex other = unit * gain.sum * (p->transmits_h ? s->vh : s->hv);
    amplitude[CHANNEL_SUM] = same * gain.sum;
    amplitude[CHANNEL_RIGHT] = same * gain.right;
    amplitude[CHANNEL_DOWN] = same * gain.down;
    amplitude[CHANNEL_CROSS] = other * gain.sum;
}

double making_null(const Making *m)
{
    static const double null_u[] = {3.8317, 5.1356, 6.3802}; /* first zero of the sum beam by the dish's taper */
    return fmin(null_u[m->preset->antenna.taper] / antenna_u_per_sine(&m->preset->antenna), 1);
}

/* Range to the ground along the boresight; NAN: there is none. */
static double range_ahead(const Making *m)
{
    static _Thread_local Rays rays;
    static _Thread_local Hits hits;
    VisibilityCounters        counters = {0};
    rays.count = 1;
    rays.columns = 0;
    rays.far_m[0] = INFINITY;
    for (int k = 0; k < 3; k++) {
        rays.o_enu[k][0] = m->scene->view->p_enu[k];
        rays.d_enu[k][0] = m->ahead[k];
    }
    visibility_first_hit(&hits, m->visibility, &rays, NULL, -1, m->scene->hidden, &counters);
    return hits.count > 0 && isfinite(hits.range_m[0]) ? hits.range_m[0] : NAN;
}

static void aim_window(Making *m)
{
    RadarFrame *f = m->frame;
    f->reference_m = m->scene->reference_m;
    if (!isfinite(f->reference_m)) f->reference_m = range_ahead(m);
    if (!isfinite(f->reference_m)) f->reference_m = no_reference_m;
    double v[3], end[3], ground_m = 0;
    v3_sub(v, m->scene->reference_v_enu_mps, m->scene->v_enu_mps);
    f->reference_rate_mps = v3_dot(v, m->ahead);
    v3_add_scaled(end, m->scene->view->p_enu, f->reference_m, m->ahead);
    if (m->scene->world->landscape)
        ground_m = elevation_height(&m->scene->world->landscape->elevation, end[0], end[1], NULL);
    m->base_m = isfinite(ground_m) ? ground_m : 0;
    m->aim_m = f->reference_m;
    m->reference_rate_mps = f->reference_rate_mps;
    /* to be kept for positions of the beam before and after */
    const ScanPlan *scan = &m->radar->scan;
    const double    half_s = scan->positions / 2 * scan->interval_s;
    m->scan_half_rad = scan->positions / 2 * scan->step_rad;
    m->sweep_m = half_s * (v3_length(v) + v3_length(m->scene->v_enu_mps));
}

void making_reach(Making *m)
{
    const double far_m = m->preset->far_m;
    m->near_m = far_m > 0 ? 0 : fmax(m->reference_m - m->half_window_m, 0);
    m->far_m = fmax(far_m, m->reference_m + m->half_window_m);
}

/* The window, and what the receiver follows. */
static void follow(Making *m)
{
    RadarFrame   *f = m->frame;
    const double  row_s = 1 / m->preset->wave.repeat_hz;
    const bool    fmcw = m->preset->wave.kind == WAVEFORM_FMCW;
    const double *right = m->right, *down = m->down, *v = m->scene->v_enu_mps;
    if (fmcw) f->reference_m = m->half_window_m;
    m->reference_m = f->reference_m;
    m->window_rate_mps = fmcw ? 0 : m->reference_rate_mps;
    making_reach(m);
    echo_unfollowed(m->radar->echoes, m->preset->wave.uncompensated ? 2 * m->reference_rate_mps * row_s : 0);
    f->ground_rate_mps = -v3_dot(v, m->ahead);
    /* the ground's rates over the beam: within its width either way, and two cells of Doppler for the window */
    f->notch_mps = hypot(v3_dot(v, right), v3_dot(v, down)) * antenna_width_rad(&m->preset->antenna) +
                   2 * f->timing.blind_mps / m->preset->wave.pulses;
}

/* Loss by the air over the reference range, taken as even along it. */
static Status air_between(Making *m)
{
    const World  *world = m->scene->world;
    const double *p = m->scene->view->p_enu;
    double        end[3];
    RadarLoss     loss;
    if (!world->atmosphere) return STATUS_OK;
    const Status status = radar_air_of(&m->radar->air, world->atmosphere, m->scene->weather);
    if (status != STATUS_OK) return status;
    if (m->preset->wave.centre_hz <= 200e9) /* P.840's range */
        m->radar->air.liquid[0] = (RadarLiquid){0, fog_top_m, fog_liquid_g_m3(m->scene->weather->visibility_m)};
    v3_add_scaled(end, p, m->frame->reference_m, m->ahead);
    const RadarPath path = {.a_m = clamp(p[2] - m->base_m, 0, 20000), .b_m = clamp(end[2] - m->base_m, 0, 20000),
                            .range_m = fmin(m->frame->reference_m, 1e6), .f_ghz = 1e-9 * m->preset->wave.centre_hz,
                            .tilt_rad = m->preset->transmits_h ? 0 : 0.5 * pi_rad};
    radar_path_loss(&loss, &path, &m->radar->gases, &m->radar->air);
    m->frame->air_db = radar_loss_db(&loss);
    if (!isfinite(m->frame->air_db)) m->frame->air_db = 0;
    m->air_np_m = m->frame->air_db * log(10) / 10 / m->frame->reference_m;
    return STATUS_OK;
}

/* ---- moving targets --------------------------------------------------------------------------------- */

static Status indicate_moving(Making *m, Detection *detection)
{
    RadarFrame     *f = m->frame;
    const Waveform *wave = &m->preset->wave;
    f->mti_w = arena_alloc(m->arena, (size_t)wave->samples, sizeof *f->mti_w);
    if (!f->mti_w) return STATUS_NO_MEMORY;
    mti_profile(f->mti_w, interval_pulses(m->radar->plan, CHANNEL_SUM), wave, m->preset->mti_rows,
                2 * (f->ground_rate_mps - f->reference_rate_mps) / wave->repeat_hz);
    for (int i = 0; i < f->detections; i++) {
        Detection   *d = &detection[i];
        const double along = sqrt(fmax(0, 1 - d->cos_right * d->cos_right - d->cos_down * d->cos_down));
        const double ground_mps = along * f->ground_rate_mps - d->cos_right * v3_dot(m->scene->v_enu_mps, m->right) -
                                  d->cos_down * v3_dot(m->scene->v_enu_mps, m->down);
        d->moving = mti_moves(d->range_rate_mps, ground_mps, f->notch_mps, f->timing.blind_mps);
    }
    return STATUS_OK;
}

/* ---- one interval --------------------------------------------------------------------------------- */

static Status process(Making *m, const Interval *interval)
{
    RadarFrame      *f = m->frame;
    const RadarPreset *p = m->preset;
    const size_t     plane = (size_t)p->wave.pulses * (size_t)p->wave.samples, all = interval_channels * plane;
    Detection       *detection = arena_alloc(m->arena, detections_most, sizeof *detection);
    f->map.cell = arena_alloc(m->arena, all, sizeof *f->map.cell);
    f->profile = arena_alloc(m->arena, 2 * (size_t)p->wave.samples, sizeof *f->profile);
    f->profile_w = arena_alloc(m->arena, (size_t)p->wave.samples, sizeof *f->profile_w);
    if (!detection || !f->map.cell || !f->profile || !f->profile_w) return STATUS_NO_MEMORY;
    interval_process(&f->map, m->radar->plan, interval, m->pool);
    interval_profile(f->profile_w, m->radar->plan, CHANNEL_SUM);
    interval_pulse(f->profile, m->radar->plan, CHANNEL_SUM, p->wave.pulses / 2);
    interval_pulse(f->profile + p->wave.samples, m->radar->plan, CHANNEL_CROSS, p->wave.pulses / 2);

    const RadarLink   link = {p->power_w, 1, 1, p->antenna.wavelength_m, 1, p->loss};
    const DetectScale scale = {.range_m = f->reference_m, .range_rate_mps = f->reference_rate_mps,
                               .unit_w = radar_received_w(&link, 1), .air_np_m = m->air_np_m};
    /* guards as wide as a vehicle's own returns, 6 m, and the Doppler main lobe */
    const int        extent = (int)clamp(ceil(6 / f->map.metre_per_column), 2, p->wave.samples / 8);
    const CfarConfig cfar = {.pfa = p->pfa, .guard = {2, extent}, .training = {p->wave.pulses >= 32 ? 3 : 0, extent},
                             .wrap_rows = true};
    f->detections_in_all = detect(detection, detections_most, &f->map, m->radar->plan, &cfar, &p->antenna, &scale);
    if (f->detections_in_all < 0) return STATUS_NO_MEMORY;
    f->detections = f->detections_in_all < detections_most ? f->detections_in_all : detections_most;
    f->detection = detection;
    return indicate_moving(m, detection);
}

static Status make(Making *m)
{
    const RadarScene *scene = m->scene;
    const Waveform   *wave = &m->preset->wave;
    Interval          interval = {.wave = *wave};
    Visibility       *visibility;
    Status status = visibility_create(&visibility, scene->world->tracer, scene->world->landscape, &scene->world->frame,
                                      scene->snapshot, 0, m->arena);
    if (status != STATUS_OK) return status;
    visibility_materials(visibility, &scene->world->materials);
    m->visibility = visibility;
    m->radar->points.count = 0;
    interval.sample = arena_alloc(m->arena, interval_channels * (size_t)wave->pulses * (size_t)wave->samples,
                                  sizeof *interval.sample);
    if (!interval.sample) return STATUS_NO_MEMORY;
    aim_window(m);
    follow(m);
    status = air_between(m);
    if (status == STATUS_OK) status = making_volume_open(m);
    if (status == STATUS_OK) status = making_targets(m);
    if (m->missing > 0) return status;
    if (status == STATUS_OK && m->radar->ground && scene->world->landscape) status = making_ground(m);
    if (status == STATUS_OK) status = making_volume(m);
    if (status == STATUS_OK) status = visibility_status(visibility);
    if (status != STATUS_OK) return status;
    Making beam;
    beam_at(&beam, m, 0, 0);
    status = beam_echoes(&beam, false);
    if (status != STATUS_OK) return status;
    echo_sum(interval.sample, m->radar->echoes);
    if (wave->uncompensated) m->frame->reference_rate_mps = 0; /* it is in every echo */
    receiver_apply(&m->frame->receiver, &interval, &m->preset->receiver, m->radar->seed, stream_noise, scene->number);
    status = process(m, &interval);
    return status == STATUS_OK && m->radar->scan_pulse ? making_scan(m, &interval) : status;
}

Status seeker_radar_measure(const RadarFrame **out, SeekerRadar *radar, const RadarScene *scene, Pool *pool,
                            Arena *arena)
{
    const double      begun_s = wall_clock_s();
    const RadarPreset *p = &radar->preset;
    RadarFrame       *frame = arena_alloc(arena, 1, sizeof *frame);
    if (!frame) return STATUS_NO_MEMORY;
    Making m = {.radar = radar, .scene = scene, .preset = p, .frame = frame, .pool = pool, .arena = arena,
                .half_window_m = p->wave.samples * light_mps / (4 * p->wave.bandwidth_hz),
                .reach = scene->reach > 0 ? scene->reach : 1};
    m.widest = m.reach * 16 / antenna_u_per_sine(&p->antenna);
    *frame = (RadarFrame){.preset = p, .aim_m = scene->reference_m, .number = scene->number};
    memcpy(frame->v_enu_mps, scene->v_enu_mps, sizeof frame->v_enu_mps);
    memcpy(frame->aim_v_enu_mps, scene->reference_v_enu_mps, sizeof frame->aim_v_enu_mps);
    waveform_timing(&frame->timing, &p->wave);
    const double *r = scene->view->r_enu_from_cam;
    for (int k = 0; k < 3; k++) {
        m.p_enu[k] = scene->view->p_enu[k];
        m.right[k] = r[3 * k];
        m.down[k] = r[3 * k + 1];
        m.ahead[k] = r[3 * k + 2];
    }
    const Status status = make(&m);
    if (status != STATUS_OK || m.missing > 0) echo_forget(radar->echoes);
    frame->spent_s = wall_clock_s() - begun_s;
    radar->left_out += m.missing > 0;
    if (status == STATUS_OK) *out = m.missing > 0 ? NULL : frame;
    return status;
}

SignatureCounters seeker_radar_counters(const SeekerRadar *radar) { return signatures_counters(radar->signatures); }
