/* The error budget of a frame, source by source, on pictures made by hand: what each source is as a share of the mean
 * and in kelvin, and how the errors of pixels are spread. Displaced targets: test_displaced_target.c. Against rendered
 * frames: test_error_budget.c, test_frame_error.c. */
#include "tests/sensor/budget_stage.h"

/* ---- sources ------------------------------------------------------------------------------------ */

/* A band's share is the root of its planes' mean square, each over its own mean; in all, of the squares' sum. */
static void sources_are_shares_of_the_mean(void **state)
{
    (void)state;
    fresh();
    for (int k = 0; k < planes; k++) {
        lab.budget.mean[k] = 2 + k;
        lab.budget.sampling[k] = 0.1 * (k + 1);
        lab.budget.level_of_detail[k] = 0.3 * (k + 1);
        lab.budget.tables[k] = 0.02 * (k + 2);
    }
    lab.budget.mean[picture_lwir] = lwir_at(300);
    for (int k = 0; k < 3; k++) lab.picture.optical[k] = lab.plane[k];
    lab.picture.lwir = lab.plane[picture_lwir], lab.picture.radar = lab.plane[picture_radar];
    FrameError error = judged(0);
    /* planes 0 .. 2 of means 2, 3, 4: 0.1 / 2, 0.2 / 3, 0.3 / 4 */
    const double sampling = sqrt((0.0025 + 0.04 / 9 + 0.005625) / 3);
    CHECK_NEAR(error.share[BAND_OPTICAL][ERROR_SAMPLING], sampling, 1e-12);
    CHECK_NEAR(error.share[BAND_OPTICAL][ERROR_LEVEL_OF_DETAIL], 3 * sampling, 1e-12);
    CHECK_NEAR(error.share[BAND_OPTICAL][ERROR_TABLES], 0.02, 1e-12);
    CHECK_NEAR(error.share[BAND_OPTICAL][ERROR_TOTAL], sqrt(10 * sampling * sampling + 0.0004), 1e-12);
    CHECK(error.share[BAND_OPTICAL][ERROR_HEAT] == 0 && error.share[BAND_OPTICAL][ERROR_DEAD_RECKONING] == 0);
    /* plane 5, mean 7: 0.6, 1.8, 0.14 */
    CHECK_NEAR(error.share[BAND_RADAR][ERROR_SAMPLING], 0.6 / 7, 1e-12);
    CHECK_NEAR(error.share[BAND_RADAR][ERROR_TABLES], 0.02, 1e-12);
    CHECK_NEAR(error.share[BAND_RADAR][ERROR_TOTAL], sqrt(0.36 + 3.24 + 0.0196) / 7, 1e-12);
    /* plane 4 in kelvin: 0.5, 1.5 and 0.12 W/(m2 sr) over the slope at the mean; the step of its difference is 1e-3 of
     * the mean, 0.06 K, of which the slope changes by 1e-3 */
    const double slope = lwir_slope(300);
    CHECK_NEAR(error.kelvin[BAND_LWIR][ERROR_SAMPLING] * slope / 0.5, 1, 1e-3);
    CHECK_NEAR(error.kelvin[BAND_LWIR][ERROR_LEVEL_OF_DETAIL] * slope / 1.5, 1, 1e-3);
    CHECK_NEAR(error.kelvin[BAND_LWIR][ERROR_TOTAL] * slope / sqrt(0.25 + 2.25 + 0.0144), 1, 1e-3);
    for (int s = 0; s < error_sources; s++) {
        CHECK(isnan(error.share[BAND_MWIR][s]) && isnan(error.kelvin[BAND_MWIR][s])); /* there is none */
        CHECK(isnan(error.kelvin[BAND_OPTICAL][s]) && isnan(error.kelvin[BAND_RADAR][s]));
    }
    CHECK(isnan(error.median_k[BAND_OPTICAL]) && isnan(error.beyond_1k[BAND_RADAR]) &&
          isnan(error.median_k[BAND_MWIR]));

    /* one channel: its own share; a plane without light has none */
    lab.picture.optical[1] = lab.picture.optical[2] = NULL;
    lab.budget.mean[picture_radar] = 0;
    error = judged(0);
    CHECK_NEAR(error.share[BAND_OPTICAL][ERROR_SAMPLING], 0.05, 1e-12);
    for (int s = 0; s < error_sources; s++) CHECK(isnan(error.share[BAND_RADAR][s]));

    /* MWIR has its own table and its own means */
    lab.picture.mwir = lab.plane[picture_mwir];
    lab.budget.mean[picture_mwir] = planck_band(3.4e-6, 4.8e-6, 320, NULL);
    double mwir_slope;
    planck_band(3.4e-6, 4.8e-6, 320, &mwir_slope);
    error = judged(0);
    CHECK_NEAR(error.kelvin[BAND_MWIR][ERROR_SAMPLING] * mwir_slope / 0.4, 1, 1e-3);
    CHECK_NEAR(error.kelvin[BAND_LWIR][ERROR_SAMPLING] * slope / 0.5, 1, 1e-3);

    FrameErrorOf of = {&lab.picture, &lab.world, &lab.snapshot, &lab.request, 0, false, NAN};
    lab.picture.budget = NULL;
    CHECK(!frame_error(&error, &of, lab.target, 0));
    lab.picture.budget = &lab.budget, lab.picture.entity = NULL;
    CHECK(!frame_error(&error, &of, lab.target, 0));
    lab.picture.entity = lab.id, lab.picture.target = NULL;
    CHECK(!frame_error(&error, &of, lab.target, 0));
}

/* Ground 0.03 K and 0.5 % of what it is from the air; a part 0.038 K and 0.45 % of what is beyond 15 K
 * (vehicle_heat_error_k); nothing where no temperature is known, over all pixels. */
static void heat_is_of_ground_and_parts(void **state)
{
    (void)state;
    fresh();
    lab.picture.lwir = lab.plane[picture_lwir];
    lab.budget.mean[picture_lwir] = lwir_at(300);
    lab.air_k = 290;
    lab.entity[0].first_patch = 0; /* the second has no temperatures */
    for (int i = 0; i < pixels; i++) lab.temp_k[i] = NAN;
    lab.temp_k[0] = 300, lab.temp_k[1] = 270;                   /* ground: 0.08 K, 0.13 K */
    lab.temp_k[2] = 315, lab.id[2] = 1;                         /* a part: 0.083 K */
    lab.temp_k[3] = 265, lab.id[3] = 1, lab.covered[3] = 0.25f; /* a quarter of a pixel of 0.083 K */
    lab.temp_k[4] = 400, lab.id[4] = 2;
    lab.temp_k[5] = 400, lab.id[5] = entities + 1; /* of no entity of the snapshot */
    lab.picture.temp_k = lab.temp_k, lab.picture.covered = lab.covered;
    const double want_k2 = (0.08 * 0.08 + 0.13 * 0.13 + 0.083 * 0.083 * (1 + 0.0625)) / pixels;
    FrameError   error = judged(0);
    /* into W/(m2 sr) and back by the same slope */
    CHECK_NEAR(error.kelvin[BAND_LWIR][ERROR_HEAT], sqrt(want_k2), 1e-9);
    CHECK_NEAR(error.share[BAND_LWIR][ERROR_HEAT] * lwir_at(300) / lwir_slope(300) / sqrt(want_k2), 1, 1e-3);
    CHECK(error.share[BAND_LWIR][ERROR_TOTAL] == error.share[BAND_LWIR][ERROR_HEAT]);
    lab.picture.covered = NULL; /* then the whole pixel is the entity's */
    error = judged(0);
    CHECK_NEAR(error.kelvin[BAND_LWIR][ERROR_HEAT], sqrt((0.08 * 0.08 + 0.13 * 0.13 + 2 * 0.083 * 0.083) / pixels),
               1e-9);
    lab.air_k = NAN;
    CHECK(judged(0).share[BAND_LWIR][ERROR_HEAT] == 0);
    lab.air_k = 290, lab.picture.temp_k = NULL;
    CHECK(judged(0).share[BAND_LWIR][ERROR_HEAT] == 0);
}

/* ---- pixel by pixel ----------------------------------------------------------------------------- */

/* Bins of 64 a decade from 1e-4 K on: the median of a single value is the middle of its bin. */
static double bin_middle_k(double k) { return 1e-4 * pow(10, (floor(64 * log10(k / 1e-4)) + 0.5) / 64); }

enum { probes_most = 4 };

static void the_rest_is_spread_by_probes_and_as_an_exponential(void **state)
{
    (void)state;
    static const double px[probes_most] = {300, 500, 100, 50};
    static float        square_w[error_thermal_planes][probes_most];
    const double        slope = lwir_slope(300), w2 = slope * slope; /* (W/(m2 sr))^2 of 1 K^2 */
    fresh();
    lab.picture.lwir = lab.plane[picture_lwir];
    lab.budget.mean[picture_lwir] = lwir_at(300);

    /* probes alone, for 900 of 1200 pixels; the last says nothing. The others have no error. */
    static const double probe_k2[probes_most] = {0.04, 4, 0.25, NAN};
    for (int i = 0; i < probes_most; i++) {
        square_w[1][i] = (float)(probe_k2[i] * w2);
        square_w[0][i] = 1e6f; /* of MWIR, which is not asked */
    }
    lab.budget.probes = probes_most, lab.budget.probe_px = px;
    lab.budget.probe_square[0] = square_w[0], lab.budget.probe_square[1] = square_w[1];
    FrameError error = judged(0);
    /* 300 px of 0, 300 of 0.2 K: half */
    CHECK_NEAR(error.median_k[BAND_LWIR] / 0.2, 1, 0.04);
    /* tables of the normal distribution: beyond 5, 0.5 and 2 sigma */
    CHECK_NEAR(error.beyond_1k[BAND_LWIR], (300 * 5.733e-7 + 500 * 0.617075 + 100 * 0.0455) / pixels, 2e-4);
    /* tables add their square to all of them: 1 K */
    lab.budget.tables[picture_lwir] = slope;
    error = judged(0);
    CHECK_NEAR(error.beyond_1k[BAND_LWIR], (300 * 0.317311 + 300 * 0.326801 + 500 * 0.654721 + 100 * 0.371093) / pixels,
               3e-4);
    lab.budget.tables[picture_lwir] = 0;
    /* probes that stand for more than the picture are scaled to it */
    static const double many_px[probes_most] = {600, 1000, 200, 50};
    lab.budget.probe_px = many_px;
    error = judged(0);
    CHECK_NEAR(error.beyond_1k[BAND_LWIR], (600 * 5.733e-7 + 1000 * 0.617075 + 200 * 0.0455) / 1800, 2e-4);
    CHECK_NEAR(error.median_k[BAND_LWIR] / 2, 1, 0.04);

    /* No probes: an exponential of mean square m has its median at m ln 2, and exp(-sqrt(2 / m)) of its pixels beyond
     * 1 K, the integral of exp(-x / m) / m erfc(1 / sqrt(2 x)); nine steps take 1 % off. The median is that of the
     * middle step: on either side of a bin's edge, it is in its own bin. */
    lab.budget.probes = 0;
    for (int bin = 200; bin < 300; bin += 33)
        for (int side = -1; side <= 1; side += 2) {
            const double median_k = 1e-4 * pow(10, bin / 64.0) * (1 + 0.006 * side),
                         mean_k2 = median_k * median_k / log(2);
            lab.budget.refined_square[1] = mean_k2 * w2 * pixels;
            lab.budget.refined_square[0] = 1e6;
            error = judged(0);
            CHECK_NEAR(error.median_k[BAND_LWIR] / bin_middle_k(median_k), 1, 1e-9);
            CHECK_NEAR(error.beyond_1k[BAND_LWIR], exp(-sqrt(2 / mean_k2)), 0.012 * exp(-sqrt(2 / mean_k2)) + 2e-3);
        }

    /* Probes of 400 px and 800 others, whose sum of squares is theirs alone: as likely beyond as on their own. */
    static const double some_px[1] = {400};
    lab.budget.probes = 1, lab.budget.probe_px = some_px;
    square_w[1][0] = (float)(4 * w2);
    lab.budget.refined_square[1] = 1.0 * w2 * 800;
    error = judged(0);
    CHECK_NEAR(error.beyond_1k[BAND_LWIR], (400 * 0.617075 + 800 * exp(-sqrt(2))) / pixels, 2e-3);
}

/* A bar of 10 x 10 pixels, 10 K warmer, 2 px off: as on its own (test_pixel_error.c), rms sqrt(20) K; 180 pixels are
 * touched and the rest is what the probes say. */
static void a_target_and_the_rest(void **state)
{
    (void)state;
    static const double px[1] = {pixels};
    static float        square_w[1];
    const double        slope = lwir_slope(300);
    fresh();
    lab.picture.lwir = lab.plane[picture_lwir];
    lab.budget.mean[picture_lwir] = lwir_at(300);
    lab.px[0] = (TargetPixels){.visible = 100, .box = {15, 10, 25, 20}};
    for (int i = 0; i < pixels; i++) {
        const int x = i % width, y = i / width;
        lab.id[i] = x >= 15 && x < 25 && y >= 10 && y < 20;
        lab.plane[picture_lwir][i] = (float)lwir_at(lab.id[i] ? 310 : 300);
        lab.temp_k[i] = lab.id[i] ? 310 : 300;
    }
    lab.entity[0].drift_m = 2 * range_m / focal_px / sqrt(2.0 / 3);
    lab.budget.probes = 1, lab.budget.probe_px = px, lab.budget.probe_square[1] = square_w;
    square_w[0] = (float)(slope * slope); /* 1 K everywhere else */
    FrameError error = judged(1);
    CHECK_NEAR(lab.target[0].band[BAND_LWIR].error_rms_k, sqrt(20), 2e-3);
    CHECK_NEAR(lab.target[0].band[BAND_LWIR].error_median_k, 5, 0.2);
    CHECK(isnan(lab.target[0].band[BAND_MWIR].error_rms_k) && isnan(lab.target[0].band[BAND_OPTICAL].error_rms_k));
    /* touched: 36 of 0, 48 + 80 of 5 K, 16 of sqrt(50) K (a pixel beside it meets it in one direction of four) */
    const double touched = 128 * 0.841481 + 16 * 0.887537, rest = (pixels - 180) * 0.317311;
    CHECK_NEAR(error.beyond_1k[BAND_LWIR], (touched + rest) / pixels, 1e-3);
    CHECK_NEAR(error.median_k[BAND_LWIR], 1, 0.04);
    /* probes that stand for twice as many pixels are scaled to them */
    static const double twice_px[1] = {2 * pixels};
    lab.budget.probe_px = twice_px;
    error = judged(1);
    CHECK_NEAR(error.beyond_1k[BAND_LWIR], (touched + rest) / pixels, 1e-3);
    /* the ground's heat, and that of what has none, in the mean of all pixels, is in each of the others: 300 K is 100 K
     * from the air, 0.53 K */
    lab.picture.temp_k = lab.temp_k, lab.air_k = 200;
    const double heat_k2 = 0.53 * 0.53 * (pixels - 100) / pixels;
    square_w[0] = (float)((1 - heat_k2) * slope * slope);
    error = judged(1);
    CHECK_NEAR(error.beyond_1k[BAND_LWIR], (touched + rest) / pixels, 1e-3);
    /* tables and its own heat besides: 2 K, and 0.038 + 0.0045 (40 - 15) = 0.1505 K */
    lab.budget.tables[picture_lwir] = 2 * slope;
    lab.picture.temp_k = lab.temp_k, lab.air_k = 270;
    lab.entity[0].first_patch = 0;
    judged(1);
    CHECK_NEAR(lab.target[0].band[BAND_LWIR].error_rms_k, sqrt(20 + 4 + 0.1505 * 0.1505), 4e-3);
    lab.budget.tables[picture_lwir] = 0, lab.entity[0].drift_m = 0;
    judged(1);
    CHECK_NEAR(lab.target[0].band[BAND_LWIR].error_rms_k, 0.1505, 1e-6);
    lab.entity[0].first_patch = -1; /* no temperatures of its own */
    judged(1);
    CHECK(lab.target[0].band[BAND_LWIR].error_rms_k == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sources_are_shares_of_the_mean),
        cmocka_unit_test(heat_is_of_ground_and_parts),
        cmocka_unit_test(the_rest_is_spread_by_probes_and_as_an_exponential),
        cmocka_unit_test(a_target_and_the_rest),
    };
    return cmocka_run_group_tests(tests, lab_open, lab_close);
}
