/* sensor/node/live/ready.h: when a live node is ready: everything is made that the entities heard will need in frames
 * (session_ready). It is said once, and again when something new had to be made, at most every ten seconds. */
#ifndef SENSOR_NODE_LIVE_READY_H
#define SENSOR_NODE_LIVE_READY_H

#include "sensor/node/session/session.h"

/* Zeroed at first. Times are of a wall clock, s. */
typedef struct Ready {
    double       heard_s; /* when the first entity was heard */
    double       since_s; /* when what is being prepared began */
    double       said_s;  /* when it was said last */
    double       first_s; /* how long after heard_s it was ready first; 0: not yet */
    bool         is;      /* ready now */
    SessionReady said;    /* what it was ready with then */
} Ready;

void ready_check(Ready *ready, const SessionReady *now, double now_s);

#endif
