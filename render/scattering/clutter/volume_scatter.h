/* render/scattering/clutter/volume_scatter.h: what drops of rain and dipoles of chaff scatter back to a radar by
 * the volume that they fill, and take from a wave. */
#ifndef RENDER_SCATTERING_CLUTTER_VOLUME_SCATTER_H
#define RENDER_SCATTERING_CLUTTER_VOLUME_SCATTER_H

#include "render/scattering/scatter.h"

/* ---- a sphere ----------------------------------------------------------------------------------- */

/* What a sphere scatters back and takes from a plane wave: Mie's series.
 *
 * Source: Bohren & Huffman, Absorption and Scattering of Light by Small Particles, 1983, 4.3 to 4.8: the logarithmic
 * derivative within the sphere by downward recurrence, Riccati-Bessel functions outside upwards. */
typedef struct MieSphere {
    double back_m2;       /* backscattering cross section as radar has it: 4 pi |S|^2 */
    double scattering_m2; /* scattered all round */
    double extinction_m2; /* taken from the wave */
} MieSphere;

/* permittivity: relative, e' - j e'' of exp(+j w t). radius_m > 0, wavelength_m > 0, 2 pi radius / wavelength up to 200
 * and |sqrt(permittivity)| times it up to 2000; else NaN. Against the exact series of a metal sphere (permittivity
 * -j 1e12) and Rayleigh's limit: tests/render/test_rain_scatter.c. Some 3 us at 94 GHz and 3 mm. */
MieSphere mie_sphere(double radius_m, double complex permittivity, double wavelength_m);

/* ---- rain --------------------------------------------------------------------------------------- */

/* What rain sends back to a radar by its volume, and how its drops fall.
 *
 * Drops are spheres of water (attenuation.h) of the sizes of Marshall & Palmer, J. Meteor. 5 (1948) 165:
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
enum { rain_sizes = 160 };

static const double rain_depolarised = 0.0031622776601683795; /* power, HV over VV: -25 dB */

typedef struct RainScatter {
    double back_1_m;          /* backscatter by volume, m2/m3 */
    double extinction_1_m;    /* of power, one way; for tests: loss is P.838's (attenuation.h) */
    double z_mm6_m3;          /* sum of D^6: Rayleigh's reflectivity factor */
    double share[rain_sizes]; /* of back_1_m from drops up to size i + 1, rising to 1 */
} RainScatter;

/*   f_ghz      1 .. 200
 *   temp_k     of the drops, 273.15 .. 323.15
 *   rain_mm_h  0 .. 300
 * False, and zeros, outside. Sums over drops of 0 .. 8 mm in equal steps: within 0.1 % of five times as many
 * (tests/render/test_rain_scatter.c). 0.4 ms. Real rain of one rate differs by a factor of two with its drops. */
bool rain_scatter(RainScatter *out, double f_ghz, double temp_k, double rain_mm_h);

/* Fall speed, m/s, of the drop that is larger than those from which the share u (0 .. 1) of the power comes back. */
double rain_fall_mps(const RainScatter *rain, double u);

/* ---- chaff -------------------------------------------------------------------------------------- */

/* A cloud of half-wave dipoles: what it returns, takes from a wave, and how it grows.
 *
 * A thin dipole at resonance, short-circuited (all metal), at an angle a to the line of sight and b between its
 * projection and a polarisation, scatters back
 *
 *     sigma = (G^2 lambda^2 / pi) F(a)^4 cos^4 b           F = cos(pi/2 cos a) / sin a, G = 1.641 = 1 / <F^2>
 *
 * G^2 lambda^2 / pi = 0.857 lambda^2: four times its effective area G lambda^2 / 4 pi by G, for a current twice
 * that of a matched load. Over all directions <F^4> = 0.470, <cos^4 b> = 3/8, <cos^2 b sin^2 b> = 1/8, so that one
 * dipole returns 0.151 lambda^2 in the polarisation that was sent and a third of it (-4.8 dB) in the other; HH and
 * VV correlate by a third (Peebles, IEEE Trans. AES-20 (1984) 128, finds the same by another way; handbooks say
 * 0.15 .. 0.18 lambda^2). Of a wave's power it takes lambda^2 / (2 pi) = 0.159 lambda^2 (G lambda^2 / pi <F^2>
 * <cos^2 b>). */
static const double chaff_same = 0.151, chaff_taken = 0.15915494309189535; /* of lambda^2, a dipole */

/* Density of the cloud: Gaussian in every direction, of this rms radius at an age. It starts as the cloud that a
 * dispenser throws, 1 m, tends to 8 m with a time constant of 1 s by the ejection and the wake, and spreads by 0.3 m/s
 * as dipoles fall at different speeds: estimates, after films of cartridges that bloom within a second. */
double chaff_radius_m(double age_s);
/* Speed at which a dipole falls in still air: the figure in common use, and an estimate of its spread. */
static const double chaff_fall_mps = 0.3, chaff_fall_spread_mps = 0.07;
static const double chaff_turbulence_mps = 0.5; /* rms of the air's motion within a cloud, each way; estimate */

/* Scattering matrix of a bunch whose mean cross section in the polarisation sent is sigma_m2, from six standard
 * normals: complex Gaussian, <|hh|^2> = <|vv|^2> = 3 <|hv|^2> = 3 <hh vv*>. The same in any basis. */
void chaff_scatter(ScatterMatrix *out, double sigma_m2, const double normal[6]);

/* Number of dipoles per area, 1/m2, that a ray passes from its start to range_m. centre_m: middle of the cloud, seen
 * from the start of the ray. */
double chaff_column_1_m2(double dipoles, double radius_m, const double centre_m[3], const double d[3], double range_m);

#endif
