/* sensor/bench/entities/rows.h: the rows of `pitviper bench` for entities. */
#ifndef SENSOR_BENCH_ENTITIES_ROWS_H
#define SENSOR_BENCH_ENTITIES_ROWS_H

#include "sensor/bench/bench.h"

extern const BenchSuite entities_benches[];
extern const int        entities_bench_count;

/* Of the suite `precision`. */
Status bench_precision_motion(Bench *bench);

#endif
