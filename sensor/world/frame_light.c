/* sensor/world/frame_light.c: sun and atmosphere of one frame from time, position, weather and view. */
#include "sensor/world/frame_light.h"

#include "sensor/world/frame_world.h"

Status frame_light(Air *air, Sun *sun, double r_host_from_enu[9], const World *world, const Config *config,
                   const FrameEye *eye, Pool *pool, Arena *arena)
{
    const Weather weather = frame_weather_at(config, world, eye->unix_s);
    HeatScene    *heat = NULL;
    Geodetic place;
    double   p_ecef[3], r_ecef_from_host[9], d_ecef[3];
    Status   status = geodetic_from_ecef(&place, eye->p_ecef);
    if (status == STATUS_OK) status = ecef_from_geodetic(p_ecef, r_ecef_from_host, &place);
    if (status == STATUS_OK)
        status = sun_at(sun, eye->unix_s, &place, weather.pressure_mbar, weather.air_temp_k - 273.15, NAN);
    if (status == STATUS_OK) status = world_heat_at(&heat, world, eye->marks, eye->unix_s, arena);
    if (status != STATUS_OK) return status;
    Sun local = *sun;
    m3_mul_v3(d_ecef, r_ecef_from_host, sun->d_enu);
    m3_tmul_v3(local.d_enu, world->frame.r_ecef_from_enu, d_ecef);
    m3_tmul(r_host_from_enu, r_ecef_from_host, world->frame.r_ecef_from_enu);

    /* heights in the atmosphere are above the ground at the origin, and the tangent plane departs from the Earth */
    const double     *p_enu = eye->view->p_enu;
    const double      ground_m = world->landscape ? elevation_height(&world->landscape->elevation, 0, 0, NULL) : 0;
    const double      eye_height_m = p_enu[2] - ground_m + (p_enu[0] * p_enu[0] + p_enu[1] * p_enu[1]) / (2 * 6371e3);
    const double      ground_k = heat ? heat_ground_k(heat->now, SURFACE_GRASS, (const double[3]){0, 0, 1}, 0, 1, 1) : 0;
    const AirSource   source = {world->atmosphere, world->planck_mwir, world->planck_lwir, ground_k};
    const AirEye      air_eye = {eye_height_m, render_air_bands(eye->bands, config_optical(config)), eye->view};
    status = air_at(air, &source, &weather, &local, &air_eye, pool, arena);
    air->heat = heat;
    return status;
}

void turn_normals(Picture *picture, const double r_host_from_enu[9])
{
    const size_t count = (size_t)picture->width * (size_t)picture->height;
    for (size_t i = 0; i < count; i++) {
        const double n[3] = {picture->normal[0][i], picture->normal[1][i], picture->normal[2][i]};
        double       turned[3];
        m3_mul_v3(turned, r_host_from_enu, n);
        for (int k = 0; k < 3; k++) picture->normal[k][i] = (float)turned[k];
    }
}
