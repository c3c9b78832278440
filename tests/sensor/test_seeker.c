/* The gimbal: limits, rate, lag; the camera: upright, right is right. */
#include "tests/check.h"

#include "sensor/node/seeker.h"

static Seeker head(double limit_deg, double rate_dps, double lag_s)
{
    return (Seeker){.config = {limit_deg * rad_per_deg, rate_dps * rad_per_deg, lag_s}};
}

static void look(double d_body[3], double azimuth_deg, double elevation_deg)
{
    const double a = azimuth_deg * rad_per_deg, e = elevation_deg * rad_per_deg;
    d_body[0] = cos(e) * cos(a), d_body[1] = cos(e) * sin(a), d_body[2] = -sin(e);
}

static void it_starts_locked_and_follows_with_its_lag(void **state)
{
    (void)state;
    Seeker s = head(60, 1e4, 0.1);
    double d[3];
    look(d, 10, -5);
    seeker_step(&s, d);
    CHECK_NEAR(s.azimuth_rad / rad_per_deg, 10, 1e-12);
    CHECK_NEAR(s.elevation_rad / rad_per_deg, -5, 1e-12);
    look(d, 20, -5);
    for (int i = 0; i < 10; i++) seeker_step(&s, d); /* one time constant */
    CHECK_NEAR(s.azimuth_rad / rad_per_deg, 20 - 10 * exp(-1), 1e-9);
}

static void it_turns_no_faster_than_its_rate(void **state)
{
    (void)state;
    Seeker s = head(60, 30, 0);
    double d[3];
    look(d, 0, 0);
    seeker_step(&s, d);
    look(d, 40, 10);
    for (int i = 0; i < 50; i++) seeker_step(&s, d);
    CHECK_NEAR(s.azimuth_rad / rad_per_deg, 15, 1e-9);  /* 0.5 s at 30 deg/s */
    CHECK_NEAR(s.elevation_rad / rad_per_deg, 10, 1e-9); /* there already */
}

static void it_stops_at_its_limit_in_the_plane_of_the_aim(void **state)
{
    (void)state;
    Seeker s = head(30, 1e4, 0);
    double d[3], want[3], got[3];
    look(d, 60, 40);
    seeker_step(&s, d);
    CHECK(s.at_limit);
    look(got, s.azimuth_rad / rad_per_deg, s.elevation_rad / rad_per_deg);
    CHECK_NEAR(acos(got[0]) / rad_per_deg, 30, 1e-9);
    CHECK_NEAR(atan2(got[1], -got[2]), atan2(d[1], -d[2]), 1e-12);
    look(d, 5, 5);
    seeker_step(&s, d);
    look(want, 5, 5);
    CHECK(!s.at_limit);
    d[0] = NAN;
    seeker_step(&s, d); /* stays */
    look(got, s.azimuth_rad / rad_per_deg, s.elevation_rad / rad_per_deg);
    for (int k = 0; k < 3; k++) CHECK_NEAR(got[k], want[k], 1e-12);
    const double behind[3] = {-1, 0, 0};
    seeker_step(&s, behind); /* no direction to prefer, and no NaN */
    CHECK(s.at_limit && isfinite(s.azimuth_rad) && isfinite(s.elevation_rad));
}

/* Body axes in ENU for a heading: x forward, y right, z down; then roll about x. */
static void body_axes(double r_enu_from_body[9], double heading_deg, double roll_deg)
{
    const double h = heading_deg * rad_per_deg, c = cos(roll_deg * rad_per_deg), s = sin(roll_deg * rad_per_deg);
    const double x[3] = {sin(h), cos(h), 0}, y[3] = {cos(h), -sin(h), 0}, z[3] = {0, 0, -1};
    for (int i = 0; i < 3; i++) {
        r_enu_from_body[3 * i]     = x[i];
        r_enu_from_body[3 * i + 1] = c * y[i] + s * z[i];
        r_enu_from_body[3 * i + 2] = -s * y[i] + c * z[i];
    }
}

static void the_picture_is_upright_whatever_the_body_does(void **state)
{
    (void)state;
    for (double heading = 0; heading < 360; heading += 45)
        for (double roll = -180; roll <= 180; roll += 60) {
            Seeker s = head(60, 1e4, 0);
            double r_enu_from_body[9], r[9], d[3];
            const double ahead[3] = {1, 0, 0};
            body_axes(r_enu_from_body, heading, roll);
            seeker_step(&s, ahead);
            seeker_camera(r, &s, r_enu_from_body);
            /* looking along the heading: right is 90 degrees clockwise of it, down is down */
            const double h = heading * rad_per_deg;
            const double want[9] = {cos(h), 0, sin(h), -sin(h), 0, cos(h), 0, -1, 0};
            for (int k = 0; k < 9; k++) CHECK_NEAR(r[k], want[k], 1e-12);
            m3_mul_v3(d, r_enu_from_body, ahead);
            for (int k = 0; k < 3; k++) CHECK_NEAR(r[3 * k + 2], d[k], 1e-12);
        }
}

static void straight_up_and_down_still_give_a_camera(void **state)
{
    (void)state;
    for (int sign = -1; sign <= 1; sign += 2) {
        const double d[3] = {0, 0, sign};
        double       r[9];
        camera_upright(r, d);
        CHECK_NEAR(r[4], -1, 1e-15); /* the picture's down is south: its top is north */
        const double x[3] = {r[0], r[3], r[6]}, y[3] = {r[1], r[4], r[7]};
        double       z[3];
        v3_cross(z, x, y);
        CHECK_NEAR(z[2], sign, 1e-15);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_starts_locked_and_follows_with_its_lag),
        cmocka_unit_test(it_turns_no_faster_than_its_rate),
        cmocka_unit_test(it_stops_at_its_limit_in_the_plane_of_the_aim),
        cmocka_unit_test(the_picture_is_upright_whatever_the_body_does),
        cmocka_unit_test(straight_up_and_down_still_give_a_camera),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
