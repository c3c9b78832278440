/* sensor/bench/sensor/speed.h: `pitviper bench speed`: the time of a frame, and of its rays alone. */
#ifndef SENSOR_BENCH_SENSOR_SPEED_H
#define SENSOR_BENCH_SENSOR_SPEED_H

#include "sensor/bench/bench.h"

Status bench_speed(Bench *bench);

#endif
