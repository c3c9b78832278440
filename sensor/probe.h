/* sensor/probe.h: what `pitviper probe` can ask of this room. */
#ifndef SENSOR_PROBE_H
#define SENSOR_PROBE_H

#include "pitviper.h"

extern const Probe sensor_probes[];
extern const int   sensor_probe_count;

#endif
