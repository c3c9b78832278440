/* render/heat/heat_course.c: the weather of all times that warm the ground up to an exercise, found at once. */
#include "render/heat/heat_private.h"

#include <stdlib.h>

void heat_run(const Heat *h, int count, PoolTask *task, void *user)
{
    if (h->config.pool) pool_run(h->config.pool, count, task, user);
    else
        for (int k = 0; k < count; k++) task(user, 0, k);
}

static void find_weather(void *user, int worker, int task)
{
    Heat         *h = user;
    const Course *c = &h->course;
    const int64_t index = task < c->coarse ? h->first + task * c->wide : c->fine_from + (task - c->coarse);
    (void)worker;
    h->config.weather(&c->at[task], (double)index * h->config.step_s, h->config.user);
}

Status heat_find_course(Heat *h)
{
    const int64_t fine = (int64_t)ceil(8 * 3600 / h->config.step_s);
    Course       *c = &h->course;
    int           strides = 0;
    c->wide = heat_half_hour(h);
    c->fine_from = h->first;
    for (; h->begun_index - c->fine_from > fine && h->begun_index - c->fine_from > c->wide; c->fine_from += c->wide)
        strides++;
    const int day = heat_day_strides(h); /* the day by which columns are started, which may be longer */
    c->coarse = (strides > day ? strides : day) + 1;
    c->fine = (int)(h->begun_index + 1 - c->fine_from) + 1;
    c->at = malloc((size_t)(c->coarse + c->fine) * sizeof *c->at);
    if (!c->at) return STATUS_NO_MEMORY;
    heat_run(h, c->coarse + c->fine, find_weather, h);
    return STATUS_OK;
}
