/* render/frame/world_vehicles.c: see world_vehicles.h. */
#include "render/frame/world_vehicles.h"

#include "render/frame/heat_drive.h"

#include <stdlib.h>

enum { weather_kept = 64, vehicle_capacity = 512 };

struct WorldVehicles {
    const World *world;
    VehicleHeat *heat;
    Arena       *arena;                 /* of scene */
    HeatScene   *scene;                 /* of scene_s */
    double       scene_s;
    struct { double unix_s; GroundWeather weather; double wind_enu_mps[3]; } kept[weather_kept]; /* by time */
};

static double wind_share_of_low_things(void)
{
    static const double height_m = 1.5, anemometer_m = 10, rough_m = 0.03; /* grass: logarithmic profile */
    return log(height_m / rough_m) / log(anemometer_m / rough_m);
}

/* Weather at the origin at a time. */
static const GroundWeather *weather_then(double wind_enu_mps[3], WorldVehicles *v, double unix_s)
{
    uint64_t bits;
    memcpy(&bits, &unix_s, sizeof bits);
    const size_t at = (size_t)((bits * UINT64_C(0x9E3779B97F4A7C15)) >> 58);
    _Static_assert(weather_kept == 64, "six bits");
    if (v->kept[at].unix_s != unix_s) {
        Weather w;
        weather_at(&w, v->world->course, unix_s);
        const double wind_mps = w.wind_mps * wind_share_of_low_things();
        heat_drive_weather(&v->kept[at].weather, unix_s, v->world->drive);
        v->kept[at].wind_enu_mps[0] = -wind_mps * sin(w.wind_from_rad);
        v->kept[at].wind_enu_mps[1] = -wind_mps * cos(w.wind_from_rad);
        v->kept[at].unix_s = unix_s;
    }
    memcpy(wind_enu_mps, v->kept[at].wind_enu_mps, sizeof v->kept[at].wind_enu_mps);
    return &v->kept[at].weather;
}

/* Share of the direct sun that relief and plants leave at a place: of the slot of the day whose sun stands nearest. */
static double sun_share(const HeatScene *scene, const double sun_d_enu[3], const double p_enu[3])
{
    uint8_t shadow[shadow_most_slots];
    double  open = 1, nearest = -2;
    int     slot = -1;
    if (!scene->shadow || !(sun_d_enu[2] > 0)) return 1;
    shadow_map_at(shadow, &open, scene->shadow, p_enu[0], p_enu[1]);
    for (int k = 0; k < scene->now->slots; k++) {
        const double d = (double)scene->now->slot_d_enu[0][k] * sun_d_enu[0] + (double)scene->now->slot_d_enu[1][k] * sun_d_enu[1] +
                         (double)scene->now->slot_d_enu[2][k] * sun_d_enu[2];
        if (d > nearest) nearest = d, slot = k;
    }
    return slot < 0 ? 1 : 1 - shadow[slot] / 255.0;
}

static const double sea_freezes_k = 271.35;

static Status ground_there(PlaceHeat *out, WorldVehicles *v, double unix_s, const double p_enu[3])
{
    const World *world = v->world;
    if (v->scene_s != unix_s || !v->scene || v->scene->shadow != world->shadow) { /* benches change its shadows */
        arena_reset(v->arena);
        const Status status = world_heat_at(&v->scene, world, NULL, unix_s, v->arena);
        if (status != STATUS_OK) return status;
        v->scene_s = unix_s;
    }
    const double up[3] = {0, 0, 1};
    double       lifted_k;
    SurfaceClass surface = SURFACE_GRASS;
    if (world->landscape) surface = landscape_surface(world->landscape, p_enu[0], p_enu[1]);
    if (surface == SURFACE_NONE) surface = SURFACE_GRASS;
    out->ground_k   = heat_scene_ground_k(&lifted_k, v->scene, (int)surface, p_enu, up, 1);
    out->under_k    = (double)v->scene->now->table.hidden_k[v->scene->now->kind_of[surface]];
    double       unlit_k;
    out->water      = surface == SURFACE_WATER;
    out->water_k    = fmax(heat_scene_ground_k(&unlit_k, v->scene, SURFACE_WATER, p_enu, up, 1), sea_freezes_k);
    out->ground_rho = 1 - (double)world->materials.material[world->materials.surface[surface]].solar_absorptance;
    out->direct_w_m2 *= sun_share(v->scene, out->sun_d_enu, p_enu);
    return STATUS_OK;
}

static Status place_there(PlaceHeat *out, const void *user, double unix_s, const double p_enu[3], bool present)
{
    static const double lapse_k_m = 0.0065, scale_m = 8500, ground_rho = 0.25;
    WorldVehicles      *v = (WorldVehicles *)user; /* the caches alone change */
    const World        *world = v->world;
    *out = (PlaceHeat){.ground_rho = ground_rho};
    const GroundWeather *w = weather_then(out->wind_enu_mps, v, unix_s);
    const Elevation     *elevation = world->landscape ? &world->landscape->elevation : NULL;
    const double ground_m = elevation ? elevation_height(elevation, p_enu[0], p_enu[1], NULL) : 0;
    const double zero_m = elevation ? elevation_height(elevation, 0, 0, NULL) : 0;
    /* heights as in the atmosphere: over the ground at the origin, and the tangent plane departs from the Earth */
    const double high_m = p_enu[2] - zero_m + (p_enu[0] * p_enu[0] + p_enu[1] * p_enu[1]) / (2 * 6371e3);
    const double colder_k = lapse_k_m * clamp(high_m, -500, 11000);
    out->air_k        = w->air.temp_k - colder_k;
    out->air_density  = exp(-clamp(high_m, -500, 30000) / scale_m);
    out->direct_w_m2  = w->direct_w_m2;
    out->diffuse_w_m2 = w->diffuse_w_m2;
    out->longwave_w_m2 = w->longwave_w_m2 * pow(out->air_k / w->air.temp_k, 4);
    out->above_m      = isfinite(ground_m) ? p_enu[2] - ground_m : 0;
    out->ground_k = out->under_k = w->air.temp_k;
    out->water_k  = fmax(w->air.temp_k, sea_freezes_k);
    memcpy(out->sun_d_enu, w->sun_d_enu, sizeof out->sun_d_enu);
    return present ? ground_there(out, v, unix_s, p_enu) : STATUS_OK;
}

Status world_vehicles_create(WorldVehicles **out, const World *world, const WorldVehiclesConfig *about)
{
    WorldVehicles *v = calloc(1, sizeof *v);
    if (!v) return STATUS_NO_MEMORY;
    v->world = world;
    v->arena = arena_create();
    for (int k = 0; k < weather_kept; k++) v->kept[k].unix_s = NAN;
    const VehicleHeatConfig config = {.first_step_s = fmin(1, about->step_s), .step_s = about->step_s,
                                      .window_us = about->window_us, .past_parts = about->past_parts,
                                      .unix_s = world->drive->exercise_s, .capacity = vehicle_capacity, .place = place_there, .user = v};
    const VehicleHeatWorld  of = {world->catalog, &world->materials, &world->parts, &world->frame, world->tracer, world->patches,
                                  about->given, about->kept};
    const Status            status = v->arena ? vehicle_heat_create(&v->heat, &config, &of) : STATUS_NO_MEMORY;
    if (status == STATUS_OK) *out = v;
    else world_vehicles_destroy(v);
    return status;
}

void world_vehicles_destroy(WorldVehicles *v)
{
    if (!v) return;
    vehicle_heat_destroy(v->heat);
    arena_destroy(v->arena);
    free(v);
}

Status world_vehicles_tick(WorldVehicles *v, const Snapshot *snapshot) { return vehicle_heat_tick(v->heat, snapshot); }

Status world_vehicles_show(const WorldVehicles *v, Snapshot *snapshot, Arena *arena)
{
    return vehicle_heat_show(v->heat, snapshot, arena);
}

const VehicleHeat *world_vehicles_heat(const WorldVehicles *v) { return v->heat; }

Status world_warm_snapshot(Snapshot *snapshot, const World *world, Arena *arena)
{
    WorldVehicles *v = NULL;
    if (!world->heat) return STATUS_OK;
    Status status = world_vehicles_create(&v, world, &(WorldVehiclesConfig){.step_s = 1, .window_us = INFINITY});
    if (status == STATUS_OK) status = world_vehicles_tick(v, snapshot);
    if (status == STATUS_OK) status = world_vehicles_show(v, snapshot, arena);
    world_vehicles_destroy(v);
    return status;
}
