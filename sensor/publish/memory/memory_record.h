/* sensor/publish/memory/memory_record.h: a frame's record and targets as they stand in shared memory. */
#ifndef SENSOR_PUBLISH_MEMORY_MEMORY_RECORD_H
#define SENSOR_PUBLISH_MEMORY_MEMORY_RECORD_H

#include "sensor/publish/frame.h"

#include <pitviper_memory.h>

/* All but lock, sequence and written_ns. targets: [room]; without truth none are filled in. Where there is not room for
 * all targets, visible ones come first; otherwise they are in the order of truth.jsonl. */
void memory_record(PitviperMemoryRecord *out, PitviperMemoryTarget *targets, int room, const Frame *frame);

#endif
