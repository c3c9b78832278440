/* Line timing, lines resampled at their own times, AC coupling and noise along lines: against kinematics, closed
 * forms and autocorrelations. */
#include "tests/check.h"

#include "sensor/detector/coupling.h"
#include "sensor/detector/scan.h"

enum { width = 256, height = 486 };
static float in[width * height], out[width * height], line[width + scan_taps];

static const double line_s = 63.5556e-6; /* of 525-line television */

/* A ripple down the columns, moved: its phase in each row says by how much. 10 degrees a second at 250 urad a pixel is
 * 698.132 px/s; over 486 lines 21.5639 px. */
static void a_panning_camera_leans(void **state)
{
    (void)state;
    const Scan   scan = {.line_s = line_s, .active = 0};
    const double rate_px_s[2] = {10 * rad_per_deg / 250e-6, 0};
    for (int i = 0; i < width * height; i++) in[i] = (float)(100 + 10 * cos(2 * pi_rad * (i % width) / 32));
    scan_resample(out, in, width, height, &scan, rate_px_s, line);
    double shift[height];
    for (int r = 0; r < height; r++) {
        double re = 0, im = 0; /* four whole ripples in the middle, clear of the mirrored edges */
        for (int c = 64; c < 192; c++) {
            re += out[r * width + c] * cos(2 * pi_rad * c / 32);
            im += out[r * width + c] * sin(2 * pi_rad * c / 32);
        }
        shift[r] = atan2(im, re) * 32 / (2 * pi_rad);
    }
    /* each place is right to half of 1/256 px; the lean over 485 lines, scaled to 486 */
    CHECK_NEAR((shift[height - 1] - shift[0]) * 486 / 485, 21.5639, 1.0 / 256);
    CHECK_NEAR(shift[height / 2] + shift[height / 2 - 1], 0, 1.0 / 256); /* the middle stands at the frame's time */
    for (int r = 1; r < height; r++) CHECK_NEAR(shift[r] - shift[r - 1], 21.5639 / 486, 1.0 / 256);
    CHECK_NEAR(scan_time_s(&scan, width, height, 0, 100) - scan_time_s(&scan, width, height, 0, 0), 100 * line_s,
               1e-12);
}

/* Down the rows: a scene that falls is stretched, one that climbs is squeezed: row r shows r - rate t(r). */
static void a_falling_scene_is_stretched(void **state)
{
    (void)state;
    const Scan scan = {.line_s = line_s, .active = 0.8};
    for (int sign = -1; sign <= 1; sign += 2) {
        const double rate_px_s[2] = {0, sign * 2000.0};
        for (int i = 0; i < width * height; i++) in[i] = (float)(1000 + 2 * (i / width));
        scan_resample(out, in, width, height, &scan, rate_px_s, line);
        for (int r = 40; r < height - 40; r++)
            /* 16 taps place a slope within 0.005 px, the phases within 1/512 */
            CHECK_NEAR(out[r * width + 17], 1000 + 2 * (r - rate_px_s[1] * line_s * (r + 0.5 - 0.5 * height)),
                       2 * (0.005 + 1.0 / 512));
    }
}

/* Amplitude of ripples at the worst shift, half a pixel: 0.6 % to 0.4 cycles a pixel. Standing still: the same bits. */
static void resampling_keeps_what_is_there(void **state)
{
    (void)state;
    const Scan   scan = {.line_s = 1, .active = 0};
    const double rate_px_s[2] = {1, 0}; /* row 242 is taken at -0.5 s: half a pixel */
    for (int k = 1; k <= 51; k++) {     /* to 0.398 */
        double re = 0, im = 0;
        for (int i = 0; i < width * height; i++) in[i] = (float)(100 + 10 * cos(2 * pi_rad * k * (i % width) / 128.0));
        scan_resample(out, in, width, height, &scan, rate_px_s, line);
        for (int c = 64; c < 192; c++) {
            re += out[242 * width + c] * cos(2 * pi_rad * k * c / 128.0) / 64;
            im += out[242 * width + c] * sin(2 * pi_rad * k * c / 128.0) / 64;
        }
        CHECK_NEAR(sqrt(re * re + im * im) / 10, 1, 0.006);
        CHECK_NEAR(cos(atan2(im, re) + 2 * pi_rad * k / 256.0), 1, 1e-6); /* and half a pixel it is */
    }
    const double still[2] = {0, 0};
    scan_resample(out, in, width, height, &scan, still, line);
    assert_memory_equal(in, out, sizeof in);
    for (int i = 0; i < width * height; i++) in[i] = 12.5f;
    scan_resample(out, in, width, height, &scan, rate_px_s, line);
    for (int i = 0; i < width * height; i++) CHECK_NEAR(out[i], 12.5, 1e-5);
}

/* Odd rows run right to left: later columns are earlier, and the path turns at the edge. */
static void alternate_lines_run_back(void **state)
{
    (void)state;
    const Scan scan = {.line_s = 1, .active = 0.8, .bidirectional = true};
    CHECK_NEAR(scan_time_s(&scan, 100, 2, 100, 0) - scan_time_s(&scan, 100, 2, 0, 0), 0.8, 1e-12);
    CHECK_NEAR(scan_time_s(&scan, 100, 2, 100, 1) - scan_time_s(&scan, 100, 2, 0, 1), -0.8, 1e-12);
    CHECK(scan_path(&scan, 100, 0, 99) == 99 && scan_path(&scan, 100, 1, 99) == 100
          && scan_path(&scan, 100, 2, 0) == 200);
}

/* A step in the first line: after n pixels exp(-2 pi f_c T) of it is left; f_c T = 0.01 gives 0.939101367 (nine
 * digits). */
static void a_step_droops(void **state)
{
    (void)state;
    const Scan scan = {.line_s = line_s};
    const int  n = 100;
    const double share = (height - 0.5) / height; /* the mean, with a step that lasts from half of line 0 to the end */
    for (int i = 0; i < width * height; i++) in[i] = i < width / 2 ? 0.0f : 1.0f;
    memcpy(out, in, sizeof in);
    coupling_apply(out, width, height, &scan, 0.01 / n);
    /* the capacitor starts on the mean and has come down on the dark side by exp(-2 pi f_c width / 2) */
    const double decay = exp(-2 * pi_rad * 0.01 / n * width / 2), base = share * decay;
    CHECK_NEAR(out[width / 2] - share, 1 - base, 2e-6);
    CHECK_NEAR((out[width / 2 + n] - share) / (out[width / 2] - share), 0.939101367, 2e-6); /* floats about 1 */
    double before = 0;
    for (int i = 0; i < width * height; i++) before += in[i];
    CHECK_NEAR(before / (width * height), share, 1e-9);

    /* a plane of one value stays; what comes back from the right shades to the left */
    for (int i = 0; i < width * height; i++) out[i] = 7;
    coupling_apply(out, width, height, &scan, 0.001);
    for (int i = 0; i < width * height; i++) CHECK(out[i] == 7);
    for (int back = 0; back < 2; back++) {
        const Scan both = {.line_s = line_s, .bidirectional = back};
        for (int i = 0; i < width * height; i++) out[i] = i % width >= 100 && i % width < 140 ? 50 : 10;
        coupling_apply(out, width, height, &both, 0.001);
        CHECK(out[2 * width + 141] < out[2 * width + 99] - 1);                    /* left to right: dark behind */
        CHECK((out[3 * width + 141] > out[3 * width + 99] + 1) == (bool)back);    /* and the other way */
    }
}

/* rho(k) = exp(-k / c) along the path, across the turn at the line's end too; none from line to line in a column
 * but what the path explains; ten frames, all different. Bounds: five deviations of a correlation of n correlated
 * samples, sqrt(c / n) each. */
static void line_noise_runs_along_the_scan(void **state)
{
    (void)state;
    const Scan   scan = {.line_s = line_s, .bidirectional = true};
    const double c = 12, n = (double)width * height, bound = 5 * sqrt(c / n);
    static float path[width * height], before[width * height];
    for (int index = 0; index < scan_pool; index++) {
        double sum2 = 0, apart = 0, across = 0, columns = 0;
        scan_line_noise(out, width, height, &scan, c, 5, 1, index);
        for (int r = 0; r < height; r++)
            for (int x = 0; x < width; x++) path[scan_path(&scan, width, r, x)] = out[r * width + x];
        for (int i = 0; i < width * height; i++) {
            sum2 += path[i] * path[i] / n;
            if (i >= 6) apart += path[i] * path[i - 6] / n;
            if (index > 0) across += out[i] * before[i] / n;
        }
        CHECK_NEAR(sum2, 1, bound);
        CHECK_NEAR(apart, exp(-6 / c), bound);
        CHECK_NEAR(across, 0, bound);
        for (int r = 1; r < height; r++)
            columns += out[r * width + width / 2] * out[(r - 1) * width + width / 2] / height;
        CHECK_NEAR(columns, 0, 5 / sqrt(height));
        /* the turn: last of an even row, and the one below it, are one step apart; their product averages rho(1) */
        double turn = 0;
        for (int r = 0; r + 1 < height; r += 2)
            turn += out[r * width + width - 1] * out[(r + 1) * width + width - 1] / (height / 2.0);
        CHECK_NEAR(turn, exp(-1 / c), 5 * sqrt(2.0 / (height / 2.0)));
        memcpy(before, out, sizeof out);
    }
}

int main(void)
{
    thread_flush_denormals();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_panning_camera_leans),
        cmocka_unit_test(a_falling_scene_is_stretched),
        cmocka_unit_test(resampling_keeps_what_is_there),
        cmocka_unit_test(alternate_lines_run_back),
        cmocka_unit_test(a_step_droops),
        cmocka_unit_test(line_noise_runs_along_the_scan),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
