/* render/light/plant_heat.h: temperatures of leaves and bark. */
#ifndef RENDER_LIGHT_PLANT_HEAT_H
#define RENDER_LIGHT_PLANT_HEAT_H

#include "render/air/air.h"
#include "render/materials/materials.h"

/* A leaf: the steady balance of what it absorbs of sun and sky with what it radiates, gives to the air and transpires;
 * leaves follow within a minute. open: share of the sky that its place in the crown receives, lit: of the direct sun, 0 ..
 * 1: by the ray that the picture's light uses too. Leaves of a place have every tilt: half of the direct sun on average. Its
 * two sides together face all of the sky, whatever its tilt.
 *
 *   boundary layer  0.135 sqrt(wind / d) mol/(m2 s) each side, d = 0.72 of a leaf 5 cm wide, 1.4 in turbulent wind
 *   stomata         0.2 mol/(m2 s) in full sun, a twentieth in the dark: broad leaves well supplied with water
 * Source: Campbell & Norman, An Introduction to Environmental Biophysics (1998), chapters 7 and 14. Linear about the air's
 * temperature: within 0.1 K of the full balance, for leaves 2 K below to 5 K above the air (test_plant_heat.c). */
double leaf_temp_k(const Daylight *light, const Material *m, double air_temp_k, double open, double lit);

/* Bark: the steady balance of a surface with its normal's tilt, less what the wood beneath takes up: the daily wave as
 * far as the branch is thick enough to hold it. The lag behind the sun is not modelled: an
 * hour at most, and the excess within 10 % of conduction in a cylinder of 5 mm .. 0.2 m (test_plant_heat.c). Nor is that
 * of wood behind the air's own daily course, since the weather has one temperature. */
double bark_temp_k(const Daylight *light, const Material *m, double air_temp_k, const double n_enu[3], double radius_m,
                   double open);

#endif
