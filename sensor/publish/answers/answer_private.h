/* sensor/publish/answers/answer_private.h: what the readers of the forms share. */
#ifndef SENSOR_PUBLISH_ANSWERS_ANSWER_PRIVATE_H
#define SENSOR_PUBLISH_ANSWERS_ANSWER_PRIVATE_H

#include "sensor/publish/answers/answer.h"

/* out: zeroed but for its form. */
AnswerReason answer_read_ring(Answer *out, const uint8_t *bytes, size_t size, const AnswerScope *scope);
AnswerReason answer_read_json(Answer *out, const uint8_t *bytes, size_t size, const AnswerScope *scope);
AnswerReason answer_read_klv(Answer *out, const uint8_t *bytes, size_t size, const AnswerScope *scope);

/* A detection of which nothing is known yet. */
AnswerDetection answer_detection_empty(void);
/* Checks a detection as it was read, and turns its azimuth to 0 .. 2 pi. */
AnswerReason answer_detection_check(AnswerDetection *d, const AnswerScope *scope);
/* Copies a class; false: it is too long, or not printable ASCII. */
bool answer_class_set(AnswerDetection *d, const char *text, size_t length);

#endif
