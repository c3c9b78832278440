/* Miss distance of proportional navigation with one lag against its closed form, by the adjoint of the linear loop.
 *
 * Of navigation constant N' and lag T, a time of flight t = x T leaves (Zarchan, Tactical and Strategic Missile
 * Guidance, single-lag guidance system; inverse Laplace transforms of s^(N'-2) / (s + 1/T)^N' for a heading error and
 * of s^(N'-3) / (s + 1/T)^N' for a manoeuvre of the target):
 *
 *   heading error e of a missile of speed V: -V e t exp(-x) times 1 - x/2, 1 - x + x^2/6, 1 - 3x/2 + x^2/2 - x^3/24
 *   target acceleration n:                  n t^2 exp(-x) times 1/2, 1/2 - x/6, 1/2 - x/3 + x^2/24     N' = 3, 4, 5
 *
 * The program's own sight, guidance and integration fly it: head on, with angles of 1e-5 rad, so that the loop is
 * linear. labels: physics */
#include "tests/entities/flight_fixture.h"

static const double lag_s = 0.5, missile_mps = 1000, target_mps = 500;

static double heading_law(int n, double x)
{
    const double e = exp(-x);
    return n == 3 ? e * (1 - x / 2) : n == 4 ? e * (1 - x + x * x / 6) : e * (1 - 1.5 * x + x * x / 2 - x * x * x / 24);
}

static double manoeuvre_law(int n, double x)
{
    const double e = exp(-x);
    return n == 3 ? e / 2 : n == 4 ? e * (0.5 - x / 6) : e * (0.5 - x / 3 + x * x / 24);
}

/* The signed miss along east: of the target as the missile passes it. */
static double fly(int n, double flight_s, double heading_rad, double target_mps2)
{
    const LocalFrame  frame = place_at(40, 20, 5000);
    const FlightWorld world = empty_world();
    Missile           m = ideal_missile();
    EngagementResult  r;
    double            east[3];
    m.gain = n;
    m.lag_s = lag_s;
    m.launch_mps = missile_mps;
    const double target[3] = {0, (missile_mps + target_mps) * flight_s, 0}, v[3] = {0, -target_mps, 0};
    const double a[3] = {target_mps2, 0, 0};
    Engagement   e = engagement_of(&frame, &m, heading_rad / rad_per_deg, 0, target, v, a);
    engagement_fly(&r, &e, &m, &world);
    assert_int_equal(r.end, FLIGHT_END_PASSED);
    CHECK(r.at_limit == 0);
    CHECK(fabs(r.miss.t_s - flight_s) < 1e-4);
    to_ecef(east, &frame, 1, 0, 0);
    return -v3_dot(r.miss.away_ecef, east); /* away: from the target to the missile */
}

/* Errors against the largest value of the curve, over times of flight of 0.25 .. 10 lags. */
static void compare(bool heading)
{
    for (int n = 3; n <= 5; n++) {
        double largest = 0, worst = 0;
        for (int pass = 0; pass < 2; pass++)
            for (double x = 0.25; x <= 10; x += x < 3 ? 0.25 : 1) {
                const double t = x * lag_s, e = 1e-5, a = 1e-3;
                const double want =
                    heading ? -missile_mps * e * t * heading_law(n, x) : a * t * t * manoeuvre_law(n, x);
                largest = fmax(largest, fabs(want));
                if (pass == 0) continue;
                const double got = heading ? fly(n, t, e, 0) : fly(n, t, 0, a);
                worst = fmax(worst, fabs(got - want));
                CHECK_NEAR(got, want, 0.01 * largest);
            }
        print_message("%s, N' = %d: worst %.3f %% of the largest miss\n", heading ? "heading error" : "manoeuvre", n,
                      100 * worst / largest);
    }
}

static void heading_error(void **state)
{
    (void)state;
    compare(true);
}

static void target_manoeuvre(void **state)
{
    (void)state;
    compare(false);
}

/* Augmented navigation knows the acceleration, so that a missile without lag in hand has less to make up: at ten lags
 * neither misses, but the plain law has asked for more: N' / (N' - 2) of the target's acceleration at the end, against
 * a command that has fallen to none (Zarchan, augmented proportional navigation: it begins at N' / 2). */
static void augmented_law_asks_for_less_at_the_end(void **state)
{
    (void)state;
    const LocalFrame  frame = place_at(40, 20, 5000);
    const FlightWorld world = empty_world();
    Missile           m = ideal_missile();
    m.lag_s = 0.01;
    m.launch_mps = missile_mps;
    const double target[3] = {0, 15000, 0}, v[3] = {0, -target_mps, 0}, a[3] = {1e-2, 0, 0};
    Engagement   e = engagement_of(&frame, &m, 0, 0, target, v, a);
    for (int law = 0; law < 2; law++) {
        EngagementResult r;
        m.guidance = law ? MISSILE_AUGMENTED : MISSILE_PN;
        e.until_s = 9;
        engagement_fly(&r, &e, &m, &world);
        /* plain: n N'/(N'-2) (1 - (t_go/t_f)^(N'-2)); augmented: n N'/2 (t_go/t_f)^(N'-2) */
        const double left = 0.1 * 0.1, want = law ? 1e-2 * 2 * left : 1e-2 * 2 * (1 - left);
        CHECK_NEAR(r.state.lateral_mps2, want, 0.01 * 2e-2);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(heading_error),
        cmocka_unit_test(target_manoeuvre),
        cmocka_unit_test(augmented_law_asks_for_less_at_the_end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
