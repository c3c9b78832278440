/* sensor/bench.h: what `pitviper bench` can measure of this room. */
#ifndef SENSOR_BENCH_H
#define SENSOR_BENCH_H

#include "pitviper.h"

extern const BenchSuite sensor_benches[];
extern const int        sensor_bench_count;

#endif
