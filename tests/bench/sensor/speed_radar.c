/* tests/bench/sensor/speed_radar.c: `bench speed --bands radar`: what a 94 GHz seeker's targets and updates cost. */
#include "tests/bench/suites.h"
#include "tests/bench/sensor/speed_private.h"

#include "tests/bench/sensor/radar_update.h"
#include "sensor/radar/echo.h"
#include "terrain/ground/landscape.h"

#include <stdlib.h>

enum { tanks_full = 10, tanks_quick = 2, seen_looks = 8 };
static const char *const   preset_name = "seeker_94";
static const double        range_m = 2000;
static const DisEntityType tank_type = {1, 1, 222, 1, 1, 1, 0};

typedef struct RadarSpeed {
    Bench           *bench;
    RadarPreset      preset;
    RadarMaterials   materials;
    Catalog         *catalog;
    RadarTarget     *target;
    const Model     *model;
    SignaturesConfig config;
    SignatureCells   cells;
    ScatterAntenna   middle, now; /* of the bin; of the look at hand */
    TotalField       field;
    Signature        signature;
    Centres          centres;
    EchoGrid        *grid;
    Echo            *echo;
    double complex  *sample;
    Status           status;
    Pool            *one, *many;
} RadarSpeed;

static TubeConfig tubes_of(const RadarSpeed *r, double rays)
{
    TubeConfig tubes = tubes_default_config(r->preset.wave.centre_hz);
    tubes.rays_per_wavelength = rays;
    tubes.splits = r->config.splits;
    tubes.warp_m = r->config.warp_m;
    tubes.warp_seed = signature_warp_seed(r->model);
    return tubes;
}

static Status open_radar(RadarSpeed *r)
{
    char   path[4096];
    Origin origin;
    Status status =
        etc_path(path, sizeof path, "radars.csv") ? radar_preset_read(&r->preset, path, preset_name) : STATUS_BAD_VALUE;
    if (status == STATUS_OK) status = radar_materials_load(&r->materials);
    if (status == STATUS_OK && !etc_path(path, sizeof path, "catalog.csv")) status = STATUS_BAD_VALUE;
    if (status == STATUS_OK) status = catalog_open(&r->catalog, path, radar_sag_m(r->preset.wave.centre_hz));
    if (status != STATUS_OK) return status;
    r->model = catalog_model(r->catalog, catalog_find(r->catalog, tank_type, &origin, NULL));
    r->config = seeker_radar_signatures(&r->preset, 1e-3, NULL);
    r->cells = signature_default_cells(r->config.frequency_hz, r->config.bandwidth_hz, r->config.aspect_rad,
                                       r->config.interval_s);
    status = radar_target_create(&r->target, r->model, &r->materials, NULL);
    if (status == STATUS_OK) status = pool_create(&r->one, 1);
    if (status == STATUS_OK) status = pool_create(&r->many, bench_threads(r->bench));
    if (status == STATUS_OK) status = echo_grid_create(&r->grid, &r->preset.wave);
    const size_t all = (size_t)interval_channels * (size_t)r->preset.wave.pulses * (size_t)r->preset.wave.samples;
    r->sample = malloc(all * sizeof *r->sample);
    return status == STATUS_OK && !r->sample ? STATUS_NO_MEMORY : status;
}

static void close_radar(RadarSpeed *r)
{
    free(r->sample);
    free(r->echo);
    echo_grid_destroy(r->grid);
    centres_free(&r->centres);
    signature_free(&r->signature);
    total_field_free(&r->field);
    radar_target_destroy(r->target);
    if (r->catalog) catalog_close(r->catalog);
    radar_materials_close(&r->materials);
    pool_destroy(r->many);
    pool_destroy(r->one);
}

/* ---- one target ------------------------------------------------------------------------------------- */

static void add_error(double *error, double *power, const ScatterMatrix *got, const ScatterMatrix *want)
{
    const double complex g[4] = {got->hh, got->hv, got->vh, got->vv}, w[4] = {want->hh, want->hv, want->vh, want->vv};
    for (int p = 0; p < 4; p++) {
        *error += creal((g[p] - w[p]) * conj(g[p] - w[p]));
        *power += creal(w[p] * conj(w[p]));
    }
}

/* Gives look i of those about the bin: its corners and the middles of its sides. */
static ScatterAntenna look_of(const RadarSpeed *r, int i)
{
    static const int at[seen_looks][2] = {{-1, -1}, {1, 1}, {-1, 1}, {1, -1}, {0, 1}, {1, 0}, {0, -1}, {-1, 0}};
    ScatterAntenna   look = r->middle;
    double           h[3], v[3];
    scatter_basis(h, v, look.u);
    v3_add_scaled(look.u, look.u, 0.5 * r->config.aspect_rad * at[i][0], h);
    v3_add_scaled(look.u, look.u, 0.5 * r->config.aspect_rad * at[i][1], v);
    v3_normalize(look.u, look.u);
    return look;
}

static Status new_bin(RadarSpeed *r, Pool *pool, double *spent_s)
{
    const TubeConfig tubes = tubes_of(r, r->config.rays_per_wavelength);
    const double     begun_s = wall_clock_s();
    Status           status = total_field_trace(&r->field, r->target, &r->middle, &r->middle, &tubes, true, pool);
    if (status == STATUS_OK) status = signature_make(&r->signature, &r->field, r->target, &r->cells);
    *spent_s = wall_clock_s() - begun_s;
    return status;
}

/* Against a list of four times the tubes over the bin's middle and a band, which takes half a minute. */
static Status error_of_bin(RadarSpeed *r, double *error_db)
{
    const TubeConfig tubes = tubes_of(r, 2 * r->config.rays_per_wavelength);
    const double     half_hz = 0.5 * r->config.bandwidth_hz;
    TotalField       finer = {0};
    ScatterMatrix    want[17], got;
    double           error = 0, power = 0;
    bench_progress(r->bench, "a list of four times the tubes");
    Status status = total_field_trace(&finer, r->target, &r->middle, &r->middle, &tubes, true, r->many);
    if (status == STATUS_OK)
        status = total_field_sweep(
            want, &(FrequencySweep){.count = 17, .first_hz = r->config.frequency_hz - half_hz, .step_hz = half_hz / 8},
            &finer, NULL);
    if (status == STATUS_OK) status = centres_make(&r->centres, &r->signature, &r->middle, &r->middle, NULL);
    for (int f = 0; f < 17 && status == STATUS_OK; f++) {
        centres_field(&got, &r->centres, r->config.frequency_hz - half_hz + f * half_hz / 8);
        add_error(&error, &power, &got, &want[f]);
    }
    *error_db = 10 * log10(error / power);
    total_field_free(&finer);
    return status;
}

static void reuse(void *user)
{
    RadarSpeed *r = user;
    r->status = centres_make(&r->centres, &r->signature, &r->now, &r->now, NULL);
    bench_keep(r->centres.centre);
}

/* Fills the samples of one pulse and channel at the middle of the interval, as points of the centres. */
static void fill_echoes(RadarSpeed *r)
{
    for (int i = 0; i < r->centres.count; i++) {
        r->echo[i] = (Echo){.path_m = r->centres.centre[i].path_m};
        for (int c = 0; c < interval_channels; c++) r->echo[i].amplitude[c] = r->centres.centre[i].s.vv;
    }
}

static void profile(void *user)
{
    RadarSpeed *r = user;
    fill_echoes(r);
    echo_add(r->grid, r->echo, r->centres.count, NULL);
    echo_sum(r->sample, r->grid);
    bench_keep(r->sample);
}

static Status add_target_rows(RadarSpeed *r)
{
    const Waveform *wave = &r->preset.wave;
    ScatterMatrix  *want = malloc((size_t)wave->samples * sizeof *want), got;
    double          made_s, error_db = NAN, error = 0, power = 0;
    BenchTime       time[2];
    char            what[what_size], against[what_size];
    if (!want) return STATUS_NO_MEMORY;
    bench_progress(r->bench, "a new bin");
    Status status = new_bin(r, r->one, &made_s);
    if (status == STATUS_OK && !bench_quick(r->bench)) status = error_of_bin(r, &error_db);
    BenchRow row = bench_row("radar, 94 GHz: a tank at 2 km, list and signature of a new bin, 1 thread");
    row.median = row.best = made_s, row.unit = "s";
    row.rate = 1e-6 * (double)r->signature.count * sizeof *r->signature.centre, row.rate_unit = "MB";
    row.error = 100 * pow(10, error_db / 20), row.error_unit = "% of the field",
    row.against = "four times the tubes, over the band";
    if (isnan(error_db)) row.error_unit = row.against = NULL;
    if (status == STATUS_OK) bench_add(r->bench, &row);

    /* a bin that is at hand: the list itself at its edge, over its band's ends */
    for (int i = 0; i < seen_looks && status == STATUS_OK; i++) {
        r->now = look_of(r, i);
        status = centres_make(&r->centres, &r->signature, &r->now, &r->now, NULL);
        for (int end = -1; end <= 1 && status == STATUS_OK; end += 2) {
            const double f_hz = wave->centre_hz + 0.5 * end * wave->bandwidth_hz;
            status = total_field_sweep(
                want, &(FrequencySweep){.count = 1, .first_hz = f_hz, .tx = &r->now, .rx = &r->now}, &r->field, NULL);
            centres_field(&got, &r->centres, f_hz);
            add_error(&error, &power, &got, &want[0]);
        }
    }
    r->echo = malloc((size_t)(r->signature.count + 1) * sizeof *r->echo);
    if (status == STATUS_OK && !r->echo) status = STATUS_NO_MEMORY;
    if (status != STATUS_OK) {
        free(want);
        return status;
    }
    const BenchWork work[2] = {{reuse, r, 1}, {profile, r, 1}};
    bench_progress(r->bench, "reused bins");
    bench_time(time, r->bench, work, 2);
    row = bench_row_of("radar, 94 GHz: the tank's centres from a bin at hand", &time[0], "M centres/s",
                       1e6 / r->signature.count);
    snprintf(against, sizeof against, "its %zu hits and %d edges, at the bin's edge and the band's ends",
             r->field.hits.count, r->field.edges.count);
    row.error = 100 * sqrt(error / power), row.error_limit = 5, row.error_unit = "% of the field",
    row.against = against;
    bench_add(r->bench, &row);

    /* an interval's samples of them; all pulses are alike, so the middle one is the sweep itself */
    r->now = r->middle;
    reuse(r);
    profile(r);
    status = total_field_sweep(want,
                               &(FrequencySweep){.count = wave->samples,
                                                 .first_hz = wave->centre_hz - 0.5 * wave->bandwidth_hz,
                                                 .step_hz = wave->bandwidth_hz / wave->samples},
                               &r->field, NULL);
    error = power = 0;
    for (int m = 0; m < wave->samples && status == STATUS_OK; m++) {
        const double complex of =
            r->sample[(size_t)(wave->pulses / 2) * (size_t)wave->samples + (size_t)m] - want[m].vv;
        error += creal(of * conj(of));
        power += creal(want[m].vv * conj(want[m].vv));
    }
    snprintf(what, sizeof what, "radar, 94 GHz: the tank's echo over %d pulses of %d samples, 4 channels", wave->pulses,
             wave->samples);
    row = bench_row_of(what, &time[1], "profiles/s", 1.0 / wave->pulses);
    row.error = 100 * sqrt(error / power), row.error_limit = 5, row.error_unit = "% of the field",
    row.against = "a sweep of its hits and edges";
    if (status == STATUS_OK) bench_add(r->bench, &row);
    row = bench_row("radar, 94 GHz: the same, a pulse");
    row.median = time[1].median_s / wave->pulses, row.best = time[1].best_s / wave->pulses, row.unit = "s";
    if (status == STATUS_OK) bench_add(r->bench, &row);
    free(want);
    return status;
}

/* ---- ten targets with clutter ----------------------------------------------------------------------- */

static Status place_tanks(TrialScene *scene, int tanks)
{
    Status status = STATUS_OK;
    for (int i = 0; i < tanks && status == STATUS_OK; i++)
        status = trial_scene_place(scene, &(TrialPlace){.type = tank_type,
                                                        .number = 100 + i,
                                                        .east_m = 12 * (i % 5) - 24,
                                                        .north_m = 25 * (i / 5),
                                                        .turn_rad = 0.61 * i});
    return status;
}

static Status time_updates(RadarSpeed *r, TrialScene *scene, Arena *const arena[3])
{
    char        catalog[4096], what[what_size];
    Snapshot    snapshot;
    Weather     weather = weather_default();
    RadarUpdate u[2];
    BenchTime   time[2];
    const int   tanks = bench_quick(r->bench) ? tanks_quick : tanks_full;
    Status      status = place_tanks(scene, tanks);
    if (status == STATUS_OK) status = entity_table_snapshot(&snapshot, scene->table, scene->sun_now_s + 0.5, arena[2]);
    if (status == STATUS_OK && !etc_path(catalog, sizeof catalog, "catalog.csv")) status = STATUS_BAD_VALUE;
    const View view = trial_view(scene, range_m, 250, 3 * rad_per_deg, 64, 64);
    for (int k = 0; k < 2 && status == STATUS_OK; k++) {
        u[k] = (RadarUpdate){.scene = {.world = &scene->world,
                                       .snapshot = &snapshot,
                                       .view = &view,
                                       .hidden = -1,
                                       .v_enu_mps = {0, 200, -20},
                                       .reference_m = NAN,
                                       .t_s = 1,
                                       .weather = &weather,
                                       .number = 1},
                             .pool = k ? r->many : r->one,
                             .arena = arena[k]};
        if (k == 0)
            status = seeker_radar_create(
                &u[0].radar, &(SeekerRadarConfig){
                                 .preset = preset_name, .catalog = catalog, .ground = true, .warp_m = 1e-3, .seed = 1});
        else u[1].radar = u[0].radar;
    }
    if (status != STATUS_OK) return status;
    bench_progress(r->bench, "signatures of the targets");
    radar_update(&u[1]); /* makes their signatures */
    const BenchWork work[2] = {{radar_update, &u[0], 1}, {radar_update, &u[1], 1}};
    bench_progress(r->bench, "targets with clutter");
    if (u[1].status == STATUS_OK) bench_time(time, r->bench, work, 2);
    status = u[0].status != STATUS_OK ? u[0].status : u[1].status;
    for (int k = 0; k < 2 && status == STATUS_OK; k++) {
        const RadarFrame *f = u[k].frame;
        const size_t      cells = (size_t)interval_channels * (size_t)f->map.rows * (size_t)f->map.columns;
        double            differ = 0;
        for (size_t i = 0; i < cells; i++)
            differ += memcmp(&f->map.cell[i], &u[0].frame->map.cell[i], sizeof *f->map.cell) != 0;
        snprintf(what, sizeof what, "radar, 94 GHz: %d tanks with clutter, bins at hand, %s", tanks,
                 k ? all_threads : "1 thread");
        BenchRow row = bench_row_of(what, &time[k], "updates/s", 1);
        row.error = differ, row.error_limit = 0, row.error_unit = "cells differ", row.against = "1 thread";
        if (k) row.ratio = bench_ratio(&time[1], &time[0]), row.to = "1 thread";
        bench_add(r->bench, &row);
    }
    if (status == STATUS_OK && u[0].frame->targets != tanks) {
        log_error("bench: speed: %d of %d tanks are in the beam", u[0].frame->targets, tanks);
        status = STATUS_BAD_VALUE;
    }
    seeker_radar_destroy(u[0].radar);
    return status;
}

typedef Status (*SceneRows)(RadarSpeed *r, TrialScene *scene, Arena *const arena[3]);

static Status on_ground(RadarSpeed *r, SceneRows rows)
{
    const Geodetic origin = {48 * rad_per_deg, 11 * rad_per_deg, 500};
    LocalFrame     frame;
    Landscape      landscape = {0};
    TrialScene     scene = {0};
    Arena         *arena[3] = {arena_create(), arena_create(), arena_create()};
    char           catalog[4096];
    double         times_s[2];
    Status         status = arena[0] && arena[1] && arena[2] ? STATUS_OK : STATUS_NO_MEMORY;
    if (status == STATUS_OK) status = local_frame_at(&frame, &origin);
    if (status == STATUS_OK) status = landscape_quick(&landscape, times_s, &frame, 6000, 6000, r->many);
    if (status == STATUS_OK && !etc_path(catalog, sizeof catalog, "catalog.csv")) status = STATUS_BAD_VALUE;
    if (status == STATUS_OK) status = trial_scene_open(&scene, &landscape, catalog, &tank_type, 1, 0);
    if (status == STATUS_OK) status = rows(r, &scene, arena);
    trial_scene_close(&scene);
    landscape_destroy(&landscape);
    for (int k = 0; k < 3; k++) arena_destroy(arena[k]);
    return status;
}

/* ---- by way of the ground ----------------------------------------------------------------------------- */

static const char *const bounce_preset = "seeker_35";

/* Opens two updates, each with a radar of its own: without the ground's mirror and with it. */
static Status open_bounce(RadarUpdate u[2], RadarSpeed *r, const char *catalog)
{
    Status status = STATUS_OK;
    for (int k = 0; k < 2 && status == STATUS_OK; k++) {
        const SeekerRadarConfig config = {
            .preset = bounce_preset, .catalog = catalog, .warp_m = 1e-3, .seed = 1, .ground_bounce = k == 1};
        status = seeker_radar_create(&u[k].radar, &config);
        if (status != STATUS_OK) break;
        bench_progress(r->bench, k ? "signatures by way of the ground" : "signature of a tank");
        u[k].pool = r->many;
        radar_update(&u[k]);
        u[k].pool = r->one;
        status = u[k].status;
    }
    if (status == STATUS_OK && !(u[1].frame->targets == 1 && u[1].frame->target[0].bounce.coherence > 0)) {
        log_error("bench: speed: the ground mirrors nothing of the tank");
        status = STATUS_BAD_VALUE;
    }
    return status;
}

/* Times the mirror of the ground: a tank alone, whose bins are there already. */
static Status time_bounce(RadarSpeed *r, TrialScene *scene, Arena *const arena[3])
{
    static const char *const what[2] = {"radar, 35 GHz: a tank at 1 km, bins at hand, no ground, 1 thread",
                                        "radar, 35 GHz: the same with radar.ground_bounce"};
    char                     catalog[4096];
    Snapshot                 snapshot;
    Weather                  weather = weather_default();
    RadarUpdate              u[2] = {{0}};
    BenchTime                time[2];
    Status status = trial_scene_place(scene, &(TrialPlace){.type = tank_type, .number = 100, .turn_rad = 0.61});
    if (status == STATUS_OK) status = entity_table_snapshot(&snapshot, scene->table, scene->sun_now_s + 0.5, arena[2]);
    if (status == STATUS_OK && !etc_path(catalog, sizeof catalog, "catalog.csv")) status = STATUS_BAD_VALUE;
    if (status != STATUS_OK) return status;
    const View view = trial_view(scene, 1000, 30, 3 * rad_per_deg, 64, 64);
    for (int k = 0; k < 2; k++)
        u[k] = (RadarUpdate){.scene = {.world = &scene->world,
                                       .snapshot = &snapshot,
                                       .view = &view,
                                       .hidden = -1,
                                       .v_enu_mps = {0, 200, 0},
                                       .reference_m = NAN,
                                       .t_s = 1,
                                       .weather = &weather,
                                       .number = 1},
                             .arena = arena[k]};
    status = open_bounce(u, r, catalog);
    const double    coherence = status == STATUS_OK ? u[1].frame->target[0].bounce.coherence : 0;
    const BenchWork work[2] = {{radar_update, &u[0], 1}, {radar_update, &u[1], 1}};
    bench_progress(r->bench, "a tank with and without the ground's mirror");
    if (status == STATUS_OK) bench_time(time, r->bench, work, 2);
    for (int k = 0; k < 2 && status == STATUS_OK; k++) {
        BenchRow row = bench_row_of(what[k], &time[k], "updates/s", 1);
        if (k) row.ratio = bench_ratio(&time[1], &time[0]), row.to = "without";
        /* a mirror of nothing would cost nothing */
        if (k) row.error = 100 * coherence, row.error_unit = "% of the field", row.against = "what the ground mirrors";
        bench_add(r->bench, &row);
        status = u[k].status;
    }
    for (int k = 0; k < 2; k++) seeker_radar_destroy(u[k].radar);
    return status;
}

Status bench_speed_radar(Bench *bench)
{
    if (!speed_wants(bench, "radar")) return STATUS_OK;
    RadarSpeed r = {.bench = bench, .middle = {.range_m = range_m}};
    radar_look(&r.middle, 33 * rad_per_deg, 7 * rad_per_deg, range_m);
    Status status = open_radar(&r);
    if (status == STATUS_OK) status = add_target_rows(&r);
    if (status == STATUS_OK) status = on_ground(&r, time_updates);
    if (status == STATUS_OK) status = on_ground(&r, time_bounce);
    if (status != STATUS_OK) log_error("bench: speed: radar: %s", status_name(status));
    close_radar(&r);
    return status;
}
