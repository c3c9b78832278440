/* terrain/probe.h: what `pitviper probe` can ask of this room. */
#ifndef TERRAIN_PROBE_H
#define TERRAIN_PROBE_H

#include "pitviper.h"

extern const Probe terrain_probes[];
extern const int   terrain_probe_count;

#endif
