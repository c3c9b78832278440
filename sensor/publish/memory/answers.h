/* sensor/publish/memory/answers.h: OUT/answers.jsonl, the answers of a recogniser: a line per detection, in the order in
 * which they were received; of an answer that found nothing a line too. */
#ifndef SENSOR_PUBLISH_MEMORY_ANSWERS_H
#define SENSOR_PUBLISH_MEMORY_ANSWERS_H

#include "sensor/publish/answer_counters.h"

#include <pitviper_memory.h>

typedef struct Answers Answers;

/* The frame that was answered. */
typedef struct AnsweredFrame {
    double time_s;      /* exercise time */
    double latency_ms;  /* from the end of its rendering to the answer's arrival; NaN: not known */
    bool   late;        /* a newer frame of the band was answered before */
} AnsweredFrame;

/* Creates the file in this folder. STATUS_IO, logged. */
Status answers_open(Answers **out, const char *folder);
/* Its lines, flushed. What cannot be written is counted, and reported once. */
void   answers_write(Answers *answers, const PitviperDetections *answer, const AnsweredFrame *frame, AnswerCounters *counters);
void   answers_close(Answers *answers); /* NULL is valid */

#endif
