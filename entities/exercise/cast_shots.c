/* entities/exercise/cast_shots.c: when and where a shot ends, and how its munition flies.
 *
 * The path is the straight line from launch to impact with loft and weave, both zero at either end. Motion along the
 * line: launch speed, a motor with decaying thrust, and a constant drag. */
#include "entities/exercise/cast_private.h"

#include "dis/pdu/decode.h"

#include <stdlib.h>

static const double longest_flight_s = 600;

static double flown_m(const ScenarioShot *shot, double flight_s)
{
    const double spent = -expm1(-flight_s / shot->boost_s);
    return shot->launch_mps * flight_s + shot->boost_mps * (flight_s - shot->boost_s * spent) -
           0.5 * shot->drag_mps2 * flight_s * flight_s;
}

/* The time until its speed is zero. */
static double longest_s(const ScenarioShot *shot)
{
    if (shot->drag_mps2 <= 0) return longest_flight_s;
    return fmin(longest_flight_s, (shot->launch_mps + shot->boost_mps) / shot->drag_mps2);
}

/* NaN: it does not reach so far. */
static double flight_time_s(const ScenarioShot *shot, double range_m)
{
    double low_s = 0, high_s = longest_s(shot);
    if (!(flown_m(shot, high_s) >= range_m)) return NAN;
    for (int i = 0; i < 60 && high_s - low_s > 1e-12 * high_s; i++) {
        const double middle_s = 0.5 * (low_s + high_s);
        if (flown_m(shot, middle_s) < range_m) low_s = middle_s;
        else high_s = middle_s;
    }
    return low_s;
}

static void up_at(double up[3], const ExerciseGround *ground, const double p_enu[3])
{
    double slope[2];
    exercise_level_at(slope, ground, p_enu[0], p_enu[1]);
    up[0] = -slope[0], up[1] = -slope[1], up[2] = 1;
    v3_normalize(up, up);
}

void cast_munition_pose(CastPose *out, const Cast *cast, const CastRound *round, double t_s)
{
    static const double h_s = 0.005;
    const ScenarioShot *shot = &cast->scenario->shot[round->shot];
    if (round->flight >= 0) {
        cast_flight_pose(out, cast, round, t_s);
        return;
    }
    double line[3], up[3], right[3] = {1, 0, 0}, p[3][3], nose[3];
    v3_sub(line, round->impact_enu, round->launch_enu);
    const double range_m = v3_length(line);
    up_at(up, &cast->ground, round->launch_enu);
    v3_cross(right, line, up);
    v3_normalize(right, right);
    for (int i = 0; i < 3; i++) {
        const double f = flown_m(shot, t_s + (i - 1) * h_s - round->fire_s) / range_m;
        const double bump = f > 0 && f < 1 ? 16 * f * f * (1 - f) * (1 - f) : 0;
        v3_add_scaled(p[i], round->launch_enu, f, line);
        v3_add_scaled(p[i], p[i], shot->loft_m * bump, up);
        v3_add_scaled(p[i], p[i], shot->weave_m * bump * sin(6 * pi_rad * f), right);
    }
    memcpy(out->p_enu, p[1], sizeof out->p_enu);
    v3_sub(nose, p[2], p[0]);
    cast_axes(out->r_enu_from_body, nose, up);
}

/* ---- start and end of a shot -------------------------------------------------------------------- */

void cast_launch_place(CastRound *round, const Cast *cast)
{
    static const double wing[3] = {0, 0, 0.8}, turret[3] = {0, 0, -2}; /* below a stub wing; at a gun's trunnions */
    const ScenarioShot *shot = &cast->scenario->shot[round->shot];
    const Carriage      carriage = cast->entity[round->shooter].carriage;
    CastPose            pose;
    double              off_enu[3];
    const double       *from = shot->launch_m.count == 3                                        ? shot->launch_m.number
                               : carriage == CARRIAGE_ROTARY || carriage == CARRIAGE_FIXED_WING ? wing
                                                                                                : turret;
    cast_pose(&pose, cast, round->shooter, round->fire_s);
    m3_mul_v3(off_enu, pose.r_enu_from_body, from);
    v3_add(round->launch_enu, pose.p_enu, off_enu);
}

/* Position of the aim point at t_s. */
static void impact_place(double p_enu[3], const Cast *cast, const CastRound *round, double t_s)
{
    static const double above_base_m = 1.2, beside_m = 8, past_m = 60, over_m = 6;
    const Scenario     *s = cast->scenario;
    const ScenarioShot *shot = &s->shot[round->shot];
    double              up[3], line[3];
    CastPose            pose;
    if (round->target >= 0) {
        cast_pose(&pose, cast, round->target, t_s);
        memcpy(p_enu, pose.p_enu, sizeof pose.p_enu);
    } else {
        const double  c = cos(s->place.turn_deg * rad_per_deg), d = sin(s->place.turn_deg * rad_per_deg);
        const double *at = shot->at_m.number;
        p_enu[0] = c * at[0] + d * at[1];
        p_enu[1] = c * at[1] - d * at[0];
        p_enu[2] = exercise_ground_at(NULL, &cast->ground, p_enu[0], p_enu[1]);
    }
    up_at(up, &cast->ground, p_enu);
    if (shot->hit == SCENARIO_HIT_ENTITY) {
        v3_add_scaled(p_enu, p_enu, above_base_m, up);
    } else if (shot->hit == SCENARIO_HIT_MISS) {
        v3_sub(line, p_enu, round->launch_enu);
        if (v3_normalize(line, line)) v3_add_scaled(p_enu, p_enu, past_m, line);
        v3_add_scaled(p_enu, p_enu, over_m, up);
    } else if (round->target >= 0) {
        for (int i = 0; i < 2; i++) p_enu[i] += beside_m * pose.r_enu_from_body[3 * i + 1];
        p_enu[2] = exercise_ground_at(NULL, &cast->ground, p_enu[0], p_enu[1]);
    }
}

/* The time of flight depends on the position of the target at its end; fixed-point iteration: a missile of 300 m/s
 * against a target of 8 m/s gains a factor of 40 per iteration; one hardly faster than its target takes many. */
static bool solve(CastRound *round, const Cast *cast)
{
    const ScenarioShot *shot = &cast->scenario->shot[round->shot];
    double              at_s = round->fire_s, line[3];
    cast_launch_place(round, cast);
    for (int i = 0; i < 200; i++) {
        impact_place(round->impact_enu, cast, round, at_s);
        v3_sub(line, round->impact_enu, round->launch_enu);
        const double flight_s = flight_time_s(shot, v3_length(line)), last_s = at_s;
        if (isnan(flight_s)) return false;
        at_s = round->fire_s + flight_s;
        if (fabs(at_s - last_s) < 1e-9) {
            round->impact_s = at_s;
            return flight_s > 0;
        }
    }
    return false;
}

/* A gun's round starts at the muzzle. */
static bool beyond_barrel(CastRound *round, const ScenarioShot *shot)
{
    static const double barrel_m = 6;
    double              line[3];
    v3_sub(line, round->impact_enu, round->launch_enu);
    const double range_m = v3_length(line);
    if (range_m < 2 * barrel_m) return false;
    v3_add_scaled(round->launch_enu, round->launch_enu, barrel_m / range_m, line);
    round->impact_s = round->fire_s + flight_time_s(shot, range_m - barrel_m);
    return true;
}

void cast_damage(Cast *cast, const CastRound *round)
{
    static const double       stops_s = 2, g_mps2 = 9.80665;
    const enum ScenarioDamage damage = cast->scenario->shot[round->shot].damage;
    CastEntity               *e = &cast->entity[round->target];
    if (isfinite(e->hit_s) || damage == SCENARIO_DAMAGE_NONE) return;
    e->damage = (uint8_t)damage; /* as DIS numbers it */
    if (e->damage > 1 && e->carriage != CARRIAGE_ROTARY && e->carriage != CARRIAGE_FIXED_WING) {
        e->rest_s = round->impact_s + stops_s;
    } else if (e->damage == 3) { /* it falls: until it hits the ground */
        for (double fall_s = 0; fall_s < 120; fall_s += 0.05) {
            CastPose pose;
            cast_pose(&pose, cast, round->target, round->impact_s + fall_s);
            const double above_m =
                pose.p_enu[2] - exercise_ground_at(NULL, &cast->ground, pose.p_enu[0], pose.p_enu[1]);
            if (above_m - 0.5 * g_mps2 * fall_s * fall_s > 0) continue;
            e->rest_s = round->impact_s + fall_s;
            break;
        }
    }
    e->hit_s = round->impact_s;
}

/* Flies a round by its row of the table of missiles, and says what came of it. */
static Status fly(Cast *cast, CastRound *round)
{
    const Scenario     *s = cast->scenario;
    const ScenarioShot *shot = &s->shot[round->shot];
    char                path[scenario_path_size + 8];
    Missile             missile;
    double              at_enu[3];
    if (*s->missiles) snprintf(path, sizeof path, "%s", s->missiles);
    else if (!etc_path(path, sizeof path, "missiles.csv")) return STATUS_IO;
    Status status = missile_read(&missile, path, shot->flies);
    if (status != STATUS_OK) {
        log_error("scenario: %s:%d: shots: flies: '%s' is no row of %s that can be used", s->path, shot->line,
                  shot->flies, path);
        return status;
    }
    cast_launch_place(round, cast);
    impact_place(at_enu, cast, round, round->fire_s); /* of a place, whose ground it meets; a target is followed */
    at_enu[2] = exercise_ground_at(NULL, &cast->ground, at_enu[0], at_enu[1]);
    status = cast_fly(cast, round, &missile, at_enu);
    if (status != STATUS_OK || cast->held) return status;
    if (round->result == dis_result_entity_impact) cast_damage(cast, round);
    else round->target = -1;
    return STATUS_OK;
}

Status cast_solve_shots(Cast *cast, const int *ids, const int *first)
{
    const Scenario *s = cast->scenario;
    int             flown = 0;
    for (int i = 0; i < cast->round_count; i++) flown += *s->shot[cast->round[i].shot].flies != 0;
    if (cast->held && flown == 0) {
        log_error(
            "scenario: %s: no shot flies: in a loop with frames one does, or several one after the other; give it "
            "`flies: ROW`, or --missile ROW",
            s->path);
        return STATUS_BAD_VALUE;
    }
    if (flown && !(cast->flight = calloc((size_t)flown, sizeof *cast->flight))) return STATUS_NO_MEMORY;
    for (int i = 0; i < cast->round_count; i++) {
        CastRound          *round = &cast->round[i];
        const ScenarioShot *shot = &s->shot[round->shot];
        int                 group = 0, member = 0;
        if (!scenario_find(&group, &member, s, ids, shot->from)) return STATUS_BAD_VALUE;
        round->shooter = first[group] + member;
        if (*shot->at && scenario_find(&group, &member, s, ids, shot->at)) round->target = first[group] + member;
        if (*shot->flies) {
            const Status status = fly(cast, round);
            if (status != STATUS_OK) return status;
            continue;
        }
        const bool gun = !shot->entity && cast->entity[round->shooter].carriage == CARRIAGE_LAND;
        if (!solve(round, cast) || (gun && !beyond_barrel(round, shot))) {
            double line[3];
            v3_sub(line, round->impact_enu, round->launch_enu);
            log_error("scenario: %s:%d: shots: what is fired at %g s does not get there: %.0f m; see launch_mps, "
                      "boost_mps, drag_mps2",
                      s->path, shot->line, round->fire_s, v3_length(line));
            return STATUS_BAD_VALUE;
        }
        round->result = shot->hit == SCENARIO_HIT_ENTITY   ? dis_result_entity_impact
                        : shot->hit == SCENARIO_HIT_GROUND ? dis_result_ground_impact
                                                           : dis_result_none;
        if (shot->hit == SCENARIO_HIT_ENTITY) cast_damage(cast, round);
        else round->target = -1;
    }
    return STATUS_OK;
}
