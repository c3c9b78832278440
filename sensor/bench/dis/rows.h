/* sensor/bench/dis/rows.h: what `pitviper bench` can measure of this room. */
#ifndef SENSOR_BENCH_DIS_ROWS_H
#define SENSOR_BENCH_DIS_ROWS_H

#include "sensor/bench/bench.h"

extern const BenchSuite dis_benches[];
extern const int        dis_bench_count;

#endif
