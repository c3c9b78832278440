/* render/scene/upright.h: axes of a camera, r_enu_from_cam, from its viewing direction and its up direction. */
#ifndef RENDER_SCENE_UPRIGHT_H
#define RENDER_SCENE_UPRIGHT_H

#include "pitviper.h"

static const double camera_vertical_rad = 2e-3; /* reason: sensor/node/session/seeker.h */

bool camera_near_vertical(const double d_enu[3]);

/* right = d x top: of unit vectors that are not parallel. */
void camera_topped(double r_enu_from_cam[9], const double d_enu[3], const double top_enu[3]);
/* Upright in ENU, along a direction of any length; within camera_vertical_rad of straight up or down, and along no
 * direction (zero, not finite: taken as north), the top is north. */
void camera_upright(double r_enu_from_cam[9], const double d_enu[3]);

#endif
