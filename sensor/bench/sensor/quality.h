/* sensor/bench/sensor/quality.h: settings jointly, time against error over several scenes: the table from which
 * quality.* selects. */
#ifndef SENSOR_BENCH_SENSOR_QUALITY_H
#define SENSOR_BENCH_SENSOR_QUALITY_H

#include "sensor/bench/bench.h"

Status bench_quality(Bench *bench);
Status bench_quality_check(const Bench *bench); /* its options */

#endif
