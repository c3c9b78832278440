/* render/radar/radar_equation.h: the radar equation: power and voltage of an echo, noise of the receiver.
 *
 * Ratios are plain numbers, not decibels: gains, losses and noise figure. Source: any book on radar, as Skolnik,
 * Introduction to Radar Systems (2001), chapters 1 and 2. */
#ifndef RENDER_RADAR_RADAR_EQUATION_H
#define RENDER_RADAR_RADAR_EQUATION_H

#include "pitviper.h"

#include <complex.h>

typedef struct RadarLink {
    double transmitted_w;               /* > 0, during the pulse */
    double transmit_gain, receive_gain; /* > 0, towards the target */
    double wavelength_m;                /* > 0 */
    double range_m;                     /* > 0 */
    double loss; /* >= 1, of power, both ways, of the system; and of the air where `path` is not used */
} RadarLink;

/* Pt Gt Gr lambda^2 sigma / ((4 pi)^3 R^4 L), W. NaN outside the ranges, and for a cross-section below 0. */
double radar_received_w(const RadarLink *link, double rcs_m2);

/* Received wave of a target of scattering amplitude S (render/radar/scatter.h: sigma = 4 pi |S|^2), sqrt(W), so that
 * the square of its modulus is radar_received_w; phase of 2 R in a vacuum against the transmitter's. path: of
 * radar_path_factor; 1: none. */
double complex radar_voltage(const RadarLink *link, double complex scattering_m, double complex path);

/* Thermal noise at the input, k 290 K B F, W: bandwidth_hz > 0, noise_factor >= 1. NaN outside. */
double radar_noise_w(double bandwidth_hz, double noise_factor);

#endif
