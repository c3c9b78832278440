/* sensor/node/clock/live_clock.c: frames by the time of day, as the exercise arrives. */
#include "sensor/node/clock/live_clock.h"

#include "dis/clock/steady_clock.h"
#include "dis/network/udp.h"

int64_t live_clock_due_ns(const LiveClock *c, double t_s)
{
    return dis_unix_ns_until(player_arrival_s(c->player, t_s));
}

/* The number of the newest frame at or before this exercise time. */
static double newest(const LiveClock *c, double t_s) { return floor(t_s * c->grid.rate_hz) - c->grid.origin; }

double live_clock_now_s(const LiveClock *c) { return player_time_s(c->player, dis_unix_s(dis_udp_now_ns())); }

static ClockAnswer next(FrameTime *out, FrameClock *clock)
{
    const LiveClock *c = (const LiveClock *)clock;
    const double     n = fmax(fmax(newest(c, live_clock_now_s(c)), c->last + 1.0), c->first);
    *out = (FrameTime){.number = (int)fmin(n, INT32_MAX), .t_s = frame_grid_s(&c->grid, n)};
    return out->t_s > c->to_s ? CLOCK_END : CLOCK_DUE;
}

static ClockAnswer wait(FrameTime *frame, FrameClock *clock)
{
    const LiveClock *c = (const LiveClock *)clock;
    const int64_t    due_ns = live_clock_due_ns(c, frame->t_s), look_ns = (int64_t)(1e9 * clock_look_s);
    int64_t          now_ns = dis_udp_now_ns();
    if (now_ns <= due_ns) {
        dis_udp_sleep_until(due_ns < now_ns + look_ns ? due_ns + 1 : now_ns + look_ns);
        now_ns = dis_udp_now_ns();
    }
    frame->late_s = 1e-9 * (double)(now_ns - due_ns);
    frame->dropped = c->last >= 0 ? (uint64_t)(frame->number - c->last - 1) : 0;
    return now_ns > due_ns ? CLOCK_DUE : CLOCK_EARLY;
}

static void done(FrameClock *clock, const FrameTime *frame) { ((LiveClock *)clock)->last = frame->number; }

static double wall_s(const FrameClock *clock, double t_s)
{
    const struct timespec at = steady_clock_monotonic(live_clock_due_ns((const LiveClock *)clock, t_s));
    return (double)at.tv_sec + 1e-9 * (double)at.tv_nsec;
}

LiveClock live_clock(void) { return (LiveClock){{next, wait, done, wall_s}, .last = -1}; }

uint64_t live_clock_behind(const LiveClock *c)
{
    const double n = newest(c, fmin(live_clock_now_s(c), isnan(c->to_s) ? INFINITY : c->to_s));
    return c->last >= 0 && n > c->last ? (uint64_t)(n - c->last) : 0;
}
