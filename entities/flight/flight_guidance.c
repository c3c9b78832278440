/* entities/flight/flight_guidance.c: from a line of sight to a lateral acceleration: whether it guides, and each law.
 */
#include "entities/flight/flight_private.h"

/* Command to line of sight: damping of the error across the line. 1: it comes in without swinging past. */
static const double command_damping = 1;
/* Loft: time in which an error of height is flown off, and in which the velocity turns; seconds beside autopilots of
 * 0.1 .. 0.3 s, so that the lag does not make it swing. */
static const double loft_height_s = 2, loft_turn_s = 0.6;
/* A target closer to the eye than this has no direction. */
static const double least_range_m = 1e-6;

const char *flight_verdict_name(FlightVerdict verdict)
{
    static const char *const name[flight_verdict_count] = {"guided", "not yet", "no sight",    "bad sight", "ahead",
                                                           "old",    "gimbal",  "out of view", "passed"};
    return name[verdict];
}

bool flight_sight_true(FlightSight *out, double t_s, const double eye_ecef[3], const double eye_v_ecef_mps[3],
                       const double p_ecef[3], const double v_ecef_mps[3], const double a_ecef_mps2[3])
{
    FlightSight s = {.t_s = t_s};
    double      away[3], drift[3];
    v3_sub(away, p_ecef, eye_ecef);
    v3_sub(drift, v_ecef_mps, eye_v_ecef_mps);
    s.range_m = v3_length(away);
    if (!(s.range_m > least_range_m)) return false;
    v3_scale(s.los_ecef, 1 / s.range_m, away);
    s.closing_mps = -v3_dot(s.los_ecef, drift);
    v3_across(s.los_rate_ecef_rps, drift, s.los_ecef);
    v3_scale(s.los_rate_ecef_rps, 1 / s.range_m, s.los_rate_ecef_rps);
    for (int k = 0; k < 3; k++) {
        s.eye_ecef[k] = eye_ecef[k];
        s.eye_v_ecef_mps[k] = eye_v_ecef_mps[k];
        s.target_a_ecef_mps2[k] = a_ecef_mps2[k];
    }
    *out = s;
    return true;
}

/* ---- the line of sight, carried on --------------------------------------------------------------- */

static void target_acceleration(double out[3], const FlightSight *sight)
{
    for (int k = 0; k < 3; k++) out[k] = v3_is_finite(sight->target_a_ecef_mps2) ? sight->target_a_ecef_mps2[k] : 0;
}

bool flight_track_at(FlightTrack *out, const FlightSight *sight, double t_s, bool moving, const double p_ecef[3],
                     const double v_ecef_mps[3])
{
    const double age_s = t_s - sight->t_s;
    FlightTrack  t = {.range_m = NAN, .closing_mps = NAN};
    for (int k = 0; k < 3; k++) {
        t.eye_ecef[k] = moving ? p_ecef[k] : sight->eye_ecef[k] + age_s * sight->eye_v_ecef_mps[k];
        t.eye_v_ecef_mps[k] = moving ? v_ecef_mps[k] : sight->eye_v_ecef_mps[k];
    }
    const bool   rate = v3_is_finite(sight->los_rate_ecef_rps);
    const double none[3] = {0}, *turn_rps = rate ? sight->los_rate_ecef_rps : none;
    if (isfinite(sight->range_m)) {
        /* the target as a point: measured place and velocity, then its acceleration */
        const double out_mps = isfinite(sight->closing_mps)
                                   ? -sight->closing_mps
                                   : -v3_dot(sight->los_ecef, sight->eye_v_ecef_mps); /* it does not come or go */
        double       a[3], away[3], drift[3];
        target_acceleration(a, sight);
        for (int k = 0; k < 3; k++) {
            const double v = sight->eye_v_ecef_mps[k] + out_mps * sight->los_ecef[k] + sight->range_m * turn_rps[k];
            const double p = sight->eye_ecef[k] + sight->range_m * sight->los_ecef[k];
            away[k] = p + age_s * (v + 0.5 * age_s * a[k]) - t.eye_ecef[k];
            drift[k] = v + age_s * a[k] - t.eye_v_ecef_mps[k];
        }
        t.range_m = v3_length(away);
        if (!(t.range_m > least_range_m)) return false;
        v3_scale(t.los_ecef, 1 / t.range_m, away);
        t.closing_mps = -v3_dot(drift, t.los_ecef);
        v3_across(t.rate_ecef_rps, drift, t.los_ecef);
        v3_scale(t.rate_ecef_rps, 1 / t.range_m, t.rate_ecef_rps);
    } else {
        v3_add_scaled(t.los_ecef, sight->los_ecef, age_s, turn_rps);
        if (!v3_normalize(t.los_ecef, t.los_ecef)) return false;
        v3_across(t.rate_ecef_rps, turn_rps, t.los_ecef);
    }
    *out = t;
    return true;
}

/* ---- the laws ------------------------------------------------------------------------------------ */

/* Turns the velocity into a direction. */
static void turn_to(double a[3], const double wanted[3], const FlightInstant *at, double rate_per_s)
{
    v3_across(a, wanted, at->ahead_ecef);
    v3_scale(a, rate_per_s * at->speed_mps, a);
}

/* True proportional navigation: across the line of sight. Without a range its closing speed is the missile's own. */
static void navigate(double a[3], const Missile *missile, const FlightTrack *track, const FlightInstant *at)
{
    const double own_mps = v3_dot(at->v_ecef_mps, track->los_ecef);
    const double closing_mps = fmax(isfinite(track->closing_mps) ? track->closing_mps : own_mps, 0);
    v3_scale(a, missile->gain * closing_mps, track->rate_ecef_rps);
}

/* Across the line from the sight to the target: a spring and a damper to it, and Coriolis's of the turning line. */
static void follow_line(double a[3], const Missile *missile, const FlightTrack *track, const FlightInstant *at)
{
    double from_eye[3], motion[3];
    v3_sub(from_eye, at->p_ecef, track->eye_ecef);
    v3_sub(motion, at->v_ecef_mps, track->eye_v_ecef_mps);
    const double along_m = v3_dot(from_eye, track->los_ecef), out_mps = v3_dot(motion, track->los_ecef);
    for (int k = 0; k < 3; k++) {
        const double error_m = along_m * track->los_ecef[k] - from_eye[k];
        const double error_mps = along_m * track->rate_ecef_rps[k] - (motion[k] - out_mps * track->los_ecef[k]);
        a[k] = missile->gain * (missile->gain * error_m + 2 * command_damping * error_mps) +
               2 * out_mps * track->rate_ecef_rps[k];
    }
}

/* Climbs to loft_m above the launch, no steeper than loft_rad, over the line of sight's bearing. */
static void fly_over(double a[3], const Missile *missile, const FlightTrack *track, const FlightInstant *at)
{
    double up[3], level[3], wanted[3];
    flight_up(up, at->p_ecef);
    v3_across(level, track->los_ecef, up);
    if (!v3_normalize(level, level)) {
        turn_to(a, track->los_ecef, at, 1 / loft_turn_s);
        return;
    }
    const double slope = (missile->loft_m - at->climbed_m) / (loft_height_s * fmax(at->speed_mps, 1));
    const double angle_rad = clamp(atan(slope), -missile->loft_rad, missile->loft_rad);
    v3_scale(wanted, cos(angle_rad), level);
    v3_add_scaled(wanted, wanted, sin(angle_rad), up);
    turn_to(a, wanted, at, 1 / loft_turn_s);
}

void flight_law(double out_ecef_mps2[3], const Missile *missile, const FlightCommand *command, const FlightInstant *at)
{
    double      a[3] = {0}, part[3];
    FlightTrack track;
    const bool  moving = missile->guidance != MISSILE_COMMAND;
    if (command->verdict == FLIGHT_GUIDED &&
        flight_track_at(&track, &command->sight, at->t_s, moving, at->p_ecef, at->v_ecef_mps)) {
        switch (missile->guidance) {
        case MISSILE_PURSUIT:
            turn_to(a, track.los_ecef, at, missile->gain);
            break;
        case MISSILE_COMMAND:
            follow_line(a, missile, &track, at);
            break;
        case MISSILE_LOFT:
            if (!command->terminal) {
                fly_over(a, missile, &track, at);
                break;
            }
            /* fall through */
        case MISSILE_PN:
        case MISSILE_AUGMENTED:
            navigate(a, missile, &track, at);
            if (missile->guidance != MISSILE_AUGMENTED) break;
            target_acceleration(part, &command->sight);
            v3_across(part, part, track.los_ecef);
            v3_add_scaled(a, a, 0.5 * missile->gain, part);
            break;
        }
    }
    v3_add_scaled(a, a, -missile->gravity_share, at->falls_ecef_mps2);
    v3_across(out_ecef_mps2, a, at->ahead_ecef);
}

/* ---- whether a measurement guides ---------------------------------------------------------------- */

/* Beyond these no number is a measurement: squares of them stay finite. */
static const double most_m = 1e8, most_mps = 1e5, most_mps2 = 1e5, most_rps = 1e4;

static bool is_within(const double v[3], double most) { return v3_is_finite(v) && v3_length(v) <= most; }

static bool sight_is_good(const FlightSight *s, const Missile *missile)
{
    if (!is_within(s->eye_ecef, most_m) || !is_within(s->eye_v_ecef_mps, most_mps)) return false;
    if (!v3_is_finite(s->los_ecef) || !(fabs(v3_length(s->los_ecef) - 1) < 1e-6)) return false;
    if (!isnan(s->range_m) && !(s->range_m > 0 && s->range_m <= most_m)) return false;
    if (!isnan(s->closing_mps) && !(fabs(s->closing_mps) <= most_mps)) return false;
    if (v3_is_finite(s->target_a_ecef_mps2) && !is_within(s->target_a_ecef_mps2, most_mps2)) return false;
    return is_within(s->los_rate_ecef_rps, most_rps) ||
           (missile->guidance == MISSILE_PURSUIT && !v3_is_finite(s->los_rate_ecef_rps));
}

static double angle_between(const double a[3], const double b[3])
{
    double cross[3];
    v3_cross(cross, a, b);
    return atan2(v3_length(cross), v3_dot(a, b)); /* exact near 0, where acos is not */
}

/* Phases begin on whole milliseconds of exercise time, whatever the step: half the step then begins them no earlier. */
static bool decides(double t_s, double step_s)
{
    static const double grid_s = 0.001, rounding = 1e-6;
    return floor(t_s / grid_s + rounding) != floor((t_s - step_s) / grid_s + rounding);
}

static FlightVerdict judge(FlightCommand *c, const Missile *missile, const FlightState *state, const FlightInstant *at,
                           const FlightWorld *world, const FlightSight *sight)
{
    FlightTrack  track;
    const bool   seeker = missile->guidance != MISSILE_COMMAND;
    const double forward[3] = {state->r_ecef_from_body[0], state->r_ecef_from_body[3], state->r_ecef_from_body[6]};
    if (!sight) return FLIGHT_NO_SIGHT;
    if (!sight_is_good(sight, missile)) return FLIGHT_BAD_SIGHT;
    const double age_s = at->t_s - sight->t_s;
    if (!(age_s > -1e-9)) return FLIGHT_AHEAD;
    if (!(age_s <= missile->memory_s)) return FLIGHT_OLD;
    if (!flight_track_at(&track, sight, at->t_s, seeker, at->p_ecef, at->v_ecef_mps)) return FLIGHT_BAD_SIGHT;
    if (seeker && !(angle_between(state->gaze_ecef, track.los_ecef) <= 0.5 * missile->field_rad))
        return FLIGHT_OUT_OF_VIEW;
    c->sees = true;
    memcpy(c->los_ecef, track.los_ecef, sizeof c->los_ecef);
    if (seeker && !(angle_between(forward, track.los_ecef) <= missile->gimbal_rad)) return FLIGHT_BEYOND_GIMBAL;
    if (seeker && track.closing_mps <= 0 && v3_dot(track.los_ecef, at->ahead_ecef) <= 0) return FLIGHT_PASSED;
    if (missile->guidance == MISSILE_LOFT && !c->terminal && decides(at->t_s, world->step_s)) {
        double up[3];
        flight_up(up, at->p_ecef);
        c->terminal = -v3_dot(track.los_ecef, up) >= sin(missile->dive_rad);
    }
    if (at->t_s < (double)state->launch_tick * world->step_s + missile->guide_after_s - 1e-9) return FLIGHT_NOT_YET;
    return FLIGHT_GUIDED;
}

void flight_command(FlightCommand *out, const Missile *missile, const FlightWorld *world, const FlightState *state,
                    const FlightSight *sight)
{
    FlightCommand c = {.terminal = state->terminal};
    FlightInstant at = {.t_s = flight_time_s(state, world)};
    memcpy(at.p_ecef, state->p_ecef, sizeof at.p_ecef);
    memcpy(at.v_ecef_mps, state->v_ecef_mps, sizeof at.v_ecef_mps);
    flight_instant(&at, world, state);
    c.verdict = judge(&c, missile, state, &at, world, sight);
    if (c.verdict == FLIGHT_GUIDED) c.sight = *sight;
    flight_law(c.lateral_ecef_mps2, missile, &c, &at);
    *out = c;
}
