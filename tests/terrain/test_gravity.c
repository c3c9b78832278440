/* Normal gravity against the closed form of the level ellipsoid, WGS 84's published values, and an inertial frame.
 * labels: physics */
#include "tests/check.h"

#include "terrain/earth/geodesy.h"
#include "terrain/earth/gravity.h"

static const double a_m = 6378137, flattening = 1 / 298.257223563, mu = 3.986004418e14;

/* Heiskanen & Moritz (1967), sections 2-7 and 2-8, without the centrifugal terms, in long double: the functions q
 * cancel to 1e-4 of their terms. */
static void closed_form(double g[3], const double p[3])
{
    typedef long double Long;
    const Long          b = a_m * (1 - (Long)flattening), e = sqrtl((Long)a_m * a_m - b * b), w = earth_turn_rps;
    const Long          s2 = (Long)p[0] * p[0] + (Long)p[1] * p[1], z = p[2], half = 0.5L * (s2 + z * z - e * e);
    const Long          u = sqrtl(half + sqrtl(half * half + e * e * z * z)), v = sqrtl(u * u + e * e);
    const Long          beta = atan2l(z * v, u * sqrtl(s2)), sb = sinl(beta), cb = cosl(beta);
    const Long          k = sqrtl((u * u + e * e * sb * sb) / (v * v));
    const Long          q0 = 0.5L * ((1 + 3 * b * b / (e * e)) * atanl(e / b) - 3 * b / e);
    const Long          q = 0.5L * ((1 + 3 * u * u / (e * e)) * atanl(e / u) - 3 * u / e);
    const Long          q1 = 3 * (1 + u * u / (e * e)) * (1 - u / e * atanl(e / u)) - 1;
    const Long          spin = w * w * a_m * a_m;
    const Long          gu = -(mu / (v * v) + spin * e / (v * v) * q1 / q0 * (0.5L * sb * sb - 1 / 6.0L)) / k;
    const Long          gb = spin / v * q / q0 * sb * cb / k;
    const Long          level = u / (k * v) * cb * gu - sb / k * gb, s = sqrtl(s2);
    g[0] = (double)(s > 0 ? level * p[0] / s : 0);
    g[1] = (double)(s > 0 ? level * p[1] / s : 0);
    g[2] = (double)(sb / k * gu + u / (k * v) * cb * gb);
}

static void gravitation_is_that_of_the_level_ellipsoid(void **state)
{
    (void)state;
    for (int lat = -90; lat <= 90; lat += 5)
        for (int step = 0; step < 5; step++) {
            const double   high_m[] = {-300, 0, 9000, 40000, 400000};
            const Geodetic place = {lat * rad_per_deg, (3 * lat + 10) * rad_per_deg, high_m[step]};
            double         p[3], got[3], want[3];
            assert_int_equal(ecef_from_geodetic(p, NULL, &place), STATUS_OK);
            earth_gravitation(got, p);
            closed_form(want, p);
            for (int k = 0; k < 3; k++) CHECK_NEAR(got[k], want[k], 1e-8);
        }
}

/* TR8350.2: normal gravity on the ellipsoid, at the equator and at the poles. */
static void gravity_on_the_ellipsoid_is_the_published_one(void **state)
{
    (void)state;
    const double still[3] = {0}, equator[3] = {0, -a_m, 0}, pole[3] = {0, 0, a_m * (1 - flattening)};
    double       g[3];
    earth_gravitation(g, equator);
    earth_turning(g, equator, still, earth_turn_rps);
    CHECK_NEAR(v3_length(g), 9.7803253359, 2e-8);
    CHECK(g[1] > 0);
    earth_gravitation(g, pole);
    earth_turning(g, pole, still, earth_turn_rps);
    CHECK_NEAR(v3_length(g), 9.8321849378, 2e-8);
    CHECK(g[2] < 0);
}

/* Coriolis and centrifugal by hand: a point that stands in inertial axes circles westwards in turning ones. */
static void what_stands_among_the_stars_circles_westwards(void **state)
{
    (void)state;
    const double w = 1e-3, r = 1000, p[3] = {r, 0, 5}, v[3] = {0, -w * r, 0};
    double       a[3] = {0};
    earth_turning(a, p, v, w);
    CHECK_NEAR(a[0], -w * w * r, 1e-12);
    CHECK_NEAR(a[1], 0, 1e-15);
    CHECK_NEAR(a[2], 0, 1e-15);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(gravitation_is_that_of_the_level_ellipsoid),
        cmocka_unit_test(gravity_on_the_ellipsoid_is_the_published_one),
        cmocka_unit_test(what_stands_among_the_stars_circles_westwards),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
