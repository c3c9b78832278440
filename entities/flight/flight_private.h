/* entities/flight/flight_private.h: what guidance and forces share at one instant within a step. */
#ifndef ENTITIES_FLIGHT_FLIGHT_PRIVATE_H
#define ENTITIES_FLIGHT_FLIGHT_PRIVATE_H

#include "entities/flight/flight.h"

/* The line of sight from the sight's eye to the target, carried on to another instant. */
typedef struct FlightTrack {
    double eye_ecef[3], eye_v_ecef_mps[3];
    double los_ecef[3], rate_ecef_rps[3];
    double range_m, closing_mps; /* NaN: not known */
} FlightTrack;

/* moving: the eye is the missile, at p and v; else the sight's own eye, which goes straight on. False: no direction. */
bool flight_track_at(FlightTrack *out, const FlightSight *sight, double t_s, bool moving, const double p_ecef[3],
                     const double v_ecef_mps[3]);

/* Where the law is evaluated. ahead: unit vector of the velocity through the air; falls_mps2: the acceleration of
 * gravity and turning axes. */
typedef struct FlightInstant {
    double t_s;
    double p_ecef[3], v_ecef_mps[3];
    double ahead_ecef[3], speed_mps; /* through the air */
    double falls_ecef_mps2[3];
    double h_m, climbed_m; /* above the ellipsoid, above the launch */
} FlightInstant;

/* The lateral acceleration that the law demands, across the velocity through the air, without limits. */
void flight_law(double out_ecef_mps2[3], const Missile *missile, const FlightCommand *command, const FlightInstant *at);

/* Fills the rest from t_s, p and v. state: of the grid point: launch_h_m, and the body's axis where there is no speed.
 */
void flight_instant(FlightInstant *at, const FlightWorld *world, const FlightState *state);
/* Unit vector of the ellipsoid's normal. */
void flight_up(double up_ecef[3], const double p_ecef[3]);

/* out = a less its part along the unit vector u; may alias a. */
static inline void v3_across(double out[3], const double a[3], const double u[3])
{
    v3_add_scaled(out, a, -v3_dot(a, u), u);
}

#endif
