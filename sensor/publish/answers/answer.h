/* sensor/publish/answers/answer.h: what a recogniser answered to one band of one frame, whatever form it was sent in.
 *
 * An answer has up to 64 detections; none: nothing was found. A datagram is one answer, and its first octets tell the
 * form:
 *
 *     ring   PVDETECT: PitviperDetections of etc/include/pitviper_memory.h, versions 1 to 3 (answer_ring.c)
 *     json   a brace: one object, or the lines of answers.jsonl (answer_json.c)
 *     klv    06 0E 2B 34: an ST 0903 VMTI local set, or an ST 0601 packet that has one (answer_klv.c)
 *
 * Each octet of a datagram is checked, and what is not as documented (etc/reference/answers.md) is refused whole, with
 * one reason. Pure functions of their arguments; nothing is logged. */
#ifndef SENSOR_PUBLISH_ANSWERS_ANSWER_H
#define SENSOR_PUBLISH_ANSWERS_ANSWER_H

#include "sensor/frame/field.h"
#include "sensor/frame/publish_counters.h"
#include "sensor/frame/records.h"

enum {
    answer_detections_most = 64,
    answer_class_size = 32,
    answer_octets_most = 65507, /* of a UDP datagram */
};

/* A number that was not given is NaN. There is a box or a line of sight, or both. */
typedef struct AnswerDetection {
    double   box_px[4];  /* image: left, top, right, bottom; from 0, the last two beyond it */
    double   los_rad[2]; /* ENU at the sensor: from north over east, 0 .. 2 pi; above the horizontal */
    double   range_m;    /* from the sensor */
    double   score;      /* 0 .. 1 */
    uint32_t track;      /* 0: none */
    char     class_name[answer_class_size]; /* printable ASCII, zeros to the end; empty: none */
    /* What a camera relates to the line of sight (answer_complete); KLV gives one of these instead. */
    double   point_px[2]; /* image: column, row, from 0.5 in the middle of the first pixel; also outside the image */
    bool     located;
    Geodetic place; /* if located */
} AnswerDetection;

typedef struct Answer {
    AnswerForm form;
    Band       band;
    /* The frame: by its number, of which KLV has the low 24 bits (number_bits: a mask), its exercise time, or both. */
    bool     numbered, timed;
    int      frame;
    uint32_t number_bits;
    int64_t  time_us; /* since 1970 */
    /* When that frame was found among those that are known: */
    double          time_s, unix_s; /* exercise time */
    double          received_s;     /* wall_clock_s */
    int             count;
    AnswerDetection detection[answer_detections_most];
} Answer;

/* What an answer can be about. */
typedef struct AnswerScope {
    unsigned bands; /* bit set of those of the run */
    int      width, height;
} AnswerScope;

/* The form of a datagram by its first octets; what is of none is taken for ANSWER_RING, and refused there. */
AnswerForm answer_form(const uint8_t *bytes, size_t size);
/* Reads one datagram. out: valid if ANSWER_GOOD; the frame is not looked up. */
AnswerReason answer_read(Answer *out, const uint8_t *bytes, size_t size, const AnswerScope *scope);

extern const FieldTable answer_fields; /* a line of answers.jsonl (answer_lines.c) */

/* ---- with the camera of its frame ---------------------------------------------------------------- */

typedef struct AnswerCamera {
    double p_ecef[3], r_ecef_from_cam[9];
    double r_ecef_from_enu[9]; /* axes at the sensor */
    View   view;               /* its size, focal length and lens */
} AnswerCamera;

void answer_camera(AnswerCamera *out, const FrameRecord *record);
/* Relates lines of sight, points of the image and places: a line of sight from the point, if there is no box, or from
 * the place; the range from the place, and the place from line of sight and range; the point from the line of sight,
 * through the lens. A point behind the camera stays NaN. */
void answer_complete(Answer *answer, const AnswerCamera *camera);

#endif
