/* render/radar/mie_sphere.h: what a sphere scatters back and takes from a plane wave: Mie's series.
 *
 * Source: Bohren & Huffman, Absorption and Scattering of Light by Small Particles, 1983, 4.3 to 4.8: the logarithmic
 * derivative within the sphere by downward recurrence, Riccati-Bessel functions outside upwards. */
#ifndef RENDER_RADAR_MIE_SPHERE_H
#define RENDER_RADAR_MIE_SPHERE_H

#include "pitviper.h"

#include <complex.h>

typedef struct MieSphere {
    double back_m2;       /* backscattering cross section as radar has it: 4 pi |S|^2 */
    double scattering_m2; /* scattered all round */
    double extinction_m2; /* taken from the wave */
} MieSphere;

/* permittivity: relative, e' - j e'' of exp(+j w t). radius_m > 0, wavelength_m > 0, 2 pi radius / wavelength up to 200
 * and |sqrt(permittivity)| times it up to 2000; else NaN. Against the exact series of a metal sphere (permittivity
 * -j 1e12) and Rayleigh's limit: tests/render/test_rain_scatter.c. Some 3 us at 94 GHz and 3 mm. */
MieSphere mie_sphere(double radius_m, double complex permittivity, double wavelength_m);

#endif
