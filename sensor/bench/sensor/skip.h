/* sensor/bench/sensor/skip.h: `pitviper bench skip`: the time that each exact skip saves, and in which scene most. */
#ifndef SENSOR_BENCH_SENSOR_SKIP_H
#define SENSOR_BENCH_SENSOR_SKIP_H

#include "sensor/bench/bench.h"

Status bench_skip(Bench *bench);

#endif
