/* sensor/node/clock/cigi_clock.h: the clock of a CIGI host: a frame is due when it asks for one, at its time, and none
 * before the last is delivered. */
#ifndef SENSOR_NODE_CLOCK_CIGI_CLOCK_H
#define SENSOR_NODE_CLOCK_CIGI_CLOCK_H

#include "sensor/node/cigi/cigi_node.h"
#include "sensor/node/clock/frame_clock.h"

typedef struct CigiClock {
    FrameClock clock;
    CigiNode  *node; /* the caller's */
    CigiGround ground;
    double     from_s, to_s; /* exercise time; frames before are answered without a picture; a frame after ends it */
    double     last_s;       /* of the last frame */
    int        made;         /* frames */
} CigiClock;

/* A clock that waits for node, ground, from_s and to_s. */
CigiClock cigi_clock(void);

#endif
