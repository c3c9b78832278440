/* Woods and rain beyond the fold through the whole chain, against integrals that the test makes itself; the same bits.
 * labels: physics slow */
#include "tests/sensor/radar_volume.h"

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
    enum { seeds = 8 };
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
        cmocka_unit_test(rain_folds_over),
        cmocka_unit_test(woods_have_the_power_of_their_integral),
        cmocka_unit_test(the_same_bits),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
