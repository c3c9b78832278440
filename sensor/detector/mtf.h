/* sensor/detector/mtf.h: modulation transfer of optics, detector footprint, smear and jitter, closed forms.
 *
 * Frequencies are cycles per pixel of the image; lengths are pixels. tests/sensor/test_mtf.c compares them with
 * published values to 1e-9, and the chain, measured on rendered planes, with their product. */
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
    double footprint_px;   /* side of the sensitive square; 1: the whole pixel */
    int    places;         /* sample positions per row or column of a pixel that the renderer has averaged, 1 .. */
    double smear_px[2];    /* of the line of sight within the integration time: column, row */
    double jitter_px;      /* rms per axis, within the integration time */
} MtfChain;

/* Transfer of the optics at (fx, fy), |f| <= 0.5. */
double mtf_optics(const MtfChain *chain, double fx, double fy);
/* Transfer of the footprint divided by that of the renderer's averaging: n evenly spaced sample positions
 * pass sin(pi f) / (n sin(pi f / n)), from 1 for one to the sinc for many. Exact along rows and columns. For a
 * footprint of a whole pixel that is sinc(f / n). */
double mtf_footprint(const MtfChain *chain, double fx, double fy);
double mtf_smear(const MtfChain *chain, double fx, double fy);
double mtf_jitter(const MtfChain *chain, double fx, double fy);
/* Product of the four. */
double mtf_chain(const MtfChain *chain, double fx, double fy);

#endif
