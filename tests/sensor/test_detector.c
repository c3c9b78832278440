/* The first detector: noise by its statistics, levels by exact order statistics, display by its invariants.
 * labels: physics */
#include "tests/check.h"

#include "sensor/detector/array_noise.h"
#include "sensor/detector/display_values.h"

enum { pixels = 96 * 64, frames = 40 };

static float plane[pixels], noisy[pixels];

static int by_value(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return x < y ? -1 : x > y;
}

/* (n - 1) s^2 / sigma^2 is chi-square with n - 1 degrees of freedom; for n = 245760 that is normal with a
 * relative deviation of sqrt(2 / n) in variance. Five deviations: one false alarm in 1.7 million. */
static void noise_has_the_sigma_asked_for(void **state)
{
    (void)state;
    const double sigmas[] = {1e-3, 0.25, 40};
    for (int k = 0; k < 3; k++) {
        double       sum = 0, sum2 = 0, lag = 0, between = 0, last = 0;
        static float before[pixels];
        for (uint32_t frame = 0; frame < frames; frame++) {
            memset(plane, 0, sizeof plane);
            detector_noise(noisy, plane, 0, pixels, sigmas[k], &(NoiseDraw){7, 3, frame});
            for (int i = 0; i < pixels; i++) {
                const double x = noisy[i] / sigmas[k];
                sum += x;
                sum2 += x * x;
                lag += x * last;
                if (frame > 0) between += x * before[i] / sigmas[k];
                last = x;
            }
            memcpy(before, noisy, sizeof before);
        }
        const double n = (double)pixels * frames, deviation = sqrt(2 / n);
        CHECK_NEAR(sum / n, 0, 5 / sqrt(n));
        CHECK_NEAR((sum2 - sum * sum / n) / (n - 1), 1, 5 * deviation);
        CHECK_NEAR(lag / n, 0, 5 / sqrt(n));     /* neighbours know nothing of each other */
        CHECK_NEAR(between / n, 0, 5 / sqrt(n)); /* nor do frames */
    }
}

/* In pieces or whole, in place or not: the same bits. Another seed, stream or frame: other bits. */
static void noise_is_a_function_of_its_counters(void **state)
{
    (void)state;
    for (int i = 0; i < pixels; i++) plane[i] = (float)i * 0.01f;
    plane[5] = NAN;
    plane[6] = INFINITY;
    detector_noise(noisy, plane, 0, pixels, 0.5, &(NoiseDraw){1, 2, 3});
    assert_memory_equal(&noisy[5], &plane[5], 2 * sizeof(float));

    static float pieces[pixels];
    memcpy(pieces, plane, sizeof pieces);
    for (size_t first = 0; first < pixels; first += 777) {
        const size_t count = pixels - first < 777 ? pixels - first : 777;
        detector_noise(pieces + first, pieces + first, first, count, 0.5, &(NoiseDraw){1, 2, 3});
    }
    assert_memory_equal(pieces, noisy, sizeof noisy);

    const uint32_t others[3][3] = {{2, 2, 3}, {1, 3, 3}, {1, 2, 4}};
    for (int k = 0; k < 3; k++) {
        int same = 0;
        detector_noise(pieces, plane, 0, pixels, 0.5, &(NoiseDraw){others[k][0], others[k][1], others[k][2]});
        for (int i = 0; i < pixels; i++) same += pieces[i] == noisy[i];
        CHECK(same < pixels / 1000);
    }

    detector_noise(pieces, plane, 0, pixels, 0, &(NoiseDraw){1, 2, 3}); /* no noise: the plane itself */
    assert_memory_equal(pieces, plane, sizeof plane);
}

/* etc/reference/sensors.md: 8 bits, levels at 1 % and 99 % of the pixels with a margin of 5 %. */
static void defaults_are_documented(void **state)
{
    (void)state;
    const DetectorConfig c = detector_default_config();
    CHECK(c.bits == 8 && c.auto_level && c.percentile_low == 0.01 && c.percentile_high == 0.99 && c.margin == 0.05);
    CHECK(c.gain == 1 && c.level_low == 0 && c.level_high == 1 && c.fire_from == INFINITY);
}

/* Against a sort, with both signs, wide exponents, ties, and non-finite values strewn in. */
static void percentiles_are_exact_order_statistics(void **state)
{
    (void)state;
    static float   finite[pixels];
    DetectorConfig config = detector_default_config();
    config.margin = 0;
    for (uint32_t trial = 0; trial < 12; trial++) {
        int n = 0;
        for (int i = 0; i < pixels; i++) {
            const double u = random_uniform(1, trial, 0, (uint64_t)i), v = random_normal(1, trial, 1, (uint64_t)i);
            plane[i] = (float)(trial % 3 == 0 ? v * pow(10, 20 * u - 10) : trial % 3 == 1 ? floor(4 * v) : 300 + v);
            if (u < 0.01) plane[i] = u < 0.003 ? NAN : u < 0.006 ? INFINITY : -INFINITY;
            if (isfinite(plane[i])) finite[n++] = plane[i];
        }
        qsort(finite, (size_t)n, sizeof *finite, by_value);
        config.percentile_low = trial == 11 ? 0 : 0.02 * trial;
        config.percentile_high = trial == 11 ? 1 : 1 - 0.013 * trial;

        const float        *planes[1] = {plane};
        const DetectorLevel level = detector_level(&config, planes, 1, pixels);
        const double        low = finite[(int)(config.percentile_low * (n - 1) + 0.5)];
        const double        high = finite[(int)(config.percentile_high * (n - 1) + 0.5)];
        /* middle and span are sums of two: two roundings each */
        CHECK_NEAR(level.low, low, 4e-16 * (fabs(low) + fabs(high)));
        CHECK_NEAR(level.high, high, 4e-16 * (fabs(low) + fabs(high)));

        /* cut in three planes, the same */
        const float        *thirds[3] = {plane, plane + pixels / 3, plane + 2 * (pixels / 3)};
        const DetectorLevel together = detector_level(&config, thirds, 3, pixels / 3);
        CHECK(together.low == level.low && together.high == level.high);
    }
}

/* Kelvin as the plane's unit: ground of 290 K with a spread of 0.1, 1 or 4 K, a target 2 K above it on 0.5 % of the
 * pixels, fire of 900 K on 0 .. 5 %: the target keeps 10 grey levels and the ground half of the contrast that it has
 * without. */
static void a_fire_takes_no_grey_levels_from_the_rest(void **state)
{
    (void)state;
    static const double spread_k[3] = {0.1, 1, 4}, fire[4] = {0, 0.01, 0.03, 0.05};
    const float        *planes[1] = {plane};
    DetectorConfig      config = detector_default_config();
    config.highlight = 1.5;
    config.min_span = 2;
    for (int k = 0; k < 3; k++) {
        double without = 0;
        for (int f = 0; f < 4; f++) {
            for (int i = 0; i < pixels; i++) {
                const double u = random_uniform(7, 0, 0, (uint64_t)i), v = random_normal(7, 1, 0, (uint64_t)i);
                plane[i] = (float)(290 + spread_k[k] * v + (u > 0.995 ? 2 : 0));
                if (u < fire[f]) plane[i] = (float)(700 + 200 * random_uniform(7, 2, 0, (uint64_t)i));
            }
            const DetectorLevel level = detector_level(&config, planes, 1, pixels);
            const double        contrast = 1 / (level.high - level.low);
            if (f == 0) without = contrast;
            CHECK(255 * 2 * contrast >= 10 && contrast >= 0.5 * without);
            CHECK(level.low < 290 && level.high > 290 && level.high < 340);
        }
    }
}

/* A step of 20 K: settles to 5 % within 1 s in scenes of 5 and 9 K, that it leaves black or white, and within 6 s in
 * one of 40 K. A burst of 10000 K for 0.2 s: within 1 s the level is within 10 of 255 grey levels of where it belongs.
 * Alike at 5, 25 and 100 Hz. */
static void a_level_settles_in_a_second_at_any_rate(void **state)
{
    (void)state;
    static const double rate_hz[3] = {5, 25, 100}, span_k[3] = {5, 9, 40}, settled_s[3] = {1, 1, 6};
    for (int k = 0; k < 3; k++) {
        double low[3];
        for (int r = 0; r < 3; r++) {
            bool                quick = false;
            DetectorLevel       level = {280, 280 + span_k[k]};
            const DetectorLevel after = {300, 300 + span_k[k]};
            for (int i = 0; i < settled_s[k] * rate_hz[r]; i++)
                detector_level_follow(&level, &quick, after, 1 / rate_hz[r], 2);
            CHECK(fabs(level.low - after.low) <= 0.05 * 20 && fabs(level.high - after.high) <= 0.05 * 20);
            low[r] = level.low;

            const DetectorLevel burst = {280, 10280};
            level = (DetectorLevel){280, 280 + span_k[k]};
            for (int i = 0; i < 0.2 * rate_hz[r]; i++) detector_level_follow(&level, &quick, burst, 1 / rate_hz[r], 2);
            CHECK(level.high > 1000);
            for (int i = 0; i < rate_hz[r]; i++)
                detector_level_follow(&level, &quick, (DetectorLevel){280, 280 + span_k[k]}, 1 / rate_hz[r], 2);
            CHECK(fabs(level.high - 280 - span_k[k]) <= 10.0 / 255 * span_k[k]);
        }
        CHECK_NEAR(low[0], low[1], 1e-9);
        CHECK_NEAR(low[0], low[2], 1e-9);
    }
    /* what differs by less than two spans is averaged: a fiftieth of it a frame of 25 Hz */
    DetectorLevel level = {280, 300};
    bool          quick = false;
    detector_level_follow(&level, &quick, (DetectorLevel){280.5, 300.5}, 0.04, 2);
    CHECK_NEAR(level.low, 280.5 - 0.5 * exp(-0.02), 1e-12);
    detector_level_follow(&level, &quick, (DetectorLevel){10, 20}, 0.04, 0);
    CHECK(level.low == 10 && level.high == 20);
    /* Five spans off, with a time constant of 2 s: all beyond two spans is lost at once, the rest is left with a tenth
     * of the time constant until it is 0.03 spans, then with the whole. Within 0.1 s: 2 exp(-0.1 / 0.2) spans; within 2
     * s: ln(2 / 0.03) x 0.2 s = 0.83994 s of the quick way, and 0.03 exp(-1.16006 / 2) spans. */
    static const double step_s[3] = {0.1, 2, 0}, left[3] = {1.2130613194, 0.0167964, 5};
    for (int k = 0; k < 3; k++) {
        quick = false, level = (DetectorLevel){0, 10};
        detector_level_follow(&level, &quick, (DetectorLevel){50, 60}, step_s[k], 2);
        CHECK_NEAR((50 - level.low) / 10, left[k], 1e-6);
        CHECK_NEAR((60 - level.high) / 10, left[k], 1e-6);
    }
}

static void a_constant_plane_is_steady_mid_grey(void **state)
{
    (void)state;
    static uint8_t  code[pixels];
    static uint16_t code16[pixels];
    const float    *planes[1] = {plane};
    DetectorConfig  config = detector_default_config();
    const float     constants[] = {38.5f, 0, -7, 1e-20f, 1e20f};
    for (int k = 0; k < 5; k++) {
        for (int i = 0; i < pixels; i++) plane[i] = constants[k];
        plane[17] = nextafterf(plane[17], INFINITY); /* rounding must not become a picture */
        config.bits = 8;
        const DetectorLevel level = detector_level(&config, planes, 1, pixels);
        CHECK(level.high > level.low);
        detector_display(code, plane, pixels, &config, level);
        for (int i = 0; i < pixels; i++) CHECK(code[i] >= 127 && code[i] <= 131);
        config.bits = 16;
        detector_display(code16, plane, pixels, &config, level);
        CHECK(code16[0] == 32768);
    }
    for (int i = 0; i < pixels; i++) plane[i] = i % 2 ? NAN : INFINITY; /* nothing finite at all */
    const DetectorLevel none = detector_level(&config, planes, 1, pixels);
    CHECK(none.low == 0 && none.high == 1);
    detector_display(code16, plane, pixels, &config, none);
    CHECK(code16[0] == 65535 && code16[1] == 0);
}

/* min_span keeps noise from being stretched over the whole scale. */
static void min_span_bounds_the_gain(void **state)
{
    (void)state;
    DetectorConfig config = detector_default_config();
    config.min_span = 2;
    for (int i = 0; i < pixels; i++) plane[i] = 300 + 0.01f * (float)(i % 3);
    const float        *planes[1] = {plane};
    const DetectorLevel level = detector_level(&config, planes, 1, pixels);
    CHECK_NEAR(level.high - level.low, 2, 1e-12);
    CHECK_NEAR(level.high + level.low, 600.02, 1e-4);
}

/* Ends, middle, outside, NaN; gain about the middle; offset. Answers from paper. */
/* Light under the least span is darkness, not half of the scale; above it, as everything. */
static void a_night_is_dark(void **state)
{
    (void)state;
    static uint8_t code[pixels];
    const float   *planes[1] = {plane};
    DetectorConfig config = detector_default_config();
    config.min_span = 1e-3;
    for (int i = 0; i < pixels; i++) plane[i] = 1e-6f * (float)i / pixels;
    DetectorLevel level = detector_level(&config, planes, 1, pixels);
    CHECK(level.low == 0 && level.high == 1e-3);
    detector_display(code, plane, pixels, &config, level);
    for (int i = 0; i < pixels; i++) CHECK(code[i] <= 1);
    for (int i = 0; i < pixels; i++) plane[i] = (float)i / pixels;
    level = detector_level(&config, planes, 1, pixels);
    CHECK(level.low < 0 && level.high > 0.99);
}

static void quantisation_by_hand(void **state)
{
    (void)state;
    DetectorConfig      config = detector_default_config();
    const DetectorLevel level = {10, 20};
    const float         in[] = {10, 20, 15, 9, -1e30f, 21, 1e30f, NAN, INFINITY, -INFINITY, 12.5f};
    const uint8_t       want[] = {0, 255, 128, 0, 0, 255, 255, 0, 255, 0, 64};
    uint8_t             got[11];
    uint16_t            got16[11];
    detector_display(got, in, 11, &config, level);
    assert_memory_equal(got, want, sizeof want);
    config.bits = 16;
    detector_display(got16, in, 11, &config, level);
    CHECK(got16[0] == 0 && got16[1] == 65535 && got16[2] == 32768 && got16[10] == 16384 && got16[7] == 0);

    config.bits = 8;
    config.gain = 2; /* 12.5 .. 17.5 fills the scale */
    detector_display(got, in, 11, &config, level);
    CHECK(got[10] == 0 && got[2] == 128 && got[0] == 0 && got[1] == 255);
    config.gain = 1;
    config.offset = 0.25;
    detector_display(got, in, 11, &config, level);
    CHECK(got[0] == 64 && got[2] == 191 && got[1] == 255);
}

/* More radiance is never darker, at any depth, with any curve; and the curve is sRGB's. */
static void display_is_monotone(void **state)
{
    (void)state;
    static float    ramp[200000];
    static uint16_t code16[200000];
    static uint8_t  code[200000];
    for (int i = 0; i < 200000; i++) ramp[i] = (float)(-0.1 + 1.2 * i / 199999);
    for (int gamma = 0; gamma < 2; gamma++) {
        DetectorConfig config = detector_default_config();
        config.display_gamma = gamma;
        const DetectorLevel level = {0, 1};
        detector_display(code, ramp, 200000, &config, level);
        config.bits = 16;
        detector_display(code16, ramp, 200000, &config, level);
        for (int i = 1; i < 200000; i++) CHECK(code[i] >= code[i - 1] && code16[i] >= code16[i - 1]);
        CHECK(code[0] == 0 && code[199999] == 255 && code16[199999] == 65535);
    }
    /* IEC 61966-2-1: linear 0.214041 is code 0.5, 0.0031308 is 0.04045 */
    DetectorConfig config = detector_default_config();
    config.display_gamma = true;
    const float in[] = {0.2140411f, 0.0031308f, 1};
    detector_display(code, in, 3, &config, (DetectorLevel){0, 1});
    CHECK(code[0] >= 127 && code[0] <= 128 && code[1] == 10 && code[2] == 255);
}

/* One gain for all three: grey stays grey, and ratios stay. */
static void rgb_has_one_gain(void **state)
{
    (void)state;
    static float   r[pixels], g[pixels], b[pixels];
    static uint8_t rgb[3 * pixels], grey[pixels];
    for (int i = 0; i < pixels; i++) {
        r[i] = g[i] = b[i] = (float)i;
        if (i % 10 == 0) b[i] = 0.5f * (float)i;
    }
    const float        *in[3] = {r, g, b};
    DetectorConfig      config = detector_default_config();
    const DetectorLevel level = detector_level(&config, in, 3, pixels);
    detector_display_rgb(rgb, in, pixels, &config, level);
    detector_display(grey, g, pixels, &config, level);
    for (int i = 0; i < pixels; i++) {
        if (i % 10) {
            CHECK(rgb[3 * i] == grey[i] && rgb[3 * i + 1] == grey[i] && rgb[3 * i + 2] == grey[i]);
        } else {
            CHECK(rgb[3 * i] == rgb[3 * i + 1]);
            /* half stays half, to rounding, until the others are at full scale; 0 has no hue */
            if (i > 0 && rgb[3 * i] < 255) CHECK(abs(2 * rgb[3 * i + 2] - rgb[3 * i]) <= 2);
        }
    }
}

/* A field of grass whose shades differ by a tenth: the stretch brings out the shades and leaves it grass green. */
static void colours_of_a_flat_picture_stay(void **state)
{
    (void)state;
    static float    r[pixels], g[pixels], b[pixels];
    static uint16_t rgb[3 * pixels];
    for (int i = 0; i < pixels; i++) {
        const float shade = 1 + 0.1f * (float)i / pixels;
        r[i] = 0.7f * shade, g[i] = shade, b[i] = 0.6f * shade;
    }
    const float   *in[3] = {r, g, b};
    DetectorConfig config = detector_default_config();
    config.bits = 16;
    detector_display_rgb(rgb, in, pixels, &config, detector_level(&config, in, 3, pixels));
    int seen = 0;
    for (int i = 0; i < pixels; i++) {
        const uint16_t *code = rgb + 3 * i;
        if (code[1] < 1000 || code[1] == 65535) continue;
        seen++;
        CHECK_NEAR(code[0] / (0.7 * code[1]), 1, 0.002); /* two roundings of at least 600 */
        CHECK_NEAR(code[2] / (0.6 * code[1]), 1, 0.002);
    }
    CHECK(seen > pixels / 20);
}

/* 10 dB is a tenth: with 60 dB over 255 codes, 42.5 codes down. */
static void radar_decibels_by_hand(void **state)
{
    (void)state;
    const float   power[] = {1e-3f, 1e-4f, 1e-6f, 1e-9f, 9e-10f, 0, -1, NAN, INFINITY, 5e-4f};
    const uint8_t want[] = {255, 213, 128, 0, 0, 0, 0, 0, 255, 242};
    uint8_t       got[10];
    detector_display_db(got, power, 10, 60, 8);
    for (int i = 0; i < 10; i++)
        if (abs(got[i] - want[i]) > (i == 1 || i == 2)) fail_msg("pixel %d: %d, want %d", i, got[i], want[i]);

    /* the scale is relative: a thousand times the power, the same picture */
    float   more[10];
    uint8_t again[10];
    for (int i = 0; i < 10; i++) more[i] = power[i] * 1024;
    detector_display_db(again, more, 10, 60, 8);
    assert_memory_equal(again, got, sizeof got);

    const float dark[3] = {0, 0, NAN};
    detector_display_db(got, dark, 3, 60, 8);
    CHECK(got[0] == 0 && got[1] == 0 && got[2] == 0);
    uint16_t wide[10];
    detector_display_db(wide, power, 10, 60, 16);
    CHECK(wide[0] == 65535 && abs(wide[2] - 32768) <= 1);
}

static int  lines;
static void count_lines(void *user, LogLevel level, const char *line)
{
    (void)user;
    lines += level == LOG_ERROR && strstr(line, "detector: bad value") == line;
}

static void bad_configurations_are_named(void **state)
{
    (void)state;
    DetectorConfig bad[8];
    for (int i = 0; i < 8; i++) bad[i] = detector_default_config();
    bad[0].gain = 0;
    bad[1].gain = NAN;
    bad[2].noise_sigma = -1;
    bad[3].bits = 12;
    bad[4].percentile_high = 0;
    bad[5].auto_level = false, bad[5].level_high = bad[5].level_low;
    bad[6].margin = INFINITY;
    bad[7].percentile_low = -0.1;
    lines = 0;
    log_set_sink(count_lines, NULL);
    for (int i = 0; i < 8; i++) {
        assert_int_equal(detector_check_config(&bad[i]), STATUS_BAD_VALUE);
        assert_int_equal(lines, i + 1);
    }
    log_set_sink(NULL, NULL);
    const DetectorConfig good = detector_default_config();
    assert_int_equal(detector_check_config(&good), STATUS_OK);
    /* every field at both ends: taken there, refused a ten-thousandth beyond */
    static const struct {
        size_t at;
        double low, high;
    } field[] = {
        {offsetof(DetectorConfig, gain), 1e-6, 1e6},          {offsetof(DetectorConfig, offset), -10, 10},
        {offsetof(DetectorConfig, noise_sigma), 0, 1e30},     {offsetof(DetectorConfig, percentile_low), 0, 0.99},
        {offsetof(DetectorConfig, percentile_high), 0.01, 1}, {offsetof(DetectorConfig, margin), 0, 10},
        {offsetof(DetectorConfig, min_span), 0, 1e30},        {offsetof(DetectorConfig, plateau), 0, 1},
        {offsetof(DetectorConfig, level_low), -1e30, 1e30},
    };
    log_set_sink(count_lines, NULL);
    for (size_t i = 0; i < sizeof field / sizeof *field; i++)
        for (int end = 0; end < 2; end++)
            for (int beyond = 0; beyond < 2; beyond++) {
                DetectorConfig c = detector_default_config();
                const double limit = end ? field[i].high : field[i].low, step = limit == 0 ? 1e-9 : 1e-4 * fabs(limit);
                *(double *)((char *)&c + field[i].at) = limit + (beyond ? end ? step : -step : 0);
                CHECK((detector_check_config(&c) == STATUS_OK) == !beyond);
            }
    /* levels by hand: the upper one is above the lower, to 1e30 */
    static const double level[][3] = {{1, 1, 0},         {1, 1.001, 1}, {-1e30, 1e30, 1},
                                      {0, 1.0001e30, 0}, {2, 1, 0},     {0, NAN, 0}};
    for (size_t i = 0; i < sizeof level / sizeof *level; i++) {
        DetectorConfig c = detector_default_config();
        c.auto_level = false, c.level_low = level[i][0], c.level_high = level[i][1];
        CHECK((detector_check_config(&c) == STATUS_OK) == (level[i][2] == 1));
    }
    log_set_sink(NULL, NULL);
}

int main(void)
{
    thread_flush_denormals();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(noise_has_the_sigma_asked_for),
        cmocka_unit_test(noise_is_a_function_of_its_counters),
        cmocka_unit_test(defaults_are_documented),
        cmocka_unit_test(percentiles_are_exact_order_statistics),
        cmocka_unit_test(a_constant_plane_is_steady_mid_grey),
        cmocka_unit_test(min_span_bounds_the_gain),
        cmocka_unit_test(a_night_is_dark),
        cmocka_unit_test(quantisation_by_hand),
        cmocka_unit_test(display_is_monotone),
        cmocka_unit_test(rgb_has_one_gain),
        cmocka_unit_test(colours_of_a_flat_picture_stay),
        cmocka_unit_test(radar_decibels_by_hand),
        cmocka_unit_test(a_fire_takes_no_grey_levels_from_the_rest),
        cmocka_unit_test(a_level_settles_in_a_second_at_any_rate),
        cmocka_unit_test(bad_configurations_are_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
