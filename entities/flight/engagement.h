/* entities/flight/engagement.h: one missile against one target that keeps its acceleration, seen as it is.
 *
 * The whole loop without a renderer: what `pitviper probe flight` evaluates. O(flight time / step); no allocation. */
#ifndef ENTITIES_FLIGHT_ENGAGEMENT_H
#define ENTITIES_FLIGHT_ENGAGEMENT_H

#include "entities/flight/flight.h"
#include "entities/flight/miss.h"

enum {
    engagement_waiting_most = 256
}; /* measurements on their way: sight_late_s over the time between them, below it */

typedef struct Engagement {
    double p_ecef[3], v_ecef_mps[3];                                    /* launch, at exercise time 0 */
    bool   target;                                                      /* without one it flies unguided */
    double target_ecef[3], target_v_ecef_mps[3], target_a_ecef_mps2[3]; /* at 0 */
    double sight_every_s;                                               /* between measurements; 0: at each step */
    double sight_late_s;                                                /* age at which a measurement arrives */
    bool   ranged;                                                      /* a measurement has range and closing speed */
    bool   ground;                                                      /* a plane ends the flight */
    double on_ecef[3], normal_ecef[3];                                  /* a point of it, unit normal upwards */
    double until_s;                                                     /* ends then; infinite: by life_s */
} Engagement;

typedef enum FlightEnd {
    FLIGHT_END_UNTIL,  /* until_s has come */
    FLIGHT_END_LIFE,   /* life_s has passed */
    FLIGHT_END_FUZE,   /* it came within the fuze's radius, and its closest approach is over */
    FLIGHT_END_PASSED, /* the range has grown by 50 m from its least */
    FLIGHT_END_GROUND,
    FLIGHT_END_LOST, /* left what is computed: flight_step */
    flight_end_count,
} FlightEnd;
const char *flight_end_name(FlightEnd end);

typedef struct EngagementResult {
    FlightEnd     end;
    FlightState   state;     /* at the last grid point */
    FlightVerdict verdict;   /* of the last command */
    double        t_s;       /* of the end: of a plane between grid points, else of the last one */
    double        p_ecef[3]; /* there */
    Miss          miss;
    double        most_lateral_mps2, most_attack_rad, most_gimbal_rad; /* at grid points */
    int64_t       guided, coasted;                                     /* steps */
    int64_t       at_limit;                                            /* steps at which all that is possible acts */
} EngagementResult;

void engagement_fly(EngagementResult *out, const Engagement *engagement, const Missile *missile,
                    const FlightWorld *world);

#endif
