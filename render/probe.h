/* render/probe.h: what `pitviper probe` can ask of this room. */
#ifndef RENDER_PROBE_H
#define RENDER_PROBE_H

#include "pitviper.h"

extern const Probe render_probes[];
extern const int   render_probe_count;

#endif
