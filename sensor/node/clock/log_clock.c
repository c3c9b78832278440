/* sensor/node/clock/log_clock.c: frames by the time of a recording. */
#include "sensor/node/clock/log_clock.h"

#include <time.h>

double log_clock_frame_s(const LogSpan *span, int number)
{
    return isnan(span->single_s) ? frame_grid_s(&span->grid, number) : span->single_s;
}

static ClockAnswer next(FrameTime *out, FrameClock *clock)
{
    const LogClock *c = (const LogClock *)clock;
    const LogSpan  *span = &c->span;
    const bool      all = span->only_count == 0;
    if (c->made == (all ? span->last - span->first + 1 : span->only_count)) return CLOCK_END;
    const int number = all ? span->first + c->made : span->only[c->made];
    *out = (FrameTime){.number = number, .t_s = log_clock_frame_s(span, number)};
    return CLOCK_DUE;
}

static double wall_s(const FrameClock *clock, double t_s)
{
    const LogClock *c = (const LogClock *)clock;
    return c->begun_s + (t_s - log_clock_frame_s(&c->span, c->span.first)) / c->speed;
}

static ClockAnswer wait(FrameTime *frame, FrameClock *clock)
{
    if (!clock->wall_s) return CLOCK_DUE;
    const double due_s = wall_s(clock, frame->t_s), now_s = wall_clock_s(), until_s = fmin(due_s, now_s + clock_look_s);
    frame->late_s = now_s - due_s;
    if (now_s >= due_s) return CLOCK_DUE;
    const struct timespec until = {(time_t)until_s, (long)((until_s - floor(until_s)) * 1e9)};
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, NULL);
    return CLOCK_EARLY;
}

static void done(FrameClock *clock, const FrameTime *frame)
{
    (void)frame;
    ((LogClock *)clock)->made++;
}

LogClock log_clock(double speed)
{
    return (LogClock){{next, wait, done, isfinite(speed) ? wall_s : NULL}, .speed = speed};
}

void log_clock_begin(LogClock *c, const LogSpan *span)
{
    c->span = *span;
    c->begun_s = wall_clock_s();
    c->made = 0;
}
