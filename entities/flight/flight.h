/* entities/flight/flight.h: a missile's flight: a point mass with attitude, flown step by step on the exercise grid.
 *
 *   FlightState s;
 *   flight_launch(&s, &missile, &world, tick, p_ecef, v_ecef_mps);
 *   while (...) {
 *       flight_command(&command, &missile, &world, &s, sight);   sight: the newest line of sight, or NULL
 *       flight_step(&s, &missile, &world, &command);
 *   }
 *
 * All in ECEF, which turns with the Earth, in double. Each function is pure: the same arguments give the same bits.
 * etc/reference/flight.md has the equations. In short: mass and thrust over time; gravity by terrain/earth/gravity.h,
 * with centrifugal and Coriolis acceleration; air by terrain/weather/standard_atmosphere.h; drag by Mach; an autopilot
 * that follows the commanded lateral acceleration with a lag, within what airframe and angle of attack allow; classic
 * Runge-Kutta of fourth order, within which guidance is evaluated at each stage. Source of the guidance laws: Zarchan,
 * Tactical and Strategic Missile Guidance.
 *
 * Errors, against an independent integration (tests/system/test_flight_judge.sh): end point within 1 cm. Not modelled:
 * roll, tip-off, thrust that grows with height, wind that changes, a target's glint. */
#ifndef ENTITIES_FLIGHT_FLIGHT_H
#define ENTITIES_FLIGHT_FLIGHT_H

#include "entities/flight/missile.h"

/* What it flies in. flight_world() is the Earth; tests and tools take parts of it away. */
typedef struct FlightWorld {
    double step_s;           /* of the grid: exercise time is tick * step_s; 1 ms */
    double gravity, turning; /* factors of gravitation and of the Earth's rate: 1, or 0 */
    double air;              /* factor of the air's density: 1; 0: vacuum */
    double geoid_m;          /* mean sea level above the ellipsoid, for the air alone */
    double wind_ecef_mps[3];
} FlightWorld;

static inline FlightWorld flight_world(void)
{
    return (FlightWorld){.step_s = 0.001, .gravity = 1, .turning = 1, .air = 1};
}

typedef struct FlightState {
    int64_t tick; /* since the exercise began; time is tick * step_s */
    int64_t launch_tick;
    double  launch_h_m; /* ellipsoidal height of the launch */
    double  p_ecef[3], v_ecef_mps[3];
    double  lag_mps2[3];         /* lateral acceleration of the autopilot, ECEF, across the velocity through the air */
    double  lag_rate_mps3[3];    /* its rate, second order alone */
    double  r_ecef_from_body[9]; /* x forward, y right, z down; the wings are level */
    double  attack_ecef[3];      /* across the velocity through the air: sine of the angle of attack, to its side */
    double  gaze_ecef[3];        /* unit: where the seeker points */
    bool    terminal;            /* loft: the dive has begun */
    /* of the last grid point, for people and tests */
    double mass_kg, thrust_n, mach, attack_rad;
    double lateral_mps2;      /* what acts across the velocity through the air, gravity aside */
    double most_lateral_mps2; /* what could */
} FlightState;

/* A line of sight as a seeker, a recogniser behind it, or a sight at the launcher measured it. Numbers that are not
 * known are NaN. */
typedef struct FlightSight {
    double t_s;                            /* exercise time of the measurement */
    double eye_ecef[3], eye_v_ecef_mps[3]; /* whose it is: the missile's, or that of the launcher's sight */
    double los_ecef[3];                    /* unit, from the eye to the target */
    double los_rate_ecef_rps[3];           /* its rate of change, across it; what pursuit can do without */
    double range_m, closing_mps;           /* closing_mps: how fast the range falls */
    double target_a_ecef_mps2[3];          /* of the target; not known: taken as 0 */
} FlightSight;

/* Fills a sight with what is true of a target: p, v, a at t_s. False: the two are within a micrometre. */
bool flight_sight_true(FlightSight *out, double t_s, const double eye_ecef[3], const double eye_v_ecef_mps[3],
                       const double p_ecef[3], const double v_ecef_mps[3], const double a_ecef_mps2[3]);

typedef enum FlightVerdict {
    FLIGHT_GUIDED,
    FLIGHT_NOT_YET,       /* guide_after_s has not passed */
    FLIGHT_NO_SIGHT,      /* NULL */
    FLIGHT_BAD_SIGHT,     /* not finite, beyond what flies, no unit vector, or without a rate that the law needs */
    FLIGHT_AHEAD,         /* measured later than now */
    FLIGHT_OLD,           /* older than memory_s */
    FLIGHT_BEYOND_GIMBAL, /* further off the body's axis than the gimbal turns */
    FLIGHT_OUT_OF_VIEW,   /* further off the seeker's axis than half its field */
    FLIGHT_PASSED,        /* the range grows */
    flight_verdict_count,
} FlightVerdict;
const char *flight_verdict_name(FlightVerdict verdict);

/* What is flown from this grid point on. Without a sight that guides the missile coasts: no command but gravity's. */
typedef struct FlightCommand {
    FlightVerdict verdict;
    FlightSight   sight; /* where guided */
    bool          terminal;
    bool          sees;                 /* los_ecef is known */
    double        los_ecef[3];          /* now, carried on from the measurement */
    double        lateral_ecef_mps2[3]; /* demanded at this grid point, before limits */
} FlightCommand;

/* Below this speed through the air there is no direction of flight: the body's axis stands for it. */
static const double flight_least_mps = 1e-3;

/* The velocity is the direction of the launch too: at least flight_least_mps. */
void flight_launch(FlightState *out, const Missile *missile, const FlightWorld *world, int64_t tick,
                   const double p_ecef[3], const double v_ecef_mps[3]);
void flight_command(FlightCommand *out, const Missile *missile, const FlightWorld *world, const FlightState *state,
                    const FlightSight *sight);
/* Points the seeker at a target before launch, as far as its gimbal goes. */
void flight_lock(FlightState *state, const Missile *missile, const double los_ecef[3]);
/* One step. False, and *state unchanged: what follows is not finite, or not between 6000 and 20000 km from the Earth's
 * centre. */
bool flight_step(FlightState *state, const Missile *missile, const FlightWorld *world, const FlightCommand *command);

static inline double flight_time_s(const FlightState *state, const FlightWorld *world)
{
    return (double)state->tick * world->step_s;
}

/* Mass, thrust of the stage that burns from here on; age_s: since launch. */
double missile_mass_kg(const Missile *missile, double age_s);
double missile_thrust_n(const Missile *missile, double age_s);
double missile_drag(const Missile *missile, double mach);
/* When the last stage has burnt, since launch. */
double missile_burnt_s(const Missile *missile);

#endif
