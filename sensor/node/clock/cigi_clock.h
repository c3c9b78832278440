/* sensor/node/clock/cigi_clock.h: the clock of a CIGI host: a frame is due when it asks for one, at its time, and none
 * before the last is delivered. */
#ifndef SENSOR_NODE_CLOCK_CIGI_CLOCK_H
#define SENSOR_NODE_CLOCK_CIGI_CLOCK_H

#include "sensor/node/cigi/cigi_node.h"
#include "sensor/node/clock/live_clock.h"

typedef struct CigiClock {
    FrameClock clock;
    CigiNode  *node; /* the caller's */
    CigiGround ground;
    double     from_s, to_s; /* exercise time; frames before are answered without a picture; a frame after ends it */
    double     last_s;       /* of the last frame */
    int        made;         /* frames */
    /* With a live exercise, whose time goes on by itself: the host's first frame, and its first after a restart, is at
     * the exercise time that arrives just then, and the others as long after it as its time stamps say; none is made
     * before its time arrives. */
    const LiveClock *live;     /* NULL: exercise time is the host's time stamp; the caller's, it has a player */
    double           offset_s; /* exercise time less the host's */
    uint64_t         restarts; /* of the host, by the last frame */
    bool             due;      /* live: the frame at due_s was asked for, and its time is still to come */
    bool             ahead;    /* live: it was said that the host is far ahead */
    double           due_s;
} CigiClock;

/* A clock that waits for node, ground, from_s and to_s. live: NULL: with a recording. */
CigiClock cigi_clock(const LiveClock *live);

#endif
