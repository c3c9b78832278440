/* sensor/node/clock/cigi_clock.c: frames when a CIGI host asks for them. */
#include "sensor/node/clock/cigi_clock.h"

enum { most_frames = 999999 };

static ClockAnswer next(FrameTime *out, FrameClock *clock)
{
    const CigiClock *c = (const CigiClock *)clock;
    *out = (FrameTime){.number = c->made, .t_s = fmax(c->last_s, c->from_s)};
    if (c->made <= most_frames) return CLOCK_DUE;
    log_info("cigi: a million frames; a further run has the next");
    return CLOCK_END;
}

/* Exercise time of the host's frame. */
static double exercise_s(CigiClock *c)
{
    const CigiSession *s = &c->node->session;
    const double       host_s = cigi_session_time_s(s);
    if (c->live && (c->made == 0 || s->events.restarts != c->restarts))
        c->offset_s = fmax(live_clock_now_s(c->live), c->last_s) - host_s;
    c->restarts = s->events.restarts;
    return host_s + c->offset_s;
}

static ClockAnswer wait(FrameTime *frame, FrameClock *clock)
{
    CigiClock *c = (CigiClock *)clock;
    if (cigi_node_wait(c->node, &c->ground, clock_look_s) != CIGI_DUE) return CLOCK_EARLY;
    const double t_s = exercise_s(c);
    if (t_s > c->to_s) {
        log_info("cigi: the host is at %.5f s, behind the end at %.5f s (exercise.to_s)", t_s, c->to_s);
        return CLOCK_END;
    }
    if (t_s < c->last_s) {
        log_warn("cigi: the host began anew at %.5f s, before the last frame at %.5f s: the run ends", t_s, c->last_s);
        return CLOCK_END;
    }
    if (t_s < c->from_s || !cigi_node_fix(c->node, t_s)) {
        cigi_node_delivered(c->node, &c->ground);
        return CLOCK_EARLY;
    }
    frame->t_s = t_s;
    return CLOCK_DUE;
}

static void done(FrameClock *clock, const FrameTime *frame)
{
    CigiClock *c = (CigiClock *)clock;
    c->last_s = frame->t_s;
    c->made++;
    cigi_node_delivered(c->node, &c->ground);
}

static double wall_s(const FrameClock *clock, double t_s)
{
    const FrameClock *live = &((const CigiClock *)clock)->live->clock;
    return live->wall_s(live, t_s);
}

CigiClock cigi_clock(const LiveClock *live)
{
    return (CigiClock){{next, wait, done, live ? wall_s : NULL}, .last_s = -INFINITY, .live = live};
}
