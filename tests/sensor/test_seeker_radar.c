/* The radar of a seeker over ground: its power against an integral over the ground that the test makes itself, its
 * place in Doppler, and the same bits whatever made them. labels: physics slow */
#include "tests/check.h"

#include "sensor/radar/seeker_radar.h"

#include "render/scattering/clutter/clutter_table_private.h"
#include "render/scattering/paths/radar_path.h"

static double      height_m = 250, aim_m = 900, reference_m = 900; /* of the axis; of the window */
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

static int open_stage(void **state)
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

static int close_stage(void **state)
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
static RadarScene scene_of(const double v_enu_mps[3], uint32_t number, const Weather *weather)
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

static SeekerRadar *open_windy_radar(uint64_t seed, double wind_mps)
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

static SeekerRadar *open_radar(uint64_t seed) { return open_windy_radar(seed, 0); }

/* Share of a pulse of pulse_doppler_ku, 1 us every 10, that arrives past the transmitter's own. */
static double heard(double range_m)
{
    const double pulse_m = 149.896229, repeat_m = 1498.96229, at_m = range_m - repeat_m * floor(range_m / repeat_m);
    return at_m < pulse_m ? at_m / pulse_m : at_m > repeat_m - pulse_m ? (repeat_m - at_m) / pulse_m : 1;
}

/* Billingsley's law: still + (1 - still) / (1 + (4 pi lag / (beta lambda))^2). */
static double kept(const ClutterRow *row, const RadarPreset *p, double lag_s, double wind_mps)
{
    const ClutterMotion motion = clutter_motion(row, p->wave.centre_hz, wind_mps);
    return motion.still +
           (1 - motion.still) / (1 + pow(4 * pi_rad * lag_s * motion.spread_mps / p->antenna.wavelength_m, 2));
}

/* Sum over ground of the power that each square metre returns: classes, heights and the dish's pattern asked for
 * anew, places and integral the test's own. Of its fields a share is the same lag_s later, in wind. *far_w: what is
 * beyond the window. */
static double power_by_integral(double *far_w, const RadarFrame *frame, double lag_s, double wind_mps)
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

static double ground_over_integral_db(int *cells, double *far_share, int seeds)
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

static void ground_has_the_power_of_its_integral(void **state)
{
    (void)state;
    int    cells;
    double far_share;
    CHECK_NEAR(ground_over_integral_db(&cells, &far_share, 3), 0, 0.3);
    CHECK(far_share == 0);
}

/* A window of 1499 m about 500 m, ground from 1270 m on: all that is received folds over; about 1499 m it is not heard.
 */
static void ground_folds_over(void **state)
{
    (void)state;
    int    cells;
    double far_share;
    preset = "pulse_doppler_ku", height_m = 250, aim_m = 1850, reference_m = 500;
    const double db = ground_over_integral_db(&cells, &far_share, 6);
    preset = "seeker_35", height_m = 250, aim_m = reference_m = 900;
    CHECK_NEAR(db, 0, 0.3);
    CHECK(far_share > 0.99);
}

/* Ground ahead moves against the antenna at v.d; the reference is followed at the axis' rate: the middle row. */
static void ground_is_where_it_must_be_in_doppler(void **state)
{
    (void)state;
    const double      v[3] = {150, 150, -60};
    const Weather     weather = weather_default();
    SeekerRadar      *radar = open_radar(3);
    RadarScene        scene = scene_of(v, 1, &weather);
    const RadarFrame *frame;
    arena_reset(stage.arena);
    CHECK(seeker_radar_measure(&frame, radar, &scene, stage.pool, stage.arena) == STATUS_OK);
    const double *r = stage.view.r_enu_from_cam;
    CHECK_NEAR(frame->reference_rate_mps, -(v[0] * r[2] + v[1] * r[5] + v[2] * r[8]), 1e-9);
    double power = 0, moment = 0;
    for (int y = 0; y < frame->map.rows; y++)
        for (int x = 0; x < frame->map.columns; x++) {
            const double complex c = frame->map.cell[(size_t)y * (size_t)frame->map.columns + (size_t)x];
            power += creal(c * conj(c));
            moment += creal(c * conj(c)) * (y - frame->map.rows / 2);
        }
    CHECK(fabs(moment / power) < 1);

    /* none of it moves, and the canceller, locked to it, leaves little: its rates differ by some 2 m/s of 86 */
    double profile_w = 0, mti_w = 0;
    for (int x = 0; x < frame->map.columns; x++) profile_w += frame->profile_w[x], mti_w += frame->mti_w[x];
    printf("canceller of the ground: %.1f dB; %d detections\n", 10 * log10(profile_w / mti_w), frame->detections);
    CHECK(frame->detections > 0 && 10 * log10(profile_w / mti_w) > 15);
    for (int i = 0; i < frame->detections; i++) CHECK(!frame->detection[i].moving);
    CHECK_NEAR(frame->timing.interval_s, 64 / 20e3, 1e-12);
    seeker_radar_destroy(radar);
}

/* A receiver that follows the range alone: the ground approaches at some 220 m/s, and the map of 64 rows spans 85.655.
 */
static void a_rate_not_followed_is_on_the_map(void **state)
{
    (void)state;
    static const char text[] =
        "name,waveform,centre_ghz,bandwidth_mhz,samples,pulses,repeat_khz,pulse_us,power_w,loss_db,dish_m,taper,transmit,"
        "noise_figure_db,phase_noise_deg,iq_gain_db,iq_phase_deg,bits,range_window,doppler_window,pfa,compensated,far_km,mti,source\n"
        "mine,lfm,35,500,512,64,20,20,30,5,0.18,1,v,5,0,0,0,0,taylor:5:40,hann,1e-6,0,0,3,test\n";
    const double  v[3] = {150, 150, -60};
    const Weather weather = weather_default();
    char          path[text_file_size];
    text_file(path, text);
    preset = "mine", own_table = path;
    SeekerRadar *radar = open_radar(3);
    preset = "seeker_35", own_table = NULL;
    remove(path);
    const RadarScene  scene = scene_of(v, 1, &weather);
    const RadarFrame *frame;
    arena_reset(stage.arena);
    CHECK(seeker_radar_measure(&frame, radar, &scene, stage.pool, stage.arena) == STATUS_OK);
    const double down = 250.0 / 900, rate = -(150 * sqrt(2) * sqrt(1 - down * down) + 60 * down), span = 85.65499;
    const int    want = 32 + (int)lround((rate - span * nearbyint(rate / span)) / span * 64);
    double       most = 0;
    int          at = -1;
    for (int y = 0; y < 64; y++) {
        double power = 0;
        for (int x = 0; x < 512; x++) {
            const double complex c = frame->map.cell[y * 512 + x];
            power += creal(c * conj(c));
        }
        if (power > most) most = power, at = y;
    }
    CHECK(frame->reference_rate_mps == 0 && abs(at - want) <= 1 && want != 32);
    CHECK_NEAR(frame->ground_rate_mps, rate, 1e-9);
    for (int i = 0; i < frame->detections; i++) CHECK(!frame->detection[i].moving);
    seeker_radar_destroy(radar);
}

/* Between two frames leaves move: the maps' correlation is the law's, weighted by the power of each class of ground. */
static void wind_decorrelates_the_ground(void **state)
{
    (void)state;
    enum { lags = 3, seeds = 4 };
    static const double lag_s[lags] = {0.001, 0.004, 1};
    const double        v[3] = {0, 0, 0}, wind_mps = 5;
    const Weather       weather = weather_default();
    double              along[lags] = {0}, power = 0, want[lags], far_w;
    for (uint64_t seed = 1; seed <= seeds; seed++) {
        SeekerRadar      *radar = open_windy_radar(seed, wind_mps), *calm = open_radar(seed);
        RadarScene        scene = scene_of(v, (uint32_t)seed, &weather);
        const RadarFrame *first, *later;
        arena_reset(stage.arena);
        CHECK(seeker_radar_measure(&first, radar, &scene, stage.pool, stage.arena) == STATUS_OK);
        const size_t cells = (size_t)first->map.rows * (size_t)first->map.columns;
        for (size_t i = 0; i < cells; i++) power += creal(first->map.cell[i] * conj(first->map.cell[i]));
        for (int l = 0; l < lags; l++) {
            scene.t_s = lag_s[l];
            CHECK(seeker_radar_measure(&later, radar, &scene, stage.pool, stage.arena) == STATUS_OK);
            for (size_t i = 0; i < cells; i++) along[l] += creal(later->map.cell[i] * conj(first->map.cell[i]));
            want[l] = power_by_integral(&far_w, first, lag_s[l], wind_mps) / power_by_integral(&far_w, first, 0, 0);
        }
        /* in a calm nothing moves */
        scene.t_s = 0;
        CHECK(seeker_radar_measure(&first, calm, &scene, stage.pool, stage.arena) == STATUS_OK);
        scene.t_s = 1;
        CHECK(seeker_radar_measure(&later, calm, &scene, stage.pool, stage.arena) == STATUS_OK);
        CHECK(memcmp(first->map.cell, later->map.cell, cells * sizeof *first->map.cell) == 0);
        seeker_radar_destroy(radar);
        seeker_radar_destroy(calm);
    }
    for (int l = 0; l < lags; l++) {
        print_message("ground in wind of %.0f m/s, %g s later: correlation %.3f, by the law %.3f\n", wind_mps, lag_s[l],
                      along[l] / power, want[l]);
        /* 4 standard errors of some 1000 independent cells */
        CHECK_NEAR(along[l] / power, want[l], 0.13);
    }
    CHECK(want[0] - want[1] > 0.13 && want[1] - want[2] > 0.13); /* three that differ */
}

static void the_same_bits(void **state)
{
    (void)state;
    const double      v[3] = {200, 100, -60};
    const Weather     weather = weather_default();
    SeekerRadar      *radar = open_radar(3), *other = open_radar(3);
    RadarScene        scene = scene_of(v, 7, &weather);
    const RadarFrame *first, *again, *alone;
    arena_reset(stage.arena);
    CHECK(seeker_radar_measure(&first, radar, &scene, stage.pool, stage.arena) == STATUS_OK);
    scene.number = 8;
    CHECK(seeker_radar_measure(&again, radar, &scene, NULL, stage.arena) == STATUS_OK);
    const size_t octets =
        interval_channels * (size_t)first->map.rows * (size_t)first->map.columns * sizeof *first->map.cell;
    CHECK(memcmp(first->map.cell, again->map.cell, octets) != 0); /* other noise */
    scene.number = 7;
    CHECK(seeker_radar_measure(&again, radar, &scene, NULL, stage.arena) == STATUS_OK);
    CHECK(seeker_radar_measure(&alone, other, &scene, stage.pool, stage.arena) == STATUS_OK);
    CHECK(memcmp(first->map.cell, again->map.cell, octets) == 0 &&
          memcmp(first->map.cell, alone->map.cell, octets) == 0);
    CHECK(first->targets == 0);
    seeker_radar_destroy(radar);
    seeker_radar_destroy(other);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ground_has_the_power_of_its_integral),  cmocka_unit_test(ground_folds_over),
        cmocka_unit_test(ground_is_where_it_must_be_in_doppler), cmocka_unit_test(a_rate_not_followed_is_on_the_map),
        cmocka_unit_test(wind_decorrelates_the_ground),          cmocka_unit_test(the_same_bits),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
