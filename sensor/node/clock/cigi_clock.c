/* sensor/node/clock/cigi_clock.c: frames when a CIGI host asks for them. */
#include "sensor/node/clock/cigi_clock.h"

#include "dis/network/udp.h"

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
    if (c->node->recorded) c->offset_s = cigi_node_offset_s(c->node);
    if (c->live && (c->made == 0 || s->events.restarts != c->restarts)) {
        c->offset_s = fmax(live_clock_now_s(c->live), c->last_s) - host_s;
        cigi_node_note_offset(c->node, c->offset_s);
    }
    c->restarts = s->events.restarts;
    return host_s + c->offset_s;
}

/* Of a live exercise a frame shows everything up to its time, so that it is not made before that has arrived. */
static ClockAnswer await_arrival(FrameTime *frame, CigiClock *c)
{
    const int64_t due_ns = live_clock_due_ns(c->live, c->due_s), look_ns = (int64_t)(1e9 * clock_look_s);
    int64_t       now_ns = dis_udp_now_ns();
    if (now_ns <= due_ns) {
        dis_udp_sleep_until(due_ns < now_ns + look_ns ? due_ns + 1 : now_ns + look_ns);
        now_ns = dis_udp_now_ns();
    }
    c->due = now_ns <= due_ns;
    frame->t_s = c->due_s;
    return c->due ? CLOCK_EARLY : CLOCK_DUE;
}

/* Once: a host that keeps real time is not ahead of it. */
static void say_ahead(CigiClock *c)
{
    static const double much_s = 2;
    const double        ahead_s = c->due_s - live_clock_now_s(c->live);
    if (c->ahead || ahead_s < much_s) return;
    c->ahead = true;
    log_warn("cigi: the host's time is %.1f s ahead of the exercise's, which goes on by itself: its frame waits until "
             "then",
             ahead_s);
}

static ClockAnswer wait(FrameTime *frame, FrameClock *clock)
{
    CigiClock *c = (CigiClock *)clock;
    if (c->due) return await_arrival(frame, c);
    const CigiEvent event = cigi_node_wait(c->node, &c->ground, clock_look_s);
    if (c->node->over) return CLOCK_END;
    if (event != CIGI_DUE) return CLOCK_EARLY;
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
    frame->t_s = c->due_s = t_s;
    if (!c->live) return CLOCK_DUE;
    say_ahead(c);
    return await_arrival(frame, c);
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
