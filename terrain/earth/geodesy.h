/* terrain/earth/geodesy.h: WGS 84, through GeographicLib (used by geodesy.cpp only). */
#ifndef TERRAIN_EARTH_GEODESY_H
#define TERRAIN_EARTH_GEODESY_H

#include "pitviper.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct Geodetic {
    double lat_rad, lon_rad; /* -pi/2 .. pi/2, -pi .. pi */
    double h_m;              /* above the ellipsoid */
} Geodetic;

/* STATUS_BAD_VALUE for non-finite input or a latitude beyond a pole; out untouched. Error 7 nm within
 * 5000 km of the surface (GeographicLib::Geocentric). */
Status geodetic_from_ecef(Geodetic *out, const double p_ecef[3]);
/* r_ecef_from_enu may be NULL: axes of the local east, north, up at the place. */
Status ecef_from_geodetic(double p_ecef[3], double r_ecef_from_enu[9], const Geodetic *place);

#ifdef __cplusplus
}
#endif
#endif
