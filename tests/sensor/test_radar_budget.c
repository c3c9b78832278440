/* The error budget of a radar's map made by hand: shares of its energy, source by source, and what they are of a cross
 * section in decibels. Of measured maps: test_radar_error.c. */
#include "tests/check.h"

#include "sensor/truth/frame_error.h"
#include "render/scattering/signatures/signature.h"

#include <complex.h>

/* A map by hand: 4 x 8 cells of power 2 in the sum channel, 64 in all; others are not looked at. An entity whose signal
 * is so many times the noise of a cell, 0.5 W times a quarter, has that in 8 of 32 cells, by the windows' bandwidths.
 */
static void shares_of_a_map_by_hand(void **state)
{
    (void)state;
    enum { rows = 4, columns = 8 };
    static double complex cell[2 * rows * columns];
    RadarPreset           preset = {.range_window = {.kind = WINDOW_RECT}, .transmits_h = true};
    SnapshotEntity        entity[4] = {{.drift_m = 0}, {.drift_m = 9}, {.drift_m = 0}, {.drift_m = 7}};
    const Snapshot        snapshot = {.count = 4, .entity = entity};
    const RadarTruth      target[3] = {{.entity = 0, .snr = 10, .rcs_error_db = {1, 2, 5}},
                                       {.entity = 1, .snr = 20, .rcs_error_db = {NAN, NAN, NAN}}, /* given: no error */
                                       {.entity = 3, .snr = 0, .rcs_error_db = {INFINITY, INFINITY, 0}}}; /* no echo */
    RadarFrame            radar = {.preset = &preset, .targets = 3, .target = target};
    RadarError            error;
    for (int i = 0; i < 2 * rows * columns; i++) cell[i] = i < rows * columns ? CMPLX(1, -1) : CMPLX(100, 7);
    radar.map =
        (RangeDoppler){.rows = rows, .columns = columns, .metre_per_column = 4, .noise_share = 0.25, .cell = cell};
    radar.receiver.noise_w = 0.5;
    radar_error(&error, &radar, &snapshot);
    /* 10 of 64, off by 1 dB: half of (10^0.1 - 1)^2 of the field's square, since half of an error is in its phase */
    const double tubes = 0.5 * pow(pow(10, 0.1) - 1, 2), centres = signature_cells_error();
    const double grid = radar_error_of_gridding() * radar_error_of_gridding();
    /* 20 of 64, displaced along the range by one of three components: 9 / sqrt(3) / 4 = 1.299 cells. Of even weights
     * the response is sin(pi x) / (n sin(pi x / n)), here of n = 256 */
    const double x = 9 / sqrt(3) / 4, moved = 2 * (1 - fabs(sin(pi_rad * x) / (256 * sin(pi_rad * x / 256))));
    CHECK_NEAR(error.share[ERROR_SAMPLING], sqrt(10 * tubes / 64), 1e-12);
    CHECK_NEAR(error.share[ERROR_LEVEL_OF_DETAIL], sqrt(10 * centres / 64), 1e-12);
    CHECK_NEAR(error.share[ERROR_DEAD_RECKONING], sqrt(20 * moved / 64), 1e-9);
    CHECK_NEAR(error.share[ERROR_TABLES], radar_error_of_gridding(), 1e-15);
    CHECK_NEAR(error.share[ERROR_TOTAL], sqrt((10 * tubes + 10 * centres + 20 * moved) / 64 + grid), 1e-9);
    /* of the cross section: that of the one whose error is known */
    CHECK_NEAR(error.db[ERROR_SAMPLING], 1, 1e-12);
    CHECK_NEAR(error.db[ERROR_LEVEL_OF_DETAIL], 10 * log10(1 + sqrt(2 * centres)), 1e-12);
    CHECK_NEAR(error.db[ERROR_TABLES], 10 * log10(1 + sqrt(2 * grid)), 1e-12);
    CHECK_NEAR(error.db[ERROR_TOTAL], 10 * log10(1 + sqrt(2 * (tubes + centres + grid))), 1e-12);
    CHECK(isnan(error.db[ERROR_DEAD_RECKONING]) && isnan(error.share[ERROR_HEAT]) && isnan(error.db[ERROR_HEAT]));

    /* with a window the response is the transform of its squared weights, sin^4 of Hann's, over their sum */
    double complex turned = 0;
    double         still = 0;
    for (int i = 0; i < 256; i++) {
        const double weight = pow(sin(pi_rad * i / 255), 4);
        turned += weight * cexp(CMPLX(0, 2 * pi_rad * x * i / 256));
        still += weight;
    }
    preset.range_window.kind = WINDOW_HANN;
    radar_error(&error, &radar, &snapshot);
    CHECK_NEAR(error.share[ERROR_DEAD_RECKONING], sqrt(20 * 2 * (1 - cabs(turned) / still) / 64), 1e-9);
    preset.range_window.kind = WINDOW_RECT;

    preset.transmits_h = false; /* then of VV */
    radar_error(&error, &radar, &snapshot);
    CHECK_NEAR(error.db[ERROR_SAMPLING], 2, 1e-12);
    /* far from where it was nothing of the magnitudes is alike */
    entity[1].drift_m = 0, entity[0].drift_m = 40 * sqrt(3) * 4;
    radar_error(&error, &radar, &snapshot);
    CHECK_NEAR(error.share[ERROR_DEAD_RECKONING], sqrt(10 * 2 / 64.0), 1e-9);
    entity[0].drift_m = -1; /* no displacement */
    radar_error(&error, &radar, &snapshot);
    CHECK(error.share[ERROR_DEAD_RECKONING] == 0);

    radar.targets = 0;
    radar_error(&error, &radar, &snapshot);
    CHECK_NEAR(error.share[ERROR_TOTAL], radar_error_of_gridding(), 1e-15);
    for (int s = 0; s < error_sources; s++) CHECK(isnan(error.db[s]));
    radar.targets = 3;
    memset(cell, 0, sizeof cell); /* a map without power */
    radar_error(&error, &radar, &snapshot);
    for (int s = 0; s < error_sources; s++) CHECK(isnan(error.share[s]));
    CHECK_NEAR(error.db[ERROR_SAMPLING], 2, 1e-12);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(shares_of_a_map_by_hand)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
