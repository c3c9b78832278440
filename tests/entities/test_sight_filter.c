/* The filter of lines of sight: exact on a steady turn, its noise that of the closed form, and what it refuses.
 * labels: physics */
#include "tests/entities/flight_fixture.h"

#include "entities/flight/sight_filter.h"

static void direction(double out[3], double angle_rad, double aside, double above)
{
    const double u[3] = {cos(angle_rad) - aside * sin(angle_rad), sin(angle_rad) + aside * cos(angle_rad), above};
    CHECK(v3_normalize(out, u));
}

/* From the second measurement on it knows a steady turn, whatever its memory. */
static void a_steady_turn_is_known_at_once(void **state)
{
    (void)state;
    for (double memory = 0; memory < 1; memory += 0.3) {
        SightFilter f = sight_filter(memory);
        for (int i = 0; i < 300; i++) {
            double u[3], off[3];
            direction(u, 1 + 0.003 * i, 0, 0);
            CHECK(sight_filter_take(&f, 5 + 0.01 * i, u));
            v3_sub(off, f.los_ecef, u);
            CHECK_NEAR(v3_length(off), 0, 1e-13);
            if (i > 0) CHECK_NEAR(v3_length(f.rate_ecef_rps), 0.3, 1e-11);
            CHECK_NEAR(v3_dot(f.los_ecef, f.rate_ecef_rps), 0, 1e-12);
        }
    }
}

/* Variances over 40 000 measurements in the steady state, both axes; T need not be even. */
static void noise_is_that_of_the_closed_form(void **state)
{
    (void)state;
    const double s = 1e-4, step_s = 0.02;
    for (int k = 0; k < 3; k++) {
        const double m = (double[]){0.5, 0.8, 0.95}[k];
        SightFilter  f = sight_filter(m);
        double       los2 = 0, rate2 = 0;
        const int    first = 400, last = 40400;
        for (int i = 0; i < last; i++) {
            double noisy[3], u[3], v[3] = {0}, off[3];
            direction(noisy, 0.002 * i, s * random_normal(7, (uint32_t)k, 0, (uint64_t)i),
                      s * random_normal(7, (uint32_t)k, 1, (uint64_t)i));
            CHECK(sight_filter_take(&f, step_s * i, noisy));
            if (i < first) continue;
            direction(u, 0.002 * i, 0, 0);
            v3_sub(off, f.los_ecef, u);
            los2 += v3_dot(off, off);
            v[0] = -0.1 * sin(0.002 * i), v[1] = 0.1 * cos(0.002 * i);
            v3_sub(off, f.rate_ecef_rps, v);
            rate2 += v3_dot(off, off);
        }
        const double third = (1 + m) * (1 + m) * (1 + m), one = 2.0 * (last - first);
        CHECK_NEAR(sqrt(los2 / one) / (s * sqrt((1 - m) * (1 + 4 * m + 5 * m * m) / third)), 1, 0.03);
        CHECK_NEAR(sqrt(rate2 / one) / (s / step_s * sqrt(2 * (1 - m) * (1 - m) * (1 - m) / third)), 1, 0.03);
    }
}

static void what_is_no_measurement_is_refused(void **state)
{
    (void)state;
    SightFilter  f = sight_filter(0.8), before;
    const double x[3] = {1, 0, 0}, back[3] = {-1, 0, 0}, wide[3] = {1.1, 0, 0}, none[3] = {NAN, 0, 0};
    CHECK(!sight_filter_take(&f, 0, wide) && !sight_filter_take(&f, 0, none) && !sight_filter_take(&f, NAN, x));
    CHECK(sight_filter_take(&f, 1, x));
    FlightSight  sight;
    const double p[3] = {6.4e6, 0, 0}, v[3] = {0, 300, 0};
    sight_filter_sight(&sight, &f, p, v);
    CHECK(isnan(sight.los_rate_ecef_rps[0]) && isnan(sight.range_m) && sight.t_s == 1);
    before = f;
    CHECK(!sight_filter_take(&f, 1, x) && !sight_filter_take(&f, 0.5, x) && !sight_filter_take(&f, 2, back));
    CHECK(memcmp(&before, &f, sizeof f) == 0);
}

/* Angles alone, 60 a second and 30 ms late, through the filter: a laser-homing and an infrared missile still come
 * close. */
static void angles_alone_guide(void **state)
{
    (void)state;
    const LocalFrame         frame = place_at(47, 13, 1500);
    const FlightWorld        world = flight_world();
    static const char *const name[] = {"at_loft", "ir_ag", "laser_ag"};
    static const double      target[3][3] = {{0, 2000, 0}, {0, 10000, -3000}, {0, 5000, -100}}, up_deg[3] = {18, 0, 8};
    const double             v[3] = {10, 0, 0}, a[3] = {0};
    for (int row = 0; row < 3; row++) {
        Missile          m;
        EngagementResult r;
        row_of_etc(&m, name[row]);
        Engagement e = engagement_of(&frame, &m, 0, up_deg[row], target[row], v, a);
        e.sight_every_s = 1 / 60.0;
        e.sight_late_s = 0.03;
        e.filter_memory = 0.7;
        engagement_fly(&r, &e, &m, &world);
        print_message("%s: %.3g m\n", name[row], r.miss.least_m);
        CHECK(r.miss.least_m < 1);
        e.noise_rad = 1e-3, e.noise_seed = 5;
        engagement_fly(&r, &e, &m, &world);
        const double once_m = r.miss.least_m;
        print_message("%s: %.3g m with 1 mrad of noise\n", name[row], once_m);
        CHECK(once_m < 10);
        engagement_fly(&r, &e, &m, &world);
        CHECK(r.miss.least_m == once_m);
        e.noise_seed = 6;
        engagement_fly(&r, &e, &m, &world);
        CHECK(r.miss.least_m != once_m);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_steady_turn_is_known_at_once),
        cmocka_unit_test(noise_is_that_of_the_closed_form),
        cmocka_unit_test(what_is_no_measurement_is_refused),
        cmocka_unit_test(angles_alone_guide),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
