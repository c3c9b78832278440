/* sensor/node/mount.h: position and axis of the sensor on its host (sensor.mount*).
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
#ifndef SENSOR_NODE_MOUNT_H
#define SENSOR_NODE_MOUNT_H

#include "entities/table/snapshot.h"
#include "sensor/settings/config.h"

typedef struct Mount {
    bool   on_part;             /* not auto */
    char   part[48];
    double offset_m[3];         /* NaN: not given */
    double r_base_from_mount[9];
} Mount;

enum { mount_body = -1, mount_missing = -2 };

Mount mount_of(const Config *config);
/* Node of a model that the sensor goes with; mount_body: the body itself; mount_missing: no such part. */
int   mount_node(const Mount *mount, const Model *model);
/* Class number of an articulated part's words or number; 0: neither. */
uint32_t mount_class(const char *part);
/* Sensor position and mount axes. node: poses of the host's nodes; at: of mount_node, negative: on the body. */
void  mount_place(double p_ecef[3], double r_ecef_from_mount[9], const Mount *mount, const SnapshotEntity *host,
                  const Model *model, const NodePose *node, int at);

#endif
