/* terrain/weather/standard_atmosphere.h: air by height: U.S. Standard Atmosphere, 1976.
 *
 * The standard's seven layers in closed form: temperature linear in geopotential height, pressure hydrostatic. Between
 * 80 and 86 km temp_k is the molecular-scale temperature, of which the standard's pressure, density and speed of sound
 * follow. Below -5 km as at -5 km; above 86 km, where the standard has other laws, the last temperature goes on.
 * Against the standard's tables: their last digit (tests/terrain/test_standard_atmosphere.c). Source: NOAA-S/T 76-1562.
 */
#ifndef TERRAIN_WEATHER_STANDARD_ATMOSPHERE_H
#define TERRAIN_WEATHER_STANDARD_ATMOSPHERE_H

#include "pitviper.h"

typedef struct StandardAir {
    double temp_k, pressure_pa, density_kg_m3, sound_mps;
} StandardAir;

/* height_msl_m: geometric, above mean sea level; finite. */
void standard_atmosphere(StandardAir *out, double height_msl_m);

#endif
