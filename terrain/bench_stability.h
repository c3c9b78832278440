/* terrain/bench_stability.h: this room's part of `pitviper bench stability`. */
#ifndef TERRAIN_BENCH_STABILITY_H
#define TERRAIN_BENCH_STABILITY_H

#include "pitviper.h"

Status terrain_bench_stability(Bench *bench);
/* terrain/bench_stability_ground.c: its second half. */
Status terrain_bench_stability_ground(Bench *bench);

/* The worst so far; what is no number is worse than any. */
static inline void bench_worse(double *worst, double error)
{
    error = fabs(error);
    if (!(error <= *worst)) *worst = isnan(error) ? INFINITY : error;
}

static inline void bench_stress(Bench *bench, const char *what, double error, double limit, const char *unit,
                                const char *against)
{
    BenchRow row    = bench_row(what);
    row.error       = error;
    row.error_limit = limit;
    row.error_unit  = unit;
    row.against     = against;
    bench_add(bench, &row);
}

#endif
