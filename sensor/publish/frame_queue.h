/* sensor/publish/frame_queue.h: a consumer whose consumers work in a thread of their own, so that the next frame is
 * made meanwhile. It is put frames in order and hands them on in order; at most one waits.
 *
 *     QUEUE_WAIT       every frame is handed on; putting waits while another frame waits. The first failure is the
 *                      result of the next put and of the close; no frame behind it is handed on
 *     QUEUE_LEAVE_OUT  putting never waits: the frame that waits is left out for the newer one; that is counted, its
 *                      consumers are told; a failure is counted and ends nothing
 *
 * With the frame that is being made, that which waits and that which is handed on it takes three frames of a pool. */
#ifndef SENSOR_PUBLISH_FRAME_QUEUE_H
#define SENSOR_PUBLISH_FRAME_QUEUE_H

#include "sensor/publish/consumer.h"

enum { queue_frames = 3 };
typedef enum QueueRule { QUEUE_WAIT, QUEUE_LEAVE_OUT } QueueRule;

typedef struct QueueCounters {
    int handed, left_out, failed;
} QueueCounters;

/* Takes the list's consumers over, also when this fails. counters: filled in by close; may be NULL. */
Status frame_queue_open(Consumer **out, Consumers *list, QueueRule rule, QueueCounters *counters);

#endif
