/* sensor/bench/dis/rows.h: the rows of `pitviper bench` for dis. */
#ifndef SENSOR_BENCH_DIS_ROWS_H
#define SENSOR_BENCH_DIS_ROWS_H

#include "sensor/bench/bench.h"

extern const BenchSuite dis_benches[];
extern const int        dis_bench_count;

#endif
