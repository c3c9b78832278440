/* entities/probe.h: the entries of `pitviper probe` of this module. */
#ifndef ENTITIES_PROBE_H
#define ENTITIES_PROBE_H

#include "pitviper.h"

extern const Probe entities_probes[];
extern const int   entities_probe_count;

#endif
