/* sensor/publish/consumer.h: what takes finished frames: files, hashes, records, and all that is to come.
 *
 * The session holds a list of consumers and knows none by name. It renders the union of what they want, and nothing
 * else. A new one is a file of its own with a function that makes it, and a line where lists are made
 * (sensor/node/session_consumers.c). */
#ifndef SENSOR_PUBLISH_CONSUMER_H
#define SENSOR_PUBLISH_CONSUMER_H

#include "sensor/publish/frame.h"

typedef enum FrameWant {
    WANT_PLANES  = 1 << 0, /* of truth; those of the bands are always there */
    WANT_TARGETS = 1 << 1, /* record.target */
    WANT_ERROR   = 1 << 2, /* record.error, where the error budget is on */
    WANT_CELLS   = 1 << 3, /* picture.small: small targets as a detector needs them */
    WANT_WITHOUT = 1 << 4, /* a second rendering without what is aimed at, or without all */
    WANT_SHA256  = 1 << 5, /* of all planes, truth too */
} FrameWant;

typedef struct Consumer Consumer;
struct Consumer {
    unsigned wants;
    /* One frame, in order of time. What it returns but STATUS_OK, logged, ends the run. */
    Status (*put)(Consumer *consumer, Frame *frame);
    /* The frame was made and is not put, for want of time; in the thread that makes frames. NULL: no matter. */
    void   (*left_out)(Consumer *consumer, const Frame *frame);
    /* Finishes what it makes and frees the consumer. */
    Status (*close)(Consumer *consumer);
};

enum { consumers_max = 16 };

typedef struct Consumers {
    int       count;
    Consumer *consumer[consumers_max];
} Consumers;

/* Takes the consumer over, also when there is no room (STATUS_BAD_VALUE). NULL: nothing. */
Status   consumers_add(Consumers *list, Consumer *consumer);
unsigned consumers_wants(const Consumers *list);
/* The frame to each in turn; the first failure ends it. */
Status   consumers_put(const Consumers *list, Frame *frame);
/* All of them; the first failure. */
Status   consumers_close(Consumers *list);
/* What a request must ask for. Whether the error budget is on is the caller's. */
void     consumers_request(RenderRequest *request, unsigned wants);

#endif
