/* terrain/probe.h: the entries of `pitviper probe` of this module. */
#ifndef TERRAIN_PROBE_H
#define TERRAIN_PROBE_H

#include "pitviper.h"

extern const Probe terrain_probes[];
extern const int   terrain_probe_count;

#endif
