/* sensor/bench/render/rows.h: the benchmarks of render for `pitviper bench`. */
#ifndef SENSOR_BENCH_RENDER_ROWS_H
#define SENSOR_BENCH_RENDER_ROWS_H

#include "sensor/bench/bench.h"

extern const BenchSuite render_benches[];
extern const int        render_bench_count;

/* Of the suite `precision`. */
Status bench_precision_light(Bench *bench);
Status bench_precision_air(Bench *bench);
Status bench_precision_trace(Bench *bench);
Status bench_precision_heat(Bench *bench);
Status bench_precision_network(Bench *bench);
Status bench_precision_patches(Bench *bench);
Status bench_precision_gas(Bench *bench);
Status bench_precision_radar(Bench *bench);
/* Of the suite `speed`: precision_network.c. */
Status bench_speed_network(Bench *bench);
/* Of the suite `crowd`: speed_crowd.c. */
Status bench_speed_crowd(Bench *bench);

#endif
