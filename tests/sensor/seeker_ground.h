/* tests/sensor/seeker_ground.h: a seeker's radar above level ground, and the power that the ground should have. */
#ifndef TESTS_SENSOR_SEEKER_GROUND_H
#define TESTS_SENSOR_SEEKER_GROUND_H

#include "tests/check.h"

#include "render/scattering/clutter/clutter_table_private.h"
#include "render/scattering/paths/radar_path.h"
#include "sensor/radar/seeker_radar.h"

static double height_m = 250, aim_m = 900, reference_m = 900; /* of the axis; of the window */

static const char *preset = "seeker_35", *own_table = NULL;

typedef struct Stage {
    Landscape landscape;
    Catalog  *catalog;
    World     world;
    Pool     *pool;
    Arena    *arena;
    View      view;
    Snapshot  snapshot;
    char      catalog_path[4096];
} Stage;

static Stage stage;

static inline int open_stage(void **state)
{
    (void)state;
    LocalFrame      frame;
    const Geodetic  origin = {0.6, -1.9, 700};
    LandscapeConfig config = landscape_default_config();
    config.half_width_m = 2000;
    config.horizon_m = 20000;
    config.relief_m = 0;
    if (!etc_path(stage.catalog_path, sizeof stage.catalog_path, "catalog.csv")) return -1;
    if (catalog_open(&stage.catalog, stage.catalog_path, 0.01) != STATUS_OK ||
        local_frame_at(&frame, &origin) != STATUS_OK)
        return -1;
    if (landscape_create(&stage.landscape, &config, &frame, NULL, 0, NULL, 0) != STATUS_OK) return -1;
    if (world_open(&stage.world, stage.catalog, &stage.landscape, &frame, "avx2") != STATUS_OK) return -1;
    if (atmosphere_open(&stage.world.atmosphere, "us1976") != STATUS_OK) return -1;
    stage.arena = arena_create();
    return stage.arena && pool_create(&stage.pool, 2) == STATUS_OK ? 0 : -1;
}

static inline int close_stage(void **state)
{
    (void)state;
    pool_destroy(stage.pool);
    arena_destroy(stage.arena);
    world_close(&stage.world);
    landscape_destroy(&stage.landscape);
    catalog_close(stage.catalog);
    return 0;
}

/* From a place over the origin towards the north-east, onto ground at the range of the aim. */
static inline RadarScene scene_of(const double v_enu_mps[3], uint32_t number, const Weather *weather)
{
    const double ground_m = elevation_height(&stage.landscape.elevation, 0, 0, NULL), down = height_m / aim_m;
    const double level = sqrt(1 - down * down), ahead[3] = {level * sqrt(0.5), level * sqrt(0.5), -down};
    const double right[3] = {sqrt(0.5), -sqrt(0.5), 0};
    double       below[3];
    v3_cross(below, ahead, right);
    stage.view = (View){.p_enu = {0, 0, ground_m + height_m}, .width = 64, .height = 64, .focal_px = 1000};
    for (int k = 0; k < 3; k++) {
        stage.view.r_enu_from_cam[3 * k] = right[k];
        stage.view.r_enu_from_cam[3 * k + 1] = below[k];
        stage.view.r_enu_from_cam[3 * k + 2] = ahead[k];
    }
    RadarScene scene = {.world = &stage.world,
                        .snapshot = &stage.snapshot,
                        .view = &stage.view,
                        .hidden = -1,
                        .reference_m = reference_m,
                        .weather = weather,
                        .number = number};
    memcpy(scene.v_enu_mps, v_enu_mps, sizeof scene.v_enu_mps);
    return scene;
}

static inline SeekerRadar *open_windy_radar(uint64_t seed, double wind_mps)
{
    SeekerRadar *radar;
    CHECK(seeker_radar_create(&radar, &(SeekerRadarConfig){.preset = preset,
                                                           .table = own_table,
                                                           .catalog = stage.catalog_path,
                                                           .isa = "avx2",
                                                           .ground = true,
                                                           .wind_mps = wind_mps,
                                                           .seed = seed}) == STATUS_OK);
    return radar;
}

static inline SeekerRadar *open_radar(uint64_t seed) { return open_windy_radar(seed, 0); }

/* Share of a pulse of pulse_doppler_ku, 1 us every 10, that arrives past the transmitter's own. */
static inline double heard(double range_m)
{
    const double pulse_m = 149.896229, repeat_m = 1498.96229, at_m = range_m - repeat_m * floor(range_m / repeat_m);
    return at_m < pulse_m ? at_m / pulse_m : at_m > repeat_m - pulse_m ? (repeat_m - at_m) / pulse_m : 1;
}

/* Billingsley's law: still + (1 - still) / (1 + (4 pi lag / (beta lambda))^2). */
static inline double kept(const ClutterRow *row, const RadarPreset *p, double lag_s, double wind_mps)
{
    const ClutterMotion motion = clutter_motion(row, p->wave.centre_hz, wind_mps);
    return motion.still +
           (1 - motion.still) / (1 + pow(4 * pi_rad * lag_s * motion.spread_mps / p->antenna.wavelength_m, 2));
}

/* Sum over ground of the power that each square metre returns: classes, heights and the dish's pattern asked for
 * anew, places and integral the test's own. Of its fields a share is the same lag_s later, in wind. *far_w: what is
 * beyond the window. */
static inline double power_by_integral(double *far_w, const RadarFrame *frame, double lag_s, double wind_mps)
{
    static ClutterTable table;
    const RadarPreset  *p = frame->preset;
    char                path[4096];
    const bool          folds = p->wave.kind == WAVEFORM_PULSE_DOPPLER, wide = p->wave.centre_hz < 20e9;
    const double        step_m = wide ? 2 : 0.5, window_m = 0.5 * p->wave.samples * frame->map.metre_per_column;
    const double        high_m = aim_m * sqrt(0.5) + (folds ? 900 : 364);
    double              sum_w = 0;
    *far_w = 0;
    CHECK(etc_path(path, sizeof path, "radar/clutter.csv") && clutter_table_open(&table, path) == STATUS_OK);
    for (double x = 300; x < high_m; x += step_m)
        for (double y = 300; y < high_m; y += step_m) {
            double n[3], at[3] = {x, y, 0}, d[3];
            at[2] = elevation_height(&stage.landscape.elevation, x, y, n);
            v3_sub(d, at, stage.view.p_enu);
            const double range_m = v3_length(d);
            if (fabs(range_m - reference_m) > window_m && !folds) continue;
            v3_scale(d, 1 / range_m, d);
            const double *r = stage.view.r_enu_from_cam;
            const double  right = d[0] * r[0] + d[1] * r[3] + d[2] * r[6],
                         down = d[0] * r[1] + d[1] * r[4] + d[2] * r[7];
            /* beyond the first null of J_2 nothing counts: below -49 dB both ways */
            if (hypot(right, down) > 5.1356 * p->antenna.wavelength_m / (pi_rad * p->antenna.diameter_m)) continue;
            const double gain = antenna_gain(&p->antenna, right, down).sum, grazing = asin(-v3_dot(d, n));
            const int    surface = landscape_surface(&stage.landscape, x, y);
            const double sigma0 =
                clutter_sigma0(&table.row[surface][wide ? CLUTTER_KU : CLUTTER_KA], grazing, p->antenna.wavelength_m);
            const RadarLink link = {p->power_w, gain * gain, gain * gain, p->antenna.wavelength_m, range_m, p->loss};
            const double    share = folds ? heard(range_m) : 1, air_db = frame->air_db * range_m / frame->reference_m;
            const double    w = share * share * radar_received_w(&link, sigma0 * step_m * step_m / n[2]) *
                             pow(10, -0.2 * air_db) *
                             kept(&table.row[surface][wide ? CLUTTER_KU : CLUTTER_KA], p, lag_s, wind_mps);
            sum_w += w;
            if (fabs(range_m - reference_m) > window_m) *far_w += w;
        }
    return sum_w;
}

static inline double ground_over_integral_db(int *cells, double *far_share, int seeds)
{
    const double  v[3] = {200, 100, -60};
    const Weather weather = weather_default();
    double        got_w = 0, want_w = 0, far_w = 0;
    *cells = 0;
    for (int seed = 1; seed <= seeds; seed++) {
        SeekerRadar      *radar = open_radar((uint64_t)seed);
        const RadarScene  scene = scene_of(v, (uint32_t)seed, &weather);
        const RadarFrame *frame;
        WindowFigures     figures;
        double            weight[512];
        arena_reset(stage.arena);
        CHECK(seeker_radar_measure(&frame, radar, &scene, stage.pool, stage.arena) == STATUS_OK);
        const int samples = frame->preset->wave.samples;
        CHECK(samples <= 512 && window_weights(weight, samples, &frame->preset->range_window) == STATUS_OK);
        CHECK(window_figures(&figures, weight, samples) == STATUS_OK);
        const double noise_w = frame->receiver.noise_w * figures.noise_bins / samples;
        for (int i = 0; i < samples; i++) got_w += (frame->profile_w[i] - noise_w) / figures.noise_bins;
        if (seed == 1) want_w = power_by_integral(&far_w, frame, 0, 0); /* the same for all */
        *cells += frame->ground_cells / seeds;
        CHECK(frame->ground_hidden < 0.02 * frame->ground_cells); /* flat ground hides next to nothing */
        seeker_radar_destroy(radar);
    }
    *far_share = far_w / want_w;
    printf("%s: ground of %d scatterers: %.3f dB over its integral, %.3f of it beyond the window\n", preset, *cells,
           10 * log10(got_w / seeds / want_w), *far_share);
    return 10 * log10(got_w / seeds / want_w);
}

#endif
