/* sensor/commands/lockstep.c: frames in step with a CIGI host: its clock, and the loop of a replay. */
#include "sensor/commands/lockstep.h"

#include "sensor/node/run/stop.h"

static bool over(void *user)
{
    (void)user;
    return stop_asked();
}

static Status make_frame(void *user, const FrameTime *frame)
{
    bool shown;
    return session_frame(&shown, user, frame);
}

void lockstep_span(Lockstep *lockstep, const Run *run, double from_s, double to_s)
{
    CigiClock   *clock = &lockstep->clock;
    const World *world = &run->made->world;
    if (!clock->node) return;
    clock->ground = (CigiGround){world->landscape, &world->frame};
    clock->from_s = from_s;
    clock->to_s = fmin(INFINITY, to_s);
    log_info("cigi: frames from %.5f s on; Ctrl-C ends it", from_s);
}

static Status frames(Run *run, Session *session, Player *player, const HostPlan *plan, const FrameGrid *grid)
{
    const Config *config = &run->options.config;
    const double  first_s = run->made->survey.first_s, last_s = run->made->survey.last_s;
    const double  from_s = config_span_time_s(config->exercise.from_s, first_s, last_s); /* NaN: none */
    const double  to_s = config_span_time_s(config->exercise.to_s, first_s, last_s);
    (void)player, (void)grid;
    lockstep_span((Lockstep *)run->clock, run, fmax(plan->start_s, from_s), to_s);
    const Status status = frame_loop(&run->stopped, &(FrameLoop){run->clock, over, NULL, make_frame, session});
    if (status != STATUS_OK || session_result(session)->frames > 0 || run->stopped) return status;
    log_error("replay: the host at %s asked for no frame", config->exercise.cigi);
    return STATUS_BAD_VALUE;
}

Status lockstep_begin(Lockstep *out, Run *run, const LiveClock *live)
{
    const Options *o = &run->options;
    *out = (Lockstep){.clock = cigi_clock(live)};
    if (!*o->config.exercise.cigi) return STATUS_OK;
    if (isfinite(o->speed) || o->host_count > 1 || o->only_count > 0) {
        log_error("replay: exercise.cigi: the host asks for each frame at its time: without %s",
                  isfinite(o->speed)  ? "--speed"
                  : o->host_count > 1 ? "several --host"
                                      : "--only");
        return STATUS_BAD_VALUE;
    }
    const bool recorded = cigi_link_recorded(o->config.exercise.cigi);
    if (live && recorded) {
        log_error("run: exercise.cigi: `recorded` is a host that `replay` has from its recording; a node has one at "
                  "HOST:PORT");
        return STATUS_BAD_VALUE;
    }
    if (recorded) run->options.config.exercise.causal = true; /* its times are those of arrival at the live node */
    const Status status = cigi_node_open(&out->clock.node, &o->config, live ? NULL : o->log);
    if (status != STATUS_OK) return status;
    run->cigi = out->clock.node;
    run->clock = &out->clock.clock;
    if (live) return STATUS_OK;
    run->frames = frames;
    run->check = NULL;
    return STATUS_OK;
}

void lockstep_record(Lockstep *lockstep, const CigiTap *tap)
{
    if (lockstep->clock.node) lockstep->clock.node->tap = *tap;
}

void lockstep_end(Lockstep *lockstep)
{
    cigi_node_close(lockstep->clock.node);
    lockstep->clock.node = NULL;
}
