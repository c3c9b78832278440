/* render/probe.h: the subcommands of `pitviper probe` for render. */
#ifndef RENDER_PROBE_H
#define RENDER_PROBE_H

#include "pitviper.h"

extern const Probe render_probes[];
extern const int   render_probe_count;

#endif
