/* sensor/publish/memory/detections.h: detections that a recogniser on this machine sends back: datagrams on loopback,
 * laid out in etc/include/pitviper_memory.h, received by a thread of their own.
 *
 * Every octet is checked. Of each band the newest datagram that refers to a recent frame of this run is kept, the rest
 * is counted by reason, so memory is bounded and a flood costs the renderer nothing. */
#ifndef SENSOR_PUBLISH_MEMORY_DETECTIONS_H
#define SENSOR_PUBLISH_MEMORY_DETECTIONS_H

#include "sensor/publish/consumer.h"

#include <pitviper_memory.h>

typedef enum DetectionsReason {
    DETECTIONS_GOOD,
    DETECTIONS_SIZE,  /* not that of its count */
    DETECTIONS_MAGIC, DETECTIONS_ORDER, DETECTIONS_VERSION, DETECTIONS_COUNT,
    DETECTIONS_BAND,  /* not one of the run's */
    DETECTIONS_BOX,   /* not within the image, not finite, empty */
    DETECTIONS_SCORE, DETECTIONS_TEXT,
    DETECTIONS_RESERVED, /* not 0 */
    DETECTIONS_FRAME, /* not one of the last detections_frames_kept */
    DETECTIONS_LATE,  /* well-formed, of an older frame than one received before */
    DETECTIONS_REASONS
} DetectionsReason;
extern const char *const detections_reason_name[DETECTIONS_REASONS];

enum { detections_frames_kept = 256 };

typedef struct DetectionSet {
    int    frame;
    Band   band;
    double time_s, unix_s; /* of that frame, exercise time */
    double received_s;     /* wall_clock_s */
    int    count;
    PitviperDetection detection[pitviper_detections_most];
} DetectionSet;

typedef struct Detections Detections;

/* bands: bit set of those of the run. STATUS_IO, logged: the port is in use. */
Status detections_open(Detections **out, int port, unsigned bands, int width, int height);
/* NULL is valid. Logs the counts. */
void   detections_close(Detections *detections);
/* A frame that detections may refer to from now on. */
void   detections_frame(Detections *detections, int frame, double time_s, double unix_s);
/* The newest of a band; false: none yet. From any thread. */
bool   detections_latest(Detections *detections, Band band, DetectionSet *out);
/* Datagrams by reason, so far. */
void   detections_counters(Detections *detections, uint64_t count[DETECTIONS_REASONS]);

/* Tells them of every frame; the detections stay the caller's and outlive it. */
Status consume_detections(Consumer **out, Detections *detections);

/* One datagram, but for the frame it refers to. out: valid if DETECTIONS_GOOD. */
DetectionsReason detections_parse(PitviperDetections *out, const uint8_t *bytes, size_t size, unsigned bands, int width,
                                  int height);

#endif
