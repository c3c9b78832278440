/* sensor/commands/fly_loop_private.h: `pitviper fly` with frames: a held round flown by what is seen in them. */
#ifndef SENSOR_COMMANDS_FLY_LOOP_PRIVATE_H
#define SENSOR_COMMANDS_FLY_LOOP_PRIVATE_H

#include "entities/exercise/exercise.h"
#include "sensor/node/flight/flight_loop.h"

enum { fly_loop_given_most = 128 };

typedef struct FlyLoop {
    const char *recogniser, *frames, *sights; /* NULL: not given */
    double      limit_s, start_s;             /* wall clock: longest waits for an answer, and for the first */
    bool        radar;                        /* sight of the seeker's radar */
    bool        overwrite, several;           /* several seeds: each has a folder of its own in `frames` */
    int         given_count;
    char      **given; /* options of `replay` */
} FlyLoop;

/* What the loop's table has beside a flight's. */
typedef struct FlyLoopCounts {
    int      frames, verdicts[loop_verdict_count];
    uint64_t late;
} FlyLoopCounts;

/* Whether frames are asked for at all. */
static inline bool fly_loop_asked(const FlyLoop *o) { return o->recogniser || o->frames || o->sights || o->radar; }

/* Flies the rounds of a held cast, one after the other, and gives the cast its flights. counts: [flight_count of the
 * cast]. write: a recording of the cast's exercise. scenario: the cast's, which gets the duration and the threshold of
 * the recording. Failures are logged. */
typedef Status FlyLoopWrite(const Cast *cast, const char *path, const char *comment);
Status fly_loop_seed(FlyLoopCounts *counts, Cast *cast, Scenario *scenario, const FlyLoop *o, FlyLoopWrite *write);

#endif
