/* sensor/bench/terrain/stability.h: the entries of `pitviper bench stability` for terrain. */
#ifndef SENSOR_BENCH_TERRAIN_STABILITY_H
#define SENSOR_BENCH_TERRAIN_STABILITY_H

#include "sensor/bench/bench.h"

Status terrain_bench_stability(Bench *bench);
/* sensor/bench/terrain/stability_ground.c: its second half. */
Status terrain_bench_stability_ground(Bench *bench);
/* sensor/bench/terrain/stability_import.c: its third part. */
Status terrain_bench_stability_import(Bench *bench);

#endif
