/* sensor/world/frame_world.c: opens a world with the atmosphere, the radar and the plants of the settings. */
#include "sensor/world/frame_world.h"

Status frame_world(World *out, const Config *config, const Catalog *catalog, const Landscape *landscape,
                   const LocalFrame *frame, const char *isa)
{
    Status status = world_open(out, catalog, landscape, frame, isa);
    if (status == STATUS_OK)
        status = atmosphere_open_at(&out->atmosphere, config->weather.atmosphere, config->weather.visibility_m);
    if (status != STATUS_OK) return status;
    out->radar.lobe_rad = config->radar.lobe_deg * rad_per_deg;
    if (strcmp(config->terrain.detail, "off") == 0) {
        detail_table_close(out->detail);
        out->detail = NULL;
    }
    return status;
}

Status frame_world_plant(World *world, const Woods *woods, const Config *config, const char *isa, Pool *pool)
{
    const ForestConfig forest = {.leaves = strcmp(config->terrain.woods_leaves, "on") == 0,
                                 .level1_px = config->terrain.woods_level1_px, .sway = config->terrain.woods_sway};
    if (!woods) return STATUS_OK;
    const double begun_s = wall_clock_s();
    const Status status  = world_plant(world, woods, &forest, isa, pool);
    log_detail("woods: grown in %.0f ms", 1e3 * (wall_clock_s() - begun_s));
    return status;
}

Weather frame_weather(const Config *config, const World *world)
{
    Weather base = weather_default();
    base.visibility_m  = config->weather.visibility_m;
    base.air_temp_k    = isnan(config->weather.air_temp_k) ? atmosphere_temp_k(world->atmosphere, 0) : config->weather.air_temp_k;
    base.pressure_mbar = config->weather.pressure_mbar;
    base.wind_mps      = config->weather.wind_mps;
    base.wind_from_rad = config->weather.wind_from_deg * rad_per_deg;
    base.humidity      = 0.01 * config->weather.humidity_pct;
    base.cloud         = config->weather.cloud;
    base.rain_mm_h     = config->weather.rain_mmh;
    return base;
}

Weather frame_weather_at(const Config *config, const World *world, double unix_s)
{
    Weather weather = frame_weather(config, world);
    if (world->course) weather_at(&weather, world->course, unix_s);
    return weather;
}

Status frame_world_warm(World *world, const Config *config, double unix_s, Pool *pool)
{
    const WeatherCourseConfig about = {frame_weather(config, world), config->weather.air_range_k, world->frame.origin.lon_rad,
                                       world->frame.origin.lat_rad};
    WeatherCourse *course;
    HeatConfig     heat = heat_default_config();
    const double   begun_s = wall_clock_s();
    Status         status = weather_course_open(&course, config->weather.day, &about);
    if (status != STATUS_OK) return status;
    log_detail("weather: %s", weather_course_about(course));
    heat.step_s = config->heat.step_s;
    heat.facets = config->heat.facets;
    heat.unix_s = unix_s;
    status = world_warm(world, course, &heat, config->heat.shadow_m, pool);
    if (status == STATUS_OK)
        log_detail("heat: ground warmed up over two days in %.0f ms, %.1f MB, %.1f MB of shadows", 1e3 * (wall_clock_s() - begun_s),
                   1e-6 * (double)heat_bytes(world->heat), world->shadow ? 1e-6 * (double)shadow_map_bytes(world->shadow) : 0.0);
    return status;
}
