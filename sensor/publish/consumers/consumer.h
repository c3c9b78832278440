/* sensor/publish/consumers/consumer.h: the interface of consumers of finished frames (files, hashes, records), lists
 * of them, and the thread that puts frames to a list.
 *
 * The session holds a list of consumers and knows none by name. It renders the union of what they need, and nothing
 * else. A new one is a file of its own with a function that creates it, and a line where lists are created
 * (sensor/node/session/session_consumers.c). */
#ifndef SENSOR_PUBLISH_CONSUMERS_CONSUMER_H
#define SENSOR_PUBLISH_CONSUMERS_CONSUMER_H

#include "sensor/frame/frame.h"

#include <pthread.h>
#include <stdatomic.h>

typedef struct Consumer Consumer;
struct Consumer {
    unsigned wants;
    /* Takes one frame, in order of time. Any result but STATUS_OK, which is logged, ends the run. */
    Status (*put)(Consumer *consumer, Frame *frame);
    /* The frame was rendered and is not put, for lack of time; called in the thread that puts. NULL: not needed. */
    void (*left_out)(Consumer *consumer, const Frame *frame);
    /* Finishes its products and frees the consumer. */
    Status (*close)(Consumer *consumer);
    const char *name; /* in the latency ledger; NULL: not in it */
    /* Makes its folders and files, once and before the first frame: only then may the products of an earlier run go.
     * NULL: there are none. Any result but STATUS_OK, logged, ends the run. */
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
Status consumers_begin(const Consumers *list);
/* Puts the frame to each consumer in turn; the first failure ends it. */
Status consumers_put(const Consumers *list, Frame *frame);
/* Their names into the ledger. NULL: none is kept. */
void consumers_expect(const Consumers *list, Latency *latency);
/* Closes all of them; returns the first failure. */
Status consumers_close(Consumers *list);
/* The planes that a request must contain. Whether the error budget is on is up to the caller. */
void consumers_request(RenderRequest *request, unsigned wants);

/* ---- a queue ------------------------------------------------------------------------------------- */

/* A consumer whose consumers run in a thread of their own, so that the next frame is rendered
 * meanwhile. It receives frames in order and passes them on in order.
 *
 *     QUEUE_WAIT       every frame is passed on; putting waits while there is no room. The first failure is the
 *                      result of the next put and of the close; no frame after it is passed on
 *     QUEUE_LEAVE_OUT  putting never waits: the oldest waiting frame is dropped for the newer one; that is counted, its
 *                      consumers are notified; a failure is counted and ends nothing. A disk that
 *                      hangs costs its own frames alone, and at the end it is given up
 *
 * With the frame being rendered, the ones waiting and the one being published it takes waiting + 2 frames of a pool. */

enum { queue_waiting_most = 8 };
typedef enum QueueRule { QUEUE_WAIT, QUEUE_LEAVE_OUT } QueueRule;

typedef struct QueueCounters {
    int handed, left_out, failed;
} QueueCounters;

typedef struct QueueOf {
    QueueRule      rule;
    int            waiting;  /* frames that may wait, 1 .. queue_waiting_most */
    bool           disk;     /* with QUEUE_LEAVE_OUT: its consumers write to disks, which may hang */
    bool           urgent;   /* its thread comes before those that render the next frame (publish_urgent) */
    const char    *what;     /* its products, as messages name them */
    QueueCounters *counters; /* filled in by close; NULL: nowhere */
} QueueOf;

/* Takes the list's consumers over, also on failure. */
Status consumer_queue_open(Consumer **out, Consumers *list, const QueueOf *of);

/* ---- threads that publish ------------------------------------------------------------------------ */

/* Gives the calling thread precedence over threads that compute for long, as far as this process has the right to. */
void publish_urgent(void);
/* Starts a thread in which signals are blocked: they are for the main thread. False: the system has none left. */
bool publish_thread(pthread_t *out, void *(*work)(void *user), void *user);

/* Waits for a publishing thread that was told to end, as long as its count of steps grows; false, logged, when it did
 * not for some seconds: a disk hangs. Whatever that thread uses must then stay as it is until the process ends. */
bool publish_ended(pthread_t thread, const _Atomic uint64_t *steps, const char *what);
/* Whether there is such a thread. */
bool publish_hangs(void);

/* ---- retries ------------------------------------------------------------------------------------- */

/* Retries a destination that cannot be written while a live node continues: reported once, retried at
 * intervals. */

typedef struct RetryBackoff {
    const char *what;    /* the products, as messages name them */
    double      off_s;   /* wall clock: no retry before */
    bool        failed;  /* the last try */
    int         lacking; /* number of failures */
} RetryBackoff;

static const double retry_interval_s = 10;

/* Whether to try now. During a retry the messages of this thread are suppressed: retry_done reports the result. */
static inline bool retry_due(const RetryBackoff *p)
{
    const bool due = wall_clock_s() >= p->off_s;
    if (due && p->failed) log_suppress(true);
    return due;
}

/* Call this after a try, with its status; where none was made, with STATUS_IO. */
static inline void retry_done(RetryBackoff *p, bool tried, Status status)
{
    if (tried) log_suppress(false);
    if (status == STATUS_OK) {
        if (p->failed) log_info("session: %s again; %d frames lack them", p->what, p->lacking);
        p->failed = false;
        return;
    }
    p->lacking++;
    if (!tried) return;
    if (!p->failed) log_warn("session: going on without %s; trying again every %.0f s", p->what, retry_interval_s);
    p->failed = true;
    p->off_s = wall_clock_s() + retry_interval_s;
}

/* Logs at the end of the run what is missing, if that has not been said yet. */
static inline void retry_end(const RetryBackoff *p)
{
    if (p->failed) log_warn("session: %d frames lack %s", p->lacking, p->what);
}

#endif
