/* The twin of the tsan gate: a race on purpose. Built and run under tsan alone, where it must fail. */
#include "pitviper.h"

static void count(void *user, int worker, int task)
{
    (void)worker, (void)task;
    ++*(volatile int *)user;
}

int main(void)
{
    Pool *pool;
    int   counted = 0;
    if (pool_create(&pool, 4) != STATUS_OK) return 0;
    for (int i = 0; i < 100; i++) pool_run(pool, 1000, count, &counted);
    pool_destroy(pool);
    return 0;
}
