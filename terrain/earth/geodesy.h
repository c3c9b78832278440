/* terrain/earth/geodesy.h: WGS 84, through GeographicLib (used by geodesy.cpp only), and local frames. */
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

/* ECEF <-> east-north-up about one origin, in double. The matrix is taken once from GeographicLib; a conversion is
 * then a 3x3 and an offset, 1 nm at ECEF size. */
typedef struct LocalFrame {
    Geodetic origin;
    double   origin_ecef[3];
    double   r_ecef_from_enu[9];
} LocalFrame;

Status local_frame_at(LocalFrame *out, const Geodetic *origin);

static inline void enu_from_ecef(double p_enu[3], const LocalFrame *frame, const double p_ecef[3])
{
    double d_ecef[3];
    v3_sub(d_ecef, p_ecef, frame->origin_ecef);
    m3_tmul_v3(p_enu, frame->r_ecef_from_enu, d_ecef);
}

static inline void ecef_from_enu(double p_ecef[3], const LocalFrame *frame, const double p_enu[3])
{
    double d_ecef[3];
    m3_mul_v3(d_ecef, frame->r_ecef_from_enu, p_enu);
    v3_add(p_ecef, d_ecef, frame->origin_ecef);
}

#ifdef __cplusplus
}
#endif
#endif
