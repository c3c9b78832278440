/* sensor/score/worst.h: the worst misses and false alarms of a recogniser: the few that one looks at first. */
#ifndef SENSOR_SCORE_WORST_H
#define SENSOR_SCORE_WORST_H

#include "render/scene/view.h"

enum { worst_most = 12, worst_sequence_size = 256, worst_name_size = 64 };

typedef struct WorstCase {
    char     sequence[worst_sequence_size]; /* folder in OUT; "": OUT itself */
    int      frame;
    Band     band;
    double   t_s;                   /* exercise time; NaN: not known */
    double   box_px[4];             /* left, top, width, height; NaN: none, as of a line of sight */
    char     name[worst_name_size]; /* class of the target, or word of the answer; from outside */
    char     id[24];                /* of the target; "": a false alarm */
    uint32_t track;                 /* of the answer; 0: none */
    double   weight;                /* what is worse has more: visible pixels of a miss, score of a false alarm */
    double   range_m, visible_fraction, snr; /* of a miss; NaN: not known */
} WorstCase;

/* From the worst on. Zeroed: none yet. */
typedef struct WorstCases {
    int       count;
    WorstCase one[worst_most];
} WorstCases;

/* Takes a case if it is among the worst. Of cases that look alike - one target or track, or answers of one class
 * without a track, of one band within 25 frames - only the worst is there. The order of the calls changes nothing. */
void worst_add(WorstCases *cases, const WorstCase *one);

#endif
