/* sensor/publish/memory/detections.h: detections that a recogniser on this machine sends back: datagrams on loopback,
 * laid out in etc/include/pitviper_memory.h, received by a thread of their own.
 *
 * Every octet is checked. The first datagram for a band of a recent frame is that frame's answer and goes into
 * answers.jsonl; of each band the newest frame's is kept for metadata. The rest is counted by reason, so memory and
 * file are bounded - an answer for each frame and band - and a flood costs the renderer nothing. */
#ifndef SENSOR_PUBLISH_MEMORY_DETECTIONS_H
#define SENSOR_PUBLISH_MEMORY_DETECTIONS_H

#include "sensor/frame/field.h"
#include "sensor/frame/publish_counters.h"
#include "sensor/publish/consumers/consumer.h"

#include <pitviper_memory.h>

enum { detections_frames_kept = 256 };

typedef struct DetectionSet {
    int               frame;
    Band              band;
    double            time_s, unix_s; /* exercise time of the frame */
    double            received_s;     /* wall_clock_s */
    int               count;
    PitviperDetection detection[pitviper_detections_most];
} DetectionSet;

typedef struct Detections Detections;

typedef struct DetectionsOf {
    int      port;
    unsigned bands;         /* bit set of those of the run */
    int      width, height; /* of the images */
} DetectionsOf;

/* STATUS_IO, logged: the port is in use. */
Status detections_open(Detections **out, const DetectionsOf *of);
/* From now on answers are written to answers.jsonl of a folder. Call it once. STATUS_IO, logged: the file cannot be
 * written. */
Status detections_record(Detections *detections, const char *folder);
/* Logs the counts and frees all. NULL is valid. counters: receives them, 0 without detections; may be NULL. */
void detections_close(Detections *detections, AnswerCounters *counters);
/* A frame that detections may refer to from now on. rendered_s: wall_clock_s; 0: not known. */
void detections_frame(Detections *detections, int frame, double time_s, double unix_s, double rendered_s);
/* Copies the newest detections of a band; false: there are none yet. Any thread may call it. */
bool detections_latest(Detections *detections, Band band, DetectionSet *out);
/* So far. */
void detections_counters(Detections *detections, AnswerCounters *out);

extern const FieldTable answer_fields; /* a line of answers.jsonl */
/* Tells them of every frame, and has them recorded; detections and folder stay the caller's and outlive it. */
Status consume_detections(Consumer **out, Detections *detections, const char *folder);

/* Reads one datagram of version 1 or 2, without looking up the frame that it refers to. out: valid if DETECTIONS_GOOD,
 * and then of version 2. */
DetectionsReason detections_parse(PitviperDetections *out, const uint8_t *bytes, size_t size, unsigned bands, int width,
                                  int height);

#endif
