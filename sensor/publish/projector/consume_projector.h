/* sensor/publish/projector/consume_projector.h: the consumer that shows one band of each frame on a display, through a
 * table of drive levels (etc/reference/projector.md). Of an image that comes while another waits the newer is shown. */
#ifndef SENSOR_PUBLISH_PROJECTOR_CONSUME_PROJECTOR_H
#define SENSOR_PUBLISH_PROJECTOR_CONSUME_PROJECTOR_H

#include "sensor/publish/consumers/consumer.h"
#include "sensor/settings/config.h"

typedef struct ProjectorOf {
    const Config      *config;                 /* projector..., the image's size; outlives the consumer */
    bool               live;                   /* poses of a gamepad are taken */
    unsigned           bands;                  /* of the run */
    int                count_bits[BAND_COUNT]; /* of raw counts; 0: a band without a sensor has none */
    Latency           *latency;                /* of its frames: it enters its flips by itself; NULL: none is kept */
    ProjectorCounters *counters;               /* filled in by close */
} ProjectorOf;

/* Waits until the window is there. STATUS_BAD_VALUE, STATUS_UNSUPPORTED, STATUS_IO, logged with what to do. Of what the
 * consumer wants of a frame the table decides: radiance needs nothing, raw counts WANT_COUNTS, the display's values
 * WANT_DISPLAY. */
Status consume_projector(Consumer **out, const ProjectorOf *of);

#endif
