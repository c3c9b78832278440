/* entities/flight/sight_filter.h: the rate of a line of sight from directions alone, as a camera and a recogniser give
 * it.
 *
 * A fading-memory filter of two states, direction and rate: each measurement weighs `memory` times as much as the next.
 * Until it has seen enough it is the least-squares line through all. Of white noise of standard deviation s in each of
 * two axes, at intervals T, what is left in the steady state (Zarchan, Tactical and Strategic Missile Guidance, fading-
 * memory filters; Morrison 1969), with m for memory (tests/entities/test_sight_filter.c):
 *
 *   direction  s sqrt((1 - m) (1 + 4 m + 5 m^2) / (1 + m)^3)       rate  s / T sqrt(2 (1 - m)^3 / (1 + m)^3) */
#ifndef ENTITIES_FLIGHT_SIGHT_FILTER_H
#define ENTITIES_FLIGHT_SIGHT_FILTER_H

#include "entities/flight/flight.h"

typedef struct SightFilter {
    double  memory; /* 0 .. below 1 */
    int64_t count;  /* measurements taken */
    double  t_s, los_ecef[3], rate_ecef_rps[3];
} SightFilter;

static inline SightFilter sight_filter(double memory) { return (SightFilter){.memory = memory}; }

/* Takes a measured direction, a unit vector. False, and nothing changed: no unit vector, not a microsecond later than
 * the one before, or on the other side. */
bool sight_filter_take(SightFilter *filter, double t_s, const double los_ecef[3]);
/* A line of sight for flight_command, of that eye at the filter's time; no range. Before the second measurement the
 * rate is not known. */
void sight_filter_sight(FlightSight *out, const SightFilter *filter, const double eye_ecef[3],
                        const double eye_v_ecef_mps[3]);

#endif
