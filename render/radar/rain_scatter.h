/* render/radar/rain_scatter.h: what rain sends back to a radar by its volume, and how its drops fall.
 *
 * Drops are spheres of water (cloud_attenuation.h) of the sizes of Marshall & Palmer, J. Meteor. 5 (1948) 165:
 *
 *     N(D) = 8000 exp(-4.1 R^-0.21 D) per m3 and mm        D in mm, R in mm/h
 *
 * each with its cross section by Mie's series: Rayleigh's form is 3 dB too strong at 35 GHz and 25 mm/h, and 13 dB at
 * 95 GHz and 5 mm/h. They fall at 9.65 - 10.3 exp(-0.6 D) m/s in still air (Atlas, Srivastava & Sekhon,
 * Rev. Geophys. 11 (1973) 1).
 *
 * Drops are flattened and canted, so that a little comes back cross-polarised: the linear depolarisation ratio of rain
 * is -25 dB here; measured -35 .. -20 dB, with rate and elevation (Bringi & Chandrasekar, Polarimetric Doppler Weather
 * Radar, 2001, 7). HH and VV are taken as equal; large drops seen from the side return up to 2 dB more in HH. */
#ifndef RENDER_RADAR_RAIN_SCATTER_H
#define RENDER_RADAR_RAIN_SCATTER_H

#include "pitviper.h"

enum { rain_sizes = 160 };

static const double rain_depolarised = 0.0031622776601683795; /* power, HV over VV: -25 dB */

typedef struct RainScatter {
    double back_1_m;            /* backscatter by volume, m2/m3 */
    double extinction_1_m;      /* of power, one way; for tests: loss is P.838's (rain_attenuation.h) */
    double z_mm6_m3;            /* sum of D^6: Rayleigh's reflectivity factor */
    double share[rain_sizes];   /* of back_1_m from drops up to size i + 1, rising to 1 */
} RainScatter;

/*   f_ghz      1 .. 200
 *   temp_k     of the drops, 273.15 .. 323.15
 *   rain_mm_h  0 .. 300
 * False, and zeros, outside. Sums over drops of 0 .. 8 mm in equal steps: within 0.1 % of five times as many
 * (tests/render/test_rain_scatter.c). 0.4 ms. Real rain of one rate differs by a factor of two with its drops. */
bool rain_scatter(RainScatter *out, double f_ghz, double temp_k, double rain_mm_h);

/* Fall speed, m/s, of the drop below which the share u (0 .. 1) of what comes back arises. */
double rain_fall_mps(const RainScatter *rain, double u);

#endif
