/* sensor/detector/blur.h: an MTF chain applied to a plane.
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
#ifndef SENSOR_DETECTOR_BLUR_H
#define SENSOR_DETECTOR_BLUR_H

#include "sensor/detector/mtf.h"

typedef struct Blur Blur;

/* Without the smear of the chain, which changes per frame. STATUS_NO_MEMORY. One user at a time. */
Status blur_create(Blur **out, int width, int height, const MtfChain *chain);
/* The frequency at which the chain is evaluated for frequency f of a row or column, -0.5 .. 0.5. */
double blur_tapered(double f_cyc_px);
/* Transfer of a smear at (fx, fy), tapered; the difference between fx and -fx fades from 0.4 to 0.5. */
double blur_smear_pass(const double smear_px[2], double fx, double fy);
void   blur_destroy(Blur *blur);
/* Rows top down; in and out may be the same. Values that are not finite become 0 before, and come back afterwards. */
void   blur_apply(Blur *blur, float *out, const float *in, const double smear_px[2]);
/* The same with a plane added before clipping at 0; more: NULL: none. */
void   blur_apply_with(Blur *blur, float *out, const float *in, const double smear_px[2], const double *more);

#endif
