/* sensor/publish/memory/memory_segment.h: the file of a ring of frames in /dev/shm: made whole before it has its name,
 * with all its memory reserved, locked for as long as this process lives, and removed at the end.
 *
 * A name in use by a living process is refused; one that a killed process left behind is replaced. */
#ifndef SENSOR_PUBLISH_MEMORY_MEMORY_SEGMENT_H
#define SENSOR_PUBLISH_MEMORY_MEMORY_SEGMENT_H

#include "pitviper.h"

#include <sys/types.h>

enum { memory_name_size = 128 };

typedef struct MemorySegment {
    char           name[memory_name_size]; /* under /dev/shm */
    char           temporary[memory_name_size + 40];
    int            file;                   /* -1: none */
    unsigned char *at;                     /* zeroed; page aligned */
    size_t         size;
    bool           named;                  /* published under its name */
} MemorySegment;

/* Zeroed memory that has no name yet. STATUS_IO, logged with what to do: no room, no permission. */
Status memory_segment_create(MemorySegment *out, const char *name, size_t size);
/* Gives it its name. STATUS_BAD_VALUE, logged: the name is in use. */
Status memory_segment_publish(MemorySegment *segment);
/* Whether the name is this segment's still: nothing keeps others from removing or replacing it. */
bool   memory_segment_is_named(const MemorySegment *segment);
/* Removes the name, if it still is this segment's, and the mapping; readers keep theirs. */
void   memory_segment_close(MemorySegment *segment);

#endif
