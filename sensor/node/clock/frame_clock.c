/* sensor/node/clock/frame_clock.c: the loop over frames. */
#include "sensor/node/clock/frame_clock.h"

/* Waits for a proposed frame. CLOCK_EARLY: it is over before. */
static ClockAnswer await(Status *status, const FrameLoop *loop, FrameTime *frame)
{
    ClockAnswer answer = CLOCK_EARLY;
    while (*status == STATUS_OK && answer == CLOCK_EARLY && !loop->over(loop->user)) {
        answer = loop->clock->wait(frame, loop->clock);
        if (answer == CLOCK_EARLY && loop->idle) *status = loop->idle(loop->user, frame);
    }
    return answer;
}

Status frame_loop(bool *over, const FrameLoop *loop)
{
    FrameClock *clock = loop->clock;
    Status      status = STATUS_OK;
    FrameTime   frame = {0};
    ClockAnswer answer;
    while ((answer = clock->next(&frame, clock)) == CLOCK_DUE) {
        answer = await(&status, loop, &frame);
        if (answer == CLOCK_DUE) status = loop->make(loop->user, &frame);
        if (answer != CLOCK_DUE || status != STATUS_OK) break;
        clock->done(clock, &frame);
    }
    if (over) *over = status == STATUS_OK && answer == CLOCK_EARLY;
    return status;
}
