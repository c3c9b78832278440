/* tests/fuzz/fuzz_answer.h: what holds of an answer of any form that was read, and after a camera completed it. */
#ifndef TESTS_FUZZ_FUZZ_ANSWER_H
#define TESTS_FUZZ_FUZZ_ANSWER_H

#include "tests/fuzz/fuzz_seed.h"

#include "sensor/publish/answers/answers.h"

#include <math.h>
#include <stdlib.h>

static const AnswerScope fuzz_scope = {1 << BAND_LWIR | 1 << BAND_OPTICAL, 64, 48};

static inline void fuzz_must(bool holds)
{
    if (!holds) abort();
}

static inline void fuzz_detection(const AnswerDetection *d)
{
    const double *b = d->box_px;
    const bool    boxed = !isnan(b[0]), sighted = !isnan(d->los_rad[0]);
    fuzz_must(!boxed || (b[0] >= 0 && b[0] < b[2] && b[2] <= fuzz_scope.width && b[1] >= 0 && b[1] < b[3] &&
                         b[3] <= fuzz_scope.height));
    fuzz_must(boxed || sighted || d->located || !isnan(d->point_px[0]));
    fuzz_must(!sighted || (d->los_rad[0] >= 0 && d->los_rad[0] < 6.2832 && fabs(d->los_rad[1]) <= 1.5708));
    fuzz_must(isnan(d->range_m) || d->range_m > 0);
    fuzz_must(isnan(d->score) || (d->score >= 0 && d->score <= 1));
    fuzz_must(strnlen(d->class_name, sizeof d->class_name) < sizeof d->class_name);
    for (const char *c = d->class_name; *c; c++) fuzz_must(*c >= 0x20 && *c <= 0x7e);
}

/* Reads octets, which the seeds of a form lead to. */
static inline void fuzz_answer(const uint8_t *data, size_t size)
{
    static Answer             a;
    static const AnswerCamera camera = {.p_ecef = {6379137, 0, 0},
                                        .r_ecef_from_cam = {0, -1, 0, 1, 0, 0, 0, 0, 1},
                                        .r_ecef_from_enu = {0, 0, 1, 1, 0, 0, 0, 1, 0},
                                        .view = {.width = 64, .height = 48, .focal_px = 100}};
    const AnswerReason        reason = answer_read(&a, data, size, &fuzz_scope);
    fuzz_must(reason >= ANSWER_GOOD && reason <= ANSWER_FRAME && answer_reason_name[reason]);
    fuzz_must(a.form >= ANSWER_RING && a.form < ANSWER_FORMS && answer_form_name[a.form]);
    if (reason != ANSWER_GOOD) return;
    fuzz_must(a.count >= 0 && a.count <= answer_detections_most && fuzz_scope.bands >> a.band & 1);
    fuzz_must(a.numbered || a.timed);
    for (int i = 0; i < a.count; i++) fuzz_detection(&a.detection[i]);
    answer_complete(&a, &camera);
    for (int i = 0; i < a.count; i++) fuzz_detection(&a.detection[i]);
}

#endif
