/* sensor/publish/frame_queue.c: a thread, and the one frame that waits for it. */
#include "sensor/publish/frame_queue.h"

#include <pthread.h>
#include <signal.h>
#include <stdlib.h>

typedef struct FrameQueue {
    Consumer        consumer;
    Consumers       list;
    QueueRule       rule;
    QueueCounters   counters, *result;
    Frame          *waits;
    Status          status;          /* QUEUE_WAIT: the first failure */
    bool            stop, running;
    pthread_mutex_t lock;            /* of waits, status, stop */
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
    FrameQueue *q     = (FrameQueue *)consumer;
    Frame      *older = NULL;
    Status      status;
    pthread_mutex_lock(&q->lock);
    while (q->rule == QUEUE_WAIT && q->waits && q->status == STATUS_OK) pthread_cond_wait(&q->room, &q->lock);
    status = q->rule == QUEUE_WAIT ? q->status : STATUS_OK;
    if (status == STATUS_OK) { /* another may wait only under QUEUE_LEAVE_OUT */
        older    = q->waits;
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

Status frame_queue_open(Consumer **out, Consumers *list, QueueRule rule, QueueCounters *counters)
{
    FrameQueue *q = calloc(1, sizeof *q);
    if (!q) {
        consumers_close(list);
        return STATUS_NO_MEMORY;
    }
    q->list     = *list;
    q->rule     = rule;
    q->result   = counters;
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
