/* A radar's receiver and processing, with echoes whose answers are known on paper: signal to noise by the radar
 * equation, places, speeds and directions of points, images of I/Q errors, noise of a converter. labels: physics */
#include "tests/check.h"

#include "render/scattering/paths/radar_path.h"
#include "sensor/radar/detect_private.h"
#include "sensor/radar/echo.h"
#include "sensor/radar/interval_private.h"

/* 94 GHz, 0.3 m of range, 64 pulses. */
static const Waveform wave = {
    .centre_hz = 94e9, .bandwidth_hz = 500e6, .pulse_s = 20e-6, .repeat_hz = 20e3, .samples = 256, .pulses = 64};
enum { samples = 256, pulses = 64, cells = samples * pulses };

static double complex sample[interval_channels * cells], cell[interval_channels * cells];

typedef struct Point {
    double range_m, range_rate_mps; /* from the reference */
    double cos_right, cos_down, rcs_m2, phase_rad;
} Point;

static const Antenna dish = {.diameter_m = 0.2, .taper = 1, .wavelength_m = 299792458.0 / 94e9};
static const double  reference_m = 3000, power_w = 15, loss = 3;

static void add_points(Interval *interval, const Point *point, int count)
{
    EchoGrid *grid;
    CHECK(echo_grid_create(&grid, &wave) == STATUS_OK);
    for (int i = 0; i < count; i++) {
        const Point         *p = &point[i];
        const AntennaGain    g = antenna_gain(&dish, p->cos_right, p->cos_down);
        const RadarLink      link = {power_w, 1, 1, dish.wavelength_m, reference_m + p->range_m, loss};
        const double complex a = sqrt(radar_received_w(&link, p->rcs_m2)) * g.sum * cexp(I * p->phase_rad);
        echo_add(
            grid,
            &(Echo){2 * p->range_m, 2 * p->range_rate_mps / wave.repeat_hz, {a * g.sum, a * g.right, a * g.down, 0}}, 1,
            NULL);
    }
    echo_sum(interval->sample, grid);
    echo_grid_destroy(grid);
}

static IntervalPlan *plan;

static RangeDoppler process(const Interval *interval, const char *range_window, const char *doppler_window)
{
    Window       range, doppler;
    RangeDoppler map = {.cell = cell};
    CHECK(!window_parse(&range, range_window) && !window_parse(&doppler, doppler_window));
    interval_plan_destroy(plan);
    CHECK(interval_plan_create(&plan, &wave, &range, &doppler) == STATUS_OK);
    interval_process(&map, plan, interval, NULL);
    return map;
}

static double power_of(double complex v) { return creal(v) * creal(v) + cimag(v) * cimag(v); }

/* Skolnik's equation in decibels, by hand: 15 W, 3 (4.77 dB), 10 m2 at 3 km; antenna 0.75 (pi 0.2 / 0.0031893)^2 =
 * 44.64 dB; 64 pulses of 20 us; noise figure 8 dB. P G^2 l^2 s / ((4 pi)^3 R^4 L):
 *     11.76 + 89.28 - 49.93 + 10 - 32.98 - 139.08 - 4.77 = -115.72 dBW; energy of 64 pulses: -28.93 dBs: -144.65 dBJ
 *     k 290 K: -203.98, and 8 dB: -195.98; signal to noise: 51.33 dB. */
static void signal_to_noise_is_the_radar_equations(void **state)
{
    (void)state;
    const Receiver receiver = {.noise_figure = pow(10, 0.8)};
    Interval       interval = {.wave = wave, .sample = sample};
    ReceiverReport report;
    double         floor_w = 0;
    memset(sample, 0, sizeof sample);
    interval_receive(&report, &interval, &receiver, 5, 0, 0);
    RangeDoppler map = process(&interval, "rect", "rect");
    for (int i = 0; i < cells; i++) floor_w += power_of(map.cell[i]) / cells;
    /* 16384 cells of exponential power: their mean scatters by 0.8 % */
    CHECK_NEAR(floor_w / (report.noise_w * map.noise_share), 1, 0.024);
    CHECK_NEAR(map.noise_share * cells, 1, 1e-12);

    const Point point = {.rcs_m2 = 10};
    add_points(&interval, &point, 1);
    map = process(&interval, "rect", "rect");
    const double peak_w = power_of(map.cell[pulses / 2 * samples + samples / 2]);
    CHECK_NEAR(10 * log10(peak_w / floor_w), 51.33, 0.12);
    /* windows take their loss, and nothing of the peak */
    const RangeDoppler tapered = process(&interval, "taylor:5:40", "hann");
    CHECK_NEAR(power_of(tapered.cell[pulses / 2 * samples + samples / 2]) / peak_w, 1, 1e-5);
    /* N (sum of squares) / (sum)^2, of symmetric windows of 256 and 64: SciPy */
    CHECK_NEAR(tapered.noise_share / map.noise_share, 1.30051567933 * 64 * 23.625 / (31.5 * 31.5), 1e-6);
}

/* 0.43 dB/km: 1.3 dB each way, where a cross section of 30 m2 is right to 0.1 dB. */
static void points_are_measured(void **state)
{
    (void)state;
    static const double air_np_m = 1e-4;
    static const Point  point[] = {
         {3.14, 4.1, 0.002, -0.001, 10, 0.3},
         {-20.3, -7.77, -0.006, 0.004, 3, 2},
         {30.05, 0, 0, 0.007, 30, 4},
         {0.1, 11.2, 0.0035, 0.003, 1, 5},
    };
    const CfarConfig  cfar = {.pfa = 1e-8, .guard = {3, 3}, .training = {3, 8}, .wrap_rows = true};
    const double      unit_w = power_w / loss * dish.wavelength_m * dish.wavelength_m / pow(4 * pi_rad, 3);
    const DetectScale scale = {.range_m = reference_m, .range_rate_mps = -220, .unit_w = unit_w, .air_np_m = air_np_m};
    const Receiver    receiver = {.noise_figure = 6};
    Interval          interval = {.wave = wave, .sample = sample};
    ReceiverReport    report;
    Detection         got[16];
    Point             weaker[4]; /* by the air of the way there and of the way back */
    for (int i = 0; i < 4; i++) {
        weaker[i] = point[i];
        weaker[i].rcs_m2 *= exp(-2 * air_np_m * (reference_m + point[i].range_m));
    }
    add_points(&interval, weaker, 4);
    interval_receive(&report, &interval, &receiver, 5, 0, 0);
    const RangeDoppler map = process(&interval, "hann", "hann");
    CHECK(detect(got, 16, &map, plan, &cfar, &dish, &scale) == 4);
    int seen = 0;
    for (int k = 0; k < 4; k++)
        for (int i = 0; i < 4; i++) {
            if (fabs(got[k].range_m - reference_m - point[i].range_m) > 1) continue;
            seen |= 1 << i;
            /* noise moves them by some snr^-0.5 of a cell; the others' side lobes, 60 dB down and more, by less */
            const double some = 3 / sqrt(got[k].snr);
            /* a pulse of 20 us over 500 MHz at 94 GHz: 3.76 ms of range rate farther */
            CHECK_NEAR(got[k].range_m - reference_m, point[i].range_m + 3.76e-3 * point[i].range_rate_mps,
                       some * map.metre_per_column);
            CHECK_NEAR(got[k].range_rate_mps + 220, point[i].range_rate_mps, some * map.mps_per_row);
            /* three times Barton's width / (1.6 (2 snr)^0.5) of monopulse */
            const double angle = 3 * antenna_width_rad(&dish) / (1.6 * sqrt(2 * got[k].snr));
            CHECK_NEAR(got[k].cos_right, point[i].cos_right, angle);
            CHECK_NEAR(got[k].cos_down, point[i].cos_down, angle);
            CHECK_NEAR(10 * log10(got[k].rcs_m2 / point[i].rcs_m2), 0, 10 * log10(1 + 3 * some));
            CHECK(got[k].snr > 1000);
        }
    CHECK(seen == 15);
    CHECK(got[0].rcs_m2 > 20); /* strongest first */
}

/* Q that is stronger or turned: a point's mirror image at minus its range, -20 log10 |gain + j phase| + 6.02 dB
 * below it. */
static void iq_errors_make_an_image(void **state)
{
    (void)state;
    const Point    point = {.range_m = 16 * 0.299792458, .rcs_m2 = 1e6};
    const Receiver receiver = {.noise_figure = 1, .iq_gain = 0.02, .iq_phase_rad = 0.015};
    Interval       interval = {.wave = wave, .sample = sample};
    ReceiverReport report;
    add_points(&interval, &point, 1);
    interval_receive(&report, &interval, &receiver, 5, 0, 0);
    const RangeDoppler    map = process(&interval, "rect", "rect");
    const double complex *row = map.cell + pulses / 2 * samples + samples / 2;
    CHECK_NEAR(10 * log10(power_of(row[-16]) / power_of(row[16])), 20 * log10(hypot(0.02, 0.015) / 2), 0.2);
}

/* A converter's noise: one twelfth of a count squared each for I and Q, where some noise dithers it; phases that
 * scatter take exp(-sigma^2) of the peak. */
static void converter_and_oscillator_add_their_noise(void **state)
{
    (void)state;
    const Point           point = {.range_m = 12.3, .range_rate_mps = 2.2, .rcs_m2 = 1e4, .phase_rad = 1};
    Receiver              receiver = {.noise_figure = 1, .bits = 8, .noise_counts = 0.3};
    Interval              interval = {.wave = wave, .sample = sample};
    ReceiverReport        report;
    static double complex before[cells];
    add_points(&interval, &point, 1);
    memcpy(before, sample, sizeof before);
    interval_receive(&report, &interval, &receiver, 5, 0, 0);
    double error = 0;
    for (int i = 0; i < cells; i++) error += power_of(sample[i] - before[i]) / cells;
    const double counts = 1 / report.counts_per_sqrt_w;
    CHECK_NEAR((error - report.noise_w) / (counts * counts / 6), 1, 0.03);
    CHECK(report.saturated == 0);

    receiver = (Receiver){.noise_figure = 1, .phase_noise_rad = 0.3};
    add_points(&interval, &(Point){.rcs_m2 = 1e4}, 1);
    double mean = 0;
    for (uint32_t k = 0; k < 40; k++) {
        add_points(&interval, &(Point){.rcs_m2 = 1e4}, 1);
        const double amplitude = cabs(sample[0]);
        interval_receive(&report, &interval, &receiver, 5, 0, k);
        const RangeDoppler map = process(&interval, "rect", "rect");
        mean += power_of(map.cell[pulses / 2 * samples + samples / 2] / amplitude) / 40;
    }
    /* of N pulses: exp(-s^2) + (1 - exp(-s^2)) / N; 40 draws scatter by 0.3 % */
    const double kept = exp(-0.09);
    CHECK_NEAR(mean, kept + (1 - kept) / pulses, 0.01);
}

/* A map by hand: amplitude 1 everywhere and 6 in one cell, whose neighbours in range and in Doppler are alike, so that
 * the point is in the middle of the cell: power 36 over noise 1 is a signal of 35. Range: columns of c / (2 B) from the
 * middle one; range rate: rows of lambda f / (2 N) likewise; on both axes at both edges. The cross section is the
 * power times R^4 exp(2 a R) over the unit and G^4, here along the axis: the antenna's own gain, and 1 W of 1 m2 at
 * 1 m. */
static void a_map_by_hand_is_measured(void **state)
{
    (void)state;
    static double complex map_cell[interval_channels * cells];
    static const int      at[6][2] = {{32, 128}, {0, 40}, {63, 41}, {9, 0}, {10, 255}, {50, 200}};
    const CfarConfig      cfar = {.pfa = 1e-3, .guard = {2, 3}, .training = {3, 4}, .wrap_rows = true};
    const DetectScale     scale = {.range_m = 3000, .range_rate_mps = -220, .unit_w = 2, .air_np_m = 3e-4};
    const double          per_column_m = 299792458.0 / (2 * 500e6), per_row_mps = 299792458.0 / 94e9 * 20e3 / 2 / 64;
    const RangeDoppler    map = {pulses, samples, per_column_m, per_row_mps, 1, map_cell};
    Window                hann;
    Detection             got[8];
    CHECK(!window_parse(&hann, "hann"));
    interval_plan_destroy(plan);
    CHECK(interval_plan_create(&plan, &wave, &hann, &hann) == STATUS_OK);
    const double gain = antenna_gain(&dish, 0, 0).sum;
    for (int k = 0; k < 6; k++) {
        const int row = at[k][0], column = at[k][1];
        for (int i = 0; i < interval_channels * cells; i++) map_cell[i] = i < cells ? 1 : 0;
        map_cell[row * samples + column] = 6 * I;
        /* beside the peak in Doppler, round the map's edge: 3 on both sides */
        map_cell[(row + 63) % 64 * samples + column] = map_cell[(row + 1) % 64 * samples + column] = 3;
        CHECK(detect(got, 8, &map, plan, &cfar, &dish, &scale) == 1);
        CHECK(got->row == row && got->column == column);
        CHECK_NEAR(got->snr, 35, 1e-6); /* where a point lies is found to 2^-31 of a cell */
        CHECK_NEAR(got->range_m, 3000 + (column - 128) * per_column_m, 1e-6);
        CHECK_NEAR(got->range_rate_mps, -220 + (row - 32) * per_row_mps, 1e-6);
        CHECK_NEAR(got->cos_right, 0, 1e-9);
        CHECK_NEAR(got->cos_down, 0, 1e-9);
        const double want_m2 = 36 * pow(got->range_m, 4) * exp(2 * 3e-4 * got->range_m) / (2 * pow(gain, 4));
        CHECK_NEAR(got->rcs_m2 / want_m2, 1, 1e-6);
    }
}

/* The lobe of n equal weights is sin(pi x) / (n sin(pi x / n)) at x cells, 1 at 0, over range and over Doppler. */
static void lobes_of_equal_weights_are_dirichlets(void **state)
{
    (void)state;
    const Interval interval = {.wave = wave, .sample = sample};
    memset(sample, 0, sizeof sample);
    process(&interval, "rect", "rect");
    CHECK_NEAR(interval_lobe(plan, false, 0), 1, 1e-12);
    for (int doppler = 0; doppler < 2; doppler++)
        for (double x = 0.013; x < 1.5; x += 0.037) {
            const int    n = doppler ? pulses : samples;
            const double want = sin(pi_rad * x) / (n * sin(pi_rad * x / n));
            CHECK_NEAR(interval_lobe(plan, doppler, x), want, 2e-7);
            CHECK_NEAR(interval_lobe(plan, doppler, -x), want, 2e-7);
        }
}

/* Each row of a channel has draws of its own, so that the receiver's threads change no bit. */
static void threads_change_no_bit(void **state)
{
    (void)state;
    static double complex other[interval_channels * cells];
    const Receiver        receiver = {.noise_figure = 6,
                                      .phase_noise_rad = 0.02,
                                      .iq_gain = 0.01,
                                      .iq_phase_rad = 0.02,
                                      .bits = 8,
                                      .noise_counts = 40};
    const Point           point = {.range_m = 3, .range_rate_mps = -2, .cos_right = 0.01, .rcs_m2 = 0.1};
    Interval              interval[2] = {{.wave = wave, .sample = sample}, {.wave = wave, .sample = other}};
    ReceiverReport        report[2];
    CHECK(pool_create(&interval[1].pool, 3) == STATUS_OK);
    for (int k = 0; k < 2; k++) {
        add_points(&interval[k], &point, 1);
        interval_receive(&report[k], &interval[k], &receiver, 5, 7, 11);
    }
    CHECK(memcmp(sample, other, sizeof sample) == 0 && report[0].saturated == report[1].saturated);
    CHECK(report[0].counts_per_sqrt_w == report[1].counts_per_sqrt_w && report[0].counts_per_sqrt_w != 1);
    pool_destroy(interval[1].pool);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(threads_change_no_bit),
        cmocka_unit_test(signal_to_noise_is_the_radar_equations),
        cmocka_unit_test(lobes_of_equal_weights_are_dirichlets),
        cmocka_unit_test(points_are_measured),
        cmocka_unit_test(a_map_by_hand_is_measured),
        cmocka_unit_test(iq_errors_make_an_image),
        cmocka_unit_test(converter_and_oscillator_add_their_noise),
    };
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    interval_plan_destroy(plan);
    return failed;
}
