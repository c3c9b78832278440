/* dis/bench_stability.h: this room's part of `pitviper bench stability`. */
#ifndef DIS_BENCH_STABILITY_H
#define DIS_BENCH_STABILITY_H

#include "pitviper.h"

Status dis_bench_stability(Bench *bench);

#endif
