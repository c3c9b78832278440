/* A sensor misses its aim as it is told: the walk's variance and correlation against closed forms, at any times it is
 * asked for; offsets drawn evenly; a camera turned so that what it aimed at is where it is to be. */
#include "sensor/node/session/aim_error.h"
#include "tests/check.h"

static const double sigma_rad = 0.01, tau_s = 8;

/* Of the values of one walk at times d apart, over many walks: variance sigma^2, covariance sigma^2 exp(-(d / tau)^2).
 * The standard error of a correlation of n pairs is below 1 / sqrt(n): five of them. */
static void walk_has_its_variance_and_correlation(void **state)
{
    (void)state;
    enum { walks = 40000 };
    static const double apart_s[] = {0, 2, 4, 8, 12, 24};
    const double        allowed = 5 / sqrt(walks);
    for (size_t k = 0; k < sizeof apart_s / sizeof *apart_s; k++) {
        double both = 0, one = 0, other = 0, mean = 0, cross = 0;
        for (int n = 0; n < walks; n++) {
            const double t_s = 1000.3 + 0.37 * (n % 100); /* nowhere near the grid of its numbers */
            const double a = aim_walk_rad(5, (uint64_t)n, 0, sigma_rad, tau_s, t_s) / sigma_rad;
            const double b = aim_walk_rad(5, (uint64_t)n, 0, sigma_rad, tau_s, t_s + apart_s[k]) / sigma_rad;
            cross += a * aim_walk_rad(5, (uint64_t)n, 1, sigma_rad, tau_s, t_s) / sigma_rad;
            both += a * b, one += a * a, other += b * b, mean += a;
        }
        const double d = apart_s[k] / tau_s;
        CHECK_NEAR(both / walks, exp(-d * d), sqrt(2) * allowed);
        CHECK_NEAR(one / walks, 1, sqrt(2) * allowed);
        CHECK_NEAR(other / walks, 1, sqrt(2) * allowed);
        CHECK_NEAR(mean / walks, 0, allowed);
        CHECK_NEAR(cross / walks, 0, allowed); /* the axes know nothing of each other */
    }
}

/* It is smooth: over a hundredth of its time constant it moves by its rate, whose variance is 2 (sigma / tau)^2, the
 * second derivative of its correlation. */
static void walk_is_smooth(void **state)
{
    (void)state;
    enum { walks = 20000 };
    const double h_s = 0.01 * tau_s;
    double       square = 0, worst = 0;
    for (int n = 0; n < walks; n++) {
        const double at = 3 * n / 7.0, a = aim_walk_rad(9, (uint64_t)n, 1, sigma_rad, tau_s, at),
                     b = aim_walk_rad(9, (uint64_t)n, 1, sigma_rad, tau_s, at + h_s);
        const double rate = (b - a) / h_s * tau_s / sigma_rad;
        square += rate * rate, worst = fmax(worst, fabs(rate));
    }
    CHECK_NEAR(square / walks, 2, 2 * 5 * sqrt(2.0 / walks));
    CHECK(worst < 8);
}

static void walk_is_of_its_time_alone(void **state)
{
    (void)state;
    double by_hundreds[301];
    for (int n = 0; n <= 300; n++) by_hundreds[n] = aim_walk_rad(3, 77, 0, sigma_rad, tau_s, 0.01 * n);
    for (int n = 300; n >= 0; n -= 100)
        assert_true(aim_walk_rad(3, 77, 0, sigma_rad, tau_s, 0.01 * n) == by_hundreds[n]);
    CHECK(aim_walk_rad(4, 77, 0, sigma_rad, tau_s, 1) != aim_walk_rad(3, 77, 0, sigma_rad, tau_s, 1));
    assert_true(aim_walk_rad(3, 77, 0, 0, tau_s, 1) == 0);
    static const double hostile[] = {NAN, INFINITY, -INFINITY, 1e300, -1e300, 1e18};
    for (size_t k = 0; k < sizeof hostile / sizeof *hostile; k++)
        CHECK(isfinite(aim_walk_rad(3, 77, 0, sigma_rad, tau_s, hostile[k])));
    CHECK(isfinite(aim_walk_rad(3, 77, 0, sigma_rad, 0.01, 1e9)));
}

/* Kolmogorov and Smirnov's largest distance from the even distribution over +- half: 1.95 / sqrt(n) at one in a
 * thousand. */
static void offsets_are_drawn_evenly(void **state)
{
    (void)state;
    enum { runs = 2000, bins = 100 };
    Config config = config_default();
    strcpy(config.sensor.aim_offset, "drawn 0.8,0.5");
    config.sensor.hfov_deg = 6, config.sensor.width_px = 720, config.sensor.height_px = 480;
    const double width = 2 * tan(3 * rad_per_deg), half[2] = {0.4 * width, 0.25 * width * 480 / 720};
    int          below[2][bins + 1] = {{0}}, middle = 0;
    for (int n = 0; n < runs; n++) {
        double tangent[2];
        config.seed = n / 4;
        aim_error_at(tangent, &config, (DisEntityId){1, 3001, (uint16_t)(10 * (n % 4))}, 12.5);
        for (int k = 0; k < 2; k++) {
            const double u = 0.5 + 0.5 * tangent[k] / half[k];
            CHECK(u >= 0 && u <= 1);
            for (int b = 0; b <= bins; b++) below[k][b] += u <= (double)b / bins;
        }
        middle += hypot(tangent[0], tangent[1]) * 720 / width < 1; /* within a pixel of the middle */
    }
    for (int k = 0; k < 2; k++)
        for (int b = 0; b <= bins; b++) CHECK_NEAR((double)below[k][b] / runs, (double)b / bins, 1.95 / sqrt(runs));
    CHECK(middle <= runs / 100);
}

/* A direction at the boresight is then seen at the tangents asked for; the picture keeps its axes to second order, and
 * its handedness. */
static void camera_turns_to_where_it_is_told(void **state)
{
    (void)state;
    for (int n = 0; n < 500; n++) {
        const double d[3] = {random_normal(1, 0, 0, 3 * (uint64_t)n), random_normal(1, 0, 0, 3 * (uint64_t)n + 1),
                             random_normal(1, 0, 0, 3 * (uint64_t)n + 2)};
        const double tangent[2] = {2 * random_uniform(2, 0, 0, (uint64_t)n) - 1,
                                   2 * random_uniform(2, 0, 1, (uint64_t)n) - 1};
        double       r[9], turned[9], seen[3], unit[3], square[9];
        v3_normalize(unit, d);
        view_upright(r, unit);
        memcpy(turned, r, sizeof r);
        aim_error_turn(turned, tangent);
        m3_tmul_v3(seen, turned, unit);
        CHECK(seen[2] > 0);
        for (int k = 0; k < 2; k++) CHECK_NEAR(seen[k] / seen[2], tangent[k], 1e-12);
        m3_tmul(square, turned, turned);
        for (int k = 0; k < 9; k++) CHECK_NEAR(square[k], k % 4 == 0, 1e-14);
        const double cross[3] = {turned[3] * turned[7] - turned[6] * turned[4],
                                 turned[6] * turned[1] - turned[0] * turned[7],
                                 turned[0] * turned[4] - turned[3] * turned[1]};
        CHECK_NEAR(cross[0] * turned[2] + cross[1] * turned[5] + cross[2] * turned[8], 1, 1e-14);
        double same[9];
        memcpy(same, r, sizeof r);
        aim_error_turn(same, (const double[2]){0, 0});
        assert_memory_equal(same, r, sizeof r);
    }
}

static void texts_of_an_offset(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        bool        good, drawn, degrees; /* good: taken */
        double      at[2];
    } all[] = {
        {"none", true, false, false, {0, 0}},          {"drawn", true, true, false, {0.4, 0.4}},
        {"drawn 1,0", true, true, false, {0.5, 0}},    {"drawn 0.5, 0.25", true, true, false, {0.25, 0.125}},
        {"0.5,-0.5", true, false, false, {0.5, -0.5}}, {"-0.1, 0", true, false, false, {-0.1, 0}},
        {"60,-60 deg", true, false, true, {60, -60}},  {"1.5,-0.25 deg", true, false, true, {1.5, -0.25}},
    };
    static const char *const bad[] = {"",        "0.1",         "0.51,0",       "0,0,0",      "nan,0",
                                      "inf,0",   "drawn 1.1,0", "drawn -0.1,0", "drawn0.1,0", "drawn ",
                                      " deg",    "60.1,0 deg",  "1,2 degrees",  "None",       "1e99999,0",
                                      "drawn 1", ",",           "drawn ,"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        AimOffset a = {.at = {7, 7}};
        if (aim_offset_parse(&a, bad[i]) || a.at[0] != 7) fail_msg("'%s'", bad[i]);
    }
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        AimOffset a = {.at = {7, 7}};
        if (aim_offset_parse(&a, all[i].text) != all[i].good) fail_msg("'%s'", all[i].text);
        CHECK(a.drawn == all[i].drawn && a.degrees == all[i].degrees);
        for (int k = 0; k < 2; k++) CHECK_NEAR(a.at[k], all[i].at[k], 1e-15);
    }
    Config config = config_default();
    strcpy(config.sensor.aim_offset, "2,-1 deg");
    double tangent[2];
    aim_error_at(tangent, &config, (DisEntityId){1, 2, 3}, 0);
    CHECK_NEAR(tangent[0], tan(2 * rad_per_deg), 1e-15);
    CHECK_NEAR(tangent[1], tan(-1 * rad_per_deg), 1e-15);
    strcpy(config.sensor.aim_offset, "0.6,0");
    log_set_sink(check_listen, NULL);
    CHECK(config_check(&config) == STATUS_BAD_VALUE && strstr(check_said, "sensor.aim_offset: '0.6,0' is not none"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(walk_has_its_variance_and_correlation),
        cmocka_unit_test(walk_is_smooth),
        cmocka_unit_test(walk_is_of_its_time_alone),
        cmocka_unit_test(offsets_are_drawn_evenly),
        cmocka_unit_test(camera_turns_to_where_it_is_told),
        cmocka_unit_test(texts_of_an_offset),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
