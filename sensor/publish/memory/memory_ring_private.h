/* sensor/publish/memory/memory_ring_private.h: writes the ring of frames in shared memory that
 * etc/include/pitviper_memory.h describes: newest wins, readers cannot change it, and nothing here waits for one.
 *
 * A frame costs one copy of its planes and one system call; no memory is allocated. */
#ifndef SENSOR_PUBLISH_MEMORY_MEMORY_RING_PRIVATE_H
#define SENSOR_PUBLISH_MEMORY_MEMORY_RING_PRIVATE_H

#include "pitviper.h"

#include <pitviper_memory.h>

typedef struct MemoryRing MemoryRing;

typedef struct MemoryRingOf {
    const char         *name; /* under /dev/shm */
    int                 slots, target_room;
    bool                truth;
    int                 plane_count;
    PitviperMemoryPlane plane[pitviper_memory_planes_most]; /* offsets are filled in */
    const char         *host;                               /* of several; NULL: one alone */
    const char         *config_sha256;
    int                 detections_port; /* 0: none */
} MemoryRingOf;

/* STATUS_BAD_VALUE, STATUS_IO, logged with what to do: the name is in use; no room. */
Status memory_ring_create(MemoryRing **out, const MemoryRingOf *of);
/* Whether readers can find it: its name is neither removed nor another's. */
bool   memory_ring_is_named(const MemoryRing *ring);
size_t memory_ring_size(const MemoryRing *ring); /* octets */
/* The record to fill in for the next frame: all but lock, sequence and written_ns. targets: [target_room]. */
PitviperMemoryRecord *memory_ring_record(MemoryRing *ring);
PitviperMemoryTarget *memory_ring_targets(MemoryRing *ring);
/* Publishes the record, its targets and the planes as the newest frame. plane: [plane_count], of the ring's sizes and
 * types. */
void memory_ring_put(MemoryRing *ring, const void *const *plane);
/* Tells readers that it has ended, and removes it. NULL is valid. */
void memory_ring_close(MemoryRing *ring);

#endif
