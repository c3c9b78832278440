/* WGS 84 against an evaluation in long double that shares nothing with GeographicLib but the two constants.
 * labels: physics */
#include "tests/check.h"

#include "terrain/earth/geodesy.h"

static const long double a_m = 6378137.0L, flattening = 1 / 298.257223563L;

typedef struct PlaceL {
    long double lat, lon, h;
} PlaceL;

static void ecef_l(long double p[3], const PlaceL *g)
{
    const long double e2 = flattening * (2 - flattening), s = sinl(g->lat), n = a_m / sqrtl(1 - e2 * s * s);
    p[0] = (n + g->h) * cosl(g->lat) * cosl(g->lon);
    p[1] = (n + g->h) * cosl(g->lat) * sinl(g->lon);
    p[2] = (n * (1 - e2) + g->h) * s;
}

/* Fixed point of tan(lat) = (z + e2 N sin(lat)) / r: each step gains two digits for heights above -1000 km. */
static PlaceL geodetic_l(const double p[3])
{
    const long double e2 = flattening * (2 - flattening), r = hypotl(p[0], p[1]);
    long double       lat = atan2l(p[2], r * (1 - e2));
    for (int k = 0; k < 60; k++) lat = atan2l(p[2] + e2 * a_m / sqrtl(1 - e2 * sinl(lat) * sinl(lat)) * sinl(lat), r);
    const long double w = sqrtl(1 - e2 * sinl(lat) * sinl(lat));
    return (PlaceL){lat, atan2l(p[1], p[0]), r * cosl(lat) + p[2] * sinl(lat) - a_m * w};
}

static double distance_l(const double p[3], const long double q[3])
{
    return (double)sqrtl((p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]) + (p[2] - q[2]) * (p[2] - q[2]));
}

/* A double of ECEF size steps by 1 nm; the angles' own last bit is worth 0.7 nm (latitude) and 1.4 nm
 * (longitude near 180 degrees). */
static void forward_agrees_with_long_double(void **state)
{
    (void)state;
    for (int n = 0; n < 20000; n++) {
        const Geodetic g = {(random_uniform(1, 0, 0, n) - 0.5) * pi_rad,
                            (random_uniform(1, 1, 0, n) - 0.5) * 2 * pi_rad,
                            -10000 + 60000 * random_uniform(1, 2, 0, n)};
        double         p[3];
        long double    want[3];
        CHECK(ecef_from_geodetic(p, NULL, &g) == STATUS_OK);
        ecef_l(want, &(PlaceL){g.lat_rad, g.lon_rad, g.h_m});
        CHECK_NEAR(distance_l(p, want), 0, 5e-9);
    }
}

static void reverse_agrees_with_long_double(void **state)
{
    (void)state;
    for (int n = 0; n < 20000; n++) {
        const double r_m = 6.3e6 + 2e5 * random_uniform(2, 0, 0, n);
        double       d[3] = {random_normal(2, 1, 0, n), random_normal(2, 2, 0, n), random_normal(2, 3, 0, n)};
        CHECK(v3_normalize(d, d));
        v3_scale(d, r_m, d);
        Geodetic     got;
        const PlaceL want = geodetic_l(d);
        CHECK(geodetic_from_ecef(&got, d) == STATUS_OK);
        CHECK_NEAR((double)(got.lat_rad - want.lat) * r_m, 0, 7e-9);
        CHECK_NEAR((double)((got.lon_rad - want.lon) * cosl(want.lat)) * r_m, 0, 7e-9);
        CHECK_NEAR((double)(got.h_m - want.h), 0, 7e-9);
    }
}

static void there_and_back(void **state)
{
    (void)state;
    for (int n = 0; n < 20000; n++) {
        const Geodetic g = {(random_uniform(3, 0, 0, n) - 0.5) * pi_rad,
                            (random_uniform(3, 1, 0, n) - 0.5) * 2 * pi_rad,
                            -5000 + 40000 * random_uniform(3, 2, 0, n)};
        double         p[3], q[3];
        Geodetic       back;
        CHECK(ecef_from_geodetic(p, NULL, &g) == STATUS_OK);
        CHECK(geodetic_from_ecef(&back, p) == STATUS_OK);
        CHECK(ecef_from_geodetic(q, NULL, &back) == STATUS_OK);
        v3_sub(q, q, p);
        CHECK_NEAR(v3_length(q), 0, 7e-9);
    }
}

static void corners_of_the_earth(void **state)
{
    (void)state;
    const double b_m = 6356752.314245179498;
    Geodetic     g;
    double       p[3], r[9];

    CHECK(geodetic_from_ecef(&g, (double[3]){0, 0, b_m + 7}) == STATUS_OK);
    CHECK_NEAR(g.lat_rad, pi_rad / 2, 0);
    CHECK_NEAR(g.h_m, 7, 2e-9);
    CHECK(geodetic_from_ecef(&g, (double[3]){0, -0.0, -b_m}) == STATUS_OK);
    CHECK_NEAR(g.lat_rad, -pi_rad / 2, 0);

    /* the antimeridian from both sides, and a signed zero: never outside -pi .. pi */
    for (int side = -1; side <= 1; side++) {
        CHECK(geodetic_from_ecef(&g, (double[3]){-6378137, side * 1e-3, 0}) == STATUS_OK);
        CHECK_NEAR(fabs(g.lon_rad), pi_rad, 2e-10);
        CHECK(fabs(g.lon_rad) <= pi_rad);
        if (side) CHECK((g.lon_rad > 0) == (side > 0));
    }
    CHECK(geodetic_from_ecef(&g, (double[3]){-6378137, -0.0, -0.0}) == STATUS_OK);
    CHECK(fabs(g.lon_rad) <= pi_rad && g.lat_rad == 0);

    /* the centre is as far from every place; anything finite and in range will do */
    CHECK(geodetic_from_ecef(&g, (double[3]){0, 0, 0}) == STATUS_OK);
    CHECK(fabs(g.lat_rad) <= pi_rad / 2 && isfinite(g.h_m) && g.h_m < -6e6);

    /* east, north, up at 0 N 90 E are -x, z, y */
    CHECK(ecef_from_geodetic(p, r, &(Geodetic){0, pi_rad / 2, 0}) == STATUS_OK);
    const double want[9] = {-1, 0, 0, 0, 0, 1, 0, 1, 0};
    for (int k = 0; k < 9; k++) CHECK_NEAR(r[k], want[k], 1e-16);
    CHECK_NEAR(p[1], 6378137, 1e-9);
    /* one turn further is the same place */
    CHECK(ecef_from_geodetic(p, NULL, &(Geodetic){0, 2.5 * pi_rad, 0}) == STATUS_OK);
    CHECK_NEAR(p[1], 6378137, 1e-8);
}

static void bad_input_leaves_the_output_alone(void **state)
{
    (void)state;
    const double bad[] = {NAN, INFINITY, -INFINITY};
    for (int n = 0; n < 3; n++)
        for (int k = 0; k < 3; k++) {
            Geodetic g = {1, 2, 3};
            double   p[3] = {6.4e6, 0, 0}, r[9] = {42};
            p[k] = bad[n];
            CHECK(geodetic_from_ecef(&g, p) == STATUS_BAD_VALUE);
            CHECK(g.lat_rad == 1 && g.lon_rad == 2 && g.h_m == 3);

            Geodetic   place = {0.5, 0.5, 0};
            LocalFrame frame = {.origin_ecef = {5, 6, 7}};
            (k == 0 ? &place.lat_rad : k == 1 ? &place.lon_rad : &place.h_m)[0] = bad[n];
            double q[3] = {8, 8, 8};
            CHECK(ecef_from_geodetic(q, r, &place) == STATUS_BAD_VALUE);
            CHECK(q[0] == 8 && q[1] == 8 && q[2] == 8 && r[0] == 42);
            CHECK(local_frame_at(&frame, &place) == STATUS_BAD_VALUE);
            CHECK(frame.origin_ecef[0] == 5 && frame.origin_ecef[2] == 7);
        }
    double q[3];
    CHECK(ecef_from_geodetic(q, NULL, &(Geodetic){nextafter(pi_rad / 2, 2), 0, 0}) == STATUS_BAD_VALUE);
    CHECK(ecef_from_geodetic(q, NULL, &(Geodetic){pi_rad / 2, 0, 0}) == STATUS_OK);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(forward_agrees_with_long_double),
        cmocka_unit_test(reverse_agrees_with_long_double),
        cmocka_unit_test(there_and_back),
        cmocka_unit_test(corners_of_the_earth),
        cmocka_unit_test(bad_input_leaves_the_output_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
