/* entities/bench.h: what `pitviper bench` can measure of this room. */
#ifndef ENTITIES_BENCH_H
#define ENTITIES_BENCH_H

#include "pitviper.h"

extern const BenchSuite entities_benches[];
extern const int        entities_bench_count;

/* Of the suite `precision`. */
Status bench_precision_motion(Bench *bench);

#endif
