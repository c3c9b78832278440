/* render/scene/upright.c: axes of a camera from its viewing direction and its up direction. */
#include "render/scene/upright.h"

void camera_topped(double r_enu_from_cam[9], const double d_enu[3], const double top_enu[3])
{
    double right[3], down[3];
    v3_cross(right, d_enu, top_enu);
    v3_normalize(right, right);
    v3_cross(down, d_enu, right);
    for (int i = 0; i < 3; i++) {
        r_enu_from_cam[3 * i]     = right[i];
        r_enu_from_cam[3 * i + 1] = down[i];
        r_enu_from_cam[3 * i + 2] = d_enu[i];
    }
}

bool camera_near_vertical(const double d_enu[3]) { return !(hypot(d_enu[0], d_enu[1]) > sin(camera_vertical_rad)); }

void camera_upright(double r_enu_from_cam[9], const double d_enu[3])
{
    static const double north[3] = {0, 1, 0}, up[3] = {0, 0, 1};
    double              d[3] = {d_enu[0], d_enu[1], d_enu[2]};
    /* what is unit to rounding keeps its bits */
    if (!(fabs(v3_dot(d, d) - 1) <= 1e-14) && !v3_normalize(d, d)) memcpy(d, north, sizeof d);
    camera_topped(r_enu_from_cam, d, camera_near_vertical(d) ? north : up);
}
