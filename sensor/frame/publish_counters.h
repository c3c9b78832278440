/* sensor/frame/publish_counters.h: counters of what consumers received and sent, for run.json. */
#ifndef SENSOR_FRAME_PUBLISH_COUNTERS_H
#define SENSOR_FRAME_PUBLISH_COUNTERS_H

#include "pitviper.h"

/* ---- datagrams received from a recogniser, by reason --------------------------------------------- */

typedef enum DetectionsReason {
    DETECTIONS_GOOD,
    DETECTIONS_SIZE, /* not that of its count */
    DETECTIONS_MAGIC,
    DETECTIONS_ORDER,
    DETECTIONS_VERSION,
    DETECTIONS_COUNT,
    DETECTIONS_BAND, /* not one of the run's */
    DETECTIONS_BOX,  /* not within the image, not finite, empty */
    DETECTIONS_SCORE,
    DETECTIONS_TEXT,
    DETECTIONS_RESERVED, /* not 0 */
    DETECTIONS_FRAME,    /* not one of the last detections_frames_kept */
    DETECTIONS_LATE,     /* well-formed, of an older frame than one received before: an answer, but not for metadata */
    DETECTIONS_REPEATED, /* well-formed, of a frame and band that were answered before */
    DETECTIONS_REASONS
} DetectionsReason;
extern const char *const detections_reason_name[DETECTIONS_REASONS];

/* The sum of datagrams and lost_kernel is what was sent here. */
typedef struct AnswerCounters {
    uint64_t datagrams[DETECTIONS_REASONS];
    uint64_t lost_kernel;  /* datagrams that came faster than they were read */
    uint64_t lines;        /* of answers.jsonl */
    uint64_t lines_failed; /* that could not be written */
} AnswerCounters;

/* ---- what streams and the ring of frames could not deliver --------------------------------------- */

/* Datagrams of all streams: taken by the kernel; refused because no program listens there; without a route; dropped
 * because the kernel's buffer was full. */
typedef struct StreamCounters {
    uint64_t sent, refused, no_route, lost;
} StreamCounters;

typedef struct SentCounters {
    StreamCounters stream;
    uint64_t       frames_unnamed; /* written into a ring whose name in /dev/shm was gone or another's by then */
} SentCounters;

#endif
