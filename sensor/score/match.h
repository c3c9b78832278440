/* sensor/score/match.h: which answer of a frame and band names which target (the rule is in score.h). */
#ifndef SENSOR_SCORE_MATCH_H
#define SENSOR_SCORE_MATCH_H

#include "sensor/score/answers.h"
#include "sensor/score/truth_line.h"

typedef enum TargetVerdict { TARGET_TO_FIND, TARGET_IGNORED, TARGET_HIDDEN } TargetVerdict;

typedef struct MatchTarget {
    const TruthTarget *truth;
    TargetVerdict      verdict;
    double             box[4];    /* left, top, width, height: of coco.json where there is one; hidden: none, 0 */
    double             within[4]; /* the amodal box cropped by the image; none: width 0 */
    double             centre[2]; /* of the amodal box */
} MatchTarget;

typedef struct MatchAnswer {
    const Answer *answer;
    bool          on_image;  /* of a line of sight: in front of the camera */
    double        centre[2]; /* px */
} MatchAnswer;

/* What answers name: a target's place in the list, or one of these. */
enum { NAMES_NOTHING = -1, NAMES_BESIDE = -2 /* an ignore region, a hidden target */, NAMES_UNASKED = -3 };

/* A frame and band. Lists are kept from one to the next. */
typedef struct MatchFrame {
    int          targets, target_room, answers, answer_room;
    MatchTarget *target;   /* [targets] */
    MatchAnswer *answer;   /* [answers], those that found something, by falling score */
    int         *names;    /* [answers] */
    int         *found_by; /* [targets]: an answer; -1: none */
} MatchFrame;

/* Makes the targets. coco: those of the frame and band; NULL: the rules' limits decide. STATUS_NO_MEMORY. */
Status match_targets(MatchFrame *m, const TruthFrame *frame, Band band, const ScoreRules *rules, const CocoTarget *coco,
                     size_t coco_count, bool has_coco);
/* Makes the answers. STATUS_NO_MEMORY. */
Status match_answers(MatchFrame *m, const TruthFrame *frame, const Answer *answer, size_t count);
/* Fills names and found_by. class_number: only targets and answers of this class; 0: all. */
void match_run(MatchFrame *m, const ScoreRules *rules, int class_number);
void match_free(MatchFrame *m);

/* Whether the answer may name the target, and how near it is: squared distance of centres, px2. */
bool match_may_name(double *distance2, const MatchTarget *target, const MatchAnswer *answer, const ScoreRules *rules);

/* Intersection of two boxes (left, top, width, height) over their union; over the first one's own area. As
 * pycocotools' maskApi has it, to the bit. */
double match_iou(const double a[4], const double b[4]);
double match_share(const double a[4], const double b[4]);

#endif
