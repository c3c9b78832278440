/* sensor/node/scene_rate.h: image motion of the point that the camera is aimed at, for smear and line timing. */
#ifndef SENSOR_NODE_SCENE_RATE_H
#define SENSOR_NODE_SCENE_RATE_H

#include "pitviper.h"

/* Rate of turn between two attitudes step_s apart, in the camera's own axes, rad/s. Second order in the angle
 * turned. */
void turn_rate(double w_cam_rps[3], const double r_world_from_before[9], const double r_world_from_after[9],
               double step_s);

/* px/s (column, row) at the image centre, of a stationary point at range_m on the boresight; not finite: far away.
 * One rate for the whole image: roll, and nearer or farther points, move differently. tests/sensor/test_scene_rate.c */
void scene_rate(double rate_px_s[2], const double w_cam_rps[3], const double v_cam_mps[3], double focal_px,
                double range_m);

#endif
