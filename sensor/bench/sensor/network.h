/* sensor/bench/sensor/network.h: `pitviper bench network`, this room's part: a live node and somebody who sends to
 * it. */
#ifndef SENSOR_BENCH_SENSOR_NETWORK_H
#define SENSOR_BENCH_SENSOR_NETWORK_H

#include "sensor/bench/bench.h"

Status bench_live(Bench *bench);

#endif
