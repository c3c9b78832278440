/* sensor/publish/consumers/consumer.c: a list of consumers used as one, and the queue that puts frames to a list in a
 * thread of its own. */
#include "sensor/publish/consumers/consumer.h"

#include <pthread.h>
#include <signal.h>
#include <stdlib.h>

/* ---- the list ------------------------------------------------------------------------------------ */

Status consumers_add(Consumers *list, Consumer *consumer)
{
    if (!consumer) return STATUS_OK;
    if (list->count == consumers_max) {
        consumer->close(consumer);
        return STATUS_BAD_VALUE;
    }
    list->consumer[list->count++] = consumer;
    return STATUS_OK;
}

unsigned consumers_wants(const Consumers *list)
{
    unsigned wants = 0;
    for (int i = 0; i < list->count; i++) wants |= list->consumer[i]->wants;
    return wants;
}

Status consumers_begin(const Consumers *list)
{
    Status status = STATUS_OK;
    for (int i = 0; i < list->count && status == STATUS_OK; i++)
        if (list->consumer[i]->begin) status = list->consumer[i]->begin(list->consumer[i]);
    return status;
}

Status consumers_put(const Consumers *list, Frame *frame)
{
    Status status = STATUS_OK;
    if (frame->publish_begun_s == 0) frame->publish_begun_s = wall_clock_s();
    for (int i = 0; i < list->count && status == STATUS_OK; i++) {
        Consumer *c = list->consumer[i];
        status = c->put(c, frame);
        if (frame->latency && status == STATUS_OK)
            latency_done(frame->latency, frame->latency_key, frame->times.rendered_s, c->name);
    }
    return status;
}

/* The frame was rendered and is put to none of them. */
static void consumers_left_out(const Consumers *list, const Frame *frame)
{
    for (int i = 0; i < list->count; i++) {
        Consumer *c = list->consumer[i];
        if (c->left_out) c->left_out(c, frame);
        if (frame->latency) latency_left_out(frame->latency, frame->latency_key, c->name);
    }
}

void consumers_expect(const Consumers *list, Latency *latency)
{
    for (int i = 0; latency && i < list->count; i++) latency_expect(latency, list->consumer[i]->name);
}

Status consumers_close(Consumers *list)
{
    Status status = STATUS_OK;
    for (int i = 0; i < 2 * list->count; i++) {
        Consumer *c = list->consumer[i % list->count];
        if (!c || ((c->wants & WANT_LATENCY) != 0) != (i >= list->count)) continue;
        list->consumer[i % list->count] = NULL;
        const Status one = c->close(c);
        if (status == STATUS_OK) status = one;
    }
    list->count = 0;
    return status;
}

void consumers_request(RenderRequest *request, unsigned wants)
{
    request->truth = wants & (WANT_PLANES | WANT_TARGETS | WANT_ERROR | WANT_SHA256);
    request->hand_over_cells &= (wants & WANT_CELLS) != 0;
    request->budget &= (wants & WANT_ERROR) != 0;
}

/* ---- the queue: a thread, and the one frame that waits for it ------------------------------------ */

typedef struct FrameQueue {
    Consumer        consumer;
    Consumers       list;
    QueueRule       rule;
    QueueCounters   counters, *result;
    Frame          *waits;
    Status          status; /* QUEUE_WAIT: the first failure */
    bool            stop, running;
    pthread_mutex_t lock; /* of waits, status, stop */
    pthread_cond_t  work, room;
    pthread_t       thread;
} FrameQueue;

static void *work(void *user)
{
    FrameQueue *q = user;
    thread_flush_denormals();
    pthread_mutex_lock(&q->lock);
    for (;;) {
        while (!q->waits && !q->stop) pthread_cond_wait(&q->work, &q->lock);
        Frame *frame = q->waits;
        if (!frame) break;
        q->waits = NULL;
        const bool ended = q->rule == QUEUE_WAIT && q->status != STATUS_OK;
        pthread_cond_signal(&q->room);
        pthread_mutex_unlock(&q->lock);
        const Status status = ended ? STATUS_OK : consumers_put(&q->list, frame);
        frame_release(frame);
        pthread_mutex_lock(&q->lock);
        if (ended) continue;
        if (status == STATUS_OK) q->counters.handed++;
        else q->counters.failed++;
        if (q->status == STATUS_OK) q->status = status;
    }
    pthread_mutex_unlock(&q->lock);
    return NULL;
}

static Status put(Consumer *consumer, Frame *frame)
{
    FrameQueue *q = (FrameQueue *)consumer;
    Frame      *older = NULL;
    Status      status;
    pthread_mutex_lock(&q->lock);
    while (q->rule == QUEUE_WAIT && q->waits && q->status == STATUS_OK) pthread_cond_wait(&q->room, &q->lock);
    status = q->rule == QUEUE_WAIT ? q->status : STATUS_OK;
    if (status == STATUS_OK) { /* another may wait only under QUEUE_LEAVE_OUT */
        older = q->waits;
        q->waits = NULL;
    }
    pthread_mutex_unlock(&q->lock);
    if (status != STATUS_OK) return status;
    if (older) {
        consumers_left_out(&q->list, older);
        frame_release(older);
        q->counters.left_out++; /* used by this thread alone until it is joined */
    }
    frame_hold(frame);
    pthread_mutex_lock(&q->lock);
    q->waits = frame;
    pthread_cond_signal(&q->work);
    pthread_mutex_unlock(&q->lock);
    return STATUS_OK;
}

/* In the rendering thread: nothing has been put. */
static Status begin(Consumer *consumer) { return consumers_begin(&((FrameQueue *)consumer)->list); }

static Status close_queue(Consumer *consumer)
{
    FrameQueue *q = (FrameQueue *)consumer;
    if (q->running) {
        pthread_mutex_lock(&q->lock);
        q->stop = true;
        pthread_cond_signal(&q->work);
        pthread_mutex_unlock(&q->lock);
        pthread_join(q->thread, NULL); /* a waiting frame is passed on before */
    }
    const Status closed = consumers_close(&q->list);
    const Status status = q->rule == QUEUE_WAIT && q->status != STATUS_OK ? q->status : closed;
    if (q->result) *q->result = q->counters;
    pthread_cond_destroy(&q->room);
    pthread_cond_destroy(&q->work);
    pthread_mutex_destroy(&q->lock);
    free(q);
    return status;
}

Status consumer_queue_open(Consumer **out, Consumers *list, QueueRule rule, QueueCounters *counters)
{
    FrameQueue *q = calloc(1, sizeof *q);
    if (!q) {
        consumers_close(list);
        return STATUS_NO_MEMORY;
    }
    q->list = *list;
    q->rule = rule;
    q->result = counters;
    q->consumer = (Consumer){consumers_wants(list), put, NULL, close_queue, NULL, begin};
    list->count = 0;
    pthread_mutex_init(&q->lock, NULL);
    pthread_cond_init(&q->work, NULL);
    pthread_cond_init(&q->room, NULL);
    sigset_t all, before; /* signals are for the main thread */
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    q->running = pthread_create(&q->thread, NULL, work, q) == 0;
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    if (q->running) {
        *out = &q->consumer;
        return STATUS_OK;
    }
    close_queue(&q->consumer);
    return STATUS_NO_MEMORY;
}
