/* entities/flight/engagement.h: one missile against one target, seen as it is: the whole loop without a renderer.
 *
 * `pitviper probe flight` has a target that keeps its acceleration; an exercise gives what moves through a scene.
 * O(flight time / step); no allocation. */
#ifndef ENTITIES_FLIGHT_ENGAGEMENT_H
#define ENTITIES_FLIGHT_ENGAGEMENT_H

#include "entities/flight/flight.h"
#include "entities/flight/miss.h"

/* Measurements on their way: sight_late_s over the time between them is below it. */
enum { engagement_waiting_most = 256 };

/* Where everything is; each function may be NULL. Pure: the same time gives the same answer. */
typedef struct EngagementScene {
    void *user;
    /* NULL: by the engagement's target_*, which are of its launch */
    void (*target_at)(double p_ecef[3], double v_ecef_mps[3], double a_ecef_mps2[3], void *user, double t_s);
    /* whose sight commands; NULL: it stands at the launch */
    void (*launcher_at)(double p_ecef[3], double v_ecef_mps[3], void *user, double t_s);
    /* a plane for the ground about a point; NULL: the engagement's, if any */
    void (*ground_at)(double on_ecef[3], double normal_ecef[3], void *user, const double p_ecef[3]);
    void (*seen)(void *user, const FlightState *state); /* each grid point, the launch too */
} EngagementScene;

typedef struct Engagement {
    int64_t                tick;                     /* of the launch */
    const EngagementScene *scene;                    /* NULL: nothing beside what is below */
    double                 p_ecef[3], v_ecef_mps[3]; /* launch */
    bool                   target;                   /* without one it flies unguided */

    double target_ecef[3], target_v_ecef_mps[3], target_a_ecef_mps2[3]; /* at the launch */
    double aim_ecef[3];   /* what is sighted, from the target: an error that it keeps; the miss is the target's own */
    double sight_every_s; /* between measurements; 0: at each step */
    double sight_late_s;  /* age at which a measurement arrives */
    double filter_memory; /* above 0: directions alone are measured, and sight_filter.h makes rates of them; no range */
    double noise_rad;     /* of these, in each of two axes; drawn by noise_seed and the number of the measurement */
    uint64_t noise_seed;
    uint32_t noise_stream;
    bool     ranged;                     /* a measurement has range and closing speed */
    bool     ground;                     /* a plane ends the flight */
    double   on_ecef[3], normal_ecef[3]; /* a point of it, unit normal upwards */
    double   until_s;                    /* after the launch; infinite: by life_s */
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
    double        t_s;       /* exercise time of the end: of a plane between grid points, else of the last one */
    double        p_ecef[3]; /* there */
    Miss          miss;
    double        most_lateral_mps2, most_attack_rad, most_gimbal_rad; /* at grid points */
    int64_t       guided, coasted;                                     /* steps */
    int64_t       at_limit;                                            /* steps at which all that is possible acts */
} EngagementResult;

void engagement_fly(EngagementResult *out, const Engagement *engagement, const Missile *missile,
                    const FlightWorld *world);

#endif
