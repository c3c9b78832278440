/* render/frame/world_heat.c: the ground's heat, driven by the weather's course and the sun and sky of the atmosphere. */
#include "render/frame/world.h"

#include "render/frame/heat_drive.h"
#include "render/light/canopy.h"

#include <stdlib.h>

static void stand_there(ShadowStand *out, const void *canopy, double x_m, double y_m)
{
    CanopyStand c;
    canopy_stand(&c, canopy, x_m, y_m);
    *out = (ShadowStand){(float)c.leaf_area, (float)c.base_m, (float)c.top_m, (float)c.open};
}

static Status cast_shadows(World *world, double shadow_m, Pool *pool)
{
    float     d_enu[3][heat_day_slots];
    const int slots = heat_slots(d_enu, world->heat);
    _Static_assert((int)shadow_most_slots >= (int)heat_day_slots, "room for a day");
    return shadow_map_create(&world->shadow, &world->landscape->elevation, shadow_m, slots, d_enu,
                             world->canopy ? stand_there : NULL, world->canopy, pool);
}

/* The wood of the plants that stand, each material once. */
static int branch_kinds(BranchKind out[branch_most_kinds], const Materials *m)
{
    int count = 0;
    for (int k = 0; k < PLANT_KINDS; k++) {
        const int row = m->plant[k][PLANT_BARK];
        bool      known = row == 0;
        for (int i = 0; i < count; i++) known |= out[i].material == row;
        if (known || count == branch_most_kinds) continue;
        const Material *bark = &m->material[row];
        out[count++] = (BranchKind){row, (double)bark->conductivity_w_mk, (double)bark->density_kg_m3 * (double)bark->heat_capacity_j_kgk,
                                    (double)bark->solar_absorptance, 1 - (double)bark->rho_lwir};
    }
    return count;
}

void world_cool(World *world)
{
    shadow_map_destroy(world->shadow);
    heat_destroy(world->heat);
    free(world->drive);
    weather_course_close(world->course);
    world->shadow = NULL, world->heat = NULL, world->drive = NULL, world->course = NULL;
}

Status world_warm(World *world, WeatherCourse *course, const HeatConfig *config, double shadow_m, Pool *pool)
{
    char        path[512];
    HeatConfig  c = *config;
    GroundKinds kinds;
    world_cool(world);
    world->course = course;
    world->drive  = calloc(1, sizeof *world->drive);
    if (!world->drive) return STATUS_NO_MEMORY;
    *world->drive = (HeatDrive){course, {world->atmosphere, world->planck_mwir, world->planck_lwir, 0}, world->frame.origin, config->unix_s};
    c.weather = heat_drive_weather, c.user = world->drive, c.pool = pool;
    if (!etc_path(path, sizeof path, "ground_heat.csv")) return STATUS_BAD_VALUE;
    Status status = ground_kinds_open(&kinds, path, &world->materials);
    BranchKind branch[branch_most_kinds];
    const int  branches = world->forest ? branch_kinds(branch, &world->materials) : 0;
    if (status == STATUS_OK) status = heat_create(&world->heat, &kinds, &c, branch, branches);
    if (status == STATUS_OK && world->landscape && shadow_m > 0) status = cast_shadows(world, shadow_m, pool);
    return status;
}

Status world_warm_clear(World *world, const HeatConfig *config, double shadow_m, Pool *pool)
{
    static const double range_k = 10;
    const Geodetic     *place = &world->frame.origin;
    WeatherCourseConfig about = {weather_default(), range_k, place->lon_rad, place->lat_rad};
    WeatherCourse      *course;
    about.base.air_temp_k = atmosphere_temp_k(world->atmosphere, 0);
    const Status status = weather_course_open(&course, "clear", &about);
    return status == STATUS_OK ? world_warm(world, course, config, shadow_m, pool) : status;
}

Status world_heat_at(HeatScene **out, const World *world, const GroundMarks *marks, double unix_s, Arena *arena)
{
    HeatNow  *now;
    MarkHeat *mark_heat = NULL;
    *out = NULL;
    if (!world->heat) return STATUS_OK;
    Status status = heat_now(&now, world->heat, unix_s, arena);
    if (status == STATUS_OK && marks)
        status = mark_heat_create(&mark_heat, marks, &world->frame, world->drive->exercise_s, unix_s, now, arena);
    if (status != STATUS_OK) return status;
    *out = arena_alloc(arena, 1, sizeof **out);
    if (!*out) return STATUS_NO_MEMORY;
    **out = (HeatScene){now, world->shadow, mark_heat};
    return STATUS_OK;
}

double world_air_k(const World *world, double unix_s)
{
    Weather w;
    if (!world->course) return NAN;
    weather_at(&w, world->course, unix_s);
    return w.air_temp_k;
}
