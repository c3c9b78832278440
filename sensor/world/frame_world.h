/* sensor/world/frame_world.h: a world from the settings: models and ground, materials, atmosphere, radar. */
#ifndef SENSOR_WORLD_FRAME_WORLD_H
#define SENSOR_WORLD_FRAME_WORLD_H

#include "render/frame/render.h"
#include "sensor/settings/config.h"

/* Borrows catalog and landscape. On failure the only valid call is world_close. */
Status frame_world(World *out, const Config *config, const Catalog *catalog, const Landscape *landscape,
                   const LocalFrame *frame, const char *isa);
/* Its plants, as terrain.woods_* say. woods must outlive the world; NULL: there are none. */
Status frame_world_plant(World *world, const Woods *woods, const Config *config, const char *isa, Pool *pool);
/* Of the settings alone: what a course of the weather starts from. With an atmosphere. */
Weather frame_weather(const Config *config, const World *world);
/* The same as its course has it then. */
Weather frame_weather_at(const Config *config, const World *world, double unix_s);
/* Its heat, over the weather of weather.* up to unix_s, that of exercise time 0. After the plants. */
Status frame_world_warm(World *world, const Config *config, double unix_s, Pool *pool);

#endif
