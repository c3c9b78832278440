/* render/radar/cloud_attenuation.h: what the droplets of cloud and fog take from a radio wave: Recommendation ITU-R
 * P.840-9 (08/2023), Rayleigh absorption by liquid water with its double-Debye permittivity. */
#ifndef RENDER_RADAR_CLOUD_ATTENUATION_H
#define RENDER_RADAR_CLOUD_ATTENUATION_H

#include "pitviper.h"

#include <complex.h>

/* Relative permittivity e' - j e'' of liquid water, exp(+j w t): P.840-9, eqs. 4 to 11 (double Debye, after Liebe).
 *   f_ghz   1 .. 200
 *   temp_k  233.15 .. 323.15; NaN outside */
double complex water_permittivity(double f_ghz, double temp_k);

/* Specific attenuation coefficient K_l, dB/km one way for 1 g/m3 of liquid water.
 *   f_ghz   1 .. 200: droplets below 0.1 mm are small against the wavelength
 *   temp_k  of the droplets, 233.15 (where the last freeze) .. 323.15
 *   returns NaN outside
 * Relative difference to values of ITU-Rpy, printed to ten digits, below 1e-9 (5 to 183 GHz, -8 to 30 C;
 * tests/render/test_radar_propagation.c). */
double cloud_attenuation(double f_ghz, double temp_k);

/* Liquid water of fog, g/m3, from the visibility (2 % contrast, as weather.visibility_m): Kunkel, J. Climate Appl.
 * Meteor. 23 (1984) 34: extinction = 144.7 W^0.88 per km, of measured advection fogs. Fog is what leaves 1000 m or
 * less: 0 above, which steps from 0.017 g/m3. NaN below 10 m. Fogs of one visibility differ by a factor of two and
 * more, as their droplets do. */
double fog_liquid_g_m3(double visibility_m);

#endif
