/* terrain/earth/refraction.h: how far lines of sight bend in air.
 *
 * A ray through air whose refractive index falls with height has the curvature (1 - 1/k) / R towards the Earth: over an
 * Earth of the radius k R it is straight. Here the Earth stays as it is, and a ray sinks below its straight line by
 * bend d^2, d the horizontal distance from the eye: bend = (1 - 1/k) / (2 R). Of k 1.149 that is 0.65 m over 8 km and
 * 25 m over 50 km; of 4/3 twice as much.
 *
 * k = 1.149 (refraction coefficient 0.13) is the mean by day over land and sea at optical and infrared wavelengths: the
 * horizon of an eye at h m is 2.065 sqrt(h) nautical miles away (Bowditch's older table 2.07, its newer 2.12), its dip
 * is 1.797' sqrt(h) (Nautical Almanac 1.76', k = 1.198: 2 % less). By night, over cold or hot ground it is anything
 * between 0.95 and 1.3. Radar: 4/3, ITU-R P.310 and P.453.
 *
 * Higher air bends less. bend is the mean over the heights between the ground and the eye of a gradient that falls as
 * exp(-h / scale): the horizon's dip is then what that atmosphere gives, and the effect dies out above it without a
 * step. Optical: scale 11 km, within 6 % of the mean gradient of density of the US Standard Atmosphere 1976 up to any
 * height; radar: 7.35 km (ITU-R P.453). Steep lines of sight from 10 km are bent up to 0.05 mrad too much, and those
 * between two aircraft of that height 1.6 times as much as there (0.25 mrad over 100 km); from space the edge of the
 * Earth by a fifth too little (0.02 degrees of dip). tests/terrain/test_refraction.c. */
#ifndef TERRAIN_EARTH_REFRACTION_H
#define TERRAIN_EARTH_REFRACTION_H

#include "terrain/earth/geodesy.h"

typedef enum RefractionBand { REFRACTION_OPTICAL, REFRACTION_RADAR } RefractionBand;

/* 1/m, of an eye and of ground at heights over the ellipsoid, m. 0 where one is no number. */
double refraction_bend(RefractionBand band, double eye_m, double ground_m);
/* The same of an eye in a local frame; ground_enu_m: height of the ground at its origin, over that. */
double refraction_bend_at(RefractionBand band, const LocalFrame *frame, const double eye_enu[3], double ground_enu_m);

/* How far a ray has sunk at a point, or what is seen there is raised, m. */
static inline double refraction_drop(double bend_per_m, const double eye_enu[3], const double p_enu[3])
{
    const double x = p_enu[0] - eye_enu[0], y = p_enu[1] - eye_enu[1];
    return bend_per_m * (x * x + y * y);
}

#endif
