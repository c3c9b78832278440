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

void camera_upright(double r_enu_from_cam[9], const double d_enu[3])
{
    double right[3] = {d_enu[1], -d_enu[0], 0}, down[3]; /* d x up */
    if (!(hypot(right[0], right[1]) > 1e-9) || !v3_normalize(right, right)) {
        right[0] = d_enu[2] > 0 ? -1 : 1; /* the top is north: right is west looking up, east looking down */
        right[1] = right[2] = 0;
    }
    v3_cross(down, d_enu, right);
    for (int i = 0; i < 3; i++) {
        r_enu_from_cam[3 * i]     = right[i];
        r_enu_from_cam[3 * i + 1] = down[i];
        r_enu_from_cam[3 * i + 2] = d_enu[i];
    }
}

void seeker_camera(double r_enu_from_cam[9], const Seeker *seeker, const double r_enu_from_body[9])
{
    double d_body[3], d_enu[3];
    direction(d_body, seeker->azimuth_rad, seeker->elevation_rad);
    m3_mul_v3(d_enu, r_enu_from_body, d_body);
    v3_normalize(d_enu, d_enu);
    camera_upright(r_enu_from_cam, d_enu);
}
