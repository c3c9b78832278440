/* tests/sensor/radar_volume.h: a seeker's radar that looks at rain, woods and chaff, and what its maps hold. */
#ifndef TESTS_SENSOR_RADAR_VOLUME_H
#define TESTS_SENSOR_RADAR_VOLUME_H

#include "tests/check.h"
#include "tests/render/hand_plants.h"

#include "render/scattering/clutter/clutter_table_private.h"
#include "render/scattering/clutter/volume_scatter.h"
#include "render/scattering/paths/attenuation.h"
#include "render/scattering/paths/radar_path.h"
#include "sensor/radar/seeker_radar.h"

static const double reference_m = 900;

typedef struct Stage {
    Landscape landscape;
    Catalog  *catalog;
    World     world, woods_world; /* the second with plants */
    Woods     woods;
    Pool     *pool;
    Arena    *arena;
    View      view;
    Snapshot  snapshot;
    char      catalog_path[4096];
} Stage;

enum { plants = 2500, squares = 5 };

static Stage stage;

static Plant plant[plants];

static ClutterTable table;

static inline void stand_woods(void)
{
    /* about where the boresight of look_down meets the ground */
    const double side_m = squares * woods_square_m, level_m = sqrt(0.5) * sqrt(reference_m * reference_m - 250 * 250);
    double       origin[3] = {level_m - 0.5 * side_m, level_m - 0.5 * side_m, 0};
    hand_grow(true, 0.1);
    stage.woods = hand_stand(plant, plants, origin, 0.5 * side_m);
    for (int i = 0; i < plants; i++) {
        for (int k = 0; k < 2; k++) plant[i].p_m[k] += (float)(0.5 * side_m);
        plant[i].p_m[2] = (float)elevation_height(&stage.landscape.elevation, origin[0] + (double)plant[i].p_m[0],
                                                  origin[1] + (double)plant[i].p_m[1], NULL);
    }
    stage.woods.nx = stage.woods.ny = squares;
    stage.woods.reach_m = side_m;
}

static inline int open_stage(void **state)
{
    (void)state;
    LocalFrame      frame;
    char            path[4096];
    const Geodetic  origin = {0.6, -1.9, 700};
    LandscapeConfig config = landscape_default_config();
    config.half_width_m = 2000;
    config.horizon_m = 20000;
    config.relief_m = 0;
    if (!etc_path(stage.catalog_path, sizeof stage.catalog_path, "catalog.csv")) return -1;
    if (!etc_path(path, sizeof path, "radar/clutter.csv") || clutter_table_open(&table, path) != STATUS_OK) return -1;
    if (catalog_open(&stage.catalog, stage.catalog_path, 0.01) != STATUS_OK ||
        local_frame_at(&frame, &origin) != STATUS_OK)
        return -1;
    if (landscape_create(&stage.landscape, &config, &frame, NULL, 0, NULL, 0) != STATUS_OK) return -1;
    if (world_open(&stage.world, stage.catalog, &stage.landscape, &frame, "avx2") != STATUS_OK) return -1;
    if (atmosphere_open(&stage.world.atmosphere, "us1976") != STATUS_OK) return -1;
    stand_woods();
    stage.woods_world = stage.world;
    if (forest_create(&stage.woods_world.forest, &stage.woods, &hand_plants, &(ForestConfig){.leaves = true}, "avx2") !=
        STATUS_OK)
        return -1;
    stage.arena = arena_create();
    return stage.arena && pool_create(&stage.pool, 2) == STATUS_OK ? 0 : -1;
}

static inline int close_stage(void **state)
{
    (void)state;
    pool_destroy(stage.pool);
    arena_destroy(stage.arena);
    forest_destroy(stage.woods_world.forest);
    world_close(&stage.world);
    landscape_destroy(&stage.landscape);
    catalog_close(stage.catalog);
    return 0;
}

/* Towards the north-east at an elevation, from a height. */
static inline RadarScene look(double elevation_rad, double height_m, uint32_t number, const Weather *weather)
{
    const double ground_m = elevation_height(&stage.landscape.elevation, 0, 0, NULL), level = cos(elevation_rad);
    const double ahead[3] = {level * sqrt(0.5), level * sqrt(0.5), sin(elevation_rad)},
                 right[3] = {sqrt(0.5), -sqrt(0.5), 0};
    double below[3];
    v3_cross(below, ahead, right);
    stage.view = (View){.p_enu = {0, 0, ground_m + height_m}, .width = 64, .height = 64, .focal_px = 1000};
    for (int k = 0; k < 3; k++) {
        stage.view.r_enu_from_cam[3 * k] = right[k];
        stage.view.r_enu_from_cam[3 * k + 1] = below[k];
        stage.view.r_enu_from_cam[3 * k + 2] = ahead[k];
    }
    return (RadarScene){.world = &stage.world,
                        .snapshot = &stage.snapshot,
                        .view = &stage.view,
                        .hidden = -1,
                        .reference_m = reference_m,
                        .weather = weather,
                        .number = number};
}

static const char *preset = "seeker_35";

static inline SeekerRadar *open_radar(uint64_t seed, bool ground)
{
    SeekerRadar *radar;
    CHECK(seeker_radar_create(&radar, &(SeekerRadarConfig){.preset = preset,
                                                           .catalog = stage.catalog_path,
                                                           .isa = "avx2",
                                                           .ground = ground,
                                                           .seed = seed,
                                                           .chaff_dipoles = 1e6}) == STATUS_OK);
    return radar;
}

static const RadarFrame *measure(SeekerRadar *radar, const RadarScene *scene)
{
    const RadarFrame *frame;
    CHECK(seeker_radar_measure(&frame, radar, scene, stage.pool, stage.arena) == STATUS_OK);
    return frame;
}

static inline double db(double ratio) { return 10 * log10(ratio); }

static inline WindowFigures range_figures(const RadarFrame *frame)
{
    WindowFigures figures;
    double        weight[512];
    CHECK(frame->preset->wave.samples == 512 && window_weights(weight, 512, &frame->preset->range_window) == STATUS_OK);
    CHECK(window_figures(&figures, weight, 512) == STATUS_OK);
    return figures;
}

/* Power of all echoes in the window, noise taken off. */
static inline double power_w(const RadarFrame *frame)
{
    const WindowFigures figures = range_figures(frame);
    double              sum_w = 0;
    for (int i = 0; i < 512; i++)
        sum_w += (frame->profile_w[i] - frame->receiver.noise_w * figures.noise_bins / 512) / figures.noise_bins;
    return sum_w;
}

/* Received of 1 m2 there, through the air alone. */
static inline double unit_w(const RadarFrame *frame, const double p_enu[3])
{
    const RadarPreset *p = frame->preset;
    const double      *r = stage.view.r_enu_from_cam;
    double             d[3];
    v3_sub(d, p_enu, stage.view.p_enu);
    const double range_m = v3_length(d), window_m = 0.5 * p->wave.samples * frame->map.metre_per_column;
    if (!(fabs(range_m - reference_m) <= window_m)) return 0;
    v3_scale(d, 1 / range_m, d);
    const double right = d[0] * r[0] + d[1] * r[3] + d[2] * r[6], down = d[0] * r[1] + d[1] * r[4] + d[2] * r[7];
    const double gain = antenna_gain(&p->antenna, right, down).sum, air_db = frame->air_db * range_m / reference_m;
    return radar_received_w(
               &(RadarLink){p->power_w, gain * gain, gain * gain, p->antenna.wavelength_m, range_m, p->loss}, 1) *
           pow(10, -0.2 * air_db);
}

/* ---- rain ---------------------------------------------------------------------------------------- */

/* Backscatter by volume, and the mean and variance of fall speed by it: the test's own sums. */
static inline double rain_by_hand(double *mean_mps, double *variance, double f_ghz, double temp_k, double rain_mm_h)
{
    double back = 0, first = 0, second = 0;
    for (double mm = 0.01; mm < 8; mm += 0.02) {
        const double sigma = 8000 * exp(-4.1 * pow(rain_mm_h, -0.21) * mm) * 0.02 *
                             mie_sphere(0.5e-3 * mm, water_permittivity(f_ghz, temp_k), 0.299792458 / f_ghz).back_m2;
        const double fall = fmax(9.65 - 10.3 * exp(-0.6 * mm), 0);
        back += sigma, first += sigma * fall, second += sigma * fall * fall;
    }
    *mean_mps = first / back;
    *variance = second / back - *mean_mps * *mean_mps;
    return back;
}

static inline int by_value(const void *a, const void *b)
{
    return (*(const double *)a > *(const double *)b) - (*(const double *)a < *(const double *)b);
}

/* ---- chaff --------------------------------------------------------------------------------------- */

static inline void put_chaff(SnapshotChaff *chaff, double range_m, double age_s, const double v_enu_mps[3])
{
    const double *r = stage.view.r_enu_from_cam;
    double        p[3];
    for (int k = 0; k < 3; k++) p[k] = stage.view.p_enu[k] + range_m * r[3 * k + 2];
    *chaff = (SnapshotChaff){.id = {1, 2, 3}, .age_s = age_s};
    ecef_from_enu(chaff->p_ecef, &stage.world.frame, p);
    m3_mul_v3(chaff->v_ecef_mps, stage.world.frame.r_ecef_from_enu, v_enu_mps);
}

#endif
