/* render/radar/signature_error.h: how wrong the field of a list of hits is, by the grid of tubes that made it and the bin of
 * aspect that it serves.
 *
 * A tube that is cut by an edge, or whose mirrors part, is wrong by a share of its own field, with a phase of its own; so the
 * squares of the tubes' fields add up to the square of the error, however the fields themselves interfere. The share is
 * measured (tank, 10 and 35 GHz); held-out models and frequencies are within a factor of two of it
 * (tests/render/test_signature_error.c). What physical optics and the model leave out is not in it. */
#ifndef RENDER_RADAR_SIGNATURE_ERROR_H
#define RENDER_RADAR_SIGNATURE_ERROR_H

#include "render/radar/centres.h"

/* Mean square of the field's error, m2: co-polarised (HH or VV), cross-polarised. */
typedef struct SignatureError {
    double same_m2, cross_m2;
} SignatureError;

/* Of centres of a list of hits; of a given signature: 0. */
void signature_error(SignatureError *out, const Centres *centres);
/* Standard deviation in dB of a cross section, of a field s with an error of mean square error_m2: 10 log10(1 + sqrt(2 e) /
 * |s|), which for small errors is that of a sum of vectors of random phase. NaN for s = 0. */
double signature_error_db(double complex s, double error_m2);

#endif
