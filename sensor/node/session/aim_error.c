/* sensor/node/session/aim_error.c: how a sensor misses its aim, and the camera that does. */
#include "sensor/node/session/aim_error.h"

enum { offset_stream = 31, walk_stream = 32 };

static uint64_t number_of(DisEntityId id)
{
    return (uint64_t)id.site << 32 | (uint64_t)id.application << 16 | (uint64_t)id.entity;
}

double aim_walk_rad(uint64_t seed, uint64_t who, int axis, double sigma_rad, double tau_s, double t_s)
{
    enum { a_tau = 4, reach = 3 * a_tau };
    /* of the squares of the weights, which for so narrow a step is their integral: tau / 2 sqrt(pi) a step */
    const double scale = sigma_rad / sqrt(0.5 * a_tau * sqrt(pi_rad)), at = t_s / tau_s * a_tau;
    const double first = floor(at) - reach;
    double       sum = 0;
    if (!(sigma_rad > 0) || !isfinite(at) || fabs(at) > 1e15) return 0;
    for (int k = 0; k <= 2 * reach + 1; k++) {
        const double tick = first + k, u = (at - tick) / a_tau;
        sum += exp(-2 * u * u) *
               random_normal(seed, walk_stream, (uint32_t)axis, who * 0x9e3779b97f4a7c15u + (uint64_t)(int64_t)tick);
    }
    return scale * sum;
}

void aim_error_at(double tangent[2], const Config *config, DisEntityId who, double t_s)
{
    const double half = tan(0.5 * config->sensor.hfov_deg * rad_per_deg);
    const double side[2] = {2 * half, 2 * half * config->sensor.height_px / config->sensor.width_px};
    AimOffset    offset = {0};
    aim_offset_parse(&offset, config->sensor.aim_offset);
    for (int k = 0; k < 2; k++) {
        const double walk_rad = aim_walk_rad((uint64_t)config->seed, number_of(who), k,
                                             config->sensor.walk_deg * rad_per_deg, config->sensor.walk_s, t_s);
        double       at = offset.at[k];
        if (offset.drawn)
            at *= 2 * random_uniform((uint64_t)config->seed, offset_stream, (uint32_t)k, number_of(who)) - 1;
        tangent[k] = (offset.degrees ? tan(at * rad_per_deg) : at * side[k]) + tan(clamp(walk_rad, -1, 1));
    }
}

void aim_error_turn(double r_enu_from_cam[9], const double tangent[2])
{
    double n[3] = {tangent[0], tangent[1], 1}, turn[9], out[9];
    if (tangent[0] == 0 && tangent[1] == 0) return;
    v3_normalize(n, n);
    /* the shortest turn from (0, 0, 1) to n (Rodrigues): I + [w] + [w]^2 / (1 + n_z), w = (-n_y, n_x, 0); the new axes
     * in the old ones are its transpose */
    const double k = 1 / (1 + n[2]);
    const double r[9] = {
        1 - k * n[0] * n[0], -k * n[0] * n[1], n[0], -k * n[0] * n[1], 1 - k * n[1] * n[1], n[1], -n[0], -n[1], n[2]};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) turn[3 * i + j] = r[3 * j + i];
    m3_mul(out, r_enu_from_cam, turn);
    memcpy(r_enu_from_cam, out, sizeof out);
}
