/* sensor/node/session/seeker_private.h: the sensor on its host: where it is mounted, the gimbal that points it, and how
 * fast its image moves. */
#ifndef SENSOR_NODE_SESSION_SEEKER_PRIVATE_H
#define SENSOR_NODE_SESSION_SEEKER_PRIVATE_H

#include "entities/table/snapshot.h"
#include "render/scene/view.h"
#include "sensor/settings/config.h"

/* ---- the mount -------------------------------------------------------------------------------------- */

/* Position and axis of the sensor on its host (sensor.mount*).
 *
 * By default (`auto`) the sensor of a munition is in its nose, that of a platform 0.3 m above its roof, and the axis
 * is the body's forward axis. sensor.mount names an articulated part instead, by the name of a node or part of the
 * host's model, by its name in SISO-REF-010 (`primary turret`, `secondary gun 2`; without a number the first) or by
 * the number of its class: the sensor then moves with that part, its position is given from the part's pivot, in the
 * part's axes.
 *
 *     mount_x_m, mount_y_m, mount_z_m     forward, right, down; from the body's origin (centre of its base) or the
 *                                         part's pivot. Not given: of `auto` as above, of a part 0
 *     mount_yaw_deg, mount_pitch_deg      turn the axis of the gimbal, right and up, in this order
 *     mount_roll_deg                      turns the image about the boresight, its right side down: the image is
 *                                         roll-stabilised to this angle */
typedef struct Mount {
    bool   on_part; /* not auto */
    char   part[48];
    double offset_m[3]; /* NaN: not given */
    double r_base_from_mount[9];
} Mount;

enum { mount_body = -1, mount_missing = -2 };

Mount seeker_mount(const Config *config);
/* The node of a model that the sensor moves with. mount_body: the body itself; mount_missing: there is no such part. */
int seeker_mount_node(const Mount *mount, const Model *model);
/* Finds the class number of an articulated part from its words or number; 0: it is neither. */
uint32_t seeker_mount_class(const char *part);
/* Sensor position and mount axes. node: the poses of the host's nodes; at: the result of seeker_mount_node, negative
 * for the body. */
void seeker_mount_place(double p_ecef[3], double r_ecef_from_mount[9], const Mount *mount, const SnapshotEntity *host,
                        const Model *model, const NodePose *node, int at);

/* ---- the gimbal ------------------------------------------------------------------------------------- */

/* A notional seeker head: a gimbal on a body that tracks an aim point.
 *
 * Two axes on the body (or on the mount): azimuth about its z (positive to the right), then
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

enum { seeker_ticks_per_s = 100 };

static const double seeker_roll_rps = 1.5707963267948966; /* 90 deg/s; estimate: roll gimbals of public data sheets
                                                           * reach 60 .. 200 */

typedef struct SeekerConfig {
    double limit_rad, rate_rps, lag_s;
    double roll_rad; /* of the image about the boresight, against upright: its right side down */
} SeekerConfig;

typedef struct Seeker {
    SeekerConfig config;
    bool         started;
    double       azimuth_rad, elevation_rad;
    double       off_rad;  /* of the aim, off the axis */
    bool         at_limit; /* the aim is outside the cone the gimbal reaches */
    bool         top_known, upright;
    double       top_enu[3]; /* of the image without config.roll_rad, at the last tick; unit */
} Seeker;

/* One tick towards a direction in body axes. The first call points there at once, as a head that is
 * locked on before launch. An aim that is not finite leaves the gimbal where it is. */
void seeker_step(Seeker *seeker, const double d_body[3]);
/* Computes the roll at the same tick; call it after seeker_step. */
void seeker_roll(Seeker *seeker, const double r_enu_from_body[9]);

/* Camera axes of the present gimbal angles: r_enu_from_cam, for a body whose attitude is r_enu_from_body. Upright where
 * seeker_roll was never called. */
void seeker_camera(double r_enu_from_cam[9], const Seeker *seeker, const double r_enu_from_body[9]);

/* ---- image motion of the point that the camera is aimed at, for smear and line timing --------------- */

/* Rate of turn between two attitudes step_s apart, in the camera's own axes, rad/s. Second order in the angle
 * turned. */
void seeker_turn_rate(double w_cam_rps[3], const double r_world_from_before[9], const double r_world_from_after[9],
                      double step_s);

/* px/s (column, row) at the image centre, of a stationary point at range_m on the boresight; not finite: far away.
 * One rate for the whole image: roll, and nearer or farther points, move differently. tests/sensor/test_scene_rate.c */
void seeker_scene_rate(double rate_px_s[2], const double w_cam_rps[3], const double v_cam_mps[3], double focal_px,
                       double range_m);

#endif
