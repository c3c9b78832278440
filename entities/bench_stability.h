/* entities/bench_stability.h: this room's part of `pitviper bench stability`. */
#ifndef ENTITIES_BENCH_STABILITY_H
#define ENTITIES_BENCH_STABILITY_H

#include "pitviper.h"

Status entities_bench_stability(Bench *bench);
Status entities_bench_stability_inputs(Bench *bench); /* numbers of PDUs: entities/bench_stability_inputs.c */
Status entities_bench_stability_text(Bench *bench);   /* numbers in files: entities/bench_stability_text.c */
Status entities_bench_stability_models(Bench *bench); /* entities/bench_stability_models.c */

/* How far a matrix is from a rotation: R'R - I, worst element, and its hand. */
static inline void stress_rotation(double *worst, const double r[9])
{
    double product[9], cross[3];
    m3_tmul(product, r, r);
    v3_cross(cross, r, r + 3);
    for (int k = 0; k < 9; k++) bench_worse(worst, product[k] - (k % 4 == 0));
    for (int k = 0; k < 3; k++) bench_worse(worst, cross[k] - r[6 + k]);
}

#endif
