/* sensor/bench/terrain/rows.h: the rows of `pitviper bench` for terrain. */
#ifndef SENSOR_BENCH_TERRAIN_ROWS_H
#define SENSOR_BENCH_TERRAIN_ROWS_H

#include "sensor/bench/bench.h"

extern const BenchSuite terrain_benches[];
extern const int        terrain_bench_count;

/* Of the suite `precision`. */
Status bench_precision_earth(Bench *bench);
Status bench_precision_land(Bench *bench);

#endif
