/* sensor/bench/sensor/speed.h: `pitviper bench speed`: the time of a frame, of its rays alone, and of a radar's update. */
#ifndef SENSOR_BENCH_SENSOR_SPEED_H
#define SENSOR_BENCH_SENSOR_SPEED_H

#include "sensor/bench/bench.h"

Status bench_speed(Bench *bench);
Status bench_speed_check(const Bench *bench); /* its options */
/* The radar with phase: targets by signatures, updates. */
Status bench_speed_radar(Bench *bench);

#endif
