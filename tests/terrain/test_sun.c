/* The sun against NREL's published vector, and against a low-precision almanac that shares no code with ERFA.
 * labels: physics */
#include "tests/check.h"

#include "terrain/earth/refraction.h"
#include "terrain/earth/sun.h"

/* Reda and Andreas, "Solar Position Algorithm for Solar Radiation Applications", NREL/TP-560-34302, appendix A.5:
 * 2003-10-17 12:30:30, seven hours west of UTC. */
static void nrel_vector(void **state)
{
    (void)state;
    const Geodetic place = {39.742476 * rad_per_deg, -105.1786 * rad_per_deg, 1830.14};
    const double   unix_s = 1066419030; /* 2003-10-17T19:30:30Z */
    Sun            sun;
    CHECK(sun_at(&sun, unix_s, &place, 820, 11, 67) == STATUS_OK);
    CHECK_NEAR(90 - sun.elevation_rad / rad_per_deg, 50.11162, 0.0005);
    CHECK_NEAR(sun.azimuth_rad / rad_per_deg, 194.340241, 0.0005);
    CHECK_NEAR(sun.distance_au, 0.9965422974, 2e-7); /* two truncations of VSOP: some 20 km */
    /* the same from ERFA by somebody else's program */
    CHECK_NEAR(90 - sun.elevation_rad / rad_per_deg, 50.111607, 2e-6);
    CHECK_NEAR(sun.azimuth_rad / rad_per_deg, 194.340197, 2e-6);
    CHECK_NEAR(v3_length(sun.d_enu), 1, 1e-15);
    CHECK_NEAR(atan2(sun.d_enu[0], sun.d_enu[1]) + 2 * pi_rad, sun.azimuth_rad, 1e-12);
    CHECK_NEAR(asin(sun.d_enu[2]), sun.elevation_rad, 1e-12);

    /* the built-in TT - UT1 is 64.184 s then: three seconds are 0.12 arcsecond */
    Sun own;
    CHECK(sun_at(&own, unix_s, &place, 820, 11, NAN) == STATUS_OK);
    CHECK_NEAR(own.azimuth_rad, sun.azimuth_rad, 2e-6);
    CHECK(own.azimuth_rad != sun.azimuth_rad);
}

/* "Low precision formulas for the Sun's coordinates", Astronomical Almanac, page C5: 0.01 degree, 1950 .. 2050; no
 * parallax, no refraction. */
static void almanac(double d_enu[3], double unix_s, const Geodetic *place)
{
    const double n = (unix_s - 946728000) / 86400; /* days from 2000-01-01T12 */
    const double l = (280.460 + 0.9856474 * n) * rad_per_deg, g = (357.528 + 0.9856003 * n) * rad_per_deg;
    const double lambda = l + (1.915 * sin(g) + 0.020 * sin(2 * g)) * rad_per_deg;
    const double epsilon = (23.439 - 0.0000004 * n) * rad_per_deg;
    const double alpha = atan2(cos(epsilon) * sin(lambda), cos(lambda)), delta = asin(sin(epsilon) * sin(lambda));
    const double gmst = (280.46061837 + 360.98564736629 * n) * rad_per_deg; /* Meeus, Astronomical Algorithms, 12.4 */
    const double hour = gmst + place->lon_rad - alpha, phi = place->lat_rad;
    d_enu[0] = -cos(delta) * sin(hour);
    d_enu[1] = cos(phi) * sin(delta) - sin(phi) * cos(delta) * cos(hour);
    d_enu[2] = sin(phi) * sin(delta) + cos(phi) * cos(delta) * cos(hour);
}

/* 0.01 of the almanac, 0.005 of aberration of the moon and rounding of its constants, 0.0024 of parallax: 0.02. With
 * no air there is no refraction. */
static void agrees_with_the_almanac(void **state)
{
    (void)state;
    double worst_deg = 0;
    for (int n = 0; n < 3000; n++) {
        const double   unix_s = 631152000 + (2524608000.0 - 631152000) * random_uniform(1, 0, 0, n); /* 1990 .. 2050 */
        const Geodetic place = {asin(2 * random_uniform(1, 1, 0, n) - 1), (2 * random_uniform(1, 2, 0, n) - 1) * pi_rad,
                                0};
        Sun            sun;
        double         want[3], cross[3];
        CHECK(sun_at(&sun, unix_s, &place, 0, 15, NAN) == STATUS_OK);
        almanac(want, unix_s, &place);
        v3_cross(cross, want, sun.d_enu);
        const double off_deg = atan2(v3_length(cross), v3_dot(want, sun.d_enu)) / rad_per_deg;
        CHECK_NEAR(off_deg, 0, 0.02);
        worst_deg = fmax(worst_deg, off_deg);
    }
    printf("worst against the almanac: %.4f degree\n", worst_deg);
    CHECK(worst_deg > 1e-4); /* two programs this close would be one */
}

static void known_places_and_days(void **state)
{
    (void)state;
    Sun sun;
    /* 2024-06-20 solstice, 20:51 UTC: noon stands over longitude -132.3 within the equation of time; at the tropic
     * it is overhead */
    double best = 0;
    for (int lon = -150; lon < -110; lon++) {
        const Geodetic tropic = {23.436 * rad_per_deg, lon * rad_per_deg, 0};
        CHECK(sun_at(&sun, 1718916660, &tropic, 1013, 15, NAN) == STATUS_OK);
        best = fmax(best, sun.elevation_rad / rad_per_deg);
    }
    CHECK_NEAR(best, 90, 0.5);
    /* and the north pole sees it 23.44 degrees up whatever the hour; refraction adds 0.04 */
    for (int hour = 0; hour < 24; hour += 6) {
        CHECK(sun_at(&sun, 1718916660 + 3600 * hour, &(Geodetic){pi_rad / 2, 0, 0}, 1013, 15, NAN) == STATUS_OK);
        CHECK_NEAR(sun.elevation_rad / rad_per_deg, 23.436 + 0.037, 0.006);
    }
    /* morning is in the east, evening in the west, noon in the south of 48 N */
    const Geodetic munich = {48.1 * rad_per_deg, 11.6 * rad_per_deg, 500};
    CHECK(sun_at(&sun, 1711000800, &munich, 1013, 10, NAN) == STATUS_OK); /* 2024-03-21T06:00Z */
    CHECK(sun.d_enu[0] > 0.9);
    CHECK(sun_at(&sun, 1711000800 + 5.3 * 3600, &munich, 1013, 10, NAN) == STATUS_OK);
    CHECK_NEAR(sun.azimuth_rad, pi_rad, 0.03);
    CHECK(sun_at(&sun, 1711000800 + 10.6 * 3600, &munich, 1013, 10, NAN) == STATUS_OK);
    CHECK(sun.d_enu[0] < -0.9);
}

/* Without a leap second table (before 1960, far ahead) the sun must not jump: along a day's edge at each year's
 * turn it moves as smoothly as in between. */
static void no_jump_at_the_ends_of_the_table(void **state)
{
    (void)state;
    const Geodetic place = {0.6, 0, 0};
    for (int year = 1900; year <= 2100; year++) {
        const double turn_s = ((year - 1970) * 365.2425) * 86400;
        Sun          a, b;
        CHECK(sun_at(&a, turn_s - 0.5, &place, 0, 15, NAN) == STATUS_OK);
        CHECK(sun_at(&b, turn_s + 0.5, &place, 0, 15, NAN) == STATUS_OK);
        double d[3];
        v3_sub(d, b.d_enu, a.d_enu);
        CHECK_NEAR(v3_length(d), 7.27e-5 * cos(asin(0.4)), 8e-6); /* one second of the Earth's turn */
    }
}

/* The TT - UT1 that sun_at uses by itself, s: the secant through a second less and a second more than `near_s`. */
static double own_delta_t_s(double unix_s, double near_s)
{
    const Geodetic place = {0.3, 0.7, 0};
    Sun            own, less, more;
    double         step[3], off[3];
    CHECK(sun_at(&own, unix_s, &place, 0, 15, NAN) == STATUS_OK);
    CHECK(sun_at(&less, unix_s, &place, 0, 15, near_s - 1) == STATUS_OK);
    CHECK(sun_at(&more, unix_s, &place, 0, 15, near_s + 1) == STATUS_OK);
    v3_sub(step, more.d_enu, less.d_enu);
    v3_sub(off, own.d_enu, less.d_enu);
    return near_s - 1 + 2 * v3_dot(off, step) / v3_dot(step, step);
}

/* Unix time of the 15th of a month at noon, s: days since 0000-03-01 of the Gregorian calendar. */
static double mid_month_s(int year, int month)
{
    const int y = year - (month <= 2), m = (month + 9) % 12;
    const int days = 365 * y + y / 4 - y / 100 + y / 400 + (153 * m + 2) / 5 + 14 - 719468;
    return days * 86400.0 + 43200;
}

/* Astronomical Almanac, pages K8 and K9, "Reduction of time scales", Delta T on 0 January of each fifth year, s. A
 * month counts by its middle, year + (month - 0.5) / 12 (Espenak and Meeus, Five Millennium Canon of Solar Eclipses).
 */
static void delta_t_before_utc_is_the_almanacs(void **state)
{
    (void)state;
    static const double almanac_s[] = {-2.72, 3.86,  10.46, 17.20, 21.16, 23.62, 24.02,
                                       23.93, 24.33, 26.77, 29.15, 31.07, 33.15};
    for (int year = 1900; year < 1960; year++)
        for (int month = 1; month <= 12; month += year % 5 == 0 ? 1 : 11) {
            const double *row = almanac_s + (year - 1900) / 5;
            const double  want_s = row[0] + (row[1] - row[0]) * ((year - 1900) % 5 + (month - 0.5) / 12) / 5;
            CHECK_NEAR(own_delta_t_s(mid_month_s(year, month), want_s), want_s, 1e-3);
        }
}

/* 32.184 s + TAI - UTC. IERS Bulletin C: 10 s in 1972, 20 s in 1981.5, 32 s in 1999, 37 s since 2017; before 1972 UTC
 * ran at a rate: 4.313170 s + (MJD - 39126) 0.002592 s from 1966 (USNO, tai-utc.dat). 1960 is the first year that ERFA
 * knows: 1.417818 s + (MJD - 37300) 0.001296 s. */
static void delta_t_of_utc_follows_leap_seconds(void **state)
{
    (void)state;
    static const struct {
        int    year, month;
        double tai_utc_s;
    } row[] = {{1972, 3, 10}, {1981, 8, 20}, {1999, 1, 32}, {2017, 1, 37}, {2024, 6, 37}};
    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++) {
        const double want_s = 32.184 + row[i].tai_utc_s;
        CHECK_NEAR(own_delta_t_s(mid_month_s(row[i].year, row[i].month), want_s), want_s, 1e-3);
    }
    for (int year = 1966; year < 1968; year++) {
        const double unix_s = mid_month_s(year, 5), mjd = unix_s / 86400 + 40587;
        const double want_s = 32.184 + 4.313170 + (mjd - 39126) * 0.002592;
        CHECK_NEAR(own_delta_t_s(unix_s, want_s), want_s, 1e-3);
    }
    const double first_s = mid_month_s(1960, 2), mjd = first_s / 86400 + 40587;
    CHECK_NEAR(own_delta_t_s(first_s, 33), 32.184 + 1.417818 + (mjd - 37300) * 0.001296, 1e-3);
}

/* After the leap seconds the estimate: straight from 69.36 s (observed, 2020.0) to 75 s in 2050 and 95 s in 2101.
 * Espenak and Meeus give 93 s in 2050, which the Earth's rotation since 2005 has shown to be 10 s and more too much;
 * the estimate is below it, and above what was observed last. */
static void delta_t_after_the_leap_seconds(void **state)
{
    (void)state;
    for (int year = 2040; year < 2101; year++) {
        const double y = year + 6.5 / 12;
        const double want_s = year < 2050 ? 69.36 + (y - 2020) / 30 * (75 - 69.36) : 75 + (y - 2050) / 51 * (95 - 75);
        const double t = y - 2000, canon_s = 62.92 + 0.32217 * t + 0.005589 * t * t;
        CHECK_NEAR(own_delta_t_s(mid_month_s(year, 7), want_s), want_s, 1e-3);
        CHECK(want_s < canon_s && want_s > 69.36);
    }
}

/* NREL SPA, equation 42, and its step 3.11: refraction is added until the upper limb, refracted by 0.5667 degree, is
 * below the horizon: 0.8334 degree. */
static void refraction_ends_with_the_disc(void **state)
{
    (void)state;
    const double day_s = 1711000800; /* 2024-03-21T06:00Z */
    int          bent = 0, straight = 0;
    for (int k = 0; k < 400; k++) { /* over the terminator, which is at 1.8 degrees then, and far from it */
        const double   lon_deg = k < 300 ? 0.5 + 0.005 * k : k - 350;
        const Geodetic place = {0.1, lon_deg * rad_per_deg, 0};
        Sun            in_vacuum, in_air;
        CHECK(sun_at(&in_vacuum, day_s, &place, 0, 10, NAN) == STATUS_OK);
        CHECK(sun_at(&in_air, day_s, &place, 900, 25, NAN) == STATUS_OK);
        const double e = in_vacuum.elevation_rad / rad_per_deg;
        const double want_deg =
            e >= -0.83337 ? 900.0 / 1010 * 283 / 298 * 1.02 / (60 * tan((e + 10.3 / (e + 5.11)) * rad_per_deg)) : 0;
        CHECK_NEAR((in_air.elevation_rad - in_vacuum.elevation_rad) / rad_per_deg, want_deg, 1e-12);
        bent += e >= -0.83337 && e < -0.76, straight += e < -0.83337 && e > -0.9;
    }
    CHECK(bent > 0 && straight > 0);
}

/* Degrees above the horizontal by the almanac: no refraction, no parallax. */
static double almanac_deg(double unix_s, const Geodetic *place)
{
    double d_enu[3];
    almanac(d_enu, unix_s, place);
    return asin(d_enu[2]) / rad_per_deg;
}

static Sun standard_sun(double unix_s, const Geodetic *place) /* 1010 mbar and 10 C, where refraction is 34' */
{
    Sun sun;
    CHECK(sun_at(&sun, unix_s, place, 1010, 10, NAN) == STATUS_OK);
    return sun;
}

/* The Nautical Almanac, and USNO: the sun rises and sets with its centre 90 degrees 50' from the zenith, 34' by
 * refraction at the horizon and 16' of semidiameter (959.63" at 1 AU: 15.73' to 16.27'). The centre's place without air
 * is of the almanac's formulas: 0.02 degree as above. 48 mornings and evenings of four latitudes; without air the limb
 * would rise 34' = 0.57 degree too high. */
static void rises_and_sets_by_the_almanac(void **state)
{
    (void)state;
    static const double lat_deg[] = {-50, -12, 35, 60};
    for (int n = 0; n < 96; n++) {
        const Geodetic place = {lat_deg[n % 4] * rad_per_deg, 0, 0};
        const double   noon_s = mid_month_s(2026, 1 + n / 4 % 12), way_s = n < 48 ? -43200 : 43200; /* in UTC, at 0 E */
        double         down_s = noon_s + way_s, up_s = noon_s;
        while (fabs(up_s - down_s) > 1e-3) {
            const double middle_s = 0.5 * (up_s + down_s);
            const Sun    sun = standard_sun(middle_s, &place);
            const double limb_deg = sun.elevation_rad / rad_per_deg + 959.63 / 3600 / sun.distance_au;
            if (limb_deg > 0) up_s = middle_s;
            else down_s = middle_s;
        }
        CHECK_NEAR(90 - almanac_deg(up_s, &place), 90 + 50.0 / 60, 0.02 + 0.3 / 60);
    }
}

/* From a raised eye the sea's horizon is 1.76' sqrt(m) lower, and so is the limb on it: 90 degrees 50' + 1.76' sqrt(m).
 * A limb is a point of the sun that air raises as it raises the centre when that is there; the dip is
 * terrain/earth/refraction.h's, 1.797' sqrt(m). The almanac leaves out what the air between the eye and its horizon
 * adds, 0.13 of that arc: 1.9' at 50 m (27 km); SPA's formula has 2.7' there. Higher up it ends: 50' below the
 * horizontal. */
static void rises_sooner_over_a_lower_horizon(void **state)
{
    (void)state;
    static const double eye_m[] = {0, 4, 10, 25, 50};
    const Geodetic      place = {0.1, 0, 0};
    for (int n = 0; n < 5; n++) {
        const double bend = refraction_bend(REFRACTION_OPTICAL, eye_m[n], 0);
        const double dip_deg = 2 * sqrt((0.5 / 6371e3 - bend) * eye_m[n]) / rad_per_deg;
        double       down_s = mid_month_s(2026, 3) - 43200, up_s = mid_month_s(2026, 3);
        while (up_s - down_s > 1e-3) {
            const double middle_s = 0.5 * (up_s + down_s);
            if (standard_sun(middle_s, &place).elevation_rad / rad_per_deg > -dip_deg) up_s = middle_s;
            else down_s = middle_s;
        }
        const double zenith_deg = 90 - almanac_deg(up_s, &place) + 16.0 / 60;
        const double more_deg = zenith_deg - (90 + (50 + 1.76 * sqrt(eye_m[n])) / 60);
        printf("from %.0f m: %.2f' farther from the zenith than the almanac's\n", eye_m[n], 60 * more_deg);
        CHECK(fabs(more_deg) < 0.02 + (0.5 + 0.45 * sqrt(eye_m[n])) / 60);
    }
}

/* The first second is 1900-01-01T00:00Z (NTP's epoch: 2208988800 s before Unix's), the last one 2100-12-31T23:59:59Z.
 */
static void limits_are_inclusive_where_they_say(void **state)
{
    (void)state;
    const Geodetic place = {0.6, 0, 0};
    Sun            sun;
    CHECK(sun_at(&sun, -2208988800.0, &place, 1013, 15, NAN) == STATUS_OK);
    CHECK(sun_at(&sun, -2208988801.0, &place, 1013, 15, NAN) == STATUS_BAD_VALUE);
    CHECK(sun_at(&sun, 4133980799.0, &place, 1013, 15, NAN) == STATUS_OK);
    CHECK(sun_at(&sun, 4133980800.0, &place, 1013, 15, NAN) == STATUS_BAD_VALUE);
    CHECK(sun_at(&sun, 0, &place, 1200, 15, NAN) == STATUS_OK && sun_at(&sun, 0, &place, 0, 15, NAN) == STATUS_OK);
    CHECK(sun_at(&sun, 0, &place, 1200.5, 15, NAN) == STATUS_BAD_VALUE);
    CHECK(sun_at(&sun, 0, &place, -0.5, 15, NAN) == STATUS_BAD_VALUE);
    CHECK(sun_at(&sun, 0, &place, 1013, -149.5, NAN) == STATUS_OK &&
          sun_at(&sun, 0, &place, 1013, 99.5, NAN) == STATUS_OK);
    CHECK(sun_at(&sun, 0, &place, 1013, -150, NAN) == STATUS_BAD_VALUE);
    CHECK(sun_at(&sun, 0, &place, 1013, 100, NAN) == STATUS_BAD_VALUE);
    CHECK(sun_at(&sun, 0, &place, 1013, 15, 1000) == STATUS_OK &&
          sun_at(&sun, 0, &place, 1013, 15, -1000) == STATUS_OK);
    CHECK(sun_at(&sun, 0, &place, 1013, 15, 1000.5) == STATUS_BAD_VALUE);
}

static void bad_input(void **state)
{
    (void)state;
    const Geodetic place = {0.6, 0, 0};
    Sun            sun = {.azimuth_rad = 42};
    CHECK(sun_at(&sun, NAN, &place, 1013, 15, NAN) == STATUS_BAD_VALUE);
    CHECK(sun_at(&sun, 1e12, &place, 1013, 15, NAN) == STATUS_BAD_VALUE);
    CHECK(sun_at(&sun, -1e12, &place, 1013, 15, NAN) == STATUS_BAD_VALUE);
    CHECK(sun_at(&sun, 0, &(Geodetic){NAN, 0, 0}, 1013, 15, NAN) == STATUS_BAD_VALUE);
    CHECK(sun_at(&sun, 0, &(Geodetic){2, 0, 0}, 1013, 15, NAN) == STATUS_BAD_VALUE);
    CHECK(sun_at(&sun, 0, &place, NAN, 15, NAN) == STATUS_BAD_VALUE);
    CHECK(sun_at(&sun, 0, &place, 1013, -273, NAN) == STATUS_BAD_VALUE);
    CHECK(sun_at(&sun, 0, &place, 1013, 15, INFINITY) == STATUS_BAD_VALUE);
    CHECK(sun.azimuth_rad == 42);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nrel_vector),
        cmocka_unit_test(agrees_with_the_almanac),
        cmocka_unit_test(known_places_and_days),
        cmocka_unit_test(no_jump_at_the_ends_of_the_table),
        cmocka_unit_test(delta_t_before_utc_is_the_almanacs),
        cmocka_unit_test(delta_t_of_utc_follows_leap_seconds),
        cmocka_unit_test(delta_t_after_the_leap_seconds),
        cmocka_unit_test(refraction_ends_with_the_disc),
        cmocka_unit_test(rises_and_sets_by_the_almanac),
        cmocka_unit_test(rises_sooner_over_a_lower_horizon),
        cmocka_unit_test(limits_are_inclusive_where_they_say),
        cmocka_unit_test(bad_input),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
