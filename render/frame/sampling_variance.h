/* render/frame/sampling_variance.h: the error of the mean of a pixel's samples, estimated from the differences among
 * them. */
#ifndef RENDER_FRAME_SAMPLING_VARIANCE_H
#define RENDER_FRAME_SAMPLING_VARIANCE_H

#include "pitviper.h"

/* Error of a mean over n x n samples, squared, by the squared differences d of neighbours among them:
 * mean_variance_factor sum d^2 / n^4. 0.09: of our rotated grid against half planes at all angles and places it is
 * 0.115 for n = 2, 0.093, 0.087, 0.085 for 3, 4, 6 and 0.106 for 16 (tests/render/test_error_law.c). */
static const double mean_variance_factor = 0.09;

/* Squared error of the mean of n x n samples of a pixel, row by row on the rotated grid of pixels.h:
 * mean_variance_factor times the squared differences of neighbours over n^4. rms within 15 % over half planes,
 * n 2 .. 16. */
double error_budget_sampling_variance(const float *out, int n);

#endif
