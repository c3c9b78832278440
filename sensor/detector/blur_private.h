/* sensor/detector/blur_private.h: modulation transfer of optics, detector footprint, smear and jitter (closed forms),
 * and the blur that it makes of a plane.
 *
 * Frequencies are cycles per pixel of the image; lengths are pixels. tests/sensor/test_mtf.c compares them with
 * published values to 1e-9, and the chain, measured on rendered planes, with their product. */
#ifndef SENSOR_DETECTOR_BLUR_PRIVATE_H
#define SENSOR_DETECTOR_BLUR_PRIVATE_H

#include "pitviper.h"

/* MTF of a circular aperture that diffracts incoherent light. x = f / cutoff >= 0; the MTF is 0 beyond 1. obscuration:
 * the central one, as a share of the diameter, 0 .. 0.95. Source: O'Neill, "Transfer function for an annular aperture",
 * JOSA 46 (1956) 285. */
double mtf_aperture(double x, double obscuration);
/* sin(pi x) / (pi x): a footprint or a smear of length w at frequency f is mtf_sinc(w f). May be negative. */
double mtf_sinc(double x);
/* exp(-2 pi^2 sigma^2 f^2) */
double mtf_gauss(double sigma_px, double f_cyc_px);

typedef struct MtfChain {
    double cutoff_cyc_px; /* pitch / (wavelength x f-number); INFINITY: no diffraction */
    double obscuration;
    double footprint_px; /* side of the sensitive square; 1: the whole pixel */
    int    places;       /* sample positions per row or column of a pixel that the renderer has averaged, 1 .. */
    double smear_px[2];  /* of the line of sight within the integration time: column, row */
    double jitter_px;    /* rms per axis, within the integration time */
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

/* ---- a plane ------------------------------------------------------------------------------------ */

/* An MTF chain applied to a plane.
 *
 * A convolution with mirrored edges is a product in the cosine transform (half-sample symmetry), so no padding is
 * needed and a plane costs two transforms of its own size. A smear that is oblique to the rows is not even in each
 * axis; its odd part goes through the sine transforms of the same cosine coefficients, which a third transform gives
 * (transform.h).
 *
 * Exact to 0.4 cycles a pixel along rows and columns; from there to Nyquist, the limit of the image's sampling, the
 * chain tapers instead of ending abruptly, so that hot objects do not ring (see blur.c). An edge overshoots by 1 %
 * with the detector footprint alone and not at all behind optics; a point has a dark ring of 0.8 % at most. Negative
 * radiance is clipped to 0. The mean is preserved to rounding (the coefficient of frequency 0 is not touched); with
 * an oblique smear except in the corners. 720 x 486, one core: 5 ms; 17 ms with an oblique smear. */
typedef struct Blur Blur;

/* Creates a blur of the chain without its smear, which changes per frame. STATUS_NO_MEMORY. One thread may use it at a
 * time. */
Status blur_create(Blur **out, int width, int height, const MtfChain *chain);
/* The frequency at which the chain is evaluated for frequency f of a row or column, -0.5 .. 0.5. */
double blur_tapered(double f_cyc_px);
/* Transfer of a smear at (fx, fy), tapered: the difference between fx and -fx fades from 0.4 to 0.5 cycles a pixel. */
double blur_smear_pass(const double smear_px[2], double fx, double fy);
void   blur_destroy(Blur *blur);
/* Rows top down; in and out may be the same. Values that are not finite become 0 before, and come back afterwards. */
void blur_apply(Blur *blur, float *out, const float *in, const double smear_px[2]);
/* Does the same, and adds a plane before clipping at 0. more NULL: adds none. */
void blur_apply_with(Blur *blur, float *out, const float *in, const double smear_px[2], const double *more);

#endif
