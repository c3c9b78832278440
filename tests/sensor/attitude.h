/* tests/sensor/attitude.h: an attitude from the angles that a test speaks of. */
#ifndef TESTS_SENSOR_ATTITUDE_H
#define TESTS_SENSOR_ATTITUDE_H

#include "pitviper.h"

/* In ENU: heading clockwise from north, pitch up, roll right side down. */
static inline void test_attitude(double r_enu_from_body[9], double heading_rad, double pitch_rad, double roll_rad)
{
    const double sh = sin(heading_rad), ch = cos(heading_rad), sp = sin(pitch_rad), cp = cos(pitch_rad);
    const double x[3] = {sh * cp, ch * cp, sp}, y[3] = {ch, -sh, 0};
    double       z[3];
    v3_cross(z, x, y);
    for (int i = 0; i < 3; i++) {
        r_enu_from_body[3 * i] = x[i];
        r_enu_from_body[3 * i + 1] = cos(roll_rad) * y[i] + sin(roll_rad) * z[i];
        r_enu_from_body[3 * i + 2] = cos(roll_rad) * z[i] - sin(roll_rad) * y[i];
    }
}

#endif
