/* tests/sensor/test_plateau.c: plateau equalisation and levels with fires: against closed forms of uniform and normal
 * populations, interpolation by search, and the time constant.
 * labels: physics */
#include "sensor/detector/level.h"
#include "tests/check.h"

enum { pixels = 120000 };

static float plane[pixels];

static DetectorConfig kelvin(double plateau)
{
    DetectorConfig c = detector_default_config();
    c.min_span = 2;
    c.plateau = plateau;
    c.highlight = 1.5;
    c.fire_from = 350;
    return c;
}

/* Grey level of a value by search, with linear interpolation. */
static double level_of(const DetectorCurve *c, double x)
{
    if (!(x >= c->value[0])) return 0;
    for (int k = 0; k < curve_steps; k++)
        if (x < c->value[k + 1]) return (k + (x - c->value[k]) / (c->value[k + 1] - c->value[k])) / curve_steps;
    return 1;
}

/* Uniform from 280 to 312 K: equalised or not, the curve is the straight line between the two, within a bin. */
static void a_uniform_plane_has_a_straight_curve(void **state)
{
    (void)state;
    static const double plateau[3] = {1, 0.002, 1e-5};
    for (int t = 0; t < 3; t++) {
        const DetectorConfig config = kelvin(plateau[t]);
        DetectorCurve        curve;
        for (int i = 0; i < pixels; i++) plane[i] = (float)(280 + 32.0 * (i + 0.5) / pixels);
        detector_plateau(&curve, &config, plane, pixels);
        for (int k = 0; k <= curve_steps; k++) CHECK_NEAR(curve.value[k], 280 + 32.0 * k / curve_steps, 2.0 / 64);
    }
}

/* Ground on 90 % of the pixels uniform over 16 K, 512 bins; a plume on 10 % uniform over 160 K, 5120 bins. Equalised
 * (plateau 1) each has its share of pixels of the grey levels. With a plateau of 0.0005 a bin of ground, 0.00176 of the
 * pixels, counts for that, 512 * 0.0005 = 0.256 in all, and one of the plume, 0.0000195, for itself: 0.1. With a
 * plateau of one pixel each bin counts the same: 512 of 5632. */
static void the_plateau_bounds_what_a_bin_counts(void **state)
{
    (void)state;
    static const double plateau[3] = {1, 0.0005, 1e-6}, ground[3] = {0.9, 0.256 / 0.356, 512.0 / 5632};
    for (int t = 0; t < 3; t++) {
        const DetectorConfig config = kelvin(plateau[t]);
        DetectorCurve        curve;
        for (int i = 0; i < pixels; i++)
            plane[i] = i % 10 ? (float)(280 + 16.0 * (i + 0.5) / pixels) : (float)(296 + 160.0 * (i + 0.5) / pixels);
        detector_plateau(&curve, &config, plane, pixels);
        CHECK_NEAR(level_of(&curve, 280), 0, 0.004);
        CHECK_NEAR(level_of(&curve, 296), ground[t], 0.006); /* 2 bins of ground, and a knot's 1/256 */
        CHECK_NEAR(level_of(&curve, 456), 1, 0.004);
    }
}

/* Never less than min_span over the whole scale; about the middle; a constant is mid grey. Counts come one by one. */
static void the_slope_is_bounded(void **state)
{
    (void)state;
    DetectorConfig config = kelvin(0.002);
    DetectorCurve  curve;
    for (int i = 0; i < pixels; i++) plane[i] = 300 + 0.001f * (float)(i % 100);
    detector_plateau(&curve, &config, plane, pixels);
    CHECK_NEAR(curve.value[curve_steps] - curve.value[0], 2, 0.1);
    CHECK_NEAR(level_of(&curve, 300.05), 0.5, 0.02);
    for (int i = 0; i < pixels; i++) plane[i] = 300;
    plane[1] = NAN, plane[2] = INFINITY, plane[3] = -INFINITY;
    detector_plateau(&curve, &config, plane, pixels);
    CHECK_NEAR(level_of(&curve, 300), 0.5, 0.01);

    config.step = 1, config.min_span = 8; /* counts: eight of them, an eighth of the scale each at most */
    for (int i = 0; i < pixels; i++) plane[i] = (float)(5000 + i % 4);
    detector_plateau(&curve, &config, plane, pixels);
    for (int n = 0; n < 3; n++) CHECK_NEAR(level_of(&curve, 5001 + n) - level_of(&curve, 5000 + n), 1.0 / 8, 1e-6);
    for (int i = 0; i < pixels; i++) plane[i] = NAN;
    detector_plateau(&curve, &config, plane, pixels);
    CHECK(curve.value[0] == 0 && curve.value[curve_steps] == 1);
}

/* Grey levels per K of a display, of 255: over the middle two sigma of the ground. */
static double contrast(const DetectorConfig *config, double sigma_k)
{
    if (config->plateau > 0) {
        DetectorCurve curve;
        detector_plateau(&curve, config, plane, pixels);
        return 255 * (level_of(&curve, 290 + sigma_k) - level_of(&curve, 290 - sigma_k)) / (2 * sigma_k);
    }
    const float        *planes[1] = {plane};
    const DetectorLevel level = detector_level(config, planes, 1, pixels);
    CHECK(level.low < 290 - sigma_k && level.high > 290 + sigma_k);
    return 255 / (level.high - level.low);
}

/* Ground of 290 K with normal noise, fire of 700 to 900 K: the ground keeps half of its contrast with fire on up to 48
 * % of the pixels (linear), on up to a fifth (plateau). What the linear level was before, without a limit of fires,
 * does not. */
static void fire_on_much_of_the_picture(void **state)
{
    (void)state;
    static const double sigma_k[3] = {0.1, 1, 4}, fire[6] = {0, 0.05, 0.12, 0.2, 0.3, 0.48};
    for (int s = 0; s < 3; s++) {
        double without[2] = {0};
        for (int f = 0; f < 6; f++) {
            for (int i = 0; i < pixels; i++) {
                plane[i] = (float)(290 + sigma_k[s] * random_normal(7, 1, 0, (uint64_t)i));
                if (random_uniform(7, 0, 0, (uint64_t)i) < fire[f])
                    plane[i] = (float)(700 + 200 * random_uniform(7, 2, 0, (uint64_t)i));
            }
            for (int plateau = 0; plateau < 2; plateau++) {
                DetectorConfig config = kelvin(plateau ? 0.002 : 0);
                const double   kept = contrast(&config, sigma_k[s]);
                if (f == 0) without[plateau] = kept;
                if (plateau && fire[f] > 0.2) continue;
                if (!(kept >= 0.5 * without[plateau]))
                    fail_msg("%g K, fire on %g: %g of %g", sigma_k[s], fire[f], kept, without[plateau]);
                config.fire_from = INFINITY;
                if (!plateau && fire[f] > 0.1) CHECK(contrast(&config, sigma_k[s]) < 0.1 * without[0]);
            }
        }
        /* fire everywhere is displayed as anything else */
        for (int i = 0; i < pixels; i++) plane[i] = (float)(700 + 200 * random_uniform(7, 2, 0, (uint64_t)i));
        const float         *planes[1] = {plane};
        const DetectorConfig config = kelvin(0);
        const DetectorLevel  level = detector_level(&config, planes, 1, pixels);
        CHECK(level.low > 680 && level.low < 705 && level.high > 895);
    }
}

/* A step of 20 K in a scene of 5 K settles to 5 % within 1 s, of 40 K to exp(-3) of it in 3 time constants; at any
 * rate. */
static void a_curve_settles_in_a_second(void **state)
{
    (void)state;
    static const double rate_hz[3] = {5, 25, 100}, span_k[2] = {5, 40}, time_s[2] = {1, 6};
    for (int s = 0; s < 2; s++) {
        double middle[3];
        for (int r = 0; r < 3; r++) {
            DetectorCurve curve, after;
            bool          quick = false;
            for (int k = 0; k <= curve_steps; k++) {
                curve.value[k] = 280 + span_k[s] * k / curve_steps;
                after.value[k] = curve.value[k] + 20;
            }
            for (int i = 0; i < time_s[s] * rate_hz[r]; i++)
                detector_plateau_follow(&curve, &quick, &after, 1 / rate_hz[r], 2);
            for (int k = 0; k <= curve_steps; k++) CHECK(fabs(curve.value[k] - after.value[k]) <= 0.05 * 20);
            middle[r] = curve.value[curve_steps / 2];
        }
        CHECK_NEAR(middle[0], middle[1], 1e-9);
        CHECK_NEAR(middle[0], middle[2], 1e-9);
    }
}

/* Against the search; gain about the middle and offset; NaN and infinities; 8 and 16 bits; never darker for more. */
static void grey_levels_are_those_of_the_curve(void **state)
{
    (void)state;
    static uint8_t  code[pixels];
    static uint16_t code16[pixels];
    DetectorConfig  config = kelvin(0.0005);
    DetectorCurve   curve;
    for (int i = 0; i < pixels; i++) plane[i] = (float)(290 + 4 * random_normal(7, 1, 0, (uint64_t)i));
    detector_plateau(&curve, &config, plane, pixels);
    for (int i = 0; i < pixels; i++) plane[i] = (float)(260 + 60.0 * i / pixels);
    plane[pixels - 3] = NAN, plane[pixels - 2] = -INFINITY, plane[pixels - 1] = INFINITY;
    for (int t = 0; t < 2; t++) {
        config.gain = t ? 2 : 1, config.offset = t ? 0.25 : 0;
        config.bits = 16;
        detector_display_curve(code16, plane, pixels, &config, &curve);
        config.bits = 8;
        detector_display_curve(code, plane, pixels, &config, &curve);
        for (int i = 0; i < pixels - 3; i++) {
            const double want = clamp((level_of(&curve, plane[i]) - 0.5) * config.gain + 0.5 + config.offset, 0, 1);
            CHECK_NEAR(code16[i], want * 65535, 0.51);
            CHECK_NEAR(code[i], want * 255, 0.51);
            CHECK(i == 0 || code16[i] >= code16[i - 1]);
        }
        CHECK(code16[pixels - 3] == 0 && code[pixels - 3] == 0);
        CHECK(code16[pixels - 2] == code16[0] && code16[pixels - 1] == 65535);
    }
}

/* The value at a share is that of the nearest rank: of ten values 0 .. 9 share s is the one at 9 s, rounded. */
static void shares_are_of_the_nearest_rank(void **state)
{
    (void)state;
    static const float ten[10] = {3, 9, 0, 7, 5, 1, 8, 2, 6, 4};
    const float *const planes[1] = {ten};
    DetectorConfig     config = detector_default_config();
    config.margin = 0;
    for (int k = 0; k < 8; k++)
        for (int above = 0; above < 2; above++) {
            config.percentile_low = (k + (above ? 0.53 : 0.47)) / 9;
            config.percentile_high = 1;
            CHECK_NEAR(detector_level(&config, planes, 1, 10).low, k + above, 1e-12);
        }
}

/* Of the values 0 .. 100 the body is from 10 to 90, at 10 and 90 % of them; white is 0.05 of it above, at 94. Fires
 * from 60.5 on are no part of it: 6 to 54 of 0 .. 60, white at 56.4; from 50.5 on they are one fewer than half, 5 to 45
 * of 0 .. 50, white at 47; from 49.5 on they are more than half, and part of it. */
static void white_is_above_the_body(void **state)
{
    (void)state;
    static const double fire_from[4] = {INFINITY, 60.5, 50.5, 49.5}, white[4] = {94, 56.4, 47, 94};
    float               values[101];
    const float *const  planes[1] = {values};
    DetectorConfig      config = detector_default_config();
    for (int i = 0; i <= 100; i++) values[i] = (float)(i * 37 % 101);
    config.margin = config.percentile_low = 0, config.percentile_high = 1, config.highlight = 0.05;
    for (int k = 0; k < 4; k++) {
        config.fire_from = fire_from[k];
        const DetectorLevel level = detector_level(&config, planes, 1, 101);
        CHECK_NEAR(level.low, 0, 1e-12);
        CHECK_NEAR(level.high, white[k], 1e-12);
    }
}

/* A span of rounding alone is shown over 1e-5 of the level, 0.003 of 300, about its middle: by levels and by the curve,
 * whose slope is at most full scale over that. */
static void a_constant_has_the_span_of_its_rounding(void **state)
{
    (void)state;
    const float         same[4] = {300, 300, 300, 300};
    const float *const  planes[1] = {same};
    DetectorConfig      config = detector_default_config();
    DetectorCurve       curve;
    const DetectorLevel level = detector_level(&config, planes, 1, 4);
    CHECK_NEAR(level.high - level.low, 0.003, 1e-9);
    CHECK_NEAR(level.high + level.low, 600, 1e-9);
    const float         nothing[4] = {0, 0, 0, 0};
    const float *const  dark[1] = {nothing};
    const DetectorLevel least = detector_level(&config, dark, 1, 4);
    CHECK_NEAR(least.high - least.low, 1e-30, 1e-36); /* of nothing: still a span to divide by */
    config.plateau = 1;
    detector_plateau(&curve, &config, same, 4);
    for (int k = 0; k <= curve_steps; k++)
        CHECK_NEAR(curve.value[k], 300 + 0.003 * ((double)k / curve_steps - 0.5), 1e-9);
}

/* Counts 0 .. 9, one of each: a bin of one count lies about each, and the curve is straight from -0.5 to 9.5. Nine of
 * ten pixels at 4 and a plateau of half of them: the bin of 4 counts 5 and that of 9 counts 1; the grey levels from 0
 * to 5/6 are those of 4, from there on of 9. */
static void counts_have_bins_about_them(void **state)
{
    (void)state;
    float          values[10];
    DetectorConfig config = detector_default_config();
    DetectorCurve  curve;
    config.step = 1, config.plateau = 0.5;
    for (int i = 0; i < 10; i++) values[i] = (float)(i * 7 % 10);
    detector_plateau(&curve, &config, values, 10);
    for (int k = 0; k <= curve_steps; k++) CHECK_NEAR(curve.value[k], -0.5 + 10.0 * k / curve_steps, 1e-9);
    for (int i = 0; i < 10; i++) values[i] = i == 3 ? 9 : 4;
    detector_plateau(&curve, &config, values, 10);
    for (int k = 0; k <= curve_steps; k++) {
        const double grey = (double)k / curve_steps, share = grey * 6 / 5;
        CHECK_NEAR(curve.value[k], share <= 1 ? 3.5 + share : 8.5 + 6 * grey - 5, 1e-9);
    }
}

int main(void)
{
    thread_flush_denormals();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_uniform_plane_has_a_straight_curve),
        cmocka_unit_test(the_plateau_bounds_what_a_bin_counts),
        cmocka_unit_test(the_slope_is_bounded),
        cmocka_unit_test(fire_on_much_of_the_picture),
        cmocka_unit_test(a_curve_settles_in_a_second),
        cmocka_unit_test(grey_levels_are_those_of_the_curve),
        cmocka_unit_test(shares_are_of_the_nearest_rank),
        cmocka_unit_test(white_is_above_the_body),
        cmocka_unit_test(a_constant_has_the_span_of_its_rounding),
        cmocka_unit_test(counts_have_bins_about_them),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
