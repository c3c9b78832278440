/* sensor/score/report.h: what scoring answers says: the rules, and what came out. sensor/score/score.h says what the
 * words mean. */
#ifndef SENSOR_SCORE_REPORT_H
#define SENSOR_SCORE_REPORT_H

#include "entities/scenery/scenery.h"
#include "sensor/score/tracks.h"
#include "sensor/score/worst.h"

enum {
    score_recognisers_max = 4,
    score_classes_max = 96, /* target_class_count() is not more */
    score_bins_max = 12,
    score_curve_max = 101,
    score_words_max = 8,
    score_word_size = 32,
};

/* ---- what is asked ------------------------------------------------------------------------------- */

typedef struct ScoreRules {
    double least_score;          /* of answers that count for rates and confusion; AP and the curve have all (0) */
    double grow, iou, small_px;  /* above (0.25, 0.3, 100) */
    double max_age_ms;           /* older answers are dropped, as if they had not come (infinity) */
    bool   answered;             /* only frames that were answered in the band; else those without are misses */
    int    min_pixels;           /* ignore regions, as publish.coco_min_* (sensor/publish/coco/coco.h): (5, 0, 0.1). */
    double min_visible, min_snr; /* Where OUT has a coco.json, its annotations decide instead */
} ScoreRules;

/* ---- what comes out ------------------------------------------------------------------------------ */

/* NaN: not known; the bounds are of 95 %. */
typedef struct ScoreShare {
    double value, low, high;
} ScoreShare;

/* Rates over some chances and some frames: all, those of a band, or those of a bin. A frame belongs to the bin of the
 * chance in it that has the most pixels, in each band by itself; without a chance to none. */
typedef struct ScoreRates {
    double     from, to;                              /* the bin, [from, to); NaN: no bin */
    long long  chances, found, recognised;            /* recognised: found by an answer of its class */
    long long  frames, frames_answered, false_alarms; /* frames: times bands */
    double     deg2, km2;                    /* of these frames: fields of view; visible ground (0: not known) */
    int        sequences;                    /* with a chance */
    double     samples;                      /* effective number of sequences, by their shares of the chances */
    ScoreShare detection, recognition;       /* found and recognised as shares of the chances */
    ScoreShare per_frame, per_deg2, per_km2; /* false alarms; NaN where there is no ground_km2 */
} ScoreRates;

/* What rates are stated against, each with its bins in rising order; empty ones are left out. */
typedef enum ScoreAgainst {
    AGAINST_RANGE,   /* m, to the target */
    AGAINST_PIXELS,  /* visible area of the target */
    AGAINST_ASPECT,  /* deg: sectors of 45, centred on nose, right ...: -22.5 .. 337.5 */
    AGAINST_VISIBLE, /* visible fraction */
    AGAINST_FOLIAGE, /* foliage fraction */
    AGAINST_SNR,     /* of the band, without its sign */
    AGAINST_HOUR,    /* local solar time, h, from the sun's direction and the sensor's latitude */
    AGAINST_COUNT
} ScoreAgainst;
extern const char *const score_against_name[AGAINST_COUNT]; /* range_m, pixels, aspect_deg, ... */

typedef struct ScoreBins {
    int        count;
    ScoreRates bin[score_bins_max];
} ScoreBins;

/* NaN: of no target to be found. */
typedef struct ScorePrecision {
    long long targets, answers; /* to be found; of the class, at any score */
    double    ap, ap50, ap75;   /* COCO; NaN too where an answer is a line of sight */
    double    ap_centre;
} ScorePrecision;

typedef struct ScoreClass {
    const char    *name; /* truth's class */
    ScorePrecision all, band[BAND_COUNT];
} ScoreClass;

/* Counts of pairs. Rows and columns 0 .. classes - 1 are truth's classes; column classes: `unknown`, a word that is no
 * class; column classes + 1: `missed`; row classes: `false`, an answer where nothing is. */
typedef struct ScoreConfusion {
    long long count[score_classes_max + 1][score_classes_max + 2];
} ScoreConfusion;

/* Of found chances: the answer's centre less the centre of the target's amodal box; the answer's range less truth's. */
typedef struct ScoreErrors {
    long long count, ranges;
    double    mean_px[2], rms_px, rms_deg; /* column, row; the length of the difference */
    double    range_mean_m, range_rms_m;   /* NaN: no answer has a range */
} ScoreErrors;

/* Of answers with latency_ms. */
typedef struct ScoreAges {
    long long count, late; /* late: a newer frame had been answered before it */
    double    median_ms, p95_ms, max_ms;
} ScoreAges;

/* Answers down to this score: the rule above, whatever the class. Scores fall. */
typedef struct ScorePoint {
    double score, recall, precision, false_per_frame;
} ScorePoint;

typedef struct ScoreWord {
    char      word[score_word_size];
    long long count;
} ScoreWord;

typedef struct ScoreRecogniser {
    char      name[64];       /* the file's name without folder and ending; numbered where two are equal */
    char      file[4096];     /* as given */
    long long answers;        /* detections read, in the frames of truth */
    long long elsewhere;      /* of frames or bands that truth does not have: in no rate */
    long long aged, ignored;  /* older than max_age_ms; neither right nor wrong */
    unsigned  bands;          /* scored */
    bool      lines_of_sight; /* some answers have no box */
    int       words;          /* those that are no class of truth, the most frequent; all are `unknown` */
    ScoreWord word[score_words_max];

    ScoreRates     total, band[BAND_COUNT];
    ScoreBins      against[AGAINST_COUNT];
    double         map, map50, ap_centre; /* means over classes with a target */
    int            classes;               /* with a target or an answer */
    ScoreClass     of_class[score_classes_max];
    ScoreConfusion confusion;                   /* by target_class number - 1 */
    long long      on_clutter[CLUTTER_CLASSES]; /* false alarms that lie on clutter, by its SceneryClass */
    ScoreErrors    errors;
    ScoreAges      ages;
    int            points;
    ScorePoint     curve[score_curve_max];
    TracksScore    tracks; /* sequences 0: no answer has a track */
    WorstCases     missed, false_alarms;
} ScoreRecogniser;

typedef struct ScoreReport {
    ScoreRules       rules;
    char             out[4096];
    bool             sweep;
    int              sequences, class_count; /* class_count: target_class_count() */
    long long        frames;                 /* lines of truth, over all sequences */
    int              recognisers;
    ScoreRecogniser *recogniser; /* [recognisers], owned */
} ScoreReport;

#endif
