/* sensor/detector/mtf.h: modulation transfer of optics, detector footprint, smear and jitter, closed forms.
 *
 * Frequencies are cycles per pixel of the picture; lengths are pixels. tests/sensor/test_mtf.c holds them against
 * published values to 1e-9 and the chain, measured on our own planes, against their product. */
#ifndef SENSOR_DETECTOR_MTF_H
#define SENSOR_DETECTOR_MTF_H

#include "pitviper.h"

/* Diffraction of a circular aperture in incoherent light. x = f / cutoff >= 0, 0 beyond 1; obscuration: central, share
 * of the diameter, 0 .. 0.95. Source: O'Neill, "Transfer function for an annular aperture", JOSA 46 (1956) 285. */
double mtf_aperture(double x, double obscuration);
/* sin(pi x) / (pi x): a footprint or a smear of length w at frequency f is mtf_sinc(w f). May be negative. */
double mtf_sinc(double x);
/* exp(-2 pi^2 sigma^2 f^2) */
double mtf_gauss(double sigma_px, double f_cyc_px);

typedef struct MtfChain {
    double cutoff_cyc_px;  /* pitch / (wavelength x f-number); INFINITY: no diffraction */
    double obscuration;
    double footprint_px;   /* side of the square that a detector sees; 1: the whole pixel */
    int    places;         /* along a row of a pixel, or a column, that the picture has averaged already, 1 .. */
    double smear_px[2];    /* of the line of sight within the integration time: column, row */
    double jitter_px;      /* rms a direction, within the integration time */
} MtfChain;

/* What the optics pass at (fx, fy), |f| <= 0.5. */
double mtf_optics(const MtfChain *chain, double fx, double fy);
/* What the footprint passes on top of what the renderer's own averaging has taken away already. n evenly spaced
 * places pass sin(pi f) / (n sin(pi f / n)): nothing is taken by one, the whole sinc by many, and this is the
 * quotient. Exact along rows and columns. For a footprint of a whole pixel that is sinc(f / n). */
double mtf_footprint(const MtfChain *chain, double fx, double fy);
double mtf_smear(const MtfChain *chain, double fx, double fy);
double mtf_jitter(const MtfChain *chain, double fx, double fy);
/* Product of the four. */
double mtf_chain(const MtfChain *chain, double fx, double fy);

#endif
