/* sensor/score/judge.h: one recogniser while truth is read: what its answers were in each frame, summed up. */
#ifndef SENSOR_SCORE_JUDGE_H
#define SENSOR_SCORE_JUDGE_H

#include "sensor/score/answers.h"
#include "sensor/score/precision.h"
#include "sensor/score/rates.h"
#include "sensor/score/tracks.h"
#include "sensor/score/worst.h"

typedef struct ErrorSums {
    long long count, ranges;
    double    px[2], px2, deg2, range, range2;
} ErrorSums;

typedef struct Judge {
    ScoreRules     rules;
    const Answers *answers;
    unsigned       bands;    /* scored */
    const char    *sequence; /* name of the one that is being read */
    long long      detections, aged, ignored;

    RateSums       total, band[BAND_COUNT], against[AGAINST_COUNT][score_bins_max];
    ScoreConfusion confusion;
    long long      on_clutter[CLUTTER_CLASSES];
    ErrorSums      errors;
    Precision      precision;
    Tracks        *tracks[BAND_COUNT]; /* of the sequence; NULL: none yet */
    TracksScore    track_score;
    WorstCases     missed, false_alarms;
    long long      late;
    size_t         ages, ages_room;
    float         *age_ms; /* one an answered frame and band */

    /* of the frame and band that is being judged; kept */
    MatchFrame       match;
    int              room, answer_room;
    PrecisionTarget *target;
    uint8_t         *centre, *any; /* [answers] */
    Answer          *young;        /* those that are not too old */
} Judge;

/* Frames in the order of truth. coco: of the sequence; NULL: it has none. STATUS_NO_MEMORY; STATUS_BAD_VALUE, logged:
 * truth that is at odds with itself. */
Status judge_frame(Judge *judge, const TruthFrame *frame, int sequence, const CocoTruth *coco);
Status judge_end_sequence(Judge *judge);
/* After the last. name and file are left. STATUS_NO_MEMORY. */
Status judge_report(ScoreRecogniser *out, Judge *judge);
void   judge_free(Judge *judge);

/* The bin of a value; -1: NaN. */
int judge_bin(ScoreAgainst which, double value);
/* Its ends. */
void judge_bin_ends(double *from, double *to, ScoreAgainst which, int bin);

#endif
