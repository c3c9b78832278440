/* sensor/score/score.h: a recogniser's answers against the truth of a run: rates, precision and recall, confusion,
 * errors, ages. `pitviper score`, the end of `run` and `replay`, and regress call score_run.
 *
 * A *sequence* is the products of one host in one run: a folder with truth.jsonl. A folder of several hosts or of a
 * sweep has many. Frames of a sequence are of one orbit and look alike, so intervals take a sequence as one sample
 * (sensor/score/interval.h).
 *
 * A *chance* is a target to be found in one frame and band: it is visible, and no ignore region (ScoreRules). An answer
 * *finds* it when it may name it: of a target of less than small_px visible pixels, when the answer's centre is within
 * the target's amodal box grown by the share `grow` about its centre (by half a pixel on each side at least); of a
 * larger one when the boxes overlap by IoU `iou`, that with box_px or that with the amodal box cropped by the image,
 * whichever is greater. An answer that is a line of sight has no box: its point decides, at any size. Answers of a
 * frame and band choose in order of falling score, each the nearest centre among the chances that are left and that it
 * may name, whatever its class. One that finds none, but may name an ignore region or a hidden target, or lies in an
 * ignore region by the share `iou` of its own area, is neither right nor wrong; all others are false alarms. Equal
 * scores are ordered by the answers' own values (answers_order), so the order of a file changes nothing.
 *
 * AP is that of COCO (pycocotools, to 1e-9): by class, boxes of coco.json where there is one, else box_px with the same
 * limits, IoU 0.50 to 0.95, 101 recalls, ignore regions as crowds, 100 answers a class and image. `ap_centre` is the
 * average precision, by the same 101 recalls, of the rule above among answers of the target's class. */
#ifndef SENSOR_SCORE_SCORE_H
#define SENSOR_SCORE_SCORE_H

#include "sensor/score/report.h"

#include <stdio.h>

ScoreRules score_default_rules(void);

typedef struct ScoreRequest {
    const char *out;                            /* folder of a run, of several hosts, or of a sweep */
    int         recognisers;                    /* 0: OUT/answers.jsonl, of each sequence its own */
    const char *answers[score_recognisers_max]; /* a file (answers.jsonl or COCO results), or a folder with
                                                 * SEQUENCE/answers.jsonl; "": the default */
    unsigned   bands;                           /* 1 << Band; 0: those that were answered */
    ScoreRules rules;
} ScoreRequest;

/* Scores a folder of products. Truth is read line by line, answers are held (some 100 octets each). Failures are
 * logged, with file, line and the next step, and leave *out zeroed: STATUS_IO; STATUS_BAD_VALUE: what is no answer or
 * no truth, and a folder without answers; STATUS_NO_MEMORY. */
Status score_run(ScoreReport *out, const ScoreRequest *request);
void   score_report_free(ScoreReport *report);

/* score.json (`pitviper help score.json`), and the same in short as text: full: with the table against every quantity.
 */
Status score_write_json(const ScoreReport *report, const char *path);
void   score_print(FILE *to, const ScoreReport *report, bool full);

#endif
