/* sensor/node/seeker.h: a notional seeker head: a gimbal on a body that tracks an aim point.
 *
 * Two axes on the body (or on the mount, sensor/node/mount.h): azimuth about its z (positive to the right), then
 * elevation about the rotated y (positive up), with a limit on the angle off its axis, a rate limit and a first-order
 * lag. The image is roll-stabilised: its columns stay in the vertical plane of the boresight. The gimbal moves on a
 * fixed grid of exercise time, so its direction at t does not depend on which frames are rendered.
 *
 * Near the vertical that plane is ill-conditioned: the roll of the image is the error of the boresight over the
 * angle to the vertical, and an attitude in float32 (as DIS sends it) has steps of 2.4e-7 rad. Within
 * camera_vertical_rad of straight up or down the image therefore keeps its up direction, carried along without roll,
 * and outside it turns back to upright no faster than seeker_roll_rps, the short way. A head that starts within this
 * cone has its up direction towards the body's nose, or, when it points along the nose, towards the body's top.
 * Outside, three angles that are each wrong by half such a step (2e-7 rad together) roll the image by 1e-4 rad at
 * most, 0.04 px at the corner of 720 x 486. tests/sensor/test_seeker.c */
#ifndef SENSOR_NODE_SEEKER_H
#define SENSOR_NODE_SEEKER_H

#include "render/scene/upright.h"

enum { seeker_ticks_per_s = 100 };

static const double seeker_roll_rps = 1.5707963267948966; /* 90 deg/s; estimate: roll gimbals of public data sheets
                                                           * reach 60 .. 200 */

typedef struct SeekerConfig {
    double limit_rad, rate_rps, lag_s;
    double roll_rad;      /* of the image about the boresight, against upright: its right side down */
} SeekerConfig;

typedef struct Seeker {
    SeekerConfig config;
    bool         started;
    double       azimuth_rad, elevation_rad;
    double       off_rad;     /* of the aim, off the axis */
    bool         at_limit;    /* the aim is outside the cone the gimbal reaches */
    bool         top_known, upright;
    double       top_enu[3];  /* of the image without config.roll_rad, at the last tick; unit */
} Seeker;

/* One tick towards a direction in body axes. The first call points there at once, as a head that is
 * locked on before launch. An aim that is not finite leaves the gimbal where it is. */
void seeker_step(Seeker *seeker, const double d_body[3]);
/* The roll at the same tick: call after seeker_step. */
void seeker_roll(Seeker *seeker, const double r_enu_from_body[9]);

/* Camera axes of the present gimbal angles: r_enu_from_cam, for a body whose attitude is r_enu_from_body. Upright where
 * seeker_roll was never called. */
void seeker_camera(double r_enu_from_cam[9], const Seeker *seeker, const double r_enu_from_body[9]);

#endif
