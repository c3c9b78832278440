/* terrain/bench_stability.h: this room's part of `pitviper bench stability`. */
#ifndef TERRAIN_BENCH_STABILITY_H
#define TERRAIN_BENCH_STABILITY_H

#include "pitviper.h"

Status terrain_bench_stability(Bench *bench);
/* terrain/bench_stability_ground.c: its second half. */
Status terrain_bench_stability_ground(Bench *bench);

#endif
