/* sensor/node/clock/live_clock.h: the clock of a live node: the newest frame that is due, else the next. When late,
 * frames are dropped, not queued. */
#ifndef SENSOR_NODE_CLOCK_LIVE_CLOCK_H
#define SENSOR_NODE_CLOCK_LIVE_CLOCK_H

#include "sensor/node/clock/frame_clock.h"
#include "sensor/node/player/player.h"

/* A frame is due when everything that counts at its time has arrived (player_arrival_s). */
typedef struct LiveClock {
    FrameClock    clock;
    FrameGrid     grid;
    double        first;  /* number of the earliest frame */
    double        to_s;   /* no frame is later, exercise time; NaN: without end */
    const Player *player; /* the caller's; it has a first PDU */
    int           last;   /* number of the frame made last; -1: none */
} LiveClock;

/* A clock whose grid, span and player are to be given before the first frame. */
LiveClock live_clock(void);
/* The exercise time that arrives now. */
double live_clock_now_s(const LiveClock *clock);
/* Unix time, ns, at which a frame at t_s is due. */
int64_t live_clock_due_ns(const LiveClock *clock, double t_s);
/* Frames after the last one that are due by now. */
uint64_t live_clock_behind(const LiveClock *clock);

#endif
