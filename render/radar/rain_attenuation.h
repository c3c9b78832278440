/* render/radar/rain_attenuation.h: what rain takes from a radio wave: Recommendation ITU-R P.838-3 (2005), k R^alpha.
 */
#ifndef RENDER_RADAR_RAIN_ATTENUATION_H
#define RENDER_RADAR_RAIN_ATTENUATION_H

#include "pitviper.h"

/* Coefficients for a path and a linear or circular polarisation.
 *   f_ghz          1 .. 1000
 *   elevation_rad  of the path, -pi / 2 .. pi / 2; its sign does not matter
 *   tilt_rad       of the electric field against the horizontal: 0 horizontal, pi / 2 vertical, pi / 4 circular too
 * False, and NaN, outside these ranges. k in dB/km of mm/h. Within half a unit of the last printed digit of the
 * examples of ITU-R SG 3 for P.838-3 (tests/render/test_radar_propagation.c); P.838 itself fits T-matrix results of one
 * distribution of drop sizes (Laws and Parsons): real rain scatters by tens of percent about it. */
bool rain_coefficients(double *k, double *alpha, double f_ghz, double elevation_rad, double tilt_rad);

/* dB/km one way. rain_mm_h 0 .. 300. NaN outside. About 1 us. */
double rain_attenuation(double f_ghz, double rain_mm_h, double elevation_rad, double tilt_rad);

#endif
