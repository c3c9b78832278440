/* render/frame/world.h: the data that does not change between frames: models, ground, materials, the tracer. */
#ifndef RENDER_FRAME_WORLD_H
#define RENDER_FRAME_WORLD_H

#include "render/air/air.h"
#include "render/trace/plants/forest.h"
#include "render/heat/heat.h"
#include "render/heat/part_table.h"
#include "render/heat/scenery_heat.h"
#include "render/heat/vehicle_heat.h"
#include "render/light/canopy.h"
#include "render/light/far_woods.h"
#include "render/light/lamps.h"
#include "render/light/sky_horizon.h"
#include "render/scattering/radar_image.h"
#include "render/trace/scenery/scenery_tracer.h"
#include "render/trace/visibility/visibility.h"
#include "terrain/detail/detail.h"
#include "terrain/earth/refraction.h"
#include "terrain/ground/surface_cells.h"
#include "terrain/weather/weather.h"

typedef struct World {
    const Catalog    *catalog;
    const Landscape  *landscape; /* NULL: no ground */
    LocalFrame        frame;     /* the ENU frame of the views */
    Tracer           *tracer;
    Materials         materials;
    DetailTable      *detail; /* of the ground; the caller may close it and set NULL: classes of one value */
    Plants           *plants; /* NULL after world_open, with forest: no plants */
    Forest           *forest;
    Canopy           *canopy;
    FarWoods         *far_woods; /* NULL: every plant stands */
    SceneryTracer    *scenery;   /* NULL after world_open: none */
    LampTypes         lamps;     /* of scenery that has lamps; empty: they are dark */
    SkyHorizons      *horizons;  /* of its buildings, over a landscape; NULL: none */
    PlanckTable      *planck_mwir, *planck_lwir;
    Atmosphere       *atmosphere; /* NULL after world_open; the caller may open one here; world_close closes it */
    RadarConfig       radar;
    WeatherCourse    *course; /* NULL after world_open, with heat and shadow: ground as warm as the air */
    Heat             *heat;
    ShadowMap        *shadow;       /* NULL with heat: nothing shaded the ground */
    struct HeatDrive *drive;        /* of heat */
    SceneryHeat      *scenery_heat; /* NULL: world_warm_scenery was not called */
    PartTable         parts;        /* what is behind the skin of parts */
    PatchSet         *patches;      /* of the models that have been seen with temperatures */
    Cache            *cache;        /* world_keep; NULL: nowhere */
    SurfaceCells     *cells;        /* what frames know of the landscape's classes */
    struct SkyKept   *sky;          /* what frames leave for the next (render/light/sky_visibility.h) */
} World;

/* frame: the landscape's, or any where there is none. */
Status world_open(World *out, const Catalog *catalog, const Landscape *landscape, const LocalFrame *frame,
                  const char *isa);
/* Where the world keeps what it makes, from here on; cache may be NULL. Before world_plant, to be of use. */
void world_keep(World *world, Cache *cache);
/* Grows the prototypes and opens the forest over woods, which must outlive the world. Once, before the first frame; on
 * failure only world_close may follow. */
Status world_plant(World *world, const Woods *woods, const ForestConfig *config, const char *isa, Pool *pool);
/* What stands in it and takes no part: scenery must outlive the world. After world_plant, before world_warm and the
 * first frame; once. isa: as world_open. STATUS_BAD_VALUE: a part's material is not in the table, or scenery's own
 * numbers are wrong; it is logged. */
Status world_scenery(World *world, const Scenery *scenery, const char *isa, Pool *pool);
/* Joins it to a frame's visibility, as it is at exercise time t_s; nothing where there is none. */
Status world_scenery_join(Visibility *v, const World *world, double t_s, const VisibilityConfig *of, Arena *arena);
/* Warms the ground up to unix_s, that of exercise time 0. course becomes the world's, on failure too. shadow_m: cells
 * of its shadow map; 0: none. After world_plant, with an atmosphere. */
Status world_warm(World *world, WeatherCourse *course, const HeatConfig *config, double shadow_m, Pool *pool);
/* Undoes it: before another atmosphere, which its heat points to. */
void world_cool(World *world);
/* Warms scenery, which must outlive the world, by the weather that warms the ground; config: as world_warm's but for
 * facets, which are its own. After world_warm; world_cool undoes it. */
Status world_warm_scenery(World *world, const Scenery *scenery, const HeatConfig *config, const char *isa, Pool *pool);
/* Its temperatures at a time, in the arena; *out NULL where there are none. */
Status world_scenery_temps(SceneryTemps **out, const World *world, double unix_s, Arena *arena);
/* The same as world_warm for a clear day of the atmosphere's own temperature: what benches and pictures of models stand
 * on. */
Status world_warm_clear(World *world, const HeatConfig *config, double shadow_m, Pool *pool);
/* The heat of ground and scenery at a time, in the arena; times in order; *out NULL where the world is not warm. marks:
 * may be NULL. */
Status world_heat_at(HeatScene **out, const World *world, const GroundMarks *marks, double unix_s, Arena *arena);
/* What entities (own; NULL: nothing) and scenery left on the ground, seen from near eye_enu, in the arena: for
 * world_heat_at. Of scenery nothing where the world is not warm. */
Status world_marks_at(GroundMarks *out, const World *world, const GroundMarks *own, const double eye_enu[3],
                      double unix_s, Arena *arena);
/* The patches of a snapshot's models. One thread at a time. */
Status world_need_patches(const World *world, const Snapshot *snapshot);
/* Air temperature at ground level then, K; NaN: the world is not warm. */
double world_air_k(const World *world, double unix_s);
void   world_close(World *world);

/* How rays from an eye bend, 1/m. */
double world_bend(const World *world, RefractionBand band, const double eye_enu[3]);

/* Its air over its origin. ground_k: AirSource's. */
AirSource world_air_source(const World *world, double ground_k);

/* ---- what drives the ground's heat: the weather's course with the sun and sky of the atmosphere  */

/* Heat keeps a pointer to it, and it to these: they outlive the heat. */
typedef struct HeatDrive {
    const WeatherCourse *course;
    AirSource            source;
    Geodetic             place;
    double               exercise_s; /* Unix time of exercise time 0 */
} HeatDrive;

/* Of the wind at 10 m, the share of low things' at 1.5 m over grass. */
double world_low_wind(void);
/* HeatWeather; user: a HeatDrive. Thermometer at 2 m, anemometer at 10 m. Beyond 1900 .. 2100 there is no sun. */
void world_heat_weather(GroundWeather *out, double unix_s, const void *drive);

/* ---- entities: vehicle_heat.h with the weather's course, and the heat of the world's ground -- */

typedef struct WorldVehicles WorldVehicles;

/* Of a node: VehicleHeatConfig.window_us. At ten frames a second or more no frame pays for more. */
static const double vehicle_window_us = 3300;

typedef struct WorldVehiclesConfig {
    double           step_s;     /* of entities whose drives do not change */
    double           window_us;  /* VehicleHeatConfig */
    int              past_parts; /* VehicleHeatConfig; 0: 1 */
    const GivenHeat *given;      /* VehicleHeatWorld; so is: */
    const KeptHeat  *kept;
} WorldVehiclesConfig;

/* The world must be warm, and outlive it. */
Status world_vehicles_create(WorldVehicles **out, const World *world, const WorldVehiclesConfig *config);
void   world_vehicles_destroy(WorldVehicles *vehicles); /* accepts NULL */
/* Of VehicleHeat: ticks in order of time; the frame's snapshot after those up to its time. */
Status             world_vehicles_tick(WorldVehicles *vehicles, const Snapshot *snapshot);
Status             world_vehicles_show(const WorldVehicles *vehicles, Snapshot *snapshot, Arena *arena);
const VehicleHeat *world_vehicles_heat(const WorldVehicles *vehicles);

/* Temperatures of a snapshot that has no past: as entities begin. What benches and pictures of models need. */
Status world_warm_snapshot(Snapshot *snapshot, const World *world, Arena *arena);

#endif
