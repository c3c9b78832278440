/* The radar's volumes through the whole chain: rain, foliage, chaff and a corner reflector against integrals and closed
 * forms that the test makes itself; statistics, Doppler, polarisation; the same bits. labels: physics */
#include "tests/check.h"
#include "tests/render/hand_plants.h"

#include "sensor/radar/seeker_radar.h"

#include "render/scattering/clutter/clutter_table_private.h"
#include "render/scattering/paths/attenuation.h"
#include "render/scattering/clutter/volume_scatter.h"
#include "render/scattering/paths/radar_path.h"

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

static Stage        stage;
static Plant        plant[plants];
static ClutterTable table;

static void stand_woods(void)
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

static int open_stage(void **state)
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

static int close_stage(void **state)
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
static RadarScene look(double elevation_rad, double height_m, uint32_t number, const Weather *weather)
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

static SeekerRadar *open_radar(uint64_t seed, bool ground)
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

static double db(double ratio) { return 10 * log10(ratio); }

static WindowFigures range_figures(const RadarFrame *frame)
{
    WindowFigures figures;
    double        weight[512];
    CHECK(frame->preset->wave.samples == 512 && window_weights(weight, 512, &frame->preset->range_window) == STATUS_OK);
    CHECK(window_figures(&figures, weight, 512) == STATUS_OK);
    return figures;
}

/* Power of all echoes in the window, noise taken off. */
static double power_w(const RadarFrame *frame)
{
    const WindowFigures figures = range_figures(frame);
    double              sum_w = 0;
    for (int i = 0; i < 512; i++)
        sum_w += (frame->profile_w[i] - frame->receiver.noise_w * figures.noise_bins / 512) / figures.noise_bins;
    return sum_w;
}

/* Received of 1 m2 there, through the air alone. */
static double unit_w(const RadarFrame *frame, const double p_enu[3])
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
static double rain_by_hand(double *mean_mps, double *variance, double f_ghz, double temp_k, double rain_mm_h)
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

static int by_value(const void *a, const void *b)
{
    return (*(const double *)a > *(const double *)b) - (*(const double *)a < *(const double *)b);
}

static void rain_has_the_power_of_its_integral(void **state)
{
    (void)state;
    enum { seeds = 4, every = 2 };
    static double sample[seeds * 512 / every];
    Weather       weather = weather_default();
    double        got_w = 0, want_w = 0, eta = NAN, mean = NAN, variance = NAN;
    double        row = 0, row2 = 0, power = 0, cross = 0, phase = 0;
    int           samples = 0;
    weather.rain_mm_h = 10;
    weather.wind_mps = 8;
    weather.wind_from_rad = 225 * rad_per_deg; /* from behind */
    const double      elevation = 30 * rad_per_deg;
    const RadarFrame *frame = NULL;
    for (uint64_t seed = 1; seed <= seeds; seed++) {
        SeekerRadar *radar = open_radar(seed, false);
        RadarScene   scene = look(elevation, 100, (uint32_t)seed, &weather);
        arena_reset(stage.arena);
        frame = measure(radar, &scene);
        got_w += power_w(frame);
        /* over the sphere about the axis; along the range it goes by 1 / R^2 and the air */
        if (seed == 1) eta = rain_by_hand(&mean, &variance, 35, atmosphere_temp_k(stage.world.atmosphere, 0), 10);
        CHECK_NEAR(frame->rain_1_m / eta, 1, 2e-3);
        const WindowFigures figures = range_figures(frame);
        const double        window_m = 0.5 * 512 * frame->map.metre_per_column,
                     wavelength_m = frame->preset->antenna.wavelength_m;
        double pattern = 0, along = 0;
        for (double a = 1e-4; a < 0.5; a += 2e-4)
            pattern += 2 * pi_rad * sin(a) * 2e-4 * pow(antenna_gain(&frame->preset->antenna, sin(a), 0).sum, 4);
        for (double r = reference_m - window_m + 0.5; r < reference_m + window_m; r++)
            along += pow(10, -0.2 * frame->air_db * r / reference_m) / (r * r);
        want_w += frame->preset->power_w * wavelength_m * wavelength_m / pow(4 * pi_rad, 3) / frame->preset->loss *
                  eta * pattern * along;
        /* intensities of one pulse, over their means */
        for (int i = 0; i < 512; i += every) {
            const double r = reference_m + (i - 256) * frame->map.metre_per_column;
            const double mean_w = frame->preset->power_w * wavelength_m * wavelength_m / pow(4 * pi_rad, 3) /
                                  frame->preset->loss * eta * pattern *
                                  pow(10, -0.2 * frame->air_db * r / reference_m) / (r * r) *
                                  frame->map.metre_per_column * figures.noise_bins;
            const double         noise_w = frame->receiver.noise_w * figures.noise_bins / 512;
            const double complex z = frame->profile[i];
            sample[samples++] = creal(z * conj(z)) / (mean_w + noise_w);
        }
        const size_t cells = (size_t)frame->map.rows * (size_t)frame->map.columns;
        double       floor_w = frame->receiver.noise_w * frame->map.noise_share;
        for (size_t c = 0; c < cells; c++) {
            const double complex z = frame->map.cell[c], x = frame->map.cell[CHANNEL_CROSS * cells + c];
            const double         w = creal(z * conj(z)) - floor_w,
                         at = (double)(c / (size_t)frame->map.columns) - frame->map.rows / 2;
            power += w, row += w * at, row2 += w * at * at;
            cross += creal(x * conj(x)) - floor_w;
        }
        phase = pow(frame->preset->receiver.phase_noise_rad, 2) * frame->map.rows * frame->map.rows / 12;
        seeker_radar_destroy(radar);
    }
    printf("rain: %.3f dB over its integral, cross-polarised %.1f dB\n", db(got_w / want_w), db(cross / power));
    CHECK_NEAR(db(got_w / want_w), 0, 0.3);
    CHECK_NEAR(db(cross / power), -25, 0.6);
    /* the wind carries it away, falling drops come nearer: both by the cosine to the axis */
    const double rate = row / power * frame->map.mps_per_row, want = 8 * cos(elevation) - mean * sin(elevation);
    /* Hann's window spreads by 1/3 of a row squared, the oscillator's phase noise its small share over all rows */
    const double width2 = (row2 / power - row * row / power / power - 1.0 / 3 - phase) * pow(frame->map.mps_per_row, 2);
    const double want2 = 1 + variance * sin(elevation) * sin(elevation);
    printf("Doppler of rain: %.2f m/s (%.2f), rms width %.2f m/s (%.2f)\n", rate, want, sqrt(width2), sqrt(want2));
    CHECK_NEAR(rate, want, 0.15);
    CHECK_NEAR(sqrt(width2), sqrt(want2), 0.15);
    qsort(sample, (size_t)samples, sizeof *sample, by_value);
    double worst = 0;
    for (int i = 0; i < samples; i++) {
        const double below = -expm1(-sample[i]);
        worst = fmax(worst, fmax(fabs(below - (double)i / samples), fabs(below - (i + 1.0) / samples)));
    }
    printf("rain's intensities against exponential: D sqrt(n) %.2f\n", worst * sqrt(samples));
    CHECK(worst * sqrt(samples) < 1.63); /* Kolmogorov and Smirnov: 1 % */
}

/* pulse_doppler_ku, a window of 1499 m about 5 km: what is received is the rain before the antenna, ten times nearer.
 */
static void rain_folds_over(void **state)
{
    (void)state;
    enum { seeds = 12 };
    Weather      weather = weather_default();
    double       got_w = 0, want_w = 0, inside_w = 0, mean, variance;
    const double step_m = 0.5, repeat_m = 1498.96229, pulse_m = 149.896229;
    weather.rain_mm_h = 10;
    preset = "pulse_doppler_ku";
    for (uint64_t seed = 1; seed <= seeds; seed++) {
        SeekerRadar *radar = open_radar(seed, false);
        RadarScene   scene = look(5 * rad_per_deg, 100, (uint32_t)seed, &weather);
        arena_reset(stage.arena);
        scene.reference_m = 5000;
        const RadarFrame  *frame = measure(radar, &scene);
        const RadarPreset *p = frame->preset;
        WindowFigures      figures;
        double             weight[128], pattern = 0;
        CHECK(p->wave.samples == 128 && window_weights(weight, 128, &p->range_window) == STATUS_OK);
        CHECK(window_figures(&figures, weight, 128) == STATUS_OK);
        for (int i = 0; i < 128; i++)
            got_w +=
                (frame->profile_w[i] - frame->receiver.noise_w * figures.noise_bins / 128) / figures.noise_bins / seeds;
        if (seed == 1) {
            const double temp_k = atmosphere_temp_k(stage.world.atmosphere, 0), wavelength_m = p->antenna.wavelength_m;
            const double eta = rain_by_hand(&mean, &variance, 16.5, temp_k, 10);
            for (double a = 5e-5; a < 0.3; a += 1e-4)
                pattern += 2 * pi_rad * sin(a) * 1e-4 * pow(antenna_gain(&p->antenna, sin(a), 0).sum, 4);
            for (double r = 10 + 0.5 * step_m; r < 20000; r += step_m) {
                const double at_m = fmod(r, repeat_m), heard = fmin(fmin(at_m, repeat_m - at_m) / pulse_m, 1);
                const double w = p->power_w * wavelength_m * wavelength_m / pow(4 * pi_rad, 3) / p->loss * eta *
                                 pattern * pow(10, -0.2 * frame->air_db * r / 5000) / (r * r) * heard * heard * step_m;
                want_w += w;
                if (fabs(r - 5000) < 0.5 * repeat_m) inside_w += w;
            }
        }
        seeker_radar_destroy(radar);
    }
    preset = "seeker_35";
    printf("rain that folds over: %.3f dB over its integral, %.1f dB of it not folded\n", db(got_w / want_w),
           db(inside_w / want_w));
    CHECK_NEAR(db(got_w / want_w), 0, 0.6); /* speckle of some thirty cells, twelve draws */
    CHECK(inside_w < 0.05 * want_w);
}

static void rain_and_fog_take_what_itu_says(void **state)
{
    (void)state;
    Weather      weather = weather_default();
    SeekerRadar *radar = open_radar(1, false);
    RadarScene   scene = look(0, 100, 1, &weather);
    arena_reset(stage.arena);
    const double clear_db = measure(radar, &scene)->air_db;
    weather.rain_mm_h = 25;
    const double rain_db = measure(radar, &scene)->air_db - clear_db;
    CHECK_NEAR(rain_db, 0.9 * rain_attenuation(35, 25, 0, 0.5 * pi_rad), 1e-6);
    weather.rain_mm_h = 0;
    weather.visibility_m = 200;
    const double fog_db = measure(radar, &scene)->air_db - clear_db;
    CHECK_NEAR(fog_db /
                   (0.9 * fog_liquid_g_m3(200) * cloud_attenuation(35, atmosphere_temp_k(stage.world.atmosphere, 100))),
               1, 0.01);
    scene = look(0, 290, 1, &weather); /* near its top, 300 m over the ground */
    const double high_db = measure(radar, &scene)->air_db;
    weather.visibility_m = weather_default().visibility_m;
    CHECK_NEAR((high_db - measure(radar, &scene)->air_db) / fog_db, 1, 0.03); /* droplets are 1 K colder */
    weather.visibility_m = 200;
    scene = look(0, 320, 1, &weather); /* above the fog */
    CHECK(fabs(measure(radar, &scene)->air_db - clear_db) < 0.01);
    seeker_radar_destroy(radar);
}

/* A look down: what is behind the ground does not return. */
static void rain_behind_the_ground_is_hidden(void **state)
{
    (void)state;
    Weather      weather = weather_default();
    SeekerRadar *radar = open_radar(1, false);
    weather.rain_mm_h = 10;
    RadarScene scene = look(-60 * rad_per_deg, reference_m * sin(60 * rad_per_deg), 1, &weather);
    arena_reset(stage.arena);
    const RadarFrame *frame = measure(radar, &scene);
    const double      noise_w = frame->receiver.noise_w * range_figures(frame).noise_bins / 512;
    double            near = 0, far = 0;
    for (int i = 0; i < 80; i++) near += frame->profile_w[60 + i] - noise_w, far += frame->profile_w[400 + i] - noise_w;
    printf("rain behind the ground: %.1f dB of that before it\n", db(fabs(far) / near));
    CHECK(db(fabs(far) / near) < -20); /* the far edge of the main lobe, 43 m behind, sees some */
    seeker_radar_destroy(radar);
}

/* ---- foliage ------------------------------------------------------------------------------------- */

/* Loss from a place towards the antenna by a march through all crowns, dB one way. */
static double march_db(const double p_enu[3])
{
    static const double step_m = 0.2;
    double              d[3], depth = 0, weighted = 0;
    int                 near[plants], count = 0;
    v3_sub(d, stage.view.p_enu, p_enu);
    v3_normalize(d, d);
    for (int i = 0; i < plants; i++) {
        double to[3], off[3];
        for (int k = 0; k < 3; k++) to[k] = stage.woods.origin_enu[k] + (double)plant[i].p_m[k] - p_enu[k];
        to[2] += 0.7 * plant_height_m(&plant[i]);
        v3_cross(off, to, d);
        if (v3_length(off) < 0.45 * plant_height_m(&plant[i]) + 2 && v3_dot(to, d) > -12) near[count++] = i;
    }
    for (int n = 0; n < count; n++) {
        const Plant *of = &plant[near[n]];
        double       axis[3][3], scale[2], from[3];
        plant_axes(axis, scale, of, NULL);
        for (int k = 0; k < 3; k++)
            from[k] = p_enu[k] - stage.woods.origin_enu[k] - (double)of->p_m[k] - 0.7 * scale[1] * axis[2][k];
        const double wide_m = 0.28 * scale[0], half_m = 0.3 * scale[1];
        const SurfaceClass class = of->kind == PLANT_PINE   ? SURFACE_FOREST_CONIFER
                                   : of->kind < PLANT_TREES ? SURFACE_FOREST_BROADLEAF
                                                            : SURFACE_SCRUB;
        for (double s = 0.5 * step_m; p_enu[2] + s * d[2] < stage.view.p_enu[2] - 200 && s < 120; s += step_m) {
            const double x = (from[0] + s * d[0]) / wide_m, y = (from[1] + s * d[1]) / wide_m;
            const double up = (from[2] + s * d[2]) / half_m;
            if (!(x * x + y * y + up * up < 1)) continue;
            depth += step_m;
            weighted += step_m * table.row[class][CLUTTER_KA].foliage_db_m;
        }
    }
    return depth > 14 ? weighted * 14 / depth * pow(depth / 14, 0.588) : weighted;
}

/* Crowns by points of the test's own in each; and the ground below them. */
static double canopy_by_integral(const RadarFrame *frame)
{
    enum { points = 20 };
    double sum_w = 0;
    for (int i = 0; i < plants; i++) {
        double axis[3][3], scale[2], middle[3];
        plant_axes(axis, scale, &plant[i], NULL);
        for (int k = 0; k < 3; k++)
            middle[k] = stage.woods.origin_enu[k] + (double)plant[i].p_m[k] + 0.7 * scale[1] * axis[2][k];
        if (unit_w(frame, middle) == 0) continue;
        const SurfaceClass class = plant[i].kind == PLANT_PINE   ? SURFACE_FOREST_CONIFER
                                   : plant[i].kind < PLANT_TREES ? SURFACE_FOREST_BROADLEAF
                                                                 : SURFACE_SCRUB;
        const ClutterRow *row = &table.row[class][CLUTTER_KA];
        const double      volume_m3 = 4 / 3.0 * pi_rad * pow(0.28 * scale[0], 2) * 0.3 * scale[1];
        const double      back = 2 * row->foliage_db_m * log(10) / 10 * row->gamma;
        for (int n = 0; n < points; n++) {
            double u[3], p[3];
            do /* in the unit sphere, by rejection */
                for (uint32_t k = 0; k < 3; k++) u[k] = 2 * (double)rand() / RAND_MAX - 1;
            while (v3_dot(u, u) > 1);
            for (int k = 0; k < 3; k++) p[k] = middle[k] + u[k] * (k < 2 ? 0.28 * scale[0] : 0.3 * scale[1]);
            sum_w += unit_w(frame, p) * back * volume_m3 / points * pow(10, -0.2 * march_db(p));
        }
    }
    return sum_w;
}

static double ground_by_integral(const RadarFrame *frame)
{
    const double step_m = 4, *o = stage.woods.origin_enu;
    double       sum_w = 0;
    for (double x = o[0] - 100; x < o[0] + 420; x += step_m)
        for (double y = o[1] - 100; y < o[1] + 420; y += step_m) {
            double n[3], d[3], at[3] = {x + step_m * rand() / RAND_MAX, y + step_m * rand() / RAND_MAX, 0};
            at[2] = elevation_height(&stage.landscape.elevation, at[0], at[1], n);
            const double unit = unit_w(frame, at);
            if (unit == 0) continue;
            int        surface = landscape_surface(&stage.landscape, at[0], at[1]);
            const bool inside = at[0] >= o[0] && at[1] >= o[1] && at[0] < o[0] + 320 && at[1] < o[1] + 320;
            if (inside &&
                (surface == SURFACE_FOREST_BROADLEAF || surface == SURFACE_FOREST_CONIFER || surface == SURFACE_SCRUB))
                surface = SURFACE_GRASS;
            v3_sub(d, stage.view.p_enu, at);
            v3_normalize(d, d);
            sum_w += unit * clutter_sigma0(&table.row[surface][CLUTTER_KA], asin(v3_dot(d, n)), 1) * step_m * step_m /
                     n[2] * pow(10, -0.2 * march_db(at));
        }
    return sum_w;
}

static void woods_have_the_power_of_their_integral(void **state)
{
    (void)state;
    const Weather weather = weather_default();
    double        got_w = 0, canopy_w = 0, ground_w = 0, bare_w = 0;
    enum { seeds = 4 };
    for (uint64_t seed = 1; seed <= seeds; seed++) {
        SeekerRadar *radar = open_radar(seed, true);
        RadarScene   scene = look(-asin(250 / reference_m), 250, (uint32_t)seed, &weather);
        arena_reset(stage.arena);
        bare_w += power_w(measure(radar, &scene)) / seeds;
        scene.world = &stage.woods_world;
        const RadarFrame *frame = measure(radar, &scene);
        got_w += power_w(frame) / seeds;
        CHECK(frame->crowns > 50);
        if (seed == 1) canopy_w = canopy_by_integral(frame), ground_w = ground_by_integral(frame);
        if (seed == 1) printf("woods of %d plants in sight: %.2f s\n", frame->crowns, frame->spent_s);
        seeker_radar_destroy(radar);
    }
    printf("woods: %.3f dB over the integral; of it the ground %.1f dB (bare: %.1f dB)\n",
           db(got_w / (canopy_w + ground_w)), db(ground_w / (canopy_w + ground_w)), db(bare_w / (canopy_w + ground_w)));
    CHECK_NEAR(db(got_w / (canopy_w + ground_w)), 0, 0.3);
}

/* ---- chaff --------------------------------------------------------------------------------------- */

static void put_chaff(SnapshotChaff *chaff, double range_m, double age_s, const double v_enu_mps[3])
{
    const double *r = stage.view.r_enu_from_cam;
    double        p[3];
    for (int k = 0; k < 3; k++) p[k] = stage.view.p_enu[k] + range_m * r[3 * k + 2];
    *chaff = (SnapshotChaff){.id = {1, 2, 3}, .age_s = age_s};
    ecef_from_enu(chaff->p_ecef, &stage.world.frame, p);
    m3_mul_v3(chaff->v_ecef_mps, stage.world.frame.r_ecef_from_enu, v_enu_mps);
}

/* Powers of the map's sum and cross-polarised channels, noise taken off, and the first moments of the first. */
typedef struct Moments {
    double power, cross, rate_mps, range_m;
} Moments;

static void add_moments(Moments *to, const RadarFrame *frame)
{
    const size_t cells = (size_t)frame->map.rows * (size_t)frame->map.columns;
    const double floor_w = frame->receiver.noise_w * frame->map.noise_share;
    for (size_t c = 0; c < cells; c++) {
        const double complex z = frame->map.cell[c], x = frame->map.cell[CHANNEL_CROSS * cells + c];
        const double         w = creal(z * conj(z)) - floor_w;
        to->power += w, to->cross += creal(x * conj(x)) - floor_w;
        to->rate_mps += w * ((double)(c / (size_t)frame->map.columns) - frame->map.rows / 2) * frame->map.mps_per_row;
        to->range_m +=
            w * ((double)(c % (size_t)frame->map.columns) - frame->map.columns / 2) * frame->map.metre_per_column;
    }
}

static void chaff_has_its_cross_section(void **state)
{
    (void)state;
    enum { looks = 12 };
    const Weather weather = weather_default();
    const double  v[3] = {12 * sqrt(0.5), 12 * sqrt(0.5), 0};
    SnapshotChaff chaff;
    Moments       got = {0};
    double        power = 0, want_w = 0, l = 0;
    Snapshot      snapshot = {.chaff_count = 1, .chaff = &chaff};
    SeekerRadar  *radar = open_radar(1, false);
    for (uint32_t number = 1; number <= looks; number++) {
        RadarScene scene = look(0, 400, number, &weather);
        scene.snapshot = &snapshot;
        put_chaff(&chaff, reference_m, 2, v);
        arena_reset(stage.arena);
        const RadarFrame *frame = measure(radar, &scene);
        CHECK(frame->clouds == 1);
        /* 0.1515 lambda^2 a dipole, over the cloud's Gaussian across the beam; so thin that it takes 0.3 % of itself */
        const double radius = 1 + 7 * (1 - exp(-2.)) + 0.6;
        double       mean = 0;
        l = frame->preset->antenna.wavelength_m;
        for (double s = 0.01; s < 6 * radius; s += 0.02)
            mean += s * 0.02 / (radius * radius) * exp(-0.5 * s * s / radius / radius) *
                    pow(antenna_gain(&frame->preset->antenna, s / reference_m, 0).sum, 4);
        want_w += radar_received_w(&(RadarLink){frame->preset->power_w, 1, 1, l, reference_m, frame->preset->loss}, 1) *
                  mean * pow(10, -0.2 * frame->air_db) * 0.1515 * l * l * 1e6;
        power += power_w(frame);
        add_moments(&got, frame);
    }
    printf("chaff of %.1f m2: %.3f dB of its mean cross section; cross-polarised %.2f dB, %.2f m/s\n",
           1e6 * 0.1515 * l * l, db(power / want_w), db(got.cross / got.power), got.rate_mps / got.power);
    CHECK_NEAR(db(power / want_w), 0, 0.3);
    CHECK_NEAR(got.cross / got.power, 1.0 / 3, 0.03);
    CHECK_NEAR(got.rate_mps / got.power, 12, 0.2);
    seeker_radar_destroy(radar);
}

/* Reported at rest ten seconds ago, 30 m before the reference, in wind of 3 m/s from behind. */
static void chaff_at_rest_is_left_to_the_wind(void **state)
{
    (void)state;
    Weather       weather = weather_default();
    SnapshotChaff chaff;
    Moments       got = {0};
    Snapshot      snapshot = {.chaff_count = 1, .chaff = &chaff};
    SeekerRadar  *radar = open_radar(1, false);
    weather.wind_from_rad = 225 * rad_per_deg;
    for (uint32_t number = 1; number <= 8; number++) {
        RadarScene scene = look(0, 400, number, &weather);
        scene.snapshot = &snapshot;
        put_chaff(&chaff, reference_m - 30, 10, (const double[3]){0, 0, 0});
        arena_reset(stage.arena);
        add_moments(&got, measure(radar, &scene));
    }
    printf("chaff in the wind: %.2f m/s, %.1f m from where it should be\n", got.rate_mps / got.power,
           got.range_m / got.power);
    CHECK_NEAR(got.rate_mps / got.power, 3, 0.2);
    CHECK_NEAR(got.range_m / got.power, 0, 1.5);
    seeker_radar_destroy(radar);
}

/* Still air, seen from below at 80 degrees: ten seconds ago it was 3 m higher, and falls at 0.3 m/s. */
static void chaff_falls(void **state)
{
    (void)state;
    Weather       weather = weather_default();
    SnapshotChaff chaff;
    Moments       got = {0};
    Snapshot      snapshot = {.chaff_count = 1, .chaff = &chaff};
    SeekerRadar  *radar = open_radar(1, false);
    weather.wind_mps = 0;
    for (uint32_t number = 1; number <= 8; number++) {
        RadarScene scene = look(80 * rad_per_deg, 400, number, &weather);
        scene.snapshot = &snapshot;
        put_chaff(&chaff, reference_m + 3, 10, (const double[3]){0, 0, 0});
        arena_reset(stage.arena);
        add_moments(&got, measure(radar, &scene));
    }
    printf("chaff that falls: %.2f m/s, %.1f m from where it should be\n", got.rate_mps / got.power,
           got.range_m / got.power);
    CHECK_NEAR(got.rate_mps / got.power, -0.3 * sin(80 * rad_per_deg), 0.2);
    CHECK_NEAR(got.range_m / got.power, 0, 1.5);
    seeker_radar_destroy(radar);
}

/* ---- a corner reflector ----------------------------------------------------------------------------- */

typedef struct Corner {
    SnapshotEntity entity;
    SnapshotJoints joints;
    Snapshot       snapshot;
} Corner;

/* Its middle on the boresight at the reference, heading north: the antenna, in the south-west and 35.3 degrees up, is
 * on the axis of an octant. */
static void put_corner(Corner *c)
{
    static const double r_enu_from_body[9] = {0, 1, 0, 1, 0, 0, 0, 0, -1};
    const DisEntityType type = {8, 3, 225, 5, 0, 0, 0};
    const double       *r = stage.view.r_enu_from_cam;
    double              p[3];
    *c = (Corner){.entity = {.id = {1, 1, 9}, .type = type, .model = catalog_find(stage.catalog, type, NULL, NULL)}};
    CHECK(strcmp(catalog_model(stage.catalog, c->entity.model)->name, "corner_reflector") == 0);
    for (int k = 0; k < 3; k++) p[k] = stage.view.p_enu[k] + reference_m * r[3 * k + 2] - (k == 2 ? 0.5 : 0);
    ecef_from_enu(c->entity.p_ecef, &stage.world.frame, p);
    m3_mul(c->entity.r_ecef_from_body, stage.world.frame.r_ecef_from_enu, r_enu_from_body);
    c->snapshot = (Snapshot){.count = 1, .entity = &c->entity, .joints = &c->joints};
}

static double strongest_m2(const RadarFrame *frame)
{
    CHECK(frame->targets == 1 && frame->detections > 0);
    CHECK_NEAR(frame->detection[0].range_m, reference_m, 0.3);
    return frame->detection[0].rcs_m2;
}

static void corners_return_what_the_handbook_says(void **state)
{
    (void)state;
    const Weather weather = weather_default();
    const double  up = asin(sqrt(1.0 / 3)), radius = 11; /* of the cloud after 10 s */
    SeekerRadar  *radar, *thick;
    Corner        corner;
    SnapshotChaff chaff;
    RadarScene    scene = look(-up, reference_m * sin(up) + 200, 1, &weather);
    radar = open_radar(1, false);
    CHECK(seeker_radar_create(&thick, &(SeekerRadarConfig){.preset = "seeker_35",
                                                           .catalog = stage.catalog_path,
                                                           .isa = "avx2",
                                                           .seed = 1,
                                                           .chaff_dipoles = 4.5e7}) == STATUS_OK);
    put_corner(&corner);
    scene.snapshot = &corner.snapshot;
    arena_reset(stage.arena);
    const RadarFrame *frame = measure(radar, &scene);
    const double      l = frame->preset->antenna.wavelength_m, want = 4 * pi_rad * pow(0.5, 4) / (3 * l * l),
                 got = strongest_m2(frame);
    printf("trihedral of 0.5 m: %.2f dB of 4 pi a^4 / 3 lambda^2 = %.1f dBsm\n", db(got / want), db(want));
    CHECK_NEAR(db(got / want), 0, 0.5);
    /* behind a cloud of chaff, 300 m before it */
    corner.snapshot.chaff = &chaff, corner.snapshot.chaff_count = 1;
    put_chaff(&chaff, reference_m - 300, 10, (const double[3]){0.1, 0, 0});
    const double behind = strongest_m2(measure(thick, &scene));
    const double taken_db = 2 * 4.5e7 / (2 * pi_rad * radius * radius) * l * l / (2 * pi_rad) * 10 / log(10);
    printf("behind chaff: %.3f dB less, %.3f by hand\n", db(got / behind), taken_db);
    CHECK_NEAR(db(got / behind), taken_db, 0.1);
    seeker_radar_destroy(radar);
    seeker_radar_destroy(thick);
}

/* ---- the same bits ------------------------------------------------------------------------------------ */

static void the_same_bits(void **state)
{
    (void)state;
    Weather       weather = weather_default();
    SnapshotChaff chaff;
    Snapshot      snapshot = {.chaff_count = 1, .chaff = &chaff};
    SeekerRadar  *radar = open_radar(3, true), *other = open_radar(3, true);
    weather.rain_mm_h = 5;
    RadarScene scene = look(-asin(250 / reference_m), 250, 7, &weather);
    scene.world = &stage.woods_world;
    scene.snapshot = &snapshot;
    put_chaff(&chaff, reference_m - 40, 5, (const double[3]){1, 0, 0});
    arena_reset(stage.arena);
    const RadarFrame *first = measure(radar, &scene), *alone, *again;
    CHECK(first->crowns > 0 && first->clouds == 1 && first->rain_1_m > 0);
    scene.number = 8;
    measure(radar, &scene);
    scene.number = 7;
    CHECK(seeker_radar_measure(&alone, radar, &scene, NULL, stage.arena) == STATUS_OK);
    CHECK(seeker_radar_measure(&again, other, &scene, stage.pool, stage.arena) == STATUS_OK);
    const size_t octets =
        interval_channels * (size_t)first->map.rows * (size_t)first->map.columns * sizeof *first->map.cell;
    CHECK(memcmp(first->map.cell, alone->map.cell, octets) == 0 &&
          memcmp(first->map.cell, again->map.cell, octets) == 0);
    seeker_radar_destroy(radar);
    seeker_radar_destroy(other);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rain_has_the_power_of_its_integral),     cmocka_unit_test(rain_folds_over),
        cmocka_unit_test(rain_and_fog_take_what_itu_says),        cmocka_unit_test(rain_behind_the_ground_is_hidden),
        cmocka_unit_test(woods_have_the_power_of_their_integral), cmocka_unit_test(chaff_has_its_cross_section),
        cmocka_unit_test(chaff_at_rest_is_left_to_the_wind),      cmocka_unit_test(chaff_falls),
        cmocka_unit_test(corners_return_what_the_handbook_says),  cmocka_unit_test(the_same_bits),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
