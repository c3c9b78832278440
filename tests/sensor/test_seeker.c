/* The gimbal: limits, rate, lag; the camera: upright, right is right. */
#include "tests/check.h"

#include "entities/motion/dead_reckoning.h"
#include "sensor/node/session/seeker_private.h"
#include "terrain/earth/geodesy.h"
#include "tests/sensor/attitude.h"

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

/* Either axis, either way: after n ticks of 1/100 s a share exp(-n / (100 lag)) of a step is left. Steps of different
 * sizes tell the axes apart. */
static void both_axes_follow_with_the_lag(void **state)
{
    (void)state;
    for (int way = -1; way <= 1; way += 2) {
        Seeker s = head(170, 1e4, 0.25);
        double d[3];
        look(d, 0, 0);
        seeker_step(&s, d);
        look(d, way * 12, way * -8);
        for (int i = 0; i < 10; i++) seeker_step(&s, d);
        CHECK_NEAR(s.azimuth_rad / rad_per_deg, way * 12 * (1 - exp(-0.4)), 1e-9);
        CHECK_NEAR(s.elevation_rad / rad_per_deg, way * -8 * (1 - exp(-0.4)), 1e-9);
    }
}

/* Either axis alone and both together, either way: 0.1 s at 30 deg/s are 3 degrees on each. The lag does not add to a
 * turn that the rate bounds: what is left of 20 degrees in a tick of lag 0.03 s would be 5.7. */
static void both_axes_keep_to_the_rate(void **state)
{
    (void)state;
    static const double lag_s[2] = {0, 0.03}, step[3][2] = {{20, 0}, {0, 20}, {20, -20}};
    for (int k = 0; k < 12; k++) {
        const int    way = k % 2 ? 1 : -1;
        const double azimuth = way * step[k / 2 % 3][0], elevation = way * step[k / 2 % 3][1];
        Seeker       s = head(170, 30, lag_s[k / 6]);
        double       d[3];
        look(d, 0, 0);
        seeker_step(&s, d);
        look(d, azimuth, elevation);
        for (int i = 0; i < 10; i++) seeker_step(&s, d);
        CHECK_NEAR(s.azimuth_rad / rad_per_deg, azimuth == 0 ? 0 : copysign(3, azimuth), 1e-9);
        CHECK_NEAR(s.elevation_rad / rad_per_deg, elevation == 0 ? 0 : copysign(3, elevation), 1e-9);
    }
}

/* An aim that passes behind is followed the short way, through 180 degrees. */
static void it_follows_through_behind(void **state)
{
    (void)state;
    for (int way = -1; way <= 1; way += 2) {
        Seeker s = head(180, 100, 0);
        double d[3];
        look(d, way * 175, 0);
        seeker_step(&s, d);
        look(d, way * -175, 0);
        for (int i = 0; i < 3; i++) seeker_step(&s, d);
        CHECK_NEAR(s.azimuth_rad / rad_per_deg, way * 178, 1e-9);
        for (int i = 0; i < 5; i++) seeker_step(&s, d);
        CHECK_NEAR(s.azimuth_rad / rad_per_deg, way * -177, 1e-9);
    }
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
    CHECK_NEAR(s.azimuth_rad / rad_per_deg, 15, 1e-9);   /* 0.5 s at 30 deg/s */
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
        r_enu_from_body[3 * i] = x[i];
        r_enu_from_body[3 * i + 1] = c * y[i] + s * z[i];
        r_enu_from_body[3 * i + 2] = -s * y[i] + c * z[i];
    }
}

static void the_picture_is_upright_whatever_the_body_does(void **state)
{
    (void)state;
    for (double heading = 0; heading < 360; heading += 45)
        for (double roll = -180; roll <= 180; roll += 60) {
            Seeker       s = head(60, 1e4, 0);
            double       r_enu_from_body[9], r[9], d[3];
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
        view_upright(r, d);
        CHECK_NEAR(r[4], -1, 1e-15); /* the picture's down is south: its top is north */
        const double x[3] = {r[0], r[3], r[6]}, y[3] = {r[1], r[4], r[7]};
        double       z[3];
        v3_cross(z, x, y);
        CHECK_NEAR(z[2], sign, 1e-15);
    }
}

/* Any length, and none: a rotation that looks along it. */
static void a_direction_may_have_any_length(void **state)
{
    (void)state;
    static const double lengths[] = {1e-150, 1e-9, 0.3, 1, 650, 6.4e6, 1e150};
    static const double d[3] = {0.48, -0.6, 0.64};
    double              want[9], got[9];
    view_upright(want, d);
    for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) {
        double longer[3];
        v3_scale(longer, lengths[i], d);
        view_upright(got, longer);
        for (int k = 0; k < 9; k++) CHECK_NEAR(got[k], want[k], 1e-15);
    }
    const double none[][3] = {{0, 0, 0}, {NAN, 0, 0}, {INFINITY, 1, 0}};
    for (int i = 0; i < 3; i++) {
        double unit[9];
        view_upright(got, none[i]);
        m3_tmul(unit, got, got);
        for (int k = 0; k < 9; k++) CHECK_NEAR(unit[k], k % 4 == 0, 1e-15);
    }
}

/* Attitude in ENU as a PDU brings it: three angles in float32, at 48 N 11 E. */
static void as_sent(double r_enu_from_body[9], const double meant[9])
{
    const Geodetic place = {48 * rad_per_deg, 11 * rad_per_deg, 0};
    LocalFrame     frame;
    double         r_ecef[9], psi, theta, phi;
    CHECK(local_frame_at(&frame, &place) == STATUS_OK);
    m3_mul(r_ecef, frame.r_ecef_from_enu, meant);
    euler_from_r_ecef_from_body(&psi, &theta, &phi, r_ecef);
    r_ecef_from_body_euler(r_ecef, (float)psi, (float)theta, (float)phi);
    m3_tmul(r_enu_from_body, frame.r_ecef_from_enu, r_ecef);
}

static void tick(double cam[9], Seeker *s, const double r_enu_from_body[9])
{
    static const double ahead[3] = {1, 0, 0};
    seeker_step(s, ahead);
    seeker_roll(s, r_enu_from_body);
    seeker_camera(cam, s, r_enu_from_body);
}

/* Angle between the tops of two pictures that look the same way but for 1e-3 rad. */
static double roll_between(const double a[9], const double b[9])
{
    const double x = a[1] * b[1] + a[4] * b[4] + a[7] * b[7], y = a[0] * b[1] + a[3] * b[4] + a[6] * b[7];
    return atan2(y, x);
}

/* A munition that falls nose down, its angles good to float32: each report's nose points another 1e-7 rad off the
 * vertical, to any side. The picture keeps its top, which is where the munition's back was. */
static void a_vertical_dive_does_not_roll(void **state)
{
    (void)state;
    for (double heading = 0.1; heading < 6.2; heading += 0.7)
        for (double spin = -1; spin <= 1; spin++) { /* rad/s about the nose: the picture does not take part */
            Seeker s = head(60, 1e4, 0.03);
            double cam[9], first[9], meant[9], r[9], most = 0, directions = 0;
            for (int k = 0; k < 400; k++) {
                const double lean = 3e-7 * sin(1.7 * k), roll = spin * 0.01 * k;
                test_attitude(meant, heading + lean, -0.5 * pi_rad + 3e-7 * cos(0.9 * k), roll);
                as_sent(r, meant);
                tick(cam, &s, r);
                if (k == 0) {
                    memcpy(first, cam, sizeof first);
                    for (int i = 0; i < 3; i++)
                        CHECK_NEAR(cam[3 * i + 1], meant[3 * i + 2], 1e-5); /* down is its belly's */
                }
                most = fmax(most, fabs(roll_between(first, cam)));
                directions = fmax(directions, fabs(remainder(atan2(r[0], r[3]) - heading, 2 * pi_rad)));
            }
            CHECK(directions > 1); /* rad: what the heading of the nose did meanwhile */
            CHECK(most < 2e-6);
        }
}

/* Over the top: from a dive at 80 degrees through the vertical and out on the other side. Upright turns round by half a
 * turn at once; the picture turns at its rate, and is upright again. A little beside the vertical, too. */
static void a_dive_through_the_vertical_rolls_steadily(void **state)
{
    (void)state;
    for (double beside = 0; beside < 3e-3; beside += 7e-4) {
        Seeker s = head(60, 1e4, 0);
        double cam[9], before[9], r[9], upright[9], most = 0;
        for (int k = 0; k <= 600; k++) {
            const double pitch = (-80 - fmin(20, 0.1 * k)) * rad_per_deg;
            const double x[3] = {sin(beside), cos(pitch) * cos(beside), sin(pitch) * cos(beside)};
            view_upright(cam, x); /* any body with that nose */
            for (int i = 0; i < 3; i++)
                r[3 * i] = cam[3 * i + 2], r[3 * i + 1] = cam[3 * i], r[3 * i + 2] = cam[3 * i + 1];
            tick(cam, &s, r);
            if (k > 0) most = fmax(most, fabs(roll_between(before, cam)));
            memcpy(before, cam, sizeof before);
            view_upright(upright, x);
        }
        CHECK(most <= seeker_roll_rps / seeker_ticks_per_s * 1.01 + 2e-3); /* and the turn of the boresight about it */
        for (int k = 0; k < 9; k++) CHECK_NEAR(cam[k], upright[k], 1e-12);
    }
}

/* Out of the cone of the vertical the picture is upright, and what float32 leaves of the roll is 0.05 px of 434. */
static void beside_the_vertical_the_picture_is_upright(void **state)
{
    (void)state;
    for (double off = 1.05 * camera_vertical_rad; off < 0.1; off *= 1.3)
        for (double heading = 0; heading < 6.2; heading += 0.3) {
            Seeker s = head(60, 1e4, 0);
            double cam[9], exact[9], meant[9], r[9], d[3];
            test_attitude(meant, heading, -0.5 * pi_rad + off, 0.3);
            for (int i = 0; i < 3; i++) d[i] = meant[3 * i];
            view_upright(exact, d);
            as_sent(r, meant);
            tick(cam, &s, r);
            CHECK(fabs(roll_between(exact, cam)) * 434 < 0.1 * camera_vertical_rad / off);
        }
}

/* The first look of a head that hangs below an aircraft: the top is where its nose is. */
static void the_first_look_down_has_the_nose_on_top(void **state)
{
    (void)state;
    static const double below[3] = {0, 0, 1};
    for (double heading = 0; heading < 6.2; heading += 0.4) {
        Seeker s = head(120, 1e4, 0);
        double cam[9], r[9];
        test_attitude(r, heading, 0, 0);
        seeker_step(&s, below);
        seeker_roll(&s, r);
        seeker_camera(cam, &s, r);
        for (int i = 0; i < 3; i++) CHECK_NEAR(-cam[3 * i + 1], r[3 * i], 1e-9);
    }
}

/* sensor.mount_roll_deg: right side down. */
static void the_picture_may_be_held_rolled(void **state)
{
    (void)state;
    Seeker s = head(60, 1e4, 0);
    double cam[9], r[9];
    s.config.roll_rad = 0.4;
    test_attitude(r, 0, 0, 0.9);
    tick(cam, &s, r);
    const double want[9] = {cos(0.4), -sin(0.4), 0, 0, 0, 1, -sin(0.4), -cos(0.4), 0};
    for (int k = 0; k < 9; k++) CHECK_NEAR(cam[k], want[k], 1e-12);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_starts_locked_and_follows_with_its_lag),
        cmocka_unit_test(both_axes_follow_with_the_lag),
        cmocka_unit_test(both_axes_keep_to_the_rate),
        cmocka_unit_test(it_follows_through_behind),
        cmocka_unit_test(it_turns_no_faster_than_its_rate),
        cmocka_unit_test(it_stops_at_its_limit_in_the_plane_of_the_aim),
        cmocka_unit_test(the_picture_is_upright_whatever_the_body_does),
        cmocka_unit_test(straight_up_and_down_still_give_a_camera),
        cmocka_unit_test(a_direction_may_have_any_length),
        cmocka_unit_test(a_vertical_dive_does_not_roll),
        cmocka_unit_test(a_dive_through_the_vertical_rolls_steadily),
        cmocka_unit_test(beside_the_vertical_the_picture_is_upright),
        cmocka_unit_test(the_first_look_down_has_the_nose_on_top),
        cmocka_unit_test(the_picture_may_be_held_rolled),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
