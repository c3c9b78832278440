/* sensor/publish/answers/answers.h: the answers that a recogniser on this machine sends back: datagrams on loopback, in
 * any form (answer.h), received by a thread of their own.
 *
 * The first datagram for a band of a recent frame is that frame's answer and goes into answers.jsonl; of each band the
 * newest frame's is kept for metadata. The rest is counted by form and reason, so memory and file are bounded - an
 * answer for each frame and band - and a flood costs the renderer nothing. */
#ifndef SENSOR_PUBLISH_ANSWERS_ANSWERS_H
#define SENSOR_PUBLISH_ANSWERS_ANSWERS_H

#include "sensor/publish/answers/answer.h"
#include "sensor/publish/consumers/consumer.h"

enum { answer_frames_kept = 256 };
/* A time stamp names the frame whose exercise time it is, this near: it may have come by a clock of 90 kHz. */
static const int64_t answer_time_us = 100;

typedef struct Answers Answers;

typedef struct AnswersOf {
    int         port;
    AnswerScope scope;
} AnswersOf;

/* A frame that may be answered. */
typedef struct AnswerFrame {
    int          number;
    double       time_s, unix_s;        /* exercise time */
    double       rendered_s, instant_s; /* wall_clock_s: of the end of rendering, of time_s; 0: not known */
    AnswerCamera camera;
} AnswerFrame;

/* STATUS_IO, logged: the port is in use. */
Status answers_open(Answers **out, const AnswersOf *of);
/* From now on answers are written to answers.jsonl of a folder. Call it once. STATUS_IO, logged: the file cannot be
 * written. */
Status answers_record(Answers *answers, const char *folder);
/* Logs the counts and frees all. NULL is valid. counters: receives them, 0 without answers; may be NULL. */
void answers_close(Answers *answers, AnswerCounters *counters);
/* A frame that may be answered from now on. */
void answers_frame(Answers *answers, const AnswerFrame *frame);
/* Copies the newest answer to a band, complete; false: there is none yet. Any thread may call it. */
bool answers_latest(Answers *answers, Band band, Answer *out);
/* From now on each answer that is taken, complete, is told as it arrives, in the thread that receives. Call it once,
 * before the first frame. */
typedef void AnswersTaken(void *user, const Answer *answer);
void         answers_watch(Answers *answers, AnswersTaken *taken, void *user);
/* So far. */
void answers_counters(Answers *answers, AnswerCounters *out);

/* Tells them of every frame, and has them recorded; answers and folder stay the caller's and outlive it. */
Status consume_answers(Consumer **out, Answers *answers, const char *folder);

#endif
