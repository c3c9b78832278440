/* sensor/quality/machine_factor.h: the speed of this machine relative to that of the table. */
#ifndef SENSOR_QUALITY_MACHINE_FACTOR_H
#define SENSOR_QUALITY_MACHINE_FACTOR_H

#include "pitviper.h"

/* This machine's time of the table's first row, divided by the table's: on this many threads, to two digits. About
 * two seconds, mostly for the scenes. STATUS_BAD_VALUE, logged: the table's first row is not the fastest settings. */
Status machine_factor(double *factor, const char *table_path, int threads);

#endif
