/* entities/flight/miss.h: how close a missile came to a point, between grid points too, and where it met a plane.
 *
 * Over a step both move on the cubic that has their positions and velocities at its ends (Hermite); for motion with
 * constant acceleration that is exact. Errors, at ECEF size, where a double steps by 1 nm: 10 nm of distance, and in
 * time 10 um of the way (tests/entities/test_miss.c). */
#ifndef ENTITIES_FLIGHT_MISS_H
#define ENTITIES_FLIGHT_MISS_H

#include "pitviper.h"

/* A point's motion over one step. */
typedef struct MissLeg {
    double p0_ecef[3], v0_ecef_mps[3], p1_ecef[3], v1_ecef_mps[3];
} MissLeg;

typedef struct Miss {
    double least_m, t_s;      /* closest approach so far, and its exercise time */
    double away_ecef[3];      /* from the target to the missile there */
    bool   fuzed;             /* it came within the fuze's radius */
    double fuze_t_s;          /* the first time that it did */
    double fuze_away_ecef[3]; /* from the target to the missile then */
} Miss;

static inline Miss miss_begin(void) { return (Miss){.least_m = INFINITY}; }

/* One step, from t_s on, step_s long. fuze_m: 0: there is no fuze. */
void miss_step(Miss *miss, double t_s, double step_s, const MissLeg *missile, const MissLeg *target, double fuze_m);

/* When in 0 .. step_s a point first comes to the far side of a plane, that is below it along the unit normal; false:
 * not in this step. A point that begins there is there at 0. */
bool plane_crossing(double *after_s, double p_ecef[3], double step_s, const MissLeg *leg, const double on_ecef[3],
                    const double normal_ecef[3]);

#endif
