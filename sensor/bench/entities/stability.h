/* sensor/bench/entities/stability.h: the entries of `pitviper bench stability` for entities. */
#ifndef SENSOR_BENCH_ENTITIES_STABILITY_H
#define SENSOR_BENCH_ENTITIES_STABILITY_H

#include "sensor/bench/bench.h"

Status entities_bench_stability(Bench *bench);
Status entities_bench_stability_inputs(Bench *bench); /* numbers of PDUs: sensor/bench/entities/stability_inputs.c */
Status entities_bench_stability_text(Bench *bench);   /* numbers in files: sensor/bench/entities/stability_text.c */
Status entities_bench_stability_models(Bench *bench); /* sensor/bench/entities/stability_models.c */

/* Deviation of a matrix from a rotation: R'R - I, worst element, and its handedness. */
static inline void stress_rotation(double *worst, const double r[9])
{
    double product[9], cross[3];
    m3_tmul(product, r, r);
    v3_cross(cross, r, r + 3);
    for (int k = 0; k < 9; k++) bench_worse(worst, product[k] - (k % 4 == 0));
    for (int k = 0; k < 3; k++) bench_worse(worst, cross[k] - r[6 + k]);
}

#endif
