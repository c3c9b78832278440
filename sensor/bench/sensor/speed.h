/* sensor/bench/sensor/speed.h: `pitviper bench speed`: what a frame costs, and what its rays alone cost. */
#ifndef SENSOR_BENCH_SENSOR_SPEED_H
#define SENSOR_BENCH_SENSOR_SPEED_H

#include "sensor/bench/bench.h"

Status bench_speed(Bench *bench);

#endif
