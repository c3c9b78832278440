/* render/bench.h: what `pitviper bench` can measure of this room. */
#ifndef RENDER_BENCH_H
#define RENDER_BENCH_H

#include "pitviper.h"

extern const BenchSuite render_benches[];
extern const int        render_bench_count;

#endif
