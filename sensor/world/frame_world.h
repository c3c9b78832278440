/* sensor/world/frame_world.h: the world as the settings have it: models and ground, materials, air, radar. */
#ifndef SENSOR_WORLD_FRAME_WORLD_H
#define SENSOR_WORLD_FRAME_WORLD_H

#include "render/frame/render.h"
#include "sensor/settings/config.h"

/* Borrows catalog and landscape. On failure the world is for world_close alone. */
Status frame_world(World *out, const Config *config, const Catalog *catalog, const Landscape *landscape,
                   const LocalFrame *frame, const char *isa);

#endif
