/* entities/probe_private.h: rows of the table of entities/probe.c that other files of this folder evaluate. */
#ifndef ENTITIES_PROBE_PRIVATE_H
#define ENTITIES_PROBE_PRIVATE_H

#include "entities/probe.h"

Status      flight_probe_open(void **state, int argc, char **argv);
const char *flight_probe_row(void *state, const ProbeValue *in, ProbeValue *out);
void        flight_probe_close(void *state);

#endif
