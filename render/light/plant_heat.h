/* render/light/plant_heat.h: temperatures of leaves and bark. */
#ifndef RENDER_LIGHT_PLANT_HEAT_H
#define RENDER_LIGHT_PLANT_HEAT_H

#include "render/air/air.h"
#include "render/materials/materials.h"

/* A leaf: the steady balance of what it absorbs of sun and sky with what it radiates, gives to the air and transpires;
 * leaves follow within a minute. open: share of the sun and of the sky that its place in the crown receives, 0 .. 1: the
 * mean of sunlit and shaded leaves there.
 *
 *   boundary layer  0.135 sqrt(wind / d) mol/(m2 s) each side, d = 0.72 of a leaf 5 cm wide, 1.4 in turbulent wind
 *   stomata         0.2 mol/(m2 s) in full sun, a twentieth in the dark: broad leaves well supplied with water
 *   air             at 60 % of relative humidity (an estimate: the weather has none)
 * Source: Campbell & Norman, An Introduction to Environmental Biophysics (1998), chapters 7 and 14. Linear about the air's
 * temperature: within 2 % of the excess for excesses below 15 K (tests/render/test_plant_heat.c). */
double leaf_temp_k(const Daylight *light, const Material *m, double air_temp_k, double open);

/* Bark: the steady balance of a surface with its normal's tilt, less what the wood beneath takes up: the daily wave as
 * far as the branch is thick enough to hold it. The lag behind the sun is not modelled. */
double bark_temp_k(const Daylight *light, const Material *m, double air_temp_k, const double n_enu[3], double radius_m,
                   double open);

#endif
