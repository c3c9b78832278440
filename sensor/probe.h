/* sensor/probe.h: the subcommands of `pitviper probe` for detectors. */
#ifndef SENSOR_PROBE_H
#define SENSOR_PROBE_H

#include "pitviper.h"

extern const Probe sensor_probes[];
extern const int   sensor_probe_count;

#endif
