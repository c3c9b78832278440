/* sensor/bench/sensor/woods.h: `pitviper bench woods`: frames of three million trees. */
#ifndef SENSOR_BENCH_SENSOR_WOODS_H
#define SENSOR_BENCH_SENSOR_WOODS_H

#include "sensor/bench/bench.h"

Status bench_woods(Bench *bench);
Status bench_woods_check(const Bench *bench); /* its options */

#endif
