/* sensor/node/mount.c: the sensor's position and axes on its host. See the header. */
#include "sensor/node/mount.h"

#include "dis/enumerations.h"

/* SISO-REF-010, articulated parts: classes of ten each, 32 apart. */
static const struct {
    const char *name;
    uint32_t    first;
} classes[] = {
    {"primary turret", 4096},   {"primary gun", 4416},   {"primary launcher", 4736},
    {"primary defense system", 5056},   {"primary radar", 5376},   {"secondary turret", 5696},
    {"secondary gun", 6016}, {"secondary launcher", 6336}, {"secondary defense system", 6656},
    {"secondary radar", 6976},
};
enum { class_count = sizeof classes / sizeof *classes, of_a_class = 10, class_step = 32 };

uint32_t mount_class(const char *part)
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

Mount mount_of(const Config *config)
{
    Mount        mount = {.on_part = strcmp(config->sensor.mount, "auto") != 0,
                          .offset_m = {config->sensor.mount_x_m, config->sensor.mount_y_m, config->sensor.mount_z_m}};
    const double yaw_rad = config->sensor.mount_yaw_deg * rad_per_deg, c = cos(yaw_rad), s = sin(yaw_rad);
    const double pitch_rad = config->sensor.mount_pitch_deg * rad_per_deg, e = cos(pitch_rad), f = sin(pitch_rad);
    /* right-handed about z (down), then about the turned y (right) */
    const double r[9] = {c * e, -s, c * f, s * e, c, s * f, -f, 0, e};
    memcpy(mount.r_base_from_mount, r, sizeof r);
    _Static_assert(sizeof mount.part == sizeof config->sensor.mount, "one name");
    memcpy(mount.part, config->sensor.mount, sizeof mount.part);
    return mount;
}

int mount_node(const Mount *mount, const Model *model)
{
    if (!mount->on_part) return mount_body;
    for (int n = 0; n < model->node_count; n++)
        if (strcmp(model->node[n].name, mount->part) == 0) return n;
    for (int i = 0; i < model->part_count; i++)
        if (strcmp(model->part[i].name, mount->part) == 0) return model->part[i].node;
    const uint32_t dis_class = mount_class(mount->part);
    for (int n = 0; dis_class && n < model->node_count; n++)
        if (model->node[n].dis_class == dis_class) return n;
    return mount_missing;
}

void mount_place(double p_ecef[3], double r_ecef_from_mount[9], const Mount *mount, const SnapshotEntity *host,
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
