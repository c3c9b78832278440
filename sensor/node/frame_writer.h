/* sensor/node/frame_writer.h: a live node's picture files, by a thread of their own, so that a disk never holds the
 * renderer. Three frames: one is rendered, one waits, one is written; a newer one takes the place of one that waits,
 * and that is counted. What is written is what frame_files_write would have written. */
#ifndef SENSOR_NODE_FRAME_WRITER_H
#define SENSOR_NODE_FRAME_WRITER_H

#include "sensor/node/frame_files.h"

typedef struct FrameWriter FrameWriter;

typedef struct FrameWriterCounters {
    int written, left_out, failed; /* frames: whole; without files for want of time; of a disk */
} FrameWriterCounters;

/* chain: detectors of the writer's own, [BAND_COUNT], taken over also when this fails; NULL: none. config must
 * outlive it. */
Status frame_writer_create(FrameWriter **out, Chain *chain[BAND_COUNT], const Config *config);
/* Writes the frame that waits, and ends. NULL is fine. */
FrameWriterCounters frame_writer_destroy(FrameWriter *writer);

/* Where the next frame is to be made; reset. */
Arena *frame_writer_arena(FrameWriter *writer);
/* Hands over the frame made in that arena; what files, picture and snapshot point to lies there or outlives the
 * writer. */
void   frame_writer_put(FrameWriter *writer, const FrameFiles *files);

#endif
