/* sensor/world/frame_light.h: sun and atmosphere of one frame, and the axes for normals in its products. */
#ifndef SENSOR_WORLD_FRAME_LIGHT_H
#define SENSOR_WORLD_FRAME_LIGHT_H

#include "render/frame/render.h"
#include "sensor/settings/config.h"

/* The inputs of sun and atmosphere, besides the world and the settings of the weather. */
typedef struct FrameEye {
    double      unix_s;
    double      p_ecef[3];
    const View *view;
    unsigned    bands;
    const GroundMarks *marks; /* NULL: none */
} FrameEye;

/* Sun at the sensor position, its direction rotated into the world's frame. r_host_from_enu: from the world's ENU to
 * that of the sensor position. */
Status frame_light(Air *air, Sun *sun, double r_host_from_enu[9], const World *world, const Config *config,
                   const FrameEye *eye, Pool *pool, Arena *arena);
/* Products give normals in the host's own ENU. */
void turn_normals(Picture *picture, const double r_host_from_enu[9]);

#endif
