/* sensor/node/session/seeker.c: the sensor on its host: its mount, its gimbal, and how fast its image moves. */
#include "sensor/node/session/seeker_private.h"

#include "dis/pdu/pdu.h"

/* ---- the mount -------------------------------------------------------------------------------------- */

/* SISO-REF-010, articulated parts: classes of ten each, 32 apart. */
static const struct {
    const char *name;
    uint32_t    first;
} classes[] = {
    {"primary turret", 4096},         {"primary gun", 4416},        {"primary launcher", 4736},
    {"primary defense system", 5056}, {"primary radar", 5376},      {"secondary turret", 5696},
    {"secondary gun", 6016},          {"secondary launcher", 6336}, {"secondary defense system", 6656},
    {"secondary radar", 6976},
};
enum { class_count = sizeof classes / sizeof *classes, of_a_class = 10, class_step = 32 };

uint32_t seeker_mount_class(const char *part)
{
    long long number;
    if (text_to_long(&number, part))
        return number >= 1024 && number < 8192 && number % class_step == 0 ? (uint32_t)number : 0;
    for (int i = 0; i < class_count; i++) {
        const size_t length = strlen(classes[i].name);
        if (strncmp(part, classes[i].name, length) != 0) continue;
        if (!part[length]) return classes[i].first;
        if (part[length] == ' ' && text_to_long(&number, part + length + 1) && number >= 1 && number <= of_a_class)
            return classes[i].first + class_step * (uint32_t)(number - 1);
    }
    return 0;
}

Mount seeker_mount(const Config *config)
{
    Mount        mount = {.on_part = strcmp(config->sensor.mount, "auto") != 0,
                          .offset_m = {config->sensor.mount_x_m, config->sensor.mount_y_m, config->sensor.mount_z_m}};
    const double yaw_rad = config->sensor.mount_yaw_deg * rad_per_deg, c = cos(yaw_rad), s = sin(yaw_rad);
    const double pitch_rad = config->sensor.mount_pitch_deg * rad_per_deg, e = cos(pitch_rad), f = sin(pitch_rad);
    /* the axes turn right-handed about z (down), then about the turned y (right) */
    const double r[9] = {c * e, -s, c * f, s * e, c, s * f, -f, 0, e};
    memcpy(mount.r_base_from_mount, r, sizeof r);
    _Static_assert(sizeof mount.part == sizeof config->sensor.mount, "one name");
    memcpy(mount.part, config->sensor.mount, sizeof mount.part);
    return mount;
}

int seeker_mount_node(const Mount *mount, const Model *model)
{
    if (!mount->on_part) return mount_body;
    for (int n = 0; n < model->node_count; n++)
        if (strcmp(model->node[n].name, mount->part) == 0) return n;
    for (int i = 0; i < model->part_count; i++)
        if (strcmp(model->part[i].name, mount->part) == 0) return model->part[i].node;
    const uint32_t dis_class = seeker_mount_class(mount->part);
    for (int n = 0; dis_class && n < model->node_count; n++)
        if (model->node[n].dis_class == dis_class) return n;
    return mount_missing;
}

void seeker_mount_place(double p_ecef[3], double r_ecef_from_mount[9], const Mount *mount, const SnapshotEntity *host,
                        const Model *model, const NodePose *node, int at)
{
    double offset_m[3] = {0, 0, 0}, base_m[3] = {0, 0, 0}, r_body_from_base[9], eye_body[3], lever_ecef[3];
    m3_identity(r_body_from_base);
    if (at >= 0) {
        memcpy(base_m, node[at].p_body, sizeof base_m);
        memcpy(r_body_from_base, node[at].r_body_from_node, sizeof r_body_from_base);
    } else if (host->type.kind == dis_kind_munition) { /* in its nose */
        offset_m[0] = model->box_high[0];
        offset_m[2] = -0.5 * model->height_m;
    } else { /* on its roof */
        offset_m[2] = -(model->height_m + 0.3);
    }
    for (int k = 0; k < 3; k++)
        if (!isnan(mount->offset_m[k])) offset_m[k] = mount->offset_m[k];
    m3_mul_v3(eye_body, r_body_from_base, offset_m);
    v3_add(eye_body, eye_body, base_m);
    m3_mul_v3(lever_ecef, host->r_ecef_from_body, eye_body);
    v3_add(p_ecef, host->p_ecef, lever_ecef);

    double r_body_from_mount[9];
    m3_mul(r_body_from_mount, r_body_from_base, mount->r_base_from_mount);
    m3_mul(r_ecef_from_mount, host->r_ecef_from_body, r_body_from_mount);
}

/* ---- the gimbal ------------------------------------------------------------------------------------- */

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

    /* an aim beyond the limit is replaced by the nearest direction on the cone, in the plane of axis and aim */
    const double off_rad = atan2(hypot(d[1], d[2]), d[0]);
    seeker->off_rad = off_rad;
    seeker->at_limit = off_rad > seeker->config.limit_rad;
    if (seeker->at_limit) {
        const double side = hypot(d[1], d[2]);
        const double y = side > 0 ? d[1] / side : 1, z = side > 0 ? d[2] / side : 0;
        d[0] = cos(seeker->config.limit_rad);
        d[1] = sin(seeker->config.limit_rad) * y;
        d[2] = sin(seeker->config.limit_rad) * z;
    }
    const double azimuth_rad = atan2(d[1], d[0]), elevation_rad = asin(clamp(-d[2], -1, 1));
    if (!seeker->started) {
        seeker->started = true;
        seeker->azimuth_rad = azimuth_rad;
        seeker->elevation_rad = elevation_rad;
        return;
    }
    static const double tick_s = 1.0 / seeker_ticks_per_s;
    const double        share = seeker->config.lag_s > 0 ? -expm1(-tick_s / seeker->config.lag_s) : 1;
    const double        most = seeker->config.rate_rps * tick_s;
    seeker->azimuth_rad += clamp(share * remainder(azimuth_rad - seeker->azimuth_rad, 2 * pi_rad), -most, most);
    seeker->azimuth_rad = remainder(seeker->azimuth_rad, 2 * pi_rad);
    seeker->elevation_rad += clamp(share * (elevation_rad - seeker->elevation_rad), -most, most);
}

/* The component of v that is perpendicular to d, scaled to length 1; false where it vanishes. */
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

/* Gives the first up direction of a head that points straight up or down. */
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
    const bool vertical = view_near_vertical(d);
    const bool kept = seeker->top_known && across(carried, seeker->top_enu, d);
    seeker->upright = !vertical;
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
    const bool upright = !seeker->top_known || (seeker->upright && !view_near_vertical(d_enu));
    if (upright || !across(top_enu, seeker->top_enu, d_enu)) view_upright(r_enu_from_cam, d_enu);
    else view_topped(r_enu_from_cam, d_enu, top_enu);
    if (seeker->config.roll_rad == 0) return;
    const double c = cos(seeker->config.roll_rad), s = sin(seeker->config.roll_rad);
    for (int i = 0; i < 3; i++) {
        const double right = r_enu_from_cam[3 * i], down = r_enu_from_cam[3 * i + 1];
        r_enu_from_cam[3 * i] = c * right + s * down;
        r_enu_from_cam[3 * i + 1] = c * down - s * right;
    }
}

/* ---- image motion ----------------------------------------------------------------------------------- */

void seeker_turn_rate(double w_cam_rps[3], const double r_world_from_before[9], const double r_world_from_after[9],
                      double step_s)
{
    double turn[9];
    m3_tmul(turn, r_world_from_before, r_world_from_after);
    w_cam_rps[0] = (turn[7] - turn[5]) / (2 * step_s);
    w_cam_rps[1] = (turn[2] - turn[6]) / (2 * step_s);
    w_cam_rps[2] = (turn[3] - turn[1]) / (2 * step_s);
}

void seeker_scene_rate(double rate_px_s[2], const double w_cam_rps[3], const double v_cam_mps[3], double focal_px,
                       double range_m)
{
    /* a point at (0, 0, range) goes by -w x p - v */
    const double nearness = isfinite(range_m) && range_m > 1 ? 1 / range_m : 0;
    rate_px_s[0] = focal_px * (-w_cam_rps[1] - v_cam_mps[0] * nearness);
    rate_px_s[1] = focal_px * (w_cam_rps[0] - v_cam_mps[1] * nearness);
}
