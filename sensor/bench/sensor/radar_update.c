/* sensor/bench/sensor/radar_update.c: see radar_update.h. */
#include "sensor/bench/sensor/radar_update.h"

#include "sensor/bench/bench.h"

void radar_update(void *update)
{
    RadarUpdate *u = update;
    arena_reset(u->arena);
    u->status = seeker_radar_measure(&u->frame, u->radar, &u->scene, u->pool, u->arena);
    bench_keep(u->frame);
}
