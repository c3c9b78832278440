/* sensor/node/seeker.c: the gimbal: see the header. */
#include "sensor/node/seeker.h"

static void direction(double d_body[3], double azimuth_rad, double elevation_rad)
{
    d_body[0] = cos(elevation_rad) * cos(azimuth_rad);
    d_body[1] = cos(elevation_rad) * sin(azimuth_rad);
    d_body[2] = -sin(elevation_rad);
}

void seeker_step(Seeker *seeker, const double d_body[3])
{
    double d[3];
    if (!v3_is_finite(d_body) || !v3_normalize(d, d_body)) return;

    /* An aim beyond the limit: the nearest direction on the cone, in the plane of axis and aim. */
    const double off_rad = atan2(hypot(d[1], d[2]), d[0]);
    seeker->off_rad      = off_rad;
    seeker->at_limit     = off_rad > seeker->config.limit_rad;
    if (seeker->at_limit) {
        const double side = hypot(d[1], d[2]);
        const double y = side > 0 ? d[1] / side : 1, z = side > 0 ? d[2] / side : 0;
        d[0] = cos(seeker->config.limit_rad);
        d[1] = sin(seeker->config.limit_rad) * y;
        d[2] = sin(seeker->config.limit_rad) * z;
    }
    const double azimuth_rad = atan2(d[1], d[0]), elevation_rad = asin(clamp(-d[2], -1, 1));
    if (!seeker->started) {
        seeker->started       = true;
        seeker->azimuth_rad   = azimuth_rad;
        seeker->elevation_rad = elevation_rad;
        return;
    }
    static const double tick_s = 1.0 / seeker_ticks_per_s;
    const double share = seeker->config.lag_s > 0 ? -expm1(-tick_s / seeker->config.lag_s) : 1;
    const double most  = seeker->config.rate_rps * tick_s;
    seeker->azimuth_rad += clamp(share * remainder(azimuth_rad - seeker->azimuth_rad, 2 * pi_rad), -most, most);
    seeker->azimuth_rad = remainder(seeker->azimuth_rad, 2 * pi_rad);
    seeker->elevation_rad += clamp(share * (elevation_rad - seeker->elevation_rad), -most, most);
}

/* Component of a vector perpendicular to d, unit; false where it vanishes. */
static bool across(double out[3], const double v[3], const double d[3])
{
    double part[3];
    v3_add_scaled(part, v, -v3_dot(v, d), d);
    return v3_length(part) > 1e-3 && v3_normalize(out, part);
}

static void boresight(double d_enu[3], const Seeker *seeker, const double r_enu_from_body[9])
{
    double d_body[3];
    direction(d_body, seeker->azimuth_rad, seeker->elevation_rad);
    m3_mul_v3(d_enu, r_enu_from_body, d_body);
    v3_normalize(d_enu, d_enu);
}

/* The first up direction of a head that points straight up or down. */
static void first_top(double top_enu[3], const double d_enu[3], const double r_enu_from_body[9])
{
    const double nose[3] = {r_enu_from_body[0], r_enu_from_body[3], r_enu_from_body[6]};
    const double roof[3] = {-r_enu_from_body[2], -r_enu_from_body[5], -r_enu_from_body[8]};
    across(top_enu, fabs(v3_dot(nose, d_enu)) < 0.866 ? nose : roof, d_enu);
}

void seeker_roll(Seeker *seeker, const double r_enu_from_body[9])
{
    static const double up[3] = {0, 0, 1}, tick_s = 1.0 / seeker_ticks_per_s;
    double              d[3], upright[3], carried[3], side[3];
    boresight(d, seeker, r_enu_from_body);
    const bool vertical = camera_near_vertical(d);
    const bool kept     = seeker->top_known && across(carried, seeker->top_enu, d);
    seeker->upright     = !vertical;
    if (!vertical) {
        v3_add_scaled(upright, up, -v3_dot(up, d), d); /* of length above 1e-3 */
        v3_normalize(upright, upright);
    }
    if (!kept) {
        if (vertical) first_top(seeker->top_enu, d, r_enu_from_body);
        else memcpy(seeker->top_enu, upright, sizeof upright);
    } else if (vertical) {
        memcpy(seeker->top_enu, carried, sizeof carried);
    } else {
        v3_cross(side, d, carried);
        const double most = seeker_roll_rps * tick_s;
        const double turn = atan2(v3_dot(upright, side), v3_dot(upright, carried));
        if (fabs(turn) <= most) {
            memcpy(seeker->top_enu, upright, sizeof upright);
        } else {
            seeker->upright = false;
            v3_scale(carried, cos(most), carried);
            v3_add_scaled(seeker->top_enu, carried, copysign(sin(most), turn), side);
            v3_normalize(seeker->top_enu, seeker->top_enu);
        }
    }
    seeker->top_known = true;
}

void seeker_camera(double r_enu_from_cam[9], const Seeker *seeker, const double r_enu_from_body[9])
{
    double d_enu[3], top_enu[3];
    boresight(d_enu, seeker, r_enu_from_body);
    const bool upright = !seeker->top_known || (seeker->upright && !camera_near_vertical(d_enu));
    if (upright || !across(top_enu, seeker->top_enu, d_enu)) camera_upright(r_enu_from_cam, d_enu);
    else camera_topped(r_enu_from_cam, d_enu, top_enu);
    if (seeker->config.roll_rad == 0) return;
    const double c = cos(seeker->config.roll_rad), s = sin(seeker->config.roll_rad);
    for (int i = 0; i < 3; i++) {
        const double right = r_enu_from_cam[3 * i], down = r_enu_from_cam[3 * i + 1];
        r_enu_from_cam[3 * i]     = c * right + s * down;
        r_enu_from_cam[3 * i + 1] = c * down - s * right;
    }
}
