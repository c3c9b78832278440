/* The twin of the tsan gate: a race on purpose. Built and run under tsan alone, where it must fail. */
#include "pitviper.h"

#include <stdatomic.h>

static atomic_int arrived;

/* Two tasks that wait for each other are on two threads; a relaxed counter orders nothing that tsan looks at. */
static void count(void *user, int worker, int task)
{
    (void)worker, (void)task;
    const double start_s = wall_clock_s();
    atomic_fetch_add_explicit(&arrived, 1, memory_order_relaxed);
    while (atomic_load_explicit(&arrived, memory_order_relaxed) < 2 && wall_clock_s() < start_s + 20) {
    }
    ++*(volatile int *)user;
}

int main(void)
{
    Pool *pool;
    int   counted = 0;
    if (pool_create(&pool, 4) != STATUS_OK) return 0;
    pool_run(pool, 2, count, &counted);
    pool_destroy(pool);
    return 0;
}
