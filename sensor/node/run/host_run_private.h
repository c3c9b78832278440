/* sensor/node/run/host_run_private.h: what host_run.c hands to run_end.c when a host's run ends. */
#ifndef SENSOR_NODE_RUN_HOST_RUN_PRIVATE_H
#define SENSOR_NODE_RUN_HOST_RUN_PRIVATE_H

#include "sensor/node/flight/node_flight.h"
#include "sensor/node/run/host_run.h"

/* What run.json says of a host's run, whether it was completed or not. */
typedef struct RunEnd {
    const char          *folder, *host, *state; /* state: complete, stopped or failed */
    const Choices       *choices;
    const SessionResult *result;
    const DisCounters   *heard;
    const WoodsChoice   *woods;
} RunEnd;

/* Whether a missile of the node's own (flight.missile) fits the run; else logged. */
Status run_check_flight(const Run *run);
/* Opens it; *out stays where it is not asked for. folder: of the products. */
Status run_open_flight(NodeFlight **out, const Run *run, const Player *player, const char *folder,
                       const HostPlan *plan);
/* Writes run.json. */
Status run_write(const Run *run, const RunEnd *end);
/* Writes run.json for the frames that were rendered, also when the run stopped early, and tells the user where they
 * are and what they lack. */
Status run_conclude(const Run *run, const RunEnd *end);

#endif
