/* sensor/node/run/run_flight.c: the missile of a run's own: whether it fits the run, and how it is opened. */
#include "sensor/node/run/host_run_private.h"

Status run_check_flight(const Run *run)
{
    const Options *o = &run->options;
    if (!node_flight_asked(&o->config) || run->flight) return STATUS_OK;
    if (o->host_count > 1 || o->sweep || (o->command == COMMAND_REPLAY && !o->config.exercise.causal)) {
        log_error(
            "flight: flight.missile: in `run`, or a replay of what that recorded, with --causal: one host, no sweep");
        return STATUS_BAD_VALUE;
    }
    return node_flight_check(&o->config, o->command == COMMAND_RUN);
}

static double arrival_s(const void *player, double t_s) { return player_arrival_s(player, t_s); }

Status run_open_flight(NodeFlight **out, const Run *run, const Player *player, const char *folder, const HostPlan *plan)
{
    const Options     *o = &run->options;
    const NodeFlightOf of = {.config = &o->config,
                             .folder = folder,
                             .target = plan->aim,
                             .version = run->first.version,
                             .exercise = (uint8_t)(run->exercise >= 0 ? run->exercise : run->first.exercise),
                             .live = o->command == COMMAND_RUN,
                             .notes = run->view.notes,
                             .user = run->user,
                             .note = run->note,
                             .send = run->report,
                             .clock = player,
                             .arrival_s = arrival_s};
    return node_flight_asked(&o->config) ? node_flight_open(out, &of) : STATUS_OK;
}
