/* render/frame/world_scenery.c: scenery of the world: what rays meet of it, and what warms it. */
#include "render/frame/world.h"

#include "entities/scenery/scenery_traces.h"

#include <stdlib.h>

static void wind_there(double wind_enu_mps[3], double unix_s, const void *user)
{
    const HeatDrive *drive = user;
    Weather          w;
    weather_at(&w, drive->course, unix_s);
    const double mps = w.wind_mps * world_low_wind();
    wind_enu_mps[0] = -mps * sin(w.wind_from_rad);
    wind_enu_mps[1] = -mps * cos(w.wind_from_rad);
    wind_enu_mps[2] = 0;
}

Status world_warm_scenery(World *world, const Scenery *scenery, const HeatConfig *config, const char *isa, Pool *pool)
{
    char              path[512];
    SceneryHeatConfig c = scenery_heat_default_config();
    Constructions    *constructions = calloc(1, sizeof *constructions);
    GroundKinds      *ground = calloc(1, sizeof *ground);
    const int         facets = c.heat.facets;
    Status            status = constructions && ground ? STATUS_OK : STATUS_NO_MEMORY;
    if (!etc_path(path, sizeof path, "ground_heat.csv")) status = STATUS_BAD_VALUE;
    if (status == STATUS_OK) status = constructions_open_etc(constructions);
    if (status == STATUS_OK) status = ground_kinds_open(ground, path, &world->materials);
    if (status == STATUS_OK) {
        c.heat = *config;
        c.heat.facets = facets, c.heat.pool = pool, c.heat.cache = world->cache;
        c.heat.weather = world_heat_weather, c.heat.user = world->drive;
        c.east_rad = world->frame.origin.lon_rad;
        c.wind = wind_there;
        c.ground = ground, c.constructions = constructions;
        c.materials = &world->materials, c.parts = &world->parts, c.frame = &world->frame;
        c.shadow = world->shadow, c.isa = isa;
        scenery_heat_destroy(world->scenery_heat);
        world->scenery_heat = NULL;
        status = scenery_heat_create(&world->scenery_heat, &c, scenery);
    }
    free(ground);
    free(constructions);
    return status;
}

Status world_scenery_temps(SceneryTemps **out, const World *world, double unix_s, Arena *arena)
{
    *out = NULL;
    return world->scenery_heat ? scenery_temps_at(out, world->scenery_heat, unix_s, arena) : STATUS_OK;
}

Status world_marks_at(GroundMarks *out, const World *world, const GroundMarks *own, const double eye_enu[3],
                      double unix_s, Arena *arena)
{
    *out = own ? *own : (GroundMarks){0};
    if (!world->scenery || !world->drive) return STATUS_OK;
    const GroundMarks before = *out;
    return scenery_marks(out, &before, scenery_tracer_of(world->scenery), &world->frame, eye_enu,
                         unix_s - world->drive->exercise_s, arena);
}

/* ---- what is seen of it ----------------------------------------------------------------------- */

Status world_scenery(World *world, const Scenery *scenery, const char *isa, Pool *pool)
{
    char           path[512];
    SceneryTracer *tracer;
    if (!etc_path(path, sizeof path, "materials.csv")) return STATUS_BAD_VALUE;
    if (scenery->objects == 0) return STATUS_OK;
    Status status = scenery_tracer_create(&tracer, scenery, isa);
    if (status != STATUS_OK) return status;
    status = scenery_tracer_materials(tracer, &world->materials, path);
    if (status == STATUS_OK && world->landscape)
        status = sky_horizons_create(&world->horizons, tracer, &world->landscape->elevation, &world->materials, pool);
    if (status == STATUS_OK && scenery->lamps > 0)
        status = etc_path(path, sizeof path, "lamps.csv") ? lamp_types_read(&world->lamps, path) : STATUS_BAD_VALUE;
    if (status == STATUS_OK) world->scenery = tracer;
    else scenery_tracer_destroy(tracer);
    return status;
}

Status world_scenery_join(Visibility *v, const World *world, double t_s, const VisibilityConfig *of, Arena *arena)
{
    SceneryFrame  *frame;
    SceneryFrameOf at = {.t_s = t_s, .skips_off = of->skips_off, .bend_per_m = of->bend_per_m};
    if (!world->scenery) return STATUS_OK;
    memcpy(at.eye_enu, of->eye_enu, sizeof at.eye_enu);
    const Status status = scenery_frame_create(&frame, world->scenery, &at, arena);
    return status == STATUS_OK ? scenery_frame_join(v, frame) : status;
}
