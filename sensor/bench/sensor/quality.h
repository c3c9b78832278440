/* sensor/bench/sensor/quality.h: settings together, time against error over several scenes: what quality.* picks
 * from. */
#ifndef SENSOR_BENCH_SENSOR_QUALITY_H
#define SENSOR_BENCH_SENSOR_QUALITY_H

#include "sensor/bench/bench.h"

Status bench_quality(Bench *bench);

#endif
