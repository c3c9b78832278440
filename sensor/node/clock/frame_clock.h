/* sensor/node/clock/frame_clock.h: when the next frame is due: a recording, the wall or another holder of the time,
 * as the one loop over frames sees it. */
#ifndef SENSOR_NODE_CLOCK_FRAME_CLOCK_H
#define SENSOR_NODE_CLOCK_FRAME_CLOCK_H

#include "pitviper.h"

/* Frame n is at (origin + n) / rate_hz of exercise time: on multiples of the interval, wherever the span begins, so
 * that a part of a run equals that part of the full run. */
typedef struct FrameGrid {
    double origin, rate_hz;
} FrameGrid;
static inline double frame_grid_s(const FrameGrid *grid, double n) { return (grid->origin + n) / grid->rate_hz; }

typedef struct FrameTime {
    int      number;
    double   t_s;     /* exercise time */
    double   late_s;  /* how long ago it was due, when its work begins; 0: this clock is not on the wall */
    uint64_t dropped; /* frames before it that were due and are not made */
} FrameTime;

typedef enum ClockAnswer {
    CLOCK_DUE,
    CLOCK_EARLY, /* a tenth of a second has passed, or less: ask again */
    CLOCK_END,   /* there is no further frame */
} ClockAnswer;

/* One implementation is a struct that begins with this. A clock never looks at a picture; it draws no random number. */
typedef struct FrameClock FrameClock;
struct FrameClock {
    /* Proposes the next frame: number and t_s, neither of which decreases. CLOCK_DUE or CLOCK_END. */
    ClockAnswer (*next)(FrameTime *out, FrameClock *clock);
    /* Waits for that frame, at most clock_look_s. CLOCK_DUE: late_s and dropped are filled in; a clock that is told the
     * time by another program may have changed number and t_s too. */
    ClockAnswer (*wait)(FrameTime *frame, FrameClock *clock);
    /* The frame has been made, or its host was not there; after a failure it is not called. */
    void (*done)(FrameClock *clock, const FrameTime *frame);
    /* wall_clock_s at which exercise time t_s arrives here. NULL: this clock keeps no pace with the wall, and nothing
     * of its frames is ever late. */
    double (*wall_s)(const FrameClock *clock, double t_s);
};

/* A wait lasts no longer: what arrives is taken meanwhile, and a signal, which ends no wait, is seen. */
static const double clock_look_s = 0.1;

/* Whether frames are made by the wall's time. clock: may be NULL. */
static inline bool clock_on_wall(const FrameClock *clock) { return clock && clock->wall_s; }

/* What a command does around its clock. */
typedef struct FrameLoop {
    FrameClock *clock;
    bool (*over)(void *user);                          /* it ends before the next frame */
    Status (*idle)(void *user, const FrameTime *next); /* while it waits; NULL: nothing */
    Status (*make)(void *user, const FrameTime *frame);
    void *user; /* of these three */
} FrameLoop;

/* Frame after frame, until the clock ends, a frame fails, or over() says so: before a frame and while it waits for one,
 * and only where there is a further frame. over: whether it ended by that; NULL: not asked. */
Status frame_loop(bool *over, const FrameLoop *loop);

#endif
