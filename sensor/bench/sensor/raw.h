/* sensor/bench/sensor/raw.h: the rays of a picture of one sample a pixel, in a frame's own order, for the tracers
 * alone. */
#ifndef SENSOR_BENCH_SENSOR_RAW_H
#define SENSOR_BENCH_SENSOR_RAW_H

#include "sensor/quality/trial.h"

typedef struct RawRays RawRays;

/* Eye rays in the frame's tiles and, where it has a band that shows shadows, the sun rays of their hits; which of them
 * come near which vehicle is found here, too. frame: one that was made; its arena is used, not reset. */
Status raw_rays_create(RawRays **out, const TrialFrame *frame);
void   raw_rays_destroy(RawRays *raw);
int    raw_rays_count(const RawRays *raw);
/* A frame's own tracers, the ground's of tiles and the parts' of packets, with its tiles, order and limits: of eye
 * rays the parts and then the ground before them, of sun rays the parts and then the ground for what they leave lit.
 * Nothing else. user: a RawRays with a pool. */
void   raw_trace(void *user);
void   raw_use_pool(RawRays *raw, Pool *pool);
/* Worst difference in range, m, between the ground's answers and a plain walk from one post line to the next in
 * double, over every so-manieth ray that asked it; INFINITY where one meets the ground and the other does not. */
double raw_worst_m(const RawRays *raw, int every);

#endif
