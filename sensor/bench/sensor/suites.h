/* sensor/bench/sensor/suites.h: all suites of `pitviper bench`. */
#ifndef SENSOR_BENCH_SENSOR_SUITES_H
#define SENSOR_BENCH_SENSOR_SUITES_H

#include "sensor/bench/bench.h"

/* One after the other from a zeroed state; NULL: no more. A BenchNext. */
const BenchSuite *bench_next_suite(size_t state[2]);

#endif
