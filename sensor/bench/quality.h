/* sensor/bench/quality.h: settings together, time against error over several scenes: what quality.* picks from. */
#ifndef SENSOR_BENCH_QUALITY_H
#define SENSOR_BENCH_QUALITY_H

#include "sensor/bench/bench.h"

Status bench_quality(Bench *bench);

/* This machine's time of the table's first row over the table's: on so many threads, to two digits. About two seconds,
 * mostly for the scenes. */
Status bench_machine_factor(double *factor, const char *table_path, int threads);

#endif
