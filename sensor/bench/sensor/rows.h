/* sensor/bench/sensor/rows.h: the suites of whole frames, detectors and the live node. */
#ifndef SENSOR_BENCH_SENSOR_ROWS_H
#define SENSOR_BENCH_SENSOR_ROWS_H

#include "sensor/bench/bench.h"

extern const BenchSuite sensor_benches[];
extern const int        sensor_bench_count;

#endif
