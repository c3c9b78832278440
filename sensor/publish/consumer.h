/* sensor/publish/consumer.h: the interface of consumers of finished frames: files, hashes, records.
 *
 * The session holds a list of consumers and knows none by name. It renders the union of what they need, and nothing
 * else. A new one is a file of its own with a function that creates it, and a line where lists are created
 * (sensor/node/session/session_consumers.c). */
#ifndef SENSOR_PUBLISH_CONSUMER_H
#define SENSOR_PUBLISH_CONSUMER_H

#include "sensor/publish/frame.h"

typedef enum FrameWant {
    WANT_PLANES  = 1 << 0, /* of truth; those of the bands are always present */
    WANT_TARGETS = 1 << 1, /* record.target */
    WANT_ERROR   = 1 << 2, /* record.error, where the error budget is on */
    WANT_CELLS   = 1 << 3, /* picture.small: small targets as a detector needs them */
    WANT_WITHOUT = 1 << 4, /* a second rendering without the target, or without all entities */
    WANT_SHA256  = 1 << 5, /* of all planes, truth too */
    WANT_DISPLAY = 1 << 6, /* frame.display: behind the detector, with gain and level */
    WANT_COUNTS  = 1 << 7, /* frame.display.counts: raw counts of the bands with a sensor */
    WANT_FOOTPRINT = 1 << 8, /* record.footprint: where the boresight and the corners meet the ground */
    WANT_LATENCY = 1 << 9, /* when other consumers are done with the frame: closed after those that do not want it */
} FrameWant;

typedef struct Consumer Consumer;
struct Consumer {
    unsigned wants;
    /* One frame, in order of time. Any result but STATUS_OK, logged, ends the run. */
    Status (*put)(Consumer *consumer, Frame *frame);
    /* The frame was rendered and is not put, for lack of time; called in the rendering thread. NULL: not needed. */
    void   (*left_out)(Consumer *consumer, const Frame *frame);
    /* Finishes its products and frees the consumer. */
    Status (*close)(Consumer *consumer);
    const char *name; /* in the latency ledger; NULL: not in it */
    /* Makes its folders and files, once and before the first frame: only then may the products of an earlier run go. NULL:
     * there are none. Any result but STATUS_OK, logged, ends the run. */
    Status (*begin)(Consumer *consumer);
};

enum { consumers_max = 16 };

typedef struct Consumers {
    int       count;
    Consumer *consumer[consumers_max];
} Consumers;

/* Takes the consumer over, also when the list is full (STATUS_BAD_VALUE). NULL: nothing. */
Status   consumers_add(Consumers *list, Consumer *consumer);
unsigned consumers_wants(const Consumers *list);
/* Of each that has a begin; the first failure ends it. */
Status   consumers_begin(const Consumers *list);
/* The frame to each in turn; the first failure ends it. */
Status   consumers_put(const Consumers *list, Frame *frame);
/* The frame was rendered and is put to none of them. */
void     consumers_left_out(const Consumers *list, const Frame *frame);
/* Their names into the ledger. NULL: none is kept. */
void     consumers_expect(const Consumers *list, Latency *latency);
/* Closes all of them; returns the first failure. */
Status   consumers_close(Consumers *list);
/* The planes that a request must contain. Whether the error budget is on is up to the caller. */
void     consumers_request(RenderRequest *request, unsigned wants);

#endif
