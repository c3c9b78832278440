/* render/frame/world_heat.c: the ground's heat, driven by the weather's course and the sun and sky of the atmosphere. */
#include "render/frame/world.h"
#include "render/light/canopy.h"

#include <stdlib.h>

/* What heat keeps a pointer to: copies, since a World may be moved. */
typedef struct HeatDrive {
    const WeatherCourse *course;
    AirSource            source;
    Geodetic             place;
    double               exercise_s;
} HeatDrive;

static Status daylight_there(Daylight *out, const AirSource *source, const Geodetic *place, const Weather *weather, double unix_s)
{
    Sun sun;
    const double air_k = isfinite(weather->air_temp_k) ? weather->air_temp_k : 288.15;
    const Status status = sun_at(&sun, unix_s, place, weather->pressure_mbar, air_k - 273.15, NAN);
    if (status == STATUS_OK) daylight_at(out, source, weather, &sun);
    return status;
}

Status world_daylight(Daylight *out, const World *world, const Weather *weather, double unix_s)
{
    const AirSource source = {world->atmosphere, world->planck_mwir, world->planck_lwir, 0};
    return daylight_there(out, &source, &world->frame.origin, weather, unix_s);
}

static void weather_then(GroundWeather *out, double unix_s, const void *user)
{
    static const double thermometer_m = 2, anemometer_m = 10;
    const HeatDrive *drive = user;
    Weather          w;
    Daylight         light = {0};
    weather_at(&w, drive->course, unix_s);
    if (daylight_there(&light, &drive->source, &drive->place, &w, unix_s) != STATUS_OK) light.weather = w; /* beyond 1900 .. 2100: night */
    const double air_k = light.weather.air_temp_k;
    *out = (GroundWeather){.air = {air_k, w.humidity * saturation_pa(air_k), 100 * w.pressure_mbar, w.wind_mps, thermometer_m, anemometer_m},
                           .direct_w_m2 = light.solar_direct_w_m2, .diffuse_w_m2 = light.solar_diffuse_w_m2,
                           .longwave_w_m2 = stefan_w_m2k4 * pow(air_k, 4) - light.longwave_loss_w_m2,
                           .rain_kg_m2s = w.rain_mm_h / 3600};
    memcpy(out->sun_d_enu, light.sun_d_enu, sizeof out->sun_d_enu);
}

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

Status world_warm(World *world, WeatherCourse *course, const HeatConfig *config, double shadow_m, Pool *pool)
{
    char        path[512];
    HeatConfig  c = *config;
    GroundKinds kinds;
    world->course = course;
    world->drive  = calloc(1, sizeof *world->drive);
    if (!world->drive) return STATUS_NO_MEMORY;
    *world->drive = (HeatDrive){course, {world->atmosphere, world->planck_mwir, world->planck_lwir, 0}, world->frame.origin, config->unix_s};
    c.weather = weather_then, c.user = world->drive, c.pool = pool;
    if (!etc_path(path, sizeof path, "ground_heat.csv")) return STATUS_BAD_VALUE;
    Status status = ground_kinds_open(&kinds, path, &world->materials);
    BranchKind branch[branch_most_kinds];
    const int  branches = world->forest ? branch_kinds(branch, &world->materials) : 0;
    if (status == STATUS_OK) status = heat_create(&world->heat, &kinds, &c, branch, branches);
    if (status == STATUS_OK && world->landscape && shadow_m > 0) status = cast_shadows(world, shadow_m, pool);
    return status;
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
