/* sensor/node/clock/flight_clock.c: frames of a flight, one after the other, as fast as they are answered. */
#include "sensor/node/clock/flight_clock.h"

/* The first frame at or after the launch, and none again. */
static int first_frame(const FlightClock *c)
{
    const double launch_s = (double)c->loop->launch_tick * c->loop->world.step_s;
    return (int)fmax(c->next, ceil(launch_s * c->grid.rate_hz - 1e-6) - c->grid.origin);
}

static ClockAnswer next(FrameTime *out, FrameClock *clock)
{
    FlightClock *c = (FlightClock *)clock;
    if (c->loop->ended && c->hand_over && c->hand_over(c->user, frame_grid_s(&c->grid, c->next)))
        c->next = first_frame(c);
    if (c->loop->ended || c->loop->strange || c->loop->out_of_memory || c->next > 999999) return CLOCK_END;
    *out = (FrameTime){.number = c->next, .t_s = frame_grid_s(&c->grid, c->next)};
    return CLOCK_DUE;
}

static ClockAnswer wait(FrameTime *frame, FrameClock *clock)
{
    return loop_sights_settle(((FlightClock *)clock)->loop, frame->t_s) ? CLOCK_DUE : CLOCK_EARLY;
}

static void done(FrameClock *clock, const FrameTime *frame) { ((FlightClock *)clock)->next = frame->number + 1; }

FlightClock flight_clock(FlightLoop *loop) { return (FlightClock){{next, wait, done, NULL}, .loop = loop}; }

Status flight_clock_begin(FlightClock *c, const FrameGrid *grid)
{
    c->grid = *grid;
    c->next = 0;
    c->next = first_frame(c);
    if (c->loop->late_s * grid->rate_hz < loop_waiting_most / 2) return STATUS_OK;
    log_error(
        "fly: %g frames a second, answered %g s late (sight_late_s), are more on their way than %d; choose a lower "
        "--rate",
        grid->rate_hz, c->loop->late_s, loop_waiting_most / 2);
    return STATUS_BAD_VALUE;
}
