/* What a scan along lines does to a plane: AC coupling by its response at the cut-off and its droop, noise along the
 * lines by its autocorrelation, and the time of each pixel; all by closed forms. Resampling: test_tdi.c. labels:
 * physics
 */
#include "tests/check.h"

#include "sensor/detector/line_scan_private.h"

#include <complex.h>

enum { width = 4000, height = 4, noisy_rows = 200 };
static float plane[width * noisy_rows];

/* Amplitude and phase of frequency f over columns first .. first + count - 1 of a row, a whole number of periods. */
static double complex wave_of(const float *row, double f, int first, int count)
{
    double complex sum = 0;
    for (int c = first; c < first + count; c++) sum += 2 * (double)row[c] * cexp(-2 * I * pi_rad * f * c) / count;
    return sum;
}

/* A first-order high pass at its cut-off passes 1 / sqrt(2) and leads by 45 degrees along the scan; far above it, all;
 * at a tenth of it, 0.1 / sqrt(1.01). Held for a pixel, H = (1 - 1/z) / (1 - a / z) with a = exp(-2 pi fc): to first
 * order in 2 pi fc = 0.0126 its gain is 1 + pi fc times the continuous one. A cut-off 10 % off changes the gain by 5 %,
 * and half and double by a quarter and more. */
static void the_cut_off_passes_half_the_power(void **state)
{
    (void)state;
    static const double fc = 0.002, f[3] = {0.002, 0.0005, 0.1};
    for (int both = 0; both < 2; both++)
        for (int k = 0; k < 3; k++) {
            const LineScan       scan = {.line_s = 1e-4, .active = 1, .bidirectional = both};
            const double         x = f[k] / fc;
            const double complex z = cexp(2 * I * pi_rad * f[k]), a = exp(-2 * pi_rad * fc);
            const double complex want = (1 - 1 / z) / (1 - a / z);
            CHECK_NEAR(cabs(want), x / sqrt(1 + x * x), 0.01); /* the continuous filter, so that f is f */
            for (int i = 0; i < width * height; i++)
                plane[i] = (float)(1000 + 10 * cos(2 * pi_rad * f[k] * (i % width)));
            line_scan_couple(plane, width, height, &scan, fc);
            for (int r = 0; r < height; r++) { /* 2000 pixels after the line's start exp(-25) of it is left */
                const bool           back = both && r % 2;
                const double complex got = wave_of(plane + r * width, f[k], back ? 0 : 2000, 2000) / 10;
                CHECK_NEAR(cabs(got), cabs(want), 1e-4); /* floats at 1000 step by 6e-5 */
                CHECK_NEAR(carg(got), back ? -carg(want) : carg(want), 1e-3);
            }
            if (k == 0) CHECK_NEAR(carg(want) / rad_per_deg, 45, 0.5);
        }
}

/* A step droops to 1 / e in 1 / (2 pi fc) pixels: 80 here; rows begin at the plane's mean, which is added again. Rows
 * that return droop to the left. */
static void a_step_droops_with_its_time_constant(void **state)
{
    (void)state;
    const LineScan scan = {.line_s = 1e-4, .active = 1, .bidirectional = true};
    for (int i = 0; i < width * height; i++) plane[i] = i / width < 2 ? 100 : 300;
    line_scan_couple(plane, width, height, &scan, 1 / (2 * pi_rad * 80));
    for (int r = 0; r < height; r++)
        for (int n = 0; n < 400; n += 80) {
            const int c = r % 2 ? width - 1 - n : n;
            CHECK_NEAR(plane[r * width + c], 200 + (r < 2 ? -100 : 100) * exp(-n / 80.0), 1e-3);
        }
    /* none: the plane itself */
    for (int i = 0; i < width * height; i++) plane[i] = (float)i;
    line_scan_couple(plane, width, height, &scan, 0);
    for (int i = 0; i < width * height; i++) CHECK(plane[i] == (float)i);
}

/* Mean product of pairs of pixels of the noise, row_step rows and column_step columns apart. */
static double product(int columns, int row_step, int column_step)
{
    double sum = 0, n = 0;
    for (int r = 0; r + row_step < noisy_rows; r++)
        for (int c = 0; c + column_step < columns; c++, n++)
            sum += (double)plane[r * columns + c] * (double)plane[(r + row_step) * columns + c + column_step];
    return sum / n;
}

/* exp(-k / length) along the rows, whatever the way, and nothing down the columns. 800000 values in runs of 2 x 10 are
 * 40000: 0.5 % each, and four of them. Half the length would give 0.14 for 0.37, a tenth more 0.40. */
static void noise_is_correlated_along_the_lines(void **state)
{
    (void)state;
    static const LineScan scans[3] = {{.line_s = 1e-4, .active = 1},
                                      {.line_s = 1e-4, .active = 1, .bidirectional = true},
                                      {.line_s = 1e-4, .by_columns = true}};
    for (int k = 0; k < 3; k++) {
        const LineNoise noise = {10, 5, 2, k};
        line_scan_noise(plane, width, noisy_rows, &scans[k], &noise);
        for (int lag = 0; lag <= 30; lag += 5) CHECK_NEAR(product(width, 0, lag), exp(-lag / 10.0), 0.02);
        for (int down = 1; down < 4; down++) CHECK_NEAR(product(width, down, 0), 0, 0.02);
        /* at the turn the path goes on where the scan returns: the last pixel of a row is beside the one below it; from
         * line to line beside the first of the next; rows of detectors know nothing of each other. 200 turns: 7 % */
        double below = 0, next = 0;
        for (int r = 0; r + 1 < noisy_rows; r++) {
            const int turn = k == 1 && r % 2 ? 0 : width - 1;
            below += (double)plane[r * width + turn] * (double)plane[(r + 1) * width + turn] / (noisy_rows - 1);
            next += (double)plane[r * width + width - 1] * (double)plane[(r + 1) * width] / (noisy_rows - 1);
        }
        CHECK_NEAR(below, k == 1 ? exp(-0.1) : 0, 0.3);
        CHECK_NEAR(next, k == 0 ? exp(-0.1) : 0, 0.3);
    }
    const LineNoise white = {0, 5, 2, 0};
    line_scan_noise(plane, width, noisy_rows, &scans[0], &white);
    for (int lag = 0; lag < 3; lag++) CHECK_NEAR(product(width, 0, lag), lag == 0, 0.006); /* 1 / sqrt(800000), x 5 */
}

/* The image's centre is the frame's time; lines follow in line_s, pixels of a line in its active share. 100 x 50, 1 ms,
 * 0.8: the first pixel at -24.5 - 0.8 x 0.495 lines, the last at as much after; on a line that returns the other end is
 * first. By columns the axes are exchanged. */
static void each_pixel_has_its_time(void **state)
{
    (void)state;
    const LineScan lines = {.line_s = 1e-3, .active = 0.8},
                   both = {.line_s = 1e-3, .active = 0.8, .bidirectional = true},
                   columns = {.line_s = 1e-3, .active = 0.8, .by_columns = true};
    CHECK_NEAR(line_scan_time_s(&lines, 100, 50, 0.5, 0), -24.896e-3, 1e-15);
    CHECK_NEAR(line_scan_time_s(&lines, 100, 50, 99.5, 0), -24.104e-3, 1e-15);
    CHECK_NEAR(line_scan_time_s(&lines, 100, 50, 0.5, 49), 24.104e-3, 1e-15);
    CHECK_NEAR(line_scan_time_s(&lines, 100, 50, 99.5, 49), 24.896e-3, 1e-15);
    CHECK_NEAR(line_scan_time_s(&both, 100, 50, 0.5, 0), -24.896e-3, 1e-15);
    CHECK_NEAR(line_scan_time_s(&both, 100, 50, 0.5, 49), 24.896e-3, 1e-15);
    CHECK_NEAR(line_scan_time_s(&both, 100, 50, 99.5, 49), 24.104e-3, 1e-15);
    /* columns: -49.5 - 0.8 x 0.49 columns for the first of all, +49.5 + 0.8 x 0.49 for the last */
    CHECK_NEAR(line_scan_time_s(&columns, 100, 50, 0.5, 0), -49.892e-3, 1e-15);
    CHECK_NEAR(line_scan_time_s(&columns, 100, 50, 0.5, 49), -49.108e-3, 1e-15);
    CHECK_NEAR(line_scan_time_s(&columns, 100, 50, 99.5, 49), 49.892e-3, 1e-15);
}

/* A picture that moves is read between its pixels in steps of 1/256: 3 + (p + 0.47) / 256 pixels are, to the bit, as 3
 * + p / 256, and 0.53 as the next step; the last line of two is half a line after the frame's time. */
static void shifts_are_of_the_nearest_step(void **state)
{
    (void)state;
    enum { wide = 64, high = 2 };
    static float   in[wide * high], line[wide + line_scan_taps], got[wide * high], want[wide * high];
    const LineScan scan = {.line_s = 1e-3};
    for (int i = 0; i < wide * high; i++) in[i] = (float)(10 + 5 * random_uniform(1, 2, 3, (uint64_t)i));
    for (int p = 0; p < 256; p++)
        for (int above = 0; above < 2; above++) {
            const double at = 3 + (p + (above ? 0.53 : 0.47)) / 256, step = 3 + (p + above) / 256.0;
            line_scan_resample(got, in, wide, high, &scan, (const double[2]){-at / 0.5e-3, 0}, line);
            line_scan_resample(want, in, wide, high, &scan, (const double[2]){-step / 0.5e-3, 0}, line);
            if (p + above < 256) assert_memory_equal(got + wide, want + wide, wide * sizeof *got);
        }
}

int main(void)
{
    thread_flush_denormals();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_cut_off_passes_half_the_power),   cmocka_unit_test(a_step_droops_with_its_time_constant),
        cmocka_unit_test(noise_is_correlated_along_the_lines), cmocka_unit_test(each_pixel_has_its_time),
        cmocka_unit_test(shifts_are_of_the_nearest_step),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
