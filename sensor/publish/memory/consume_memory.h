/* sensor/publish/memory/consume_memory.h: the consumer that writes each frame into a ring in shared memory, for
 * recognisers on this machine (etc/reference/memory.md). It never waits, so it belongs in the rendering thread,
 * before the other consumers. */
#ifndef SENSOR_PUBLISH_MEMORY_CONSUME_MEMORY_H
#define SENSOR_PUBLISH_MEMORY_CONSUME_MEMORY_H

#include "sensor/publish/consumers/consumer.h"
#include "sensor/settings/config.h"

typedef struct MemoryOf {
    const Config *config; /* publish.memory..., the image's size; outlives the consumer */
    const char   *config_sha256;
    unsigned      bands;                  /* of the run */
    int           count_bits[BAND_COUNT]; /* of raw counts; 0: a band without a sensor has none */
    uint64_t   *unnamed; /* counts frames that were written while the ring's name was not its own; NULL: not counted */
    const char *host;    /* of several hosts of one run: its id, or `observer`; NULL: one alone */
} MemoryOf;

/* Names the ring in /dev/shm; host as above. */
enum { memory_name_size = 96 };
void memory_name(char out[memory_name_size], const Config *config, const char *host);

/* STATUS_BAD_VALUE, STATUS_IO, logged with what to do: the name is in use; no room in /dev/shm. */
Status consume_memory(Consumer **out, const MemoryOf *of);

#endif
