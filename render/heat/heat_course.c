/* render/heat/heat_course.c: the weather of all times that warm the ground up to an exercise, found at once. */
#include "render/heat/heat_private.h"

#include <stdlib.h>

void heat_run(Pool *pool, int count, PoolTask *task, void *user)
{
    if (pool) pool_run(pool, count, task, user);
    else
        for (int k = 0; k < count; k++) task(user, 0, k);
}

typedef struct CourseJob {
    const Course     *course;
    const HeatConfig *config;
} CourseJob;

static void find_weather(void *user, int worker, int task)
{
    const CourseJob  *job = user;
    const Course     *c = job->course;
    const HeatConfig *config = job->config;
    const int64_t     index = task < c->coarse ? c->first + task * c->wide : c->fine_from + (task - c->coarse);
    (void)worker;
    config->weather(&c->at[task], (double)index * config->step_s, config->user);
}

Status heat_course_find(Course *c, const HeatConfig *config, int64_t first, int64_t begun)
{
    const int64_t fine = (int64_t)ceil(8 * 3600 / config->step_s);
    int           strides = 0;
    c->first = first;
    c->wide = heat_half_hour(config);
    c->fine_from = first;
    for (; begun - c->fine_from > fine && begun - c->fine_from > c->wide; c->fine_from += c->wide) strides++;
    const int day = heat_day_strides(config); /* the day by which columns are started, which may be longer */
    c->coarse = (strides > day ? strides : day) + 1;
    c->fine = (int)(begun + 1 - c->fine_from) + 1;
    c->at = malloc((size_t)(c->coarse + c->fine) * sizeof *c->at);
    if (!c->at) return STATUS_NO_MEMORY;
    heat_run(config->pool, c->coarse + c->fine, find_weather, &(CourseJob){c, config});
    return STATUS_OK;
}

int heat_day_sun(int slot_of[heat_day_slots], float d_enu[3][heat_day_slots], const HeatConfig *c)
{
    const double day = floor(c->unix_s / day_s) * day_s;
    int          slots = 0;
    for (int s = 0; s < heat_day_slots; s++) {
        double at_s = day + (s + 0.5) * slot_s;
        if (at_s > c->unix_s) at_s -= day_s; /* of the day past */
        GroundWeather w;
        c->weather(&w, at_s, c->user);
        slot_of[s] = -1;
        if (!(w.sun_d_enu[2] > 0)) continue;
        for (int k = 0; k < 3; k++) d_enu[k][slots] = (float)w.sun_d_enu[k];
        slot_of[s] = slots++;
    }
    return slots;
}
