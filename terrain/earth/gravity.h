/* terrain/earth/gravity.h: the normal gravity field of WGS 84, in axes that turn with the Earth.
 *
 * Gravitation is that of the level ellipsoid: mu and the zonal harmonics J2, J4, J6. Its potential is that of the
 * closed form (Heiskanen & Moritz, Physical Geodesy, 1967, ch. 2) within the harmonics left out, J8 = 1.4e-11: below
 * 1e-8 m/s2 from the surface up (tests/terrain/test_gravity.c). The true field deviates from the normal one by up to
 * 1e-3 m/s2 in mountains, which is not modelled. Source: NIMA TR8350.2, 3rd edition. */
#ifndef TERRAIN_EARTH_GRAVITY_H
#define TERRAIN_EARTH_GRAVITY_H

#include "pitviper.h"

static const double earth_turn_rps = 7.292115e-5; /* about +z of ECEF */

/* Gravitation alone, m/s2, ECEF axes; no centrifugal part. p_ecef not 0. */
void earth_gravitation(double g_ecef_mps2[3], const double p_ecef[3]);

/* Adds what a point at p_ecef that moves with v_ecef in axes turning at turn_rps about z has besides: the centrifugal
 * acceleration, w^2 (x, y, 0), and Coriolis's, -2 w x v. */
void earth_turning(double a_ecef_mps2[3], const double p_ecef[3], const double v_ecef_mps[3], double turn_rps);

#endif
