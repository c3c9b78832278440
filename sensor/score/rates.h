/* sensor/score/rates.h: sums of chances, frames and false alarms over sequences, and the rates that they make. */
#ifndef SENSOR_SCORE_RATES_H
#define SENSOR_SCORE_RATES_H

#include "sensor/score/report.h"

typedef struct RateCounts {
    long long chances, found, recognised, frames, answered, false_alarms;
    long long frames_km2, false_km2; /* of frames whose km2 is known */
    double    deg2, km2;
} RateCounts;

/* Zeroed: nothing yet. */
typedef struct RateSums {
    RateCounts now, all;                            /* of the sequence that is being read; of all that ended */
    double     chances2, frames2, false2_per_frame; /* sums of squares over sequences; of false alarms^2 / frames */
    int        sequences;                           /* with a chance */
} RateSums;

void       rates_end_sequence(RateSums *sums);
ScoreRates rates_of(const RateSums *sums, double from, double to);

#endif
