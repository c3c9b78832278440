/* dis/bench_network.h: `pitviper bench network`, this room's part: sockets and the recorder. */
#ifndef DIS_BENCH_NETWORK_H
#define DIS_BENCH_NETWORK_H

#include "pitviper.h"

Status bench_network(Bench *bench);

#endif
