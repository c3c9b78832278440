/* sensor/publish/consumers/consumer.c: a list of consumers used as one, and the queue that puts frames to a list in a
 * thread of its own. */
#include "sensor/publish/consumers/consumer.h"

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

/* ---- the queue: a thread, and the frames that wait for it ---------------------------------------- */

typedef struct FrameQueue {
    Consumer         consumer;
    Consumers        list;
    QueueOf          of;
    QueueCounters    counters;
    int              count;                     /* of frames that wait */
    Frame           *waits[queue_waiting_most]; /* [count], the oldest first */
    Status           status;                    /* QUEUE_WAIT: the first failure */
    Status           closed;                    /* of.disk: of its consumers, in its thread */
    bool             stop, running;
    _Atomic uint64_t steps; /* frames done with */
    pthread_mutex_t  lock;  /* of waits, status, stop */
    pthread_cond_t   work, room;
    pthread_t        thread;
} FrameQueue;

static Frame *take_oldest(FrameQueue *q)
{
    Frame *frame = q->waits[0];
    memmove(q->waits, q->waits + 1, (size_t)--q->count * sizeof(Frame *));
    return frame;
}

static void *work(void *user)
{
    FrameQueue *q = user;
    thread_flush_denormals();
    if (q->of.urgent) publish_urgent();
    pthread_mutex_lock(&q->lock);
    for (;;) {
        while (q->count == 0 && !q->stop) pthread_cond_wait(&q->work, &q->lock);
        if (q->count == 0) break;
        Frame     *frame = take_oldest(q);
        const bool ended = q->of.rule == QUEUE_WAIT && q->status != STATUS_OK;
        pthread_cond_signal(&q->room);
        pthread_mutex_unlock(&q->lock);
        const Status status = ended ? STATUS_OK : consumers_put(&q->list, frame);
        frame_release(frame);
        atomic_fetch_add(&q->steps, 1);
        pthread_mutex_lock(&q->lock);
        if (ended) continue;
        if (status == STATUS_OK) q->counters.handed++;
        else q->counters.failed++;
        if (q->status == STATUS_OK) q->status = status;
    }
    pthread_mutex_unlock(&q->lock);
    if (q->of.disk) q->closed = consumers_close(&q->list); /* here: a close may hang too */
    return NULL;
}

static Status put(Consumer *consumer, Frame *frame)
{
    FrameQueue *q = (FrameQueue *)consumer;
    const bool  waits = q->of.rule == QUEUE_WAIT;
    Frame      *older = NULL;
    Status      status;
    pthread_mutex_lock(&q->lock);
    while (waits && q->count == q->of.waiting && q->status == STATUS_OK) pthread_cond_wait(&q->room, &q->lock);
    status = waits ? q->status : STATUS_OK;
    if (status == STATUS_OK && q->count == q->of.waiting) older = take_oldest(q); /* under QUEUE_LEAVE_OUT alone */
    pthread_mutex_unlock(&q->lock);
    if (status != STATUS_OK) return status;
    if (older) {
        consumers_left_out(&q->list, older);
        frame_release(older);
        q->counters.left_out++; /* used by this thread alone until it is joined */
    }
    frame_hold(frame);
    pthread_mutex_lock(&q->lock);
    q->waits[q->count++] = frame; /* there is room: only this thread puts */
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
        pthread_mutex_unlock(&q->lock); /* waiting frames are passed on before it ends */
        if (!q->of.disk) pthread_join(q->thread, NULL);
        else if (!publish_ended(q->thread, &q->steps, q->of.what)) {
            if (q->of.counters) *q->of.counters = q->counters;
            return STATUS_IO; /* q stays as it is */
        }
    }
    Status       status = q->of.rule == QUEUE_WAIT ? q->status : q->closed;
    const Status closed = consumers_close(&q->list); /* of those that its thread has not closed */
    if (status == STATUS_OK) status = closed;
    if (q->of.counters) *q->of.counters = q->counters;
    pthread_cond_destroy(&q->room);
    pthread_cond_destroy(&q->work);
    pthread_mutex_destroy(&q->lock);
    free(q);
    return status;
}

Status consumer_queue_open(Consumer **out, Consumers *list, const QueueOf *of)
{
    FrameQueue *q = calloc(1, sizeof *q);
    if (!q) {
        consumers_close(list);
        return STATUS_NO_MEMORY;
    }
    q->list = *list;
    q->of = *of;
    q->consumer = (Consumer){consumers_wants(list), put, NULL, close_queue, NULL, begin};
    list->count = 0;
    pthread_mutex_init(&q->lock, NULL);
    pthread_cond_init(&q->work, NULL);
    pthread_cond_init(&q->room, NULL);
    q->running = publish_thread(&q->thread, work, q);
    if (q->running) {
        *out = &q->consumer;
        return STATUS_OK;
    }
    close_queue(&q->consumer);
    return STATUS_NO_MEMORY;
}
