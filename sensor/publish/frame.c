/* sensor/publish/frame.c: reference-counted frames, and their pool. */
#include "sensor/publish/frame.h"

#include <pthread.h>
#include <stdlib.h>

struct FramePool {
    int             count;
    Frame          *frame;    /* [count] */
    pthread_mutex_t lock;     /* of the frames' reference counts */
    pthread_cond_t  released;
};

Status frame_pool_create(FramePool **out, int frames)
{
    FramePool *pool = calloc(1, sizeof *pool);
    if (!pool) return STATUS_NO_MEMORY;
    pthread_mutex_init(&pool->lock, NULL);
    pthread_cond_init(&pool->released, NULL);
    pool->frame = calloc((size_t)frames, sizeof *pool->frame);
    bool whole  = pool->frame != NULL;
    for (int i = 0; i < frames && whole; i++) {
        pool->count         = i + 1;
        pool->frame[i].pool = pool;
        whole               = (pool->frame[i].arena = arena_create()) != NULL;
    }
    if (whole) *out = pool;
    else frame_pool_destroy(pool);
    return whole ? STATUS_OK : STATUS_NO_MEMORY;
}

void frame_pool_destroy(FramePool *pool)
{
    if (!pool) return;
    for (int i = 0; i < pool->count; i++) arena_destroy(pool->frame[i].arena);
    pthread_cond_destroy(&pool->released);
    pthread_mutex_destroy(&pool->lock);
    free(pool->frame);
    free(pool);
}

static Frame *free_one(FramePool *pool)
{
    for (int i = 0; i < pool->count; i++)
        if (pool->frame[i].holds == 0) return &pool->frame[i];
    return NULL;
}

Frame *frame_pool_take(FramePool *pool)
{
    Frame *frame;
    pthread_mutex_lock(&pool->lock);
    while (!(frame = free_one(pool))) pthread_cond_wait(&pool->released, &pool->lock);
    frame->holds = 1;
    pthread_mutex_unlock(&pool->lock);
    Arena *arena = frame->arena;
    arena_reset(arena);
    *frame = (Frame){.arena = arena, .pool = pool, .holds = 1};
    return frame;
}

void frame_hold(Frame *frame)
{
    pthread_mutex_lock(&frame->pool->lock);
    frame->holds++;
    pthread_mutex_unlock(&frame->pool->lock);
}

void frame_release(Frame *frame)
{
    if (!frame) return;
    FramePool *pool = frame->pool;
    pthread_mutex_lock(&pool->lock);
    if (--frame->holds == 0) pthread_cond_signal(&pool->released);
    pthread_mutex_unlock(&pool->lock);
}
