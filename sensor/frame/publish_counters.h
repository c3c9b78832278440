/* sensor/frame/publish_counters.h: counters of what consumers received and sent, for run.json. */
#ifndef SENSOR_FRAME_PUBLISH_COUNTERS_H
#define SENSOR_FRAME_PUBLISH_COUNTERS_H

#include "sensor/frame/latency_private.h"
#include "pitviper.h"

/* ---- answers received from a recogniser: datagrams by form and reason ----------------------------- */

typedef enum AnswerForm {
    ANSWER_RING, /* PitviperDetections of etc/include/pitviper_memory.h */
    ANSWER_JSON,
    ANSWER_KLV, /* MISB ST 0903 */
    ANSWER_FORMS
} AnswerForm;
extern const char *const answer_form_name[ANSWER_FORMS]; /* ring, json, klv */

typedef enum AnswerReason {
    ANSWER_GOOD,
    ANSWER_SIZE,  /* not that of its count */
    ANSWER_MAGIC, /* its first octets are those of no form */
    ANSWER_ORDER,
    ANSWER_VERSION,
    ANSWER_COUNT, /* more detections than answer_detections_most, or another number than it says */
    ANSWER_BAND,  /* not one of the run's */
    ANSWER_BOX,   /* not within the image, not finite, empty; no place at all */
    ANSWER_SCORE,
    ANSWER_TEXT,
    ANSWER_RESERVED, /* not 0 */
    ANSWER_NO_JSON,
    ANSWER_FIELD,     /* of JSON: unknown, missing, of another type */
    ANSWER_LOCAL_SET, /* of KLV: key, lengths, items, an item twice, a value that the standard does not have */
    ANSWER_CHECKSUM,
    ANSWER_IMAGE, /* pixels of another image: its width or height */
    ANSWER_SIGHT, /* line of sight: not finite, outside its range */
    ANSWER_RANGE,
    ANSWER_FRAME,    /* not one of the last answer_frames_kept */
    ANSWER_LATE,     /* well-formed, of an older frame than one received before: an answer, but not for metadata */
    ANSWER_REPEATED, /* well-formed, of a frame and band that were answered before */
    ANSWER_REASONS
} AnswerReason;
extern const char *const answer_reason_name[ANSWER_REASONS];

/* The sum of datagrams and lost_kernel is what was sent here. */
typedef struct AnswerCounters {
    uint64_t datagrams[ANSWER_FORMS][ANSWER_REASONS];
    uint64_t lost_kernel;  /* datagrams that came faster than they were read */
    uint64_t lines;        /* of answers.jsonl */
    uint64_t lines_failed; /* that could not be written */
} AnswerCounters;

/* Of a reason, by all forms. */
static inline uint64_t answer_datagrams(const AnswerCounters *c, AnswerReason reason)
{
    uint64_t sum = 0;
    for (int form = 0; form < ANSWER_FORMS; form++) sum += c->datagrams[form][reason];
    return sum;
}

/* ---- what streams and the ring of frames could not deliver --------------------------------------- */

/* Datagrams of all streams: taken by the kernel; refused because no program listens there; without a route; dropped
 * because the kernel's buffer was full. */
typedef struct StreamCounters {
    uint64_t sent, refused, no_route, lost;
} StreamCounters;

/* Images of a window on a display (sensor/publish/projector/). */
typedef struct ProjectorCounters {
    uint64_t       shown, dropped; /* flipped; never shown: a newer one came before, or the window was gone */
    uint64_t       late;           /* of those shown, at whose flip a newer one was there */
    uint64_t       waited_out;     /* frames that were held up for all of projector.wait_ms */
    double         refresh_hz;     /* of the display; 0: not known */
    char           what[200];      /* where it is shown and by what */
    LatencyFigures interval, off;  /* between flips; how far that is from a whole number of refreshes */
    LatencyFigures after;          /* from the end of rendering to the flip */
} ProjectorCounters;

typedef struct SentCounters {
    StreamCounters    stream;
    ProjectorCounters projector;
    uint64_t          frames_unnamed; /* written into a ring whose name in /dev/shm was gone or another's by then */
} SentCounters;

#endif
