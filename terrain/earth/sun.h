/* terrain/earth/sun.h: direction of the sun, by ERFA. Apparent place with parallax and refraction as NREL SPA
 * defines them; within 0.0005 degree of its published vector (tests/terrain/test_sun.c). */
#ifndef TERRAIN_EARTH_SUN_H
#define TERRAIN_EARTH_SUN_H

#include "terrain/earth/geodesy.h"

typedef struct Sun {
    double azimuth_rad;   /* clockwise from north */
    double elevation_rad; /* apparent (refracted) above the horizon */
    double distance_au;
    double d_enu[3]; /* unit, towards the sun, at the place */
} Sun;

/* unix_s: UTC as Unix time, 1900 .. 2100. delta_t_s: TT - UT1; NAN for a built-in estimate. */
Status sun_at(Sun *out, double unix_s, const Geodetic *place, double pressure_mbar, double temp_c, double delta_t_s);

#endif
