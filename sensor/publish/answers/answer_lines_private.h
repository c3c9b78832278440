/* sensor/publish/answers/answer_lines_private.h: answers.jsonl: a line per detection in the order of arrival, also one
 * of an answer without any. */
#ifndef SENSOR_PUBLISH_ANSWERS_ANSWER_LINES_PRIVATE_H
#define SENSOR_PUBLISH_ANSWERS_ANSWER_LINES_PRIVATE_H

#include "sensor/publish/answers/answer.h"

typedef struct AnswerLines AnswerLines;

/* When an answer came. */
typedef struct AnswerArrival {
    double latency_ms; /* since the end of the frame's rendering; NaN: not known */
    double age_ms;     /* since the frame's instant of the exercise; NaN: the run keeps no pace with the clock */
    bool   late;
} AnswerArrival;

/* Creates the file in this folder. STATUS_IO, logged. */
Status answer_lines_open(AnswerLines **out, const char *folder);
/* Writes the lines of an answer, complete, and flushes them. What cannot be written is counted, and reported once. */
void answer_lines_write(AnswerLines *lines, const Answer *answer, const AnswerArrival *arrival,
                        AnswerCounters *counters);
void answer_lines_close(AnswerLines *lines); /* NULL is valid */

#endif
