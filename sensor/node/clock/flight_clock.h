/* sensor/node/clock/flight_clock.h: the clock of a missile in the loop: the frames of a grid from its launch on, none
 * before what was seen in earlier ones is known as far as it guides until then; they end with the flight. */
#ifndef SENSOR_NODE_CLOCK_FLIGHT_CLOCK_H
#define SENSOR_NODE_CLOCK_FLIGHT_CLOCK_H

#include "sensor/node/clock/frame_clock.h"
#include "sensor/node/flight/flight_loop.h"

typedef struct FlightClock {
    FrameClock  clock;
    FlightLoop *loop; /* the caller's */
    FrameGrid   grid;
    int         next;
    /* The missile has ended; t_s: of the next frame, before which no other can be launched. False: there is no further
     * one, or it failed. NULL: there is none. */
    bool (*hand_over)(void *user, double t_s);
    void *user;
} FlightClock;

FlightClock flight_clock(FlightLoop *loop);
/* The first frame is the first of the grid after the launch. STATUS_BAD_VALUE, logged: more frames would be on their
 * way than are kept. */
Status flight_clock_begin(FlightClock *clock, const FrameGrid *grid);

#endif
