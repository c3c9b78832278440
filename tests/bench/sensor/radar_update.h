/* tests/bench/sensor/radar_update.h: one measurement of a seeker's radar, as work of a benchmark. */
#ifndef TESTS_BENCH_SENSOR_RADAR_UPDATE_H
#define TESTS_BENCH_SENSOR_RADAR_UPDATE_H

#include "sensor/radar/seeker_radar.h"
#include "tests/bench/bench.h"

typedef struct RadarUpdate {
    SeekerRadar      *radar;
    RadarScene        scene;
    Pool             *pool;  /* NULL: one thread */
    Arena            *arena; /* reset each time */
    const RadarFrame *frame;
    Status            status;
} RadarUpdate;

static inline void radar_update(void *update)
{
    RadarUpdate *u = update;
    arena_reset(u->arena);
    u->status = seeker_radar_measure(&u->frame, u->radar, &u->scene, u->pool, u->arena);
    bench_keep(u->frame);
}

#endif
