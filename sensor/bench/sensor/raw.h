/* sensor/bench/sensor/raw.h: the rays of an image of one sample per pixel, in a frame's own order, for the tracers
 * alone. */
#ifndef SENSOR_BENCH_SENSOR_RAW_H
#define SENSOR_BENCH_SENSOR_RAW_H

#include "sensor/quality/trial.h"

typedef struct RawRays RawRays;

/* Eye rays in the frame's tiles and, where it has a band with shadows, the sun rays of their hits; the rays that
 * pass near each vehicle are found here, too. frame: one that was rendered; its arena is used, not reset. */
Status raw_rays_create(RawRays **out, const TrialFrame *frame);
void   raw_rays_destroy(RawRays *raw);
int    raw_rays_count(const RawRays *raw);
/* A frame's own tracers, of the ground by tiles and of the parts by packets, with its tiles, order and limits: of
 * eye rays the parts and then the ground in front of them, of sun rays the parts and then the ground for the rays
 * not blocked. Nothing else. user: a RawRays with a pool. */
void   raw_trace(void *user);
void   raw_use_pool(RawRays *raw, Pool *pool);
/* Worst difference in range, m, between the ground tracer and a reference walk from one post line to the next in
 * double, over every n-th ray traced to the ground; INFINITY where one hits the ground and the other does not. */
double raw_worst_m(const RawRays *raw, int every);

#endif
