/* render/radar/chaff.h: a cloud of half-wave dipoles: what it returns, takes from a wave, and how it grows.
 *
 * A thin dipole at resonance, short-circuited (all metal), at an angle a to the line of sight and b between its
 * projection and a polarisation, scatters back
 *
 *     sigma = (G^2 lambda^2 / pi) F(a)^4 cos^4 b           F = cos(pi/2 cos a) / sin a, G = 1.641 = 1 / <F^2>
 *
 * G^2 lambda^2 / pi = 0.857 lambda^2: four times its effective area G lambda^2 / 4 pi by G, for a current twice that of
 * a matched load. Over all directions <F^4> = 0.470, <cos^4 b> = 3/8, <cos^2 b sin^2 b> = 1/8, so that one dipole
 * returns 0.151 lambda^2 in the polarisation that was sent and a third of it (-4.8 dB) in the other; HH and VV correlate
 * by a third (Peebles, IEEE Trans. AES-20 (1984) 128, finds the same by another way; handbooks say 0.15 .. 0.18
 * lambda^2). Of a wave's power it takes lambda^2 / (2 pi) = 0.159 lambda^2 (G lambda^2 / pi <F^2> <cos^2 b>). */
#ifndef RENDER_RADAR_CHAFF_H
#define RENDER_RADAR_CHAFF_H

#include "render/radar/scatter.h"

static const double chaff_same = 0.151, chaff_taken = 0.15915494309189535; /* of lambda^2, a dipole */

/* Density of the cloud: Gaussian in every direction, of this rms radius at an age. It starts as the cloud that a
 * dispenser throws, 1 m, tends to 8 m with a time constant of 1 s by the ejection and the wake, and spreads by 0.3 m/s
 * as dipoles fall at different speeds: estimates, after films of cartridges that bloom within a second. */
double chaff_radius_m(double age_s);
/* Fall of a dipole in still air: the figure in common use, and an estimate of its spread. */
static const double chaff_fall_mps = 0.3, chaff_fall_spread_mps = 0.07;
static const double chaff_turbulence_mps = 0.5; /* rms of the air's motion within a cloud, each way; estimate */

/* Scattering matrix of a bunch whose mean cross section in the polarisation sent is sigma_m2, from six standard
 * normals: complex Gaussian, <|hh|^2> = <|vv|^2> = 3 <|hv|^2> = 3 <hh vv*>. The same in any basis. */
void chaff_scatter(ScatterMatrix *out, double sigma_m2, const double normal[6]);

/* Dipoles by area along a ray, 1/m2, from its start to range_m: of `dipoles` about centre_m, seen from its start. */
double chaff_column_1_m2(double dipoles, double radius_m, const double centre_m[3], const double d[3], double range_m);

#endif
