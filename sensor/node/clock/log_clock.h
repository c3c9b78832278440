/* sensor/node/clock/log_clock.h: the clock of a recording: each frame of a span in turn, none dropped; at a multiple of
 * the recording's own time, or free-running. */
#ifndef SENSOR_NODE_CLOCK_LOG_CLOCK_H
#define SENSOR_NODE_CLOCK_LOG_CLOCK_H

#include "sensor/node/clock/frame_clock.h"

/* Frames first .. last of the grid, or those of `only`, ascending. */
typedef struct LogSpan {
    FrameGrid  grid;
    int        first, last;
    const int *only; /* [only_count] within first .. last; only_count 0: all */
    int        only_count;
    double     single_s; /* time of the one frame of a span shorter than an interval; NaN: it has frames of the grid */
} LogSpan;

typedef struct LogClock {
    FrameClock clock;
    LogSpan    span;
    double     speed;   /* recorded seconds a second; INFINITY: free-running */
    double     begun_s; /* wall_clock_s at the time of frame `first` */
    int        made;    /* frames */
} LogClock;

/* A clock that waits for log_clock_begin. speed > 0. */
LogClock log_clock(double speed);
/* Starts it with the first frame of the span, which is due now. */
void   log_clock_begin(LogClock *clock, const LogSpan *span);
double log_clock_frame_s(const LogSpan *span, int number);

#endif
