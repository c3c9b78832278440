/* sensor/bench/dis/stability.h: the entries of `pitviper bench stability` for dis. */
#ifndef SENSOR_BENCH_DIS_STABILITY_H
#define SENSOR_BENCH_DIS_STABILITY_H

#include "sensor/bench/bench.h"

Status dis_bench_stability(Bench *bench);

#endif
