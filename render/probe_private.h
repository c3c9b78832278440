/* render/probe_private.h: probes with a file of their own. */
#ifndef RENDER_PROBE_PRIVATE_H
#define RENDER_PROBE_PRIVATE_H

#include "pitviper.h"

Status      heat_probe_open(void **state, int argc, char **argv);
const char *heat_probe_row(void *state, const ProbeValue *in, ProbeValue *out);
void        heat_probe_close(void *state);

Status      wall_probe_open(void **state, int argc, char **argv);
const char *wall_probe_row(void *state, const ProbeValue *in, ProbeValue *out);
void        wall_probe_close(void *state);

Status      heat_node_probe_open(void **state, int argc, char **argv);
const char *heat_node_probe_row(void *state, const ProbeValue *in, ProbeValue *out);
void        heat_node_probe_close(void *state);

Status      propagation_probe_open(void **state, int argc, char **argv);
const char *propagation_probe_row(void *state, const ProbeValue *in, ProbeValue *out);
void        propagation_probe_close(void *state);
const char *radar_equation_probe_row(void *state, const ProbeValue *in, ProbeValue *out);
Status      rcs_probe_open(void **state, int argc, char **argv);
const char *rcs_probe_row(void *state, const ProbeValue *in, ProbeValue *out);
void        rcs_probe_close(void *state);
Status      clutter_probe_open(void **state, int argc, char **argv); /* of both */
const char *clutter_probe_row(void *state, const ProbeValue *in, ProbeValue *out);
const char *clutter_cell_probe_row(void *state, const ProbeValue *in, ProbeValue *out);
void        clutter_probe_close(void *state);

#endif
