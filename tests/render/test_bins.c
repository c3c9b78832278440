/* Bins of aspect and range that signatures are made for: their middles by hand, at the poles and where azimuth wraps,
 * and of the ground's plane. labels: physics */
#include "tests/check.h"

#include "render/scattering/signatures/bins.h"

static ScatterAntenna at(double azimuth_deg, double elevation_deg, double range_m)
{
    const double az = azimuth_deg * rad_per_deg, el = elevation_deg * rad_per_deg;
    return (ScatterAntenna){{cos(el) * cos(az), cos(el) * sin(az), sin(el)}, range_m};
}

static void check_middle(const ScatterAntenna *got, double azimuth_deg, double elevation_deg, double range_m)
{
    const ScatterAntenna want = at(azimuth_deg, elevation_deg, range_m);
    for (int k = 0; k < 3; k++) CHECK_NEAR(got->u[k], want.u[k], 1e-12);
    CHECK(got->range_m == range_m || fabs(got->range_m - range_m) < 1e-9 * range_m);
}

/* Bins of 10 degrees: elevations 5, 15, .. 85 of either sign; about the axis as many as come nearest to 10 degrees
 * across: 36 cos 5 = 35.86, 36; 36 cos 45 = 25.5, 25; 36 cos 85 = 3.14, 3; from -180 on. Ranges: 2^(n / 4), the nearest
 * in its logarithm: from 2^(n / 4 - 1 / 8). */
static void middles_are_those_by_hand(void **state)
{
    (void)state;
    static const struct {
        double az, el, range_m, want_az, want_el, want_m;
    } of[] = {{1, 1, 1000, 5, 5, 1024},
              {-1, 9.9, 1024 * 0.92, -5, 5, 1024},
              {9.9, -0.1, 1024 * 0.91, 5, -5, 861.0779292198},
              {10.1, -9.9, 1024 * 1.085, 15, -5, 1024},
              {-179.9, 12, 1024 * 1.095, -180 + 0.5 * 360 / 35, 15, 1217.7480857628},
              {179.9, 12, INFINITY, 180 - 0.5 * 360 / 35, 15, INFINITY},
              {1, 41, 8, -180 + 12.5 * 14.4, 45, 8},
              {-8, 49, 8, -180 + 11.5 * 14.4, 45, 8},
              {-61, 86, 8, -120, 85, 8},
              {-59, 86, 8, 0, 85, 8},
              {61, -86, 8, 120, -85, 8}};
    for (size_t i = 0; i < sizeof of / sizeof *of; i++) {
        const ScatterAntenna antenna = at(of[i].az, of[i].el, of[i].range_m);
        ScatterAntenna       middle;
        signature_bin(&middle, &antenna, 10 * rad_per_deg);
        check_middle(&middle, of[i].want_az, of[i].want_el, of[i].want_m);
    }
}

/* Straight up and down, and where bins do not divide the quarter: 90 degrees and a bit is no elevation. One bin about
 * the axis at least. */
static void poles_are_in_bins(void **state)
{
    (void)state;
    ScatterAntenna middle, up = {{0, 0, 1}, INFINITY}, down = {{0, 0, -1}, INFINITY};
    signature_bin(&middle, &up, 40 * rad_per_deg); /* 80 to 120 degrees: at most 90 */
    CHECK_NEAR(middle.u[2], 1, 1e-12);
    signature_bin(&middle, &down, 40 * rad_per_deg); /* -120 to -80 */
    CHECK_NEAR(middle.u[2], -1, 1e-12);
    signature_bin(&middle, &up, 24 * rad_per_deg); /* 72 to 96: 84; 15 cos 84 = 1.57, two bins of azimuth */
    check_middle(&middle, 90, 84, INFINITY);
}

/* The ground's plane: bins of 1 degree and steps of 2 cm, only where one of the antennas is an image. */
static void planes_are_in_bins(void **state)
{
    (void)state;
    SignatureLook        look = {.tx = at(1, 1, 1000), .rx = at(-12, 23, 500)}, middle;
    const ScatterAntenna n = at(20.3, 85.2, INFINITY);
    memcpy(look.plane.n, n.u, sizeof n.u);
    look.plane.height_m = 1.2349;
    signature_look_bin(&middle, &look, 10 * rad_per_deg);
    check_middle(&middle.tx, 5, 5, 1024);
    check_middle(&middle.rx, -180 + 15.5 * 360 / 33, 25, 512); /* 36 cos 25 = 32.6 */
    CHECK(!middle.image[0] && !middle.image[1] && middle.plane.height_m == 0 && v3_length(middle.plane.n) == 0);
    for (int i = 0; i < 2; i++) {
        look.image[0] = i == 0, look.image[1] = i == 1;
        signature_look_bin(&middle, &look, 10 * rad_per_deg);
        CHECK(middle.image[0] == look.image[0] && middle.image[1] == look.image[1]);
        CHECK_NEAR(middle.plane.height_m, 1.24, 1e-12);
        /* 360 cos 85.5 = 28.2: 28 bins of 12.857 degrees; 200.3 / 12.857 = 15.6 */
        const ScatterAntenna want = at(-180 + 15.5 * 360 / 28, 85.5, INFINITY);
        for (int k = 0; k < 3; k++) CHECK_NEAR(middle.plane.n[k], want.u[k], 1e-12);
    }
    look.plane.height_m = 1.2299;
    signature_look_bin(&middle, &look, 10 * rad_per_deg);
    CHECK_NEAR(middle.plane.height_m, 1.22, 1e-12);
    look.plane.height_m = -0.0101;
    signature_look_bin(&middle, &look, 10 * rad_per_deg);
    CHECK_NEAR(middle.plane.height_m, -0.02, 1e-12);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(middles_are_those_by_hand),
        cmocka_unit_test(poles_are_in_bins),
        cmocka_unit_test(planes_are_in_bins),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
