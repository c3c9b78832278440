/* sensor/publish/sent_counters.h: what streams and the ring of frames could not deliver, for run.json. */
#ifndef SENSOR_PUBLISH_SENT_COUNTERS_H
#define SENSOR_PUBLISH_SENT_COUNTERS_H

#include "pitviper.h"

/* Datagrams of all streams: taken by the kernel; refused because no program listens there; without a route; dropped because the
 * kernel's buffer was full. */
typedef struct StreamCounters {
    uint64_t sent, refused, no_route, lost;
} StreamCounters;

typedef struct SentCounters {
    StreamCounters stream;
    uint64_t       frames_unnamed; /* written into a ring whose name in /dev/shm was gone or another's by then */
} SentCounters;

#endif
