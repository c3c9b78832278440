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

static ClockAnswer wait(FrameTime *frame, FrameClock *clock)
{
    CigiClock *c = (CigiClock *)clock;
    if (cigi_node_wait(c->node, &c->ground, clock_look_s) != CIGI_DUE) return CLOCK_EARLY;
    const double t_s = cigi_session_time_s(&c->node->session);
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

CigiClock cigi_clock(void) { return (CigiClock){{next, wait, done, NULL}, .last_s = -INFINITY}; }
