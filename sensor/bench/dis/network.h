/* sensor/bench/dis/network.h: `pitviper bench network`: sockets and the recorder. */
#ifndef SENSOR_BENCH_DIS_NETWORK_H
#define SENSOR_BENCH_DIS_NETWORK_H

#include "sensor/bench/bench.h"

Status bench_network(Bench *bench);

#endif
