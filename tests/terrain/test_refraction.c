/* How far air bends lines of sight, against the closed forms of navigators' tables and of radar, and against Snell's
 * invariant of a spherical atmosphere. labels: physics */
#include "tests/check.h"

#include "terrain/earth/refraction.h"

static const double earth_m = 6371e3, nautical_mile_m = 1852;

/* Of an Earth of radius R that rays over it make flatter: ground falls away by d^2 / 2R and rises by bend d^2. */
static double dip_rad(double bend_per_m, double eye_m) { return 2 * sqrt((0.5 / earth_m - bend_per_m) * eye_m); }
static double horizon_m(double bend_per_m, double eye_m) { return sqrt(eye_m / (0.5 / earth_m - bend_per_m)); }

/* Against a straight ray, of k = 1.149 and 4/3 over R = 6371 km: (1 - 1/k) d^2 / 2R = 0.12968 d^2 / 12742 km and
 * 0.25 d^2 / 12742 km: 8 km 0.651 and 1.256 m, 16 km 2.605 and 5.023 m, 50 km 25.44 and 49.05 m. */
static void lifts(void **state)
{
    (void)state;
    static const double want[][3] = {{8e3, 0.651, 1.256}, {16e3, 2.605, 5.023}, {50e3, 25.44, 49.05}};
    for (int k = 0; k < 3; k++) {
        const double eye[3] = {3000, -2000, 10};
        const double p[3] = {3000 + 0.6 * want[k][0], -2000 - 0.8 * want[k][0], 500};
        CHECK_NEAR(refraction_drop(refraction_bend(REFRACTION_OPTICAL, 0, 0), eye, p), want[k][1], 6e-4 * want[k][1]);
        CHECK_NEAR(refraction_drop(refraction_bend(REFRACTION_RADAR, 0, 0), eye, p), want[k][2], 6e-4 * want[k][2]);
    }
}

/* Bowditch, The American Practical Navigator: visible horizon 1.144 sqrt(feet) nautical miles (table 8 up to
 * 1981: 2.072 sqrt(m)), 1.169 since (2.117); without air 1.064 (1.927). The Nautical Almanac's dip: 1.76' sqrt(m),
 * without air 1.926'. Radar: 4.12 km sqrt(m) (4/3; Skolnik, Introduction to Radar Systems). */
static void horizons(void **state)
{
    (void)state;
    for (double eye_m = 2; eye_m < 150; eye_m *= 3) {
        const double bend = refraction_bend(REFRACTION_OPTICAL, eye_m, 0), root = sqrt(eye_m);
        CHECK_NEAR(horizon_m(bend, eye_m) / nautical_mile_m / root, 2.072, 0.01);
        CHECK_NEAR(dip_rad(bend, eye_m) / rad_per_deg * 60 / root, 1.76, 0.025 * 1.76);
        CHECK_NEAR(horizon_m(refraction_bend(REFRACTION_RADAR, eye_m, 0), eye_m) / root, 4120, 0.005 * 4120);
        /* and the form itself is theirs: */
        CHECK_NEAR(dip_rad(0, eye_m) / rad_per_deg * 60 / root, 1.926, 0.001 * 1.926);
        CHECK_NEAR(horizon_m(0, eye_m) / nautical_mile_m / root, 1.927, 0.001 * 1.927);
    }
}

/* n r cos(elevation) is the same all along a ray in a spherical atmosphere: the dip to a horizon at sea level is
 * acos(n0 R / (n (R + h))), with n - 1 = 0.12968 (scale / R) exp(-h / scale): of that gradient at the ground, scale 11
 * km. It is within a per cent up to 20 km, and dies out: from 300 km it is less than a thousandth. */
static void high_eyes(void **state)
{
    (void)state;
    const double scale_m = 11000, n0 = (1 - 1 / 1.149) * scale_m / earth_m;
    for (double eye_m = 100; eye_m < 25000; eye_m *= 1.7) {
        const double cosine = (1 + n0) * earth_m / ((1 + n0 * exp(-eye_m / scale_m)) * (earth_m + eye_m));
        const double vacuum = acos(earth_m / (earth_m + eye_m)), bend = refraction_bend(REFRACTION_OPTICAL, eye_m, 0);
        const double raised_rad = vacuum - acos(cosine), got_rad = dip_rad(0, eye_m) - dip_rad(bend, eye_m);
        CHECK_NEAR(got_rad, raised_rad, 0.02 * raised_rad);
    }
    CHECK_NEAR(refraction_bend(REFRACTION_OPTICAL, 11000, 0) / refraction_bend(REFRACTION_OPTICAL, 0, 0), 1 - exp(-1),
               1e-12);
    CHECK_NEAR(refraction_bend(REFRACTION_RADAR, 7350, 0) / refraction_bend(REFRACTION_RADAR, 0, 0), 1 - exp(-1),
               1e-12);
    CHECK(refraction_bend(REFRACTION_OPTICAL, 4e7, 0) < 5e-4 * refraction_bend(REFRACTION_OPTICAL, 0, 0));
}

/* Between heights it is the mean of exp(-h / scale), from whichever it is seen; of one height that itself, without a
 * step. */
static void means(void **state)
{
    (void)state;
    const double sea = refraction_bend(REFRACTION_OPTICAL, 0, 0);
    enum { steps = 1000 };
    double sum = 0;
    for (int k = 0; k < steps; k++) sum += exp(-(1500 + (k + 0.5) * 6000 / steps) / 11000) / steps;
    CHECK_NEAR(refraction_bend(REFRACTION_OPTICAL, 7500, 1500) / sea, sum, 1e-6);
    CHECK_NEAR(refraction_bend(REFRACTION_OPTICAL, 1500, 7500) / sea, sum, 1e-6);
    CHECK_NEAR(refraction_bend(REFRACTION_OPTICAL, 1500, 1500) / sea, exp(-1500.0 / 11000), 1e-12);
    CHECK_NEAR(refraction_bend(REFRACTION_OPTICAL, 1500 + 1e-6, 1500) / sea, exp(-1500.0 / 11000), 1e-9);
    CHECK_NEAR(refraction_bend(REFRACTION_OPTICAL, -400, -400), sea, 1e-12 * sea);
    CHECK(refraction_bend(REFRACTION_OPTICAL, NAN, 0) == 0 && refraction_bend(REFRACTION_OPTICAL, 0, INFINITY) == 0);
}

/* In a local frame: heights are over the ellipsoid. 100 km from the origin the tangent plane is 785 m above it. */
static void in_a_frame(void **state)
{
    (void)state;
    LocalFrame     frame;
    const Geodetic origin = {0.6, 1, 800};
    assert_int_equal(local_frame_at(&frame, &origin), STATUS_OK);
    const double eye[3] = {100e3, 0, 3000}, want = refraction_bend(REFRACTION_OPTICAL, 800 + 3000 + 785, 800 + 200);
    CHECK_NEAR(refraction_bend_at(REFRACTION_OPTICAL, &frame, eye, 200), want, 2e-4 * want);
    CHECK(refraction_bend_at(REFRACTION_OPTICAL, &frame, (double[3]){NAN, 0, 0}, 200) == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lifts), cmocka_unit_test(horizons),   cmocka_unit_test(high_eyes),
        cmocka_unit_test(means), cmocka_unit_test(in_a_frame),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
