/* render/light/plant_heat.h: temperatures of leaves. */
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

#endif
