/* render/frame/world.c: opens what does not change between frames; warms its ground, and the entities in it. */

#include "render/frame/world.h"
#include "render/light/sky_visibility.h"
#include "render/trace/parts/parts.h"
#include "render/trace/plants/plants_kept.h"
#include "render/light/canopy.h"

#include <stdlib.h>

Status world_open(World *out, const Catalog *catalog, const Landscape *landscape, const LocalFrame *frame,
                  const char *isa)
{
    World  world = {.catalog = catalog, .landscape = landscape, .frame = *frame, .radar = {.lobe_rad = 0.05}};
    char   materials[512], surfaces[512], detail[512], parts[512], machines[512];
    Status status = STATUS_BAD_VALUE;

    if (!etc_path(materials, sizeof materials, "materials.csv") ||
        !etc_path(surfaces, sizeof surfaces, "surfaces.csv") || !etc_path(detail, sizeof detail, "ground_detail.csv") ||
        !etc_path(parts, sizeof parts, "heat.csv") || !etc_path(machines, sizeof machines, "heat_machines.csv")) {
        log_error("render: path of the tables is too long; set PITVIPER_ETC to a shorter one");
        return STATUS_BAD_VALUE;
    }
    status = tracer_create(&world.tracer, catalog, isa);
    if (status == STATUS_OK) status = materials_open(&world.materials, materials, surfaces, catalog);
    if (status == STATUS_OK) status = part_table_open(&world.parts, parts, machines);
    if (status == STATUS_OK && !(world.patches = calloc(1, sizeof *world.patches))) status = STATUS_NO_MEMORY;
    if (status == STATUS_OK) status = heat_patches_create(world.patches, catalog_model_count(catalog));
    if (status == STATUS_OK) status = sky_kept_create(&world.sky, sky_kept_octets);
    if (status == STATUS_OK) status = detail_table_open(&world.detail, detail, detail_cut_off);
    PlanckTable **const planck[2] = {&world.planck_mwir, &world.planck_lwir};
    for (int k = 0; k < 2 && status == STATUS_OK; k++) {
        const SpectralBand band = channel_band((ChannelPlace)(SPECTRAL_MWIR + k));
        status = planck_table_seen(planck[k], &band);
    }
    if (status != STATUS_OK) {
        world_close(&world);
        return status;
    }
    if (landscape) world.cells = surface_cells_create(landscape);
    *out = world;
    return STATUS_OK;
}

void world_keep(World *world, Cache *cache) { world->cache = world->patches->cache = cache; }

Status world_need_patches(const World *world, const Snapshot *snapshot)
{
    Status status = STATUS_OK;
    for (int i = 0; i < snapshot->count && status == STATUS_OK; i++) {
        const SnapshotEntity *e = &snapshot->entity[i];
        if (e->first_patch < 0 || e->model < 0 || e->model >= tracer_model_count(world->tracer)) continue;
        status = tracer_need(world->tracer, e->model);
        if (status == STATUS_OK)
            status = heat_patches_need(world->patches, e->model, tracer_model(world->tracer, e->model));
    }
    return status;
}

/* The prototypes, and what their light is kept by. */
static Status grow_plants(World *world, CacheKey *key, const ForestConfig *config, const char *isa, Pool *pool)
{
    const uint64_t seed = plants_seed;
    const int64_t  embree = tracer_embree(world->tracer);
    const uint8_t  light[2] = {config->leaves, config->fine}; /* bare trees let more through to their bark */
    const Status   status = plants_create(&world->plants, seed, pool);
    if (status != STATUS_OK) return status;
    *key = cache_key("light of prototypes");
    cache_key_add(key, &seed, sizeof seed); /* by which they grow, in this program */
    cache_key_add(key, &embree, sizeof embree);
    cache_key_add(key, light, sizeof light);
    if (isa) cache_key_add(key, isa, strlen(isa));
    return STATUS_OK;
}

/* What even light reaches the quads, from the cache, or found and kept there. */
static Status light_plants(World *world, CacheKey *key, Pool *pool)
{
    void  *octets;
    size_t count;
    if (cache_fetch(&octets, &count, world->cache, key)) {
        const Status status = plants_light_from_octets(world->plants, octets, count);
        free(octets);
        if (status == STATUS_OK) return STATUS_OK;
    }
    const Status status = forest_openness(world->plants, world->forest, pool);
    if (status != STATUS_OK) return status;
    forest_shade(world->plants, world->forest, pool);
    count = world->cache ? plants_light_to_octets(NULL, world->plants) : 0;
    if (count == 0 || !(octets = malloc(count))) return STATUS_OK;
    plants_light_to_octets(octets, world->plants);
    cache_keep(world->cache, key, octets, count);
    free(octets);
    return STATUS_OK;
}

Status world_plant(World *world, const Woods *woods, const ForestConfig *config, const char *isa, Pool *pool)
{
    char     optics[512], ground[512];
    CacheKey key = {.digest = NULL};
    if (!etc_path(optics, sizeof optics, "plant_optics.csv") || !etc_path(ground, sizeof ground, "woods.csv")) {
        log_error("render: path of the tables is too long; set PITVIPER_ETC to a shorter one");
        return STATUS_BAD_VALUE;
    }
    Status status = materials_add_plants(&world->materials, optics, ground);
    if (status == STATUS_OK) status = grow_plants(world, &key, config, isa, pool);
    if (status == STATUS_OK) status = forest_create(&world->forest, woods, world->plants, config, isa);
    if (status != STATUS_OK) return status;
    status = light_plants(world, &key, pool);
    if (status != STATUS_OK) return status;
    const PlantsKept kept = {*key.name ? world->cache : NULL, key.name};
    forest_keep(world->forest, &kept);
    status = canopy_create_kept(&world->canopy, woods, world->plants, &world->materials, config->leaves, &kept);
    if (status == STATUS_OK) status = canopy_see_pages(world->canopy, world->forest, config->leaves);
    if (status != STATUS_OK) return status;
    return far_woods_create(&world->far_woods, woods, world->forest, &world->materials, config->leaves, &kept, pool);
}

void world_cool(World *world)
{
    scenery_heat_destroy(world->scenery_heat);
    heat_shadow_destroy(world->shadow);
    heat_destroy(world->heat);
    free(world->drive);
    weather_course_close(world->course);
    world->shadow = NULL, world->heat = NULL, world->drive = NULL, world->course = NULL;
    world->scenery_heat = NULL;
}

void world_close(World *world)
{
    world_cool(world);
    sky_horizons_destroy(world->horizons);
    scenery_tracer_destroy(world->scenery);
    forest_destroy(world->forest);
    canopy_destroy(world->canopy);
    far_woods_destroy(world->far_woods);
    plants_destroy(world->plants);
    atmosphere_close(world->atmosphere);
    planck_table_destroy(world->planck_lwir);
    planck_table_destroy(world->planck_mwir);
    detail_table_close(world->detail);
    materials_close(&world->materials);
    if (world->patches) heat_patches_destroy(world->patches);
    free(world->patches);
    sky_kept_destroy(world->sky);
    surface_cells_destroy(world->cells);
    tracer_destroy(world->tracer);
    memset(world, 0, sizeof *world);
}

static double ground_at_origin(const World *world)
{
    return world->landscape ? elevation_height(&world->landscape->elevation, 0, 0, NULL) : 0;
}

double world_bend(const World *world, RefractionBand band, const double eye_enu[3])
{
    return refraction_bend_at(band, &world->frame, eye_enu, ground_at_origin(world));
}

AirSource world_air_source(const World *world, double ground_k)
{
    return (AirSource){world->atmosphere, world->planck_mwir, world->planck_lwir, ground_k,
                       world->frame.origin.h_m + ground_at_origin(world)};
}

/* ---- what drives the ground: the weather, with the sun and sky of the atmosphere --------------- */

/* Sun and all of its radiation at a place under this weather. STATUS_BAD_VALUE: sun_at's. */
static Status heat_drive_daylight(Daylight *out, const AirSource *source, const Geodetic *place, const Weather *weather,
                                  double unix_s)
{
    Sun          sun;
    const double air_k = isfinite(weather->air_temp_k) ? weather->air_temp_k : 288.15;
    const Status status = sun_at(&sun, unix_s, place, weather->pressure_mbar, air_k - 273.15, NAN);
    if (status == STATUS_OK) daylight_at(out, source, weather, &sun);
    return status;
}

void world_heat_weather(GroundWeather *out, double unix_s, const void *user)
{
    static const double thermometer_m = 2, anemometer_m = 10;
    const HeatDrive    *drive = user;
    Weather             w;
    Daylight            light = {0};
    weather_at(&w, drive->course, unix_s);
    if (heat_drive_daylight(&light, &drive->source, &drive->place, &w, unix_s) != STATUS_OK)
        light.weather = w; /* beyond 1900 .. 2100: night */
    const double air_k = light.weather.air_temp_k;
    *out = (GroundWeather){.air = {air_k, w.humidity * saturation_pa(air_k), 100 * w.pressure_mbar, w.wind_mps,
                                   thermometer_m, anemometer_m},
                           .direct_w_m2 = light.solar_direct_w_m2,
                           .diffuse_w_m2 = light.solar_diffuse_w_m2,
                           .longwave_w_m2 = stefan_w_m2k4 * pow(air_k, 4) - light.longwave_loss_w_m2,
                           .rain_kg_m2s = w.rain_mm_h / 3600};
    memcpy(out->sun_d_enu, light.sun_d_enu, sizeof out->sun_d_enu);
}

/* ---- the ground's heat, driven by the weather's course and the sun and sky ------------------- */

/* The ground's heat, driven by the weather's course and the sun and sky of the atmosphere. */

static void stand_there(ShadowStand *out, const void *canopy, double x_m, double y_m)
{
    CanopyStand c;
    canopy_stand(&c, canopy, x_m, y_m);
    *out = (ShadowStand){(float)c.hides, (float)c.base_m, (float)c.top_m, (float)c.open};
}

static void raise_scenery(float *z_m, const ShadowGrid *g, const void *tracer)
{
    scenery_tracer_tops(z_m, tracer, g->nx, g->ny, g->x0_m, g->y0_m, g->cell_m);
}

static Status cast_shadows(World *world, double shadow_m, Pool *pool)
{
    float     d_enu[3][heat_day_slots];
    float     clumped[heat_day_slots] = {0};
    const int slots = heat_slots(d_enu, world->heat);
    _Static_assert((int)shadow_most_slots >= (int)heat_day_slots, "room for a day");
    for (int k = 0; k < slots && world->canopy; k++)
        clumped[k] = (float)canopy_clumping(world->canopy, (double)d_enu[2][k]);
    const ShadowOf of = {.elevation = &world->landscape->elevation,
                         .cell_m = shadow_m,
                         .slots = slots,
                         .d_enu = d_enu,
                         .clumped = world->canopy ? clumped : NULL,
                         .plants = world->canopy ? stand_there : NULL,
                         .user = world->canopy,
                         .cache = world->cache,
                         .raise = world->scenery ? raise_scenery : NULL,
                         .raise_user = world->scenery};
    return heat_shadow_create(&world->shadow, &of, pool);
}

/* The wood of the plants that stand, and with marks what they are painted with, each material once. */
static int branch_kinds(BranchKind out[branch_most_kinds], const Materials *m, bool marked)
{
    int count = 0;
    for (int k = 0; k < PLANT_KINDS + (marked ? PLANT_MARKS : 0); k++) {
        const int row = k < PLANT_KINDS ? m->plant[k][PLANT_BARK] : m->mark[k - PLANT_KINDS];
        bool      known = row == 0;
        for (int i = 0; i < count; i++) known |= out[i].material == row;
        if (known || count == branch_most_kinds) continue;
        const Material *bark = &m->material[row];
        out[count++] = (BranchKind){row, (double)bark->conductivity_w_mk,
                                    (double)bark->density_kg_m3 * (double)bark->heat_capacity_j_kgk,
                                    (double)bark->solar_absorptance, 1 - (double)bark->rho_lwir};
    }
    return count;
}

Status world_warm(World *world, WeatherCourse *course, const HeatConfig *config, double shadow_m, Pool *pool)
{
    char        path[512];
    HeatConfig  c = *config;
    GroundKinds kinds;
    world_cool(world);
    world->course = course;
    world->drive = calloc(1, sizeof *world->drive);
    if (!world->drive) return STATUS_NO_MEMORY;
    *world->drive = (HeatDrive){course, world_air_source(world, 0), world->frame.origin, config->unix_s};
    c.weather = world_heat_weather, c.user = world->drive, c.pool = pool, c.cache = world->cache;
    if (!etc_path(path, sizeof path, "ground_heat.csv")) return STATUS_BAD_VALUE;
    Status     status = ground_kinds_open(&kinds, path, &world->materials);
    BranchKind branch[branch_most_kinds];
    const int  branches =
        world->forest ? branch_kinds(branch, &world->materials, forest_woods(world->forest)->marked > 0) : 0;
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

static Status ground_at_time(HeatScene **out, const World *world, const GroundMarks *marks, double unix_s, Arena *arena)
{
    HeatNow  *now;
    MarkHeat *mark_heat = NULL;
    *out = NULL;
    if (!world->heat) return STATUS_OK;
    Status status = heat_now(&now, world->heat, unix_s, arena);
    if (status == STATUS_OK && marks)
        status = heat_marks_create(&mark_heat, marks, &world->frame, world->drive->exercise_s, unix_s, now, arena);
    if (status != STATUS_OK) return status;
    *out = arena_alloc(arena, 1, sizeof **out);
    if (!*out) return STATUS_NO_MEMORY;
    **out = (HeatScene){.now = now, .shadow = world->shadow, .marks = mark_heat};
    return STATUS_OK;
}

Status world_heat_at(HeatScene **out, const World *world, const GroundMarks *marks, double unix_s, Arena *arena)
{
    SceneryTemps *scenery;
    Status        status = ground_at_time(out, world, marks, unix_s, arena);
    if (status != STATUS_OK || !*out) return status;
    status = world_scenery_temps(&scenery, world, unix_s, arena);
    (*out)->scenery = status == STATUS_OK ? scenery : NULL;
    return status;
}

double world_air_k(const World *world, double unix_s)
{
    Weather w;
    if (!world->course) return NAN;
    weather_at(&w, world->course, unix_s);
    return w.air_temp_k;
}

/* ---- entities -------------------------------------------------------------------------------- */

enum { weather_kept = 64, vehicle_capacity = 512 };

struct WorldVehicles {
    const World *world;
    VehicleHeat *heat;
    Arena       *arena; /* of scene */
    HeatScene   *scene; /* of scene_s */
    double       scene_s;
    struct {
        double        unix_s;
        GroundWeather weather;
        double        wind_enu_mps[3];
    } kept[weather_kept]; /* by time */
};

double world_low_wind(void)
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
        const double wind_mps = w.wind_mps * world_low_wind();
        world_heat_weather(&v->kept[at].weather, unix_s, v->world->drive);
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
    heat_shadow_at(shadow, &open, scene->shadow, p_enu[0], p_enu[1]);
    for (int k = 0; k < scene->now->slots; k++) {
        const double d = (double)scene->now->slot_d_enu[0][k] * sun_d_enu[0] +
                         (double)scene->now->slot_d_enu[1][k] * sun_d_enu[1] +
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
        const Status status = ground_at_time(&v->scene, world, NULL, unix_s, v->arena);
        if (status != STATUS_OK) return status;
        v->scene_s = unix_s;
    }
    const double up[3] = {0, 0, 1};
    double       lifted_k;
    SurfaceClass surface = SURFACE_GRASS;
    if (world->landscape) surface = landscape_surface(world->landscape, p_enu[0], p_enu[1]);
    if (surface == SURFACE_NONE) surface = SURFACE_GRASS;
    out->ground_k = heat_scene_ground_k(&lifted_k, v->scene, (int)surface, p_enu, up, 1);
    out->under_k = (double)v->scene->now->table.hidden_k[v->scene->now->kind_of[surface]];
    double unlit_k;
    out->water = surface == SURFACE_WATER;
    out->water_k = fmax(heat_scene_ground_k(&unlit_k, v->scene, SURFACE_WATER, p_enu, up, 1), sea_freezes_k);
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
    const double         ground_m = elevation ? elevation_height(elevation, p_enu[0], p_enu[1], NULL) : 0;
    const double         zero_m = elevation ? elevation_height(elevation, 0, 0, NULL) : 0;
    /* heights as in the atmosphere: over the ground at the origin, and the tangent plane departs from the Earth */
    const double high_m = p_enu[2] - zero_m + (p_enu[0] * p_enu[0] + p_enu[1] * p_enu[1]) / (2 * 6371e3);
    const double colder_k = lapse_k_m * clamp(high_m, -500, 11000);
    out->air_k = w->air.temp_k - colder_k;
    out->air_density = exp(-clamp(high_m, -500, 30000) / scale_m);
    out->direct_w_m2 = w->direct_w_m2;
    out->diffuse_w_m2 = w->diffuse_w_m2;
    out->longwave_w_m2 = w->longwave_w_m2 * pow(out->air_k / w->air.temp_k, 4);
    out->above_m = isfinite(ground_m) ? p_enu[2] - ground_m : 0;
    out->ground_k = out->under_k = w->air.temp_k;
    out->water_k = fmax(w->air.temp_k, sea_freezes_k);
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
    const VehicleHeatConfig config = {.first_step_s = fmin(1, about->step_s),
                                      .step_s = about->step_s,
                                      .window_us = about->window_us,
                                      .past_parts = about->past_parts,
                                      .unix_s = world->drive->exercise_s,
                                      .capacity = vehicle_capacity,
                                      .place = place_there,
                                      .user = v};
    const VehicleHeatWorld  of = {world->catalog, &world->materials, &world->parts, &world->frame,
                                  world->tracer,  world->patches,    about->given,  about->kept};
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
