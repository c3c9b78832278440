/* sensor/score/precision.h: average precision as COCO defines it, over any number of images.
 *
 * The rules are those of pycocotools' COCOeval with useCats, area range `all` and maxDets 100: an answer is matched, in
 * order of falling score, with the target of its class of the greatest IoU that is left, for each of ten least IoUs,
 * 0.50 to 0.95; one matched with an ignore region, whose IoU is the share of the answer's own area, does not count, and
 * such a region matches many. Precision is made to fall with recall, and read at recalls 0, 0.01, ... 1
 * (github.com/cocodataset/cocoapi, PythonAPI/pycocotools/cocoeval.py; Lin et al., Microsoft COCO, 2014). */
#ifndef SENSOR_SCORE_PRECISION_H
#define SENSOR_SCORE_PRECISION_H

#include "sensor/score/match.h"

enum { precision_ious = 10, precision_recalls = 101, precision_answers_most = 100 };

/* What an answer is by a rule that is not COCO's. */
typedef enum PrecisionMark { MARK_WRONG, MARK_RIGHT, MARK_IGNORED } PrecisionMark;

typedef struct PrecisionEntry {
    double   score;
    uint32_t order;            /* of coming */
    uint16_t matched, ignored; /* bit i: at the i-th IoU */
    uint8_t  class_number, band;
    uint8_t  centre, any; /* PrecisionMark: by the rule of score.h within the class; whatever the class */
} PrecisionEntry;

typedef struct PrecisionTarget {
    double  box[4]; /* left, top, width, height */
    uint8_t class_number;
    bool    ignored; /* a crowd */
} PrecisionTarget;

typedef struct Precision {
    size_t          count, room;
    PrecisionEntry *entry;
    long long       targets[score_classes_max + 1][BAND_COUNT]; /* to be found, of COCO's list */
    long long       chances[score_classes_max + 1][BAND_COUNT]; /* to be found, of truth */
    long long       answers[score_classes_max + 1][BAND_COUNT];
    /* of the image that is being added */
    int                     image_room;
    const PrecisionTarget **image_target;
    bool                   *image_taken;
} Precision;

/* Adds a frame and band. Images must come in the order that ties are to be broken by. centre, any: [m->answers].
 * STATUS_NO_MEMORY. */
Status precision_add(Precision *p, Band band, const PrecisionTarget *target, int targets, const MatchFrame *m,
                     const uint8_t *centre, const uint8_t *any);
/* After the last: sorts by falling score. */
void precision_sort(Precision *p);
/* Of a class, in a band or (BAND_COUNT) in all. STATUS_NO_MEMORY. */
Status precision_of(ScorePrecision *out, const Precision *p, int class_number, int band);
/* Precision and recall whatever the class; frames: that were scored. Returns the number of points. */
int  precision_curve(ScorePoint out[score_curve_max], const Precision *p, long long chances, long long frames);
void precision_free(Precision *p);

#endif
