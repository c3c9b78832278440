/* sensor/publish/frame_queue.h: a consumer whose consumers run in a thread of their own, so that the next frame is
 * rendered meanwhile. It receives frames in order and passes them on in order; at most one waits.
 *
 *     QUEUE_WAIT       every frame is passed on; putting waits while another frame waits. The first failure is the
 *                      result of the next put and of the close; no frame after it is passed on
 *     QUEUE_LEAVE_OUT  putting never waits: the waiting frame is dropped for the newer one; that is counted, its
 *                      consumers are notified; a failure is counted and ends nothing
 *
 * With the frame being rendered, the one waiting and the one being published it takes three frames of a pool. */
#ifndef SENSOR_PUBLISH_FRAME_QUEUE_H
#define SENSOR_PUBLISH_FRAME_QUEUE_H

#include "sensor/publish/consumer.h"

enum { queue_frames = 3 };
typedef enum QueueRule { QUEUE_WAIT, QUEUE_LEAVE_OUT } QueueRule;

typedef struct QueueCounters {
    int handed, left_out, failed;
} QueueCounters;

/* Takes the list's consumers over, also on failure. counters: filled in by close; may be NULL. */
Status frame_queue_open(Consumer **out, Consumers *list, QueueRule rule, QueueCounters *counters);

#endif
