/* sensor/quality/machine_factor.h: how this machine's time compares with the table's. */
#ifndef SENSOR_QUALITY_MACHINE_FACTOR_H
#define SENSOR_QUALITY_MACHINE_FACTOR_H

#include "pitviper.h"

/* This machine's time of the table's first row over the table's: on so many threads, to two digits. About two seconds,
 * mostly for the scenes. STATUS_BAD_VALUE, logged: the table's first row is not the quickest settings. */
Status machine_factor(double *factor, const char *table_path, int threads);

#endif
