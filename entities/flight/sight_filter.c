/* entities/flight/sight_filter.c: one measurement into direction and rate. */
#include "entities/flight/sight_filter.h"

#include "entities/flight/flight_private.h"

/* Nearer measurements would make rates of rounding. */
static const double least_interval_s = 1e-6;

/* A unit vector turned along a great circle: by `way`, across it, whose length is the angle. */
static void turn_by(double out[3], const double u[3], const double way[3])
{
    const double angle_rad = v3_length(way);
    v3_scale(out, cos(angle_rad), u);
    if (angle_rad > 0) v3_add_scaled(out, out, sin(angle_rad) / angle_rad, way);
    v3_normalize(out, out);
}

/* What lies across a unit vector, carried with it along the great circle to another: its length stays. */
static void carry(double v[3], const double from[3], const double to[3])
{
    double       both[3];
    const double share = v3_dot(v, to) / (1 + v3_dot(from, to));
    v3_add(both, from, to);
    v3_add_scaled(v, v, -share, both);
}

bool sight_filter_take(SightFilter *f, double t_s, const double los_ecef[3])
{
    const double after_s = t_s - f->t_s;
    double       measured[3], way[3], ahead[3], off[3];
    if (!isfinite(t_s) || !v3_is_finite(los_ecef) || !(fabs(v3_length(los_ecef) - 1) < 1e-6)) return false;
    v3_normalize(measured, los_ecef);
    if (f->count == 0) {
        *f = (SightFilter){.memory = f->memory, .count = 1, .t_s = t_s};
        memcpy(f->los_ecef, measured, sizeof f->los_ecef);
        return true;
    }
    if (!(after_s >= least_interval_s) || !(v3_dot(measured, f->los_ecef) > 0)) return false;
    v3_scale(way, after_s, f->rate_ecef_rps);
    turn_by(ahead, f->los_ecef, way);
    const double along = v3_dot(measured, ahead);
    if (!(along > 0)) return false;
    v3_across(off, measured, ahead);
    const double sine = v3_length(off);
    if (sine > 0) v3_scale(off, atan2(sine, along) / sine, off); /* its length is the angle */

    const double n = (double)++f->count, m = f->memory;
    const double g = fmax(2 * (2 * n - 1) / (n * (n + 1)), 1 - m * m), h = fmax(6 / (n * (n + 1)), (1 - m) * (1 - m));
    carry(f->rate_ecef_rps, f->los_ecef, ahead);
    v3_add_scaled(f->rate_ecef_rps, f->rate_ecef_rps, h / after_s, off);
    v3_scale(way, g, off);
    turn_by(f->los_ecef, ahead, way);
    carry(f->rate_ecef_rps, ahead, f->los_ecef);
    v3_across(f->rate_ecef_rps, f->rate_ecef_rps, f->los_ecef);
    f->t_s = t_s;
    return true;
}

void sight_filter_sight(FlightSight *out, const SightFilter *f, const double eye_ecef[3],
                        const double eye_v_ecef_mps[3])
{
    *out = (FlightSight){.t_s = f->t_s, .range_m = NAN, .closing_mps = NAN};
    for (int k = 0; k < 3; k++) {
        out->eye_ecef[k] = eye_ecef[k];
        out->eye_v_ecef_mps[k] = eye_v_ecef_mps[k];
        out->los_ecef[k] = f->los_ecef[k];
        out->los_rate_ecef_rps[k] = f->count > 1 ? f->rate_ecef_rps[k] : NAN;
        out->target_a_ecef_mps2[k] = NAN;
    }
}
