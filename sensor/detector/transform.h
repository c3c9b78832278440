/* sensor/detector/transform.h: Fourier, cosine and sine transforms of planes, of one size each, planned once. Uses
 * FFTW: in double, plans by estimate, without vector code, so that bits do not depend on threads or processor. */
#ifndef SENSOR_DETECTOR_TRANSFORM_H
#define SENSOR_DETECTOR_TRANSFORM_H

#include "pitviper.h"

typedef struct Transform Transform;

typedef enum TransformKind {
    TRANSFORM_COSINES,      /* REDFT10 both ways: plane [rows][columns] to coefficients, in place */
    TRANSFORM_COSINES_BACK, /* REDFT01; there and back multiplies by 4 rows columns */
    TRANSFORM_SINES_BACK,   /* RODFT01, frequencies from 1 */
    TRANSFORM_WAVES_BACK,   /* from: [rows][columns / 2 + 1] pairs, real and imaginary, of the spectrum of a real plane;
                             * to: [rows][columns]. From is overwritten */
    TRANSFORM_ROWS,         /* exp(-2 pi i j k / columns), each row of [rows][columns] complex numbers, in place */
    TRANSFORM_ROWS_BACK,    /* exp(+...); there and back multiplies by columns */
} TransformKind;

/* Makes a transform for these two buffers of transform_alloc alone; all but WAVES_BACK may have in and out the same.
 * Several threads may call it. */
Status transform_create(Transform **out, TransformKind kind, int rows, int columns, double *from, double *to);
void   transform_destroy(Transform *t);
/* No allocation. */
void transform_run(const Transform *t);

/* Doubles with the alignment that transforms need; NULL: no memory. */
double *transform_alloc(size_t count);
void    transform_free(double *values);

#endif
