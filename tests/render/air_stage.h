/* tests/render/air_stage.h: the air of a frame by the tables of US 1976, and rays along which it is looked at. */
#ifndef TESTS_RENDER_AIR_STAGE_H
#define TESTS_RENDER_AIR_STAGE_H

#include "tests/check.h"
#include "render/air/air.h"

static PlanckTable *mwir, *lwir;
static Atmosphere  *atmosphere;
static Arena       *arena;
static Hits         hits;
static Rays         rays;

enum { all_bands = (1 << AIR_BAND_COUNT) - 1 };

static int open_tables(void **state)
{
    (void)state;
    return planck_table_create(&mwir, 3.4e-6, 4.8e-6) != STATUS_OK ||
           planck_table_create(&lwir, 8e-6, 12e-6) != STATUS_OK ||
           atmosphere_open(&atmosphere, "us1976") != STATUS_OK || !(arena = arena_create());
}

static int close_tables(void **state)
{
    (void)state;
    planck_table_destroy(mwir);
    planck_table_destroy(lwir);
    atmosphere_close(atmosphere);
    arena_destroy(arena);
    return 0;
}

/* The state of US 1976's own ground, LOWTRAN7's: 288.2 K, 7745 ppmv of vapour at 1013 hPa. */
static inline Weather us1976_weather(void)
{
    Weather weather = weather_default();
    weather.air_temp_k = 288.2;
    weather.humidity = 7745e-6 * 101300 / weather_saturation_pa(288.2);
    return weather;
}

static const double sun_azimuth = 2.1;

static Sun sun_at_elevation(double elevation_deg)
{
    const double e = elevation_deg * rad_per_deg;
    return (Sun){.azimuth_rad = sun_azimuth,
                 .elevation_rad = e,
                 .distance_au = 1,
                 .d_enu = {cos(e) * sin(sun_azimuth), cos(e) * cos(sun_azimuth), sin(e)}};
}

static Air air_of(const Weather *weather, double elevation_deg, double eye_m, unsigned bands, const View *view)
{
    const Sun       sun = sun_at_elevation(elevation_deg);
    const AirSource source = {atmosphere, mwir, lwir, 0, 0};
    const AirEye    eye = {eye_m, bands, view};
    Air             air;
    arena_reset(arena);
    CHECK(air_at(&air, &source, weather, &sun, &eye, NULL, arena) == STATUS_OK);
    return air;
}

static void clear(void) { hits.count = rays.count = 0; }

static int add(double azimuth_rad, double elevation_rad, double range_m)
{
    const int i = hits.count++;
    rays.count = hits.count;
    rays.d_enu[0][i] = cos(elevation_rad) * sin(azimuth_rad);
    rays.d_enu[1][i] = cos(elevation_rad) * cos(azimuth_rad);
    rays.d_enu[2][i] = sin(elevation_rad);
    for (int k = 0; k < 3; k++) rays.o_enu[k][i] = 0;
    hits.range_m[i] = range_m;
    return i;
}

#endif
