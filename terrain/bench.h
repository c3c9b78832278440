/* terrain/bench.h: what `pitviper bench` can measure of this room. */
#ifndef TERRAIN_BENCH_H
#define TERRAIN_BENCH_H

#include "pitviper.h"

extern const BenchSuite terrain_benches[];
extern const int        terrain_bench_count;

#endif
