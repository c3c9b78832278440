/* sensor/node/seeker.h: a notional seeker head: a gimbal on a body, that follows an aim point.
 *
 * Two axes on the body: azimuth about body z (positive to the right), then elevation about the turned y
 * (positive up), with a limit on the angle off the body axis, a rate limit and a first-order lag. The
 * picture is roll-stabilised: its columns stay in the vertical plane of the boresight. The gimbal moves on a
 * fixed grid of exercise time, so where it points at t does not depend on which frames are made. */
#ifndef SENSOR_NODE_SEEKER_H
#define SENSOR_NODE_SEEKER_H

#include "pitviper.h"

enum { seeker_ticks_per_s = 100 };

typedef struct SeekerConfig {
    double limit_rad, rate_rps, lag_s;
} SeekerConfig;

typedef struct Seeker {
    SeekerConfig config;
    bool         started;
    double       azimuth_rad, elevation_rad;
    bool         at_limit; /* the aim is outside the cone the gimbal reaches */
} Seeker;

/* One tick towards a unit direction in body axes. The first call points there at once, as a head that is
 * locked on before launch. An aim that is not finite leaves the gimbal where it is. */
void seeker_step(Seeker *seeker, const double d_body[3]);

/* Camera axes of the present gimbal angles: r_enu_from_cam, for a body whose attitude is r_enu_from_body. */
void seeker_camera(double r_enu_from_cam[9], const Seeker *seeker, const double r_enu_from_body[9]);

/* Camera looking along a unit direction, upright in ENU; straight up or down, the top is north. */
void camera_upright(double r_enu_from_cam[9], const double d_enu[3]);

#endif
