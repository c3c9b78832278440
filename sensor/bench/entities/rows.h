/* sensor/bench/entities/rows.h: what `pitviper bench` can measure of this room. */
#ifndef SENSOR_BENCH_ENTITIES_ROWS_H
#define SENSOR_BENCH_ENTITIES_ROWS_H

#include "sensor/bench/bench.h"

extern const BenchSuite entities_benches[];
extern const int        entities_bench_count;

/* Of the suite `precision`. */
Status bench_precision_motion(Bench *bench);

#endif
