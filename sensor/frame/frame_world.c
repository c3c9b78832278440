/* sensor/frame/frame_world.c: a world with the atmosphere and the plants of the settings, and the sun of a frame. */
#include "sensor/frame/frame_world.h"

Status frame_world_open(World *out, const Config *config, const Catalog *catalog, const Landscape *landscape,
                        const LocalFrame *frame, const char *isa)
{
    const Status status = world_open(out, catalog, landscape, frame, isa);
    if (status == STATUS_OK && !config->terrain.detail) {
        detail_table_close(out->detail);
        out->detail = NULL;
    }
    return status;
}

WeatherFog frame_world_fog(const Config *config)
{
    static const WeatherFog fog[] = {[FOG_AUTO] = WEATHER_FOG_AUTO,
                                     [FOG_NONE] = WEATHER_FOG_NONE,
                                     [FOG_RADIATION] = WEATHER_FOG_RADIATION,
                                     [FOG_ADVECTION] = WEATHER_FOG_ADVECTION};
    return fog[config->weather.fog];
}

Status frame_world_model(char out[frame_model_size], const Config *config)
{
    Weather weather = weather_default();
    weather.air_temp_k = config->weather.air_temp_k;
    weather.humidity = 0.01 * config->weather.humidity_pct;
    const double kg_m3 = isnan(weather.air_temp_k) ? NAN : weather_vapour_kg_m3(&weather);
    return atmosphere_nearest(out, frame_model_size, config->weather.atmosphere, weather.air_temp_k, kg_m3);
}

Status frame_world_air(World *world, const Config *config)
{
    char model[frame_model_size];
    world_cool(world);
    atmosphere_close(world->atmosphere);
    world->atmosphere = NULL;
    const Status status = frame_world_model(model, config);
    if (status != STATUS_OK) return status;
    return atmosphere_open_at(&world->atmosphere, model,
                              droplets_haze_m(config->weather.visibility_m, frame_world_fog(config)));
}

void frame_world_radar(World *world, const Config *config)
{
    world->radar.lobe_rad = config->radar.lobe_deg * rad_per_deg;
}

Status frame_world(World *out, const Config *config, const Catalog *catalog, const Landscape *landscape,
                   const LocalFrame *frame, const char *isa)
{
    Status status = frame_world_open(out, config, catalog, landscape, frame, isa);
    if (status == STATUS_OK) status = frame_world_air(out, config);
    if (status == STATUS_OK) frame_world_radar(out, config);
    return status;
}

Cache *frame_world_cache(const Config *config)
{
    return config->cache.on ? cache_open(config->cache.folder, (size_t)config->cache.most_mb << 20) : NULL;
}

Status frame_world_plant(World *world, const Woods *woods, const Config *config, const char *isa, Pool *pool)
{
    const ForestConfig forest = {.leaves = config->terrain.woods_leaves,
                                 .fine = true,
                                 .level1_px = config->terrain.woods_level1_px,
                                 .sway = config->terrain.woods_sway,
                                 .tables = config->terrain.woods_tables,
                                 .far_m = config->terrain.woods_far_m,
                                 .far_mb = config->terrain.woods_far_mb};
    if (!woods) return STATUS_OK;
    const double begun_s = wall_clock_s();
    const Status status = world_plant(world, woods, &forest, isa, pool);
    log_detail("woods: grown in %.0f ms", 1e3 * (wall_clock_s() - begun_s));
    return status;
}

/* The weather by the settings alone, which a course of the weather starts from. The world must have an atmosphere. */
static Weather frame_weather(const Config *config, const World *world)
{
    Weather base = weather_default();
    base.visibility_m = config->weather.visibility_m;
    base.air_temp_k =
        isnan(config->weather.air_temp_k) ? atmosphere_temp_k(world->atmosphere, 0) : config->weather.air_temp_k;
    base.pressure_mbar = config->weather.pressure_mbar;
    base.wind_mps = config->weather.wind_mps;
    base.wind_from_rad = config->weather.wind_from_deg * rad_per_deg;
    base.humidity = 0.01 * config->weather.humidity_pct;
    base.cloud = config->weather.cloud;
    base.rain_mm_h = config->weather.rain_mmh;
    base.fog = frame_world_fog(config);
    return base;
}

Weather frame_weather_at(const Config *config, const World *world, double unix_s)
{
    Weather weather = frame_weather(config, world);
    if (world->course) weather_at(&weather, world->course, unix_s);
    return weather;
}

static Status warm_scenery(World *world, const HeatConfig *heat, Pool *pool)
{
    const double begun_s = wall_clock_s();
    const Status status = world_warm_scenery(world, scenery_tracer_of(world->scenery), heat, NULL, pool);
    if (status == STATUS_OK)
        log_detail("heat: scenery warmed up in %.0f ms, %.1f MB", 1e3 * (wall_clock_s() - begun_s),
                   1e-6 * (double)scenery_heat_bytes(world->scenery_heat));
    return status;
}

Status frame_world_warm(World *world, const Config *config, double unix_s, Pool *pool)
{
    const WeatherCourseConfig about = {frame_weather(config, world), config->weather.air_range_k,
                                       world->frame.origin.lon_rad, world->frame.origin.lat_rad};
    WeatherCourse            *course;
    HeatConfig                heat = heat_default_config();
    const double              begun_s = wall_clock_s();
    Status                    status = weather_course_open(&course, config->weather.day, &about);
    if (status != STATUS_OK) return status;
    log_detail("weather: %s", weather_course_about(course));
    heat.step_s = config->heat.step_s;
    heat.facets = config->heat.facets;
    heat.unix_s = unix_s;
    status = world_warm(world, course, &heat, config->heat.shadow_m, pool);
    if (status == STATUS_OK)
        log_detail("heat: ground warmed up over two days in %.0f ms, %.1f MB, %.1f MB of shadows",
                   1e3 * (wall_clock_s() - begun_s), 1e-6 * (double)heat_bytes(world->heat),
                   world->shadow ? 1e-6 * (double)heat_shadow_bytes(world->shadow) : 0.0);
    if (status == STATUS_OK && world->scenery) status = warm_scenery(world, &heat, pool);
    return status;
}

/* ---- sun and atmosphere of one frame, from time, position, weather and view ---------------------- */

Status frame_light(FrameLight *out, const World *world, const Config *config, const FrameEye *eye, Pool *pool,
                   Arena *arena)
{
    const Weather weather = frame_weather_at(config, world, eye->unix_s);
    HeatScene    *heat = NULL;
    GroundMarks   marks;
    Geodetic      place;
    double        p_ecef[3], r_ecef_from_host[9], d_ecef[3];
    Status        status = geodetic_from_ecef(&place, eye->p_ecef);
    if (status == STATUS_OK) status = ecef_from_geodetic(p_ecef, r_ecef_from_host, &place);
    if (status == STATUS_OK)
        status = sun_at(&out->sun, eye->unix_s, &place, weather.pressure_mbar, weather.air_temp_k - 273.15, NAN);
    if (status == STATUS_OK) status = world_marks_at(&marks, world, eye->marks, eye->view->p_enu, eye->unix_s, arena);
    if (status == STATUS_OK) status = world_heat_at(&heat, world, &marks, eye->unix_s, arena);
    if (status != STATUS_OK) return status;
    Sun local = out->sun;
    m3_mul_v3(d_ecef, r_ecef_from_host, out->sun.d_enu);
    m3_tmul_v3(local.d_enu, world->frame.r_ecef_from_enu, d_ecef);
    m3_tmul(out->r_host_from_enu, r_ecef_from_host, world->frame.r_ecef_from_enu);

    /* heights in the atmosphere are above the ground at the origin, and the tangent plane departs from the Earth */
    const double   *p_enu = eye->view->p_enu;
    const double    ground_m = world->landscape ? elevation_height(&world->landscape->elevation, 0, 0, NULL) : 0;
    const double    eye_height_m = p_enu[2] - ground_m + (p_enu[0] * p_enu[0] + p_enu[1] * p_enu[1]) / (2 * 6371e3);
    const double    ground_k = heat ? heat_ground_k(heat->now, SURFACE_GRASS, (const double[3]){0, 0, 1}, 0, 1, 1) : 0;
    const AirSource source = world_air_source(world, ground_k);
    const AirEye    air_eye = {eye_height_m, render_air_bands(eye->bands, config_optical(config)), eye->view};
    status = air_at(&out->air, &source, &weather, &local, &air_eye, pool, arena);
    out->air.heat = heat;
    return status;
}

void frame_turn_normals(Picture *picture, const double r_host_from_enu[9])
{
    const size_t count = (size_t)picture->width * (size_t)picture->height;
    for (size_t i = 0; i < count; i++) {
        const double n[3] = {picture->normal[0][i], picture->normal[1][i], picture->normal[2][i]};
        double       turned[3];
        m3_mul_v3(turned, r_host_from_enu, n);
        for (int k = 0; k < 3; k++) picture->normal[k][i] = (float)turned[k];
    }
}
