/* sensor/node/scene_rate.c: image motion of the point that the camera is aimed at. */
#include "sensor/node/scene_rate.h"

void turn_rate(double w_cam_rps[3], const double r_world_from_before[9], const double r_world_from_after[9],
               double step_s)
{
    double turn[9];
    m3_tmul(turn, r_world_from_before, r_world_from_after);
    w_cam_rps[0] = (turn[7] - turn[5]) / (2 * step_s);
    w_cam_rps[1] = (turn[2] - turn[6]) / (2 * step_s);
    w_cam_rps[2] = (turn[3] - turn[1]) / (2 * step_s);
}

void scene_rate(double rate_px_s[2], const double w_cam_rps[3], const double v_cam_mps[3], double focal_px,
                double range_m)
{
    /* a point at (0, 0, range) goes by -w x p - v */
    const double nearness = isfinite(range_m) && range_m > 1 ? 1 / range_m : 0;
    rate_px_s[0] = focal_px * (-w_cam_rps[1] - v_cam_mps[0] * nearness);
    rate_px_s[1] = focal_px * (w_cam_rps[0] - v_cam_mps[1] * nearness);
}
