/* pitviper_threads.c: one pool. Tasks are handed out by a counter; results must not depend on which thread ran which
 * task. */
#include "pitviper.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <time.h>
#include <xmmintrin.h>

typedef struct Worker {
    Pool     *pool;
    pthread_t thread;
    int       index;
} Worker;

struct Pool {
    int             threads;
    Worker         *worker; /* [threads - 1]; the caller is worker 0 */
    pthread_mutex_t lock;
    pthread_cond_t  work, done;
    uint64_t        round; /* number of the present pool_run call */
    bool            open;  /* that call may still have tasks to hand out */
    int             busy;  /* workers that run its tasks */
    bool            stop;
    PoolTask       *task;
    void           *user;
    int             count, next;
};

void thread_flush_denormals(void) { _mm_setcsr(_mm_getcsr() | 0x8040); /* FTZ and DAZ */ }

static void run_tasks(Pool *pool, int worker)
{
    for (;;) {
        const int task = __atomic_fetch_add(&pool->next, 1, __ATOMIC_RELAXED);
        if (task >= pool->count) return;
        pool->task(pool->user, worker, task);
    }
}

static void *worker_main(void *argument)
{
    Worker  *self = argument;
    Pool    *pool = self->pool;
    uint64_t seen = 0;

    thread_flush_denormals();
    pthread_mutex_lock(&pool->lock);
    for (;;) {
        while ((pool->round == seen || !pool->open) && !pool->stop) pthread_cond_wait(&pool->work, &pool->lock);
        if (pool->stop) break;
        seen = pool->round;
        pool->busy++;
        pthread_mutex_unlock(&pool->lock);
        run_tasks(pool, self->index);
        pthread_mutex_lock(&pool->lock);
        if (--pool->busy == 0) pthread_cond_signal(&pool->done);
    }
    pthread_mutex_unlock(&pool->lock);
    return NULL;
}

Status pool_create(Pool **out, int threads)
{
    if (threads < 1 || threads > 1024) return STATUS_BAD_VALUE;
    Pool *pool = calloc(1, sizeof *pool);
    if (!pool) return STATUS_NO_MEMORY;
    pthread_mutex_init(&pool->lock, NULL);
    pthread_cond_init(&pool->work, NULL);
    pthread_cond_init(&pool->done, NULL);
    pool->threads = 1;
    pool->worker = calloc((size_t)threads, sizeof *pool->worker);
    if (!pool->worker) {
        pool_destroy(pool);
        return STATUS_NO_MEMORY;
    }
    for (int i = 1; i < threads; i++) {
        Worker *worker = &pool->worker[i - 1];
        worker->pool = pool;
        worker->index = i;
        if (pthread_create(&worker->thread, NULL, worker_main, worker) != 0) {
            pool_destroy(pool);
            return STATUS_NO_MEMORY;
        }
        pool->threads = i + 1;
    }
    *out = pool;
    return STATUS_OK;
}

void pool_destroy(Pool *pool)
{
    if (!pool) return;
    pthread_mutex_lock(&pool->lock);
    pool->stop = true;
    pthread_cond_broadcast(&pool->work);
    pthread_mutex_unlock(&pool->lock);
    for (int i = 1; i < pool->threads; i++) pthread_join(pool->worker[i - 1].thread, NULL);
    pthread_cond_destroy(&pool->done);
    pthread_cond_destroy(&pool->work);
    pthread_mutex_destroy(&pool->lock);
    free(pool->worker);
    free(pool);
}

int pool_threads(const Pool *pool) { return pool->threads; }

void pool_run(Pool *pool, int count, PoolTask *task, void *user)
{
    if (count <= 0) return;
    pthread_mutex_lock(&pool->lock);
    pool->task = task;
    pool->user = user;
    pool->count = count;
    pool->next = 0;
    pool->busy = 0;
    pool->open = true;
    pool->round++;
    pthread_cond_broadcast(&pool->work);
    pthread_mutex_unlock(&pool->lock);

    run_tasks(pool, 0);

    /* all are handed out: a worker that is not awake by now has nothing to do, and is not waited for */
    pthread_mutex_lock(&pool->lock);
    pool->open = false;
    while (pool->busy > 0) pthread_cond_wait(&pool->done, &pool->lock);
    pthread_mutex_unlock(&pool->lock);
}

static bool (*_Atomic work_stop)(void);

void work_stop_when(bool (*asked)(void)) { atomic_store(&work_stop, asked); }

bool work_stop_asked(void)
{
    bool (*asked)(void) = atomic_load(&work_stop);
    return asked && asked();
}

typedef struct Stoppable {
    PoolTask *task;
    void     *user;
} Stoppable;

static void unless_stopped(void *user, int worker, int task)
{
    const Stoppable *s = user;
    if (!work_stop_asked()) s->task(s->user, worker, task);
}

bool pool_run_unless_stopped(Pool *pool, int count, PoolTask *task, void *user)
{
    Stoppable s = {task, user};
    if (pool) pool_run(pool, count, unless_stopped, &s);
    else
        for (int n = 0; n < count; n++) unless_stopped(&s, 0, n);
    return !work_stop_asked();
}

int thread_processors(void)
{
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof set, &set) != 0) return 1;
    const int count = CPU_COUNT(&set);
    return count > 0 ? count : 1;
}

double wall_clock_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}
