/* sensor/bench/sensor/stability.h: `pitviper bench stability`: detectors and displays at extreme inputs, and threads
 * that agree. */
#ifndef SENSOR_BENCH_SENSOR_STABILITY_H
#define SENSOR_BENCH_SENSOR_STABILITY_H

#include "sensor/bench/bench.h"

Status sensor_bench_stability(Bench *bench);

#endif
