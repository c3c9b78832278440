/* entities/exercise/exercise.h: a DIS simulator that publishes the entities of a scenario: Entity State is sent when
 * dead reckoning of the last report deviates from the truth by a threshold, at each heartbeat, and when the appearance
 * changes; shots with Fire and Detonation.
 *
 * Guaranteed after the first report: at every tick a receiver's dead reckoning is within the thresholds of the
 * truth, as far as the network delivers (tests/entities/test_exercise.c). An entity is checked no more often than that
 * requires: the next check follows from the error, its rate and bounds on their growth. 10 000 vehicles cost some 5 %
 * of a core at 60 ticks a second.
 *
 * Uses no clock and no socket: each step generates the datagrams of one tick and passes them to a sink. */
#ifndef ENTITIES_EXERCISE_EXERCISE_H
#define ENTITIES_EXERCISE_EXERCISE_H

#include "entities/exercise/cast_private.h"

/* One datagram at exercise time t_s; times do not decrease. False: stop. */
typedef bool ExerciseSink(void *user, double t_s, const uint8_t *bytes, size_t octets);

typedef struct ExerciseCounts {
    uint64_t pdus, datagrams, octets; /* as sent; PDUs: as generated */
    uint64_t lost, duplicated, overtaken, malformed;
} ExerciseCounts;

typedef struct Exercise Exercise;

/* cast must outlive the exercise. epoch_unix_s: Unix time of exercise time 0, for absolute stamps. */
Status exercise_create(Exercise **out, const Cast *cast, double epoch_unix_s, ExerciseSink *sink, void *user);
void   exercise_destroy(Exercise *exercise);
/* Exercise time of the next step, s: whole ticks from 0. */
double exercise_time(const Exercise *exercise);
/* One tick. False when it is over: the duration has passed, or the sink returned false. */
bool exercise_step(Exercise *exercise);
/* Sends the datagrams still delayed; exercise_step calls it at the end. */
void                  exercise_finish(Exercise *exercise);
const ExerciseCounts *exercise_counts(const Exercise *exercise);
int                   exercise_most_received(const Exercise *exercise); /* entities that were sent */

#endif
