/* sensor/bench/sensor/radar_update.h: one measurement of a seeker's radar, as work of a benchmark. */
#ifndef SENSOR_BENCH_SENSOR_RADAR_UPDATE_H
#define SENSOR_BENCH_SENSOR_RADAR_UPDATE_H

#include "sensor/radar/seeker_radar.h"

typedef struct RadarUpdate {
    SeekerRadar      *radar;
    RadarScene        scene;
    Pool             *pool;   /* NULL: one thread */
    Arena            *arena;  /* reset each time */
    const RadarFrame *frame;
    Status            status;
} RadarUpdate;

void radar_update(void *update);

#endif
