/* sensor/bench/sensor/network.h: `pitviper bench network`: a live node, and a process that sends an exercise to it. */
#ifndef SENSOR_BENCH_SENSOR_NETWORK_H
#define SENSOR_BENCH_SENSOR_NETWORK_H

#include "sensor/bench/bench.h"

Status bench_live(Bench *bench);
/* Shared memory and video of a live node, by its latency ledger. */
Status bench_publish(Bench *bench);

#endif
