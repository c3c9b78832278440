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
 * scores are ordered by the answers' own values (score_answer_order), so the order of a file changes nothing.
 *
 * AP is that of COCO (pycocotools, to 1e-9): by class, boxes of coco.json where there is one, else box_px with the same
 * limits, IoU 0.50 to 0.95, 101 recalls, ignore regions as crowds, 100 answers a class and image. `ap_centre` is the
 * average precision, by the same 101 recalls, of the rule above among answers of the target's class. */
#ifndef SENSOR_SCORE_SCORE_H
#define SENSOR_SCORE_SCORE_H

#include "render/scene/view.h"
#include "sensor/score/tracks.h"
#include "sensor/score/worst.h"

enum {
    score_recognisers_max = 4,
    score_classes_max = 40, /* target_class_count() is less */
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

ScoreRules score_default_rules(void);

typedef struct ScoreRequest {
    const char *out;                            /* folder of a run, of several hosts, or of a sweep */
    int         recognisers;                    /* 0: OUT/answers.jsonl, of each sequence its own */
    const char *answers[score_recognisers_max]; /* a file (answers.jsonl or COCO results), or a folder with
                                                 * SEQUENCE/answers.jsonl; "": the default */
    unsigned   bands;                           /* 1 << Band; 0: those that were answered */
    ScoreRules rules;
} ScoreRequest;

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
    ScoreConfusion confusion; /* by target_class number - 1 */
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

/* Scores a folder of products. Truth is read line by line, answers are held (some 100 octets each). Failures are
 * logged, with file, line and the next step, and leave *out zeroed: STATUS_IO; STATUS_BAD_VALUE: what is no answer or
 * no truth, and a folder without answers; STATUS_NO_MEMORY. */
Status score_run(ScoreReport *out, const ScoreRequest *request);
void   score_report_free(ScoreReport *report);

/* score.json (`pitviper help score`), and the same in short as text: full: with the table against every quantity. */
Status score_write_json(const ScoreReport *report, const char *path);
void   score_print(FILE *to, const ScoreReport *report, bool full);

#endif
