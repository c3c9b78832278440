/* dis/bench.h: what `pitviper bench` can measure of this room. */
#ifndef DIS_BENCH_H
#define DIS_BENCH_H

#include "pitviper.h"

extern const BenchSuite dis_benches[];
extern const int        dis_bench_count;

#endif
