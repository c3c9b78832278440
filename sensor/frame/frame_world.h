/* sensor/frame/frame_world.h: what the settings say of a frame's world: models and ground, materials, atmosphere,
 * plants, sun. */
#ifndef SENSOR_FRAME_FRAME_WORLD_H
#define SENSOR_FRAME_FRAME_WORLD_H

#include "render/frame/render.h"
#include "sensor/settings/config.h"

/* Borrows catalog and landscape. On failure the only valid call is world_close. */
Status frame_world(World *out, const Config *config, const Catalog *catalog, const Landscape *landscape,
                   const LocalFrame *frame, const char *isa);
/* Its parts: without atmosphere and radar; its atmosphere, in place of another; its radar. */
Status frame_world_open(World *out, const Config *config, const Catalog *catalog, const Landscape *landscape,
                        const LocalFrame *frame, const char *isa);
Status frame_world_air(World *world, const Config *config);
/* The model of the atmosphere that the settings name; of a set by weather the one nearest to theirs. */
enum { frame_model_size = 1200 };
Status frame_world_model(char out[frame_model_size], const Config *config);
/* The setting weather.fog. */
WeatherFog frame_world_fog(const Config *config);
void       frame_world_radar(World *world, const Config *config);
/* The cache that cache.* name, for World.cache; NULL: there is none, which is logged where that is no choice. The
 * caller closes it after the world. */
Cache *frame_world_cache(const Config *config);
/* Its plants, as terrain.woods_* say. woods must outlive the world; NULL: there are none. */
Status frame_world_plant(World *world, const Woods *woods, const Config *config, const char *isa, Pool *pool);
/* The weather at unix_s. */
Weather frame_weather_at(const Config *config, const World *world, double unix_s);
/* Warms the world over the weather of weather.* up to unix_s, which is exercise time 0. Call it after
 * frame_world_plant. */
Status frame_world_warm(World *world, const Config *config, double unix_s, Pool *pool);

/* ---- sun and atmosphere of one frame, and the axes for normals in its products ------------------- */

/* Where a frame is seen from, when, and in which bands. */
typedef struct FrameEye {
    double             unix_s;
    double             p_ecef[3];
    const View        *view;
    unsigned           bands;
    const GroundMarks *marks; /* of entities; NULL: none */
} FrameEye;

/* The light of a frame. */
typedef struct FrameLight {
    Air    air;
    Sun    sun;                /* at the sensor position, in its own ENU */
    double r_host_from_enu[9]; /* from the world's ENU to that of the sensor position */
} FrameLight;
Status frame_light(FrameLight *out, const World *world, const Config *config, const FrameEye *eye, Pool *pool,
                   Arena *arena);
/* Products give normals in the host's own ENU. */
void frame_turn_normals(Picture *picture, const double r_host_from_enu[9]);

#endif
