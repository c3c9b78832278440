/* entities/exercise/cast.c: poses of all entities. Their creation: cast_entities.c; missiles: cast_shots.c. */
#include "entities/exercise/cast_private.h"

#include "dis/pdu/pdu.h"

static const double g_mps2 = 9.80665;
static const double roll_out_s = 2; /* time for which an entity that was hit rolls on, on the ground */

/* ---- distance along --------------------------------------------------------------------------- */

/* Distance of the whole group since time 0, m, and its speed. Unsteadiness warps time, so stationary entities stay
 * stationary. */
static double travelled(double *speed_mps, const Cast *cast, int group, double t_s)
{
    static const double  swing_rps = 0.25;
    const ScenarioGroup *g = &cast->scenario->group[group];
    const double         v = g->speed_mps, begins_s = g->start_s, stops_s = cast->stop_s[group];
    double               way, speed, pace = 1;
    if (v <= 0) {
        *speed_mps = 0;
        return 0;
    }
    if (g->unsteady_m > 0) {
        const double phase = 2 * pi_rad * random_uniform((uint64_t)cast->scenario->seed, 1, 0, 2);
        const double angle = swing_rps * t_s + phase;
        t_s += g->unsteady_m / v * sin(angle);
        pace += g->unsteady_m / v * swing_rps * cos(angle);
    }
    const double moving_s = fmin(t_s, stops_s);
    if (isnan(begins_s)) {
        way = v * moving_s, speed = v;
    } else {
        const double after_s = fmax(moving_s - begins_s, 0), part = fmin(after_s / cast_ramp_s, 1);
        way = v * (0.5 * part * part * cast_ramp_s + fmax(after_s - cast_ramp_s, 0)), speed = v * part;
    }
    if (t_s > stops_s) {
        const double after_s = fmin(t_s - stops_s, cast_ramp_s);
        way += speed * (after_s - 0.5 * after_s * after_s / cast_ramp_s);
        speed *= 1 - after_s / cast_ramp_s;
    }
    *speed_mps = speed * pace;
    return way;
}

/* Distance and speed of one entity, which ends its way when it is hit. */
static double way_of(double *speed_mps, const Cast *cast, const CastEntity *e, double t_s)
{
    if (!(t_s > e->hit_s) || !isfinite(e->rest_s)) return travelled(speed_mps, cast, e->group, t_s);
    if (e->carriage == CARRIAGE_ROTARY || e->carriage == CARRIAGE_FIXED_WING) {
        const double way = travelled(speed_mps, cast, e->group, fmin(t_s, e->rest_s));
        if (t_s >= e->rest_s) *speed_mps = 0;
        return way;
    }
    double       hit_mps;
    const double hit_m = travelled(&hit_mps, cast, e->group, e->hit_s), after_s = fmin(t_s - e->hit_s, roll_out_s);
    *speed_mps = hit_mps * (1 - after_s / roll_out_s);
    return hit_m + hit_mps * (after_s - 0.5 * after_s * after_s / roll_out_s);
}

/* ---- where ------------------------------------------------------------------------------------ */

void cast_axes(double r_enu_from_body[9], const double forward[3], const double up[3])
{
    double x[3] = {1, 0, 0}, y[3], z[3];
    v3_normalize(x, forward);
    v3_cross(y, x, up);
    v3_normalize(y, y);
    v3_cross(z, x, y);
    for (int i = 0; i < 3; i++) {
        r_enu_from_body[3 * i] = x[i];
        r_enu_from_body[3 * i + 1] = y[i];
        r_enu_from_body[3 * i + 2] = z[i];
    }
}

static double phase_of(const Cast *cast, int entity, uint32_t which)
{
    return 2 * pi_rad * random_uniform((uint64_t)cast->scenario->seed, 3, which, (uint64_t)entity);
}

/* Hover: swaying by 0.4 m and pitching by a degree. */
static void hover(CastPose *out, double forward[3], const Cast *cast, int entity, double t_s)
{
    const double a = phase_of(cast, entity, 0), b = phase_of(cast, entity, 1);
    out->p_enu[0] += 0.4 * sin(0.9 * t_s + a);
    out->p_enu[2] += 0.4 * sin(0.7 * t_s + b);
    forward[2] += 0.02 * sin(0.5 * t_s + b);
}

/* An aircraft shot down falls, and continues forward until it hits the ground. */
static void fall(CastPose *out, const CastEntity *e, double t_s)
{
    const double after_s = fmin(t_s, e->rest_s) - e->hit_s;
    if (after_s > 0 && isfinite(e->rest_s)) out->p_enu[2] -= 0.5 * g_mps2 * after_s * after_s;
}

/* Banks an aircraft as in a coordinated turn: tan = v^2 / (r g). */
static void lean(double up[3], const double left[3], double speed_mps, double curvature)
{
    const double tan_bank = clamp(speed_mps * speed_mps * curvature / g_mps2, -2, 2);
    const double c = 1 / sqrt(1 + tan_bank * tan_bank);
    for (int i = 0; i < 3; i++) up[i] = c * (up[i] + tan_bank * left[i]);
}

void cast_pose(CastPose *out, const Cast *cast, int entity, double t_s)
{
    const CastEntity *e = &cast->entity[entity];
    if (e->group < 0) {
        cast_munition_pose(out, cast, &cast->round[e->round], t_s);
        return;
    }
    const ScenarioGroup *g = &cast->scenario->group[e->group];
    const Route         *route = &cast->route[e->group];
    const bool           flies = e->carriage == CARRIAGE_ROTARY || e->carriage == CARRIAGE_FIXED_WING;
    double               speed_mps, slope[2], curvature = 0;
    RoutePoint           at;
    const double         way_m = way_of(&speed_mps, cast, e, t_s) - (double)e->behind_m;

    route_at(&at, route, way_m);
    const double along = hypot(at.d[0], at.d[1]);
    double       forward[2] = {at.d[0] / along, at.d[1] / along};
    double       left[3] = {-forward[1], forward[0], 0};
    double       x = at.p[0] + e->aside_m * left[0], y = at.p[1] + e->aside_m * left[1];
    if (e->own >= 0) {
        const CastHidden *own = &cast->hidden[e->own];
        x = own->x_m, y = own->y_m;
        forward[0] = sin(own->heading_rad), forward[1] = cos(own->heading_rad);
        left[0] = -forward[1], left[1] = forward[0];
    }
    const bool stands = g->route_m.count == 2;
    if (stands) speed_mps = 0; /* a stationary entity's route only gives its heading */
    else curvature = (at.d[0] * at.dd[1] - at.d[1] * at.dd[0]) / (along * along * along);

    out->p_enu[0] = x, out->p_enu[1] = y;
    if (flies) {
        out->p_enu[2] = at.p[2];
        exercise_level_at(slope, &cast->ground, x, y);
    } else if (e->carriage == CARRIAGE_SEA) {
        out->p_enu[2] = exercise_level_at(slope, &cast->ground, x, y) + g->height_m;
    } else {
        out->p_enu[2] = exercise_ground_at(slope, &cast->ground, x, y) + g->height_m;
    }
    if (e->carriage == CARRIAGE_LIFE) exercise_level_at(slope, &cast->ground, x, y); /* upright */
    double nose[3] = {forward[0], forward[1], slope[0] * forward[0] + slope[1] * forward[1]};
    double up[3] = {-slope[0], -slope[1], 1};
    if (flies) {
        if (e->carriage == CARRIAGE_FIXED_WING) nose[2] = at.d[2] / along;
        else nose[2] -= 0.1 * fmin(speed_mps / 50, 1); /* a rotorcraft pitches down to move forward */
        v3_normalize(up, up);
        lean(up, left, speed_mps, curvature);
        if (e->carriage == CARRIAGE_ROTARY && stands && !(t_s > e->hit_s)) hover(out, nose, cast, entity, t_s);
        fall(out, e, t_s);
    }
    cast_axes(out->r_enu_from_body, nose, up);
}

void cast_kinematics(Kinematics *out, const Cast *cast, int entity, double t_s)
{
    static const double h_s = 0.01;
    const double       *r = cast->ground.frame.r_ecef_from_enu;
    CastPose            at, before, after;
    double              v_enu[3], a_enu[3], change[9], spin[9];
    cast_pose(&at, cast, entity, t_s);
    cast_pose(&before, cast, entity, t_s - h_s);
    cast_pose(&after, cast, entity, t_s + h_s);
    for (int i = 0; i < 3; i++) {
        v_enu[i] = (after.p_enu[i] - before.p_enu[i]) / (2 * h_s);
        a_enu[i] = (after.p_enu[i] - at.p_enu[i] - (at.p_enu[i] - before.p_enu[i])) / (h_s * h_s);
    }
    for (int i = 0; i < 9; i++) change[i] = (after.r_enu_from_body[i] - before.r_enu_from_body[i]) / (2 * h_s);
    m3_tmul(spin, at.r_enu_from_body, change); /* dR/dt = R skew(w) */
    out->algorithm = 4;
    out->w_body_rps[0] = 0.5 * (spin[7] - spin[5]);
    out->w_body_rps[1] = 0.5 * (spin[2] - spin[6]);
    out->w_body_rps[2] = 0.5 * (spin[3] - spin[1]);
    m3_mul_v3(out->v_mps, r, v_enu);
    m3_mul_v3(out->a_mps2, r, a_enu);
    m3_mul(out->r_ecef_from_body, r, at.r_enu_from_body);
    ecef_from_enu(out->p_ecef, &cast->ground.frame, at.p_enu);
}

/* ---- appearance and more ---------------------------------------------------------------------- */

bool cast_present(const Cast *cast, int entity, double t_s)
{
    const CastEntity *e = &cast->entity[entity];
    if (e->group < 0) {
        const CastRound *round = &cast->round[e->round];
        if (round->flight >= 0 && cast->flight[round->flight].held) return false;
        return t_s >= round->fire_s && t_s < round->impact_s - cast->scenario->shot[round->shot].silent_s;
    }
    const ScenarioGroup *g = &cast->scenario->group[e->group];
    return !(t_s < g->appears_s) && !(t_s >= g->leaves_s);
}

static const double flash_s = 0.5; /* duration of a munition's launch flash */

uint32_t cast_appearance(const Cast *cast, int entity, double t_s)
{
    static const uint32_t launch_flash = 1u << 16, engine = 1u << dis_appearance_power_plant_bit;
    const CastEntity     *e = &cast->entity[entity];
    if (e->group < 0) return t_s < cast->round[e->round].fire_s + flash_s ? launch_flash : 0;

    const ScenarioGroup *g = &cast->scenario->group[e->group];
    uint32_t             bits = (uint32_t)g->appearance;
    if (t_s >= e->hit_s && e->damage) {
        bits |= (uint32_t)e->damage << dis_appearance_damage_shift;
        if (e->damage == dis_damage_destroyed)
            return bits | 1u << dis_appearance_flaming_bit | 1u << dis_appearance_smoke_shift;
        if (e->damage == 2) bits |= 1u << dis_appearance_smoke_shift;
    }
    if (e->carriage == CARRIAGE_LIFE) return bits;
    if (g->engine && !(t_s >= g->engine_off_s)) bits |= engine;
    if (e->carriage == CARRIAGE_LAND) {
        double speed_mps;
        way_of(&speed_mps, cast, e, t_s);
        /* tracks raise more dust than wheels */
        static const uint32_t trails[] = {
            [SCENARIO_DUST_SMALL] = 1, [SCENARIO_DUST_MEDIUM] = 2, [SCENARIO_DUST_LARGE] = 3};
        const uint32_t trail = g->dust == SCENARIO_DUST_AUTO ? (e->type.category <= 4 ? 2 : 1) : trails[g->dust];
        if (fabs(speed_mps) > 1 && g->route_m.count > 2) bits |= trail << dis_appearance_trail_shift;
    }
    return bits;
}

int cast_joints(JointReport joint[cast_max_joints], const Cast *cast, int entity, double t_s)
{
    const CastEntity *e = &cast->entity[entity];
    int               count = 0;
    if (e->joints < 0) return 0;
    const bool   swings = cast->scenario->group[e->group].turret == SCENARIO_TURRET_SWING;
    const double phase = 2 * pi_rad * random_uniform((uint64_t)cast->scenario->seed, 1, 0, (uint64_t)entity);
    const double rate = 0.35 + 0.08 * (entity % 4), halted = t_s > e->hit_s && isfinite(e->rest_s) ? 0 : 1;
    if (isfinite(e->rest_s)) t_s = fmin(t_s, e->hit_s);
    for (int k = 0; k < cast_max_joints && cast->joint[e->joints + k].dis_class; k++) {
        const CastJoint *j = &cast->joint[e->joints + k];
        double           value = 0, slew = 0;
        if (swings && j->metric == 11) {
            value = 1.1 * sin(rate * t_s + phase), slew = 1.1 * rate * cos(rate * t_s + phase);
            if (j->low <= j->high && (value < j->low || value > j->high))
                value = clamp(value, j->low, j->high), slew = 0;
        } else if (swings) {
            value = 0.06 + 0.05 * sin(0.6 * t_s + phase), slew = 0.03 * cos(0.6 * t_s + phase);
        }
        joint[count++] =
            (JointReport){.parameter = j->dis_class + j->metric, .value = (float)value, .rate = (float)(halted * slew)};
    }
    return count;
}

bool cast_still(const Cast *cast, int entity, double t_s)
{
    static const double over_s = 0.02; /* step of the differences */
    const CastEntity   *e = &cast->entity[entity];
    if (e->group < 0) return false;
    const ScenarioGroup *g = &cast->scenario->group[e->group];
    if (t_s > e->rest_s + over_s) return true;
    if (t_s > e->hit_s) return false;
    if (g->route_m.count == 2 || g->speed_mps <= 0) return e->carriage != CARRIAGE_ROTARY || g->route_m.count != 2;
    const double bent_s = g->unsteady_m / g->speed_mps + over_s;
    return t_s < g->start_s - bent_s || t_s > cast->stop_s[e->group] + cast_ramp_s + bent_s;
}

double cast_next_change(const Cast *cast, int entity, double t_s)
{
    const CastEntity *e = &cast->entity[entity];
    double            times[7] = {e->hit_s, e->rest_s, NAN, NAN, NAN, NAN, NAN}, next = INFINITY;
    if (e->group < 0) {
        const CastRound *round = &cast->round[e->round];
        times[2] = round->fire_s, times[3] = round->fire_s + flash_s;
        times[4] = round->impact_s - cast->scenario->shot[round->shot].silent_s;
    } else {
        const ScenarioGroup *g = &cast->scenario->group[e->group];
        const double         bent_s = g->speed_mps > 0 ? g->unsteady_m / g->speed_mps + 0.02 : 0;
        times[2] = g->appears_s, times[3] = g->leaves_s, times[4] = g->start_s - bent_s;
        times[5] = cast->stop_s[e->group] - bent_s, times[6] = g->engine_off_s;
    }
    for (int i = 0; i < 7; i++)
        if (times[i] > t_s) next = fmin(next, times[i]);
    return next;
}

void cast_marking(char marking[11], const Cast *cast, int entity)
{
    const CastEntity *e = &cast->entity[entity];
    const char       *name =
        e->group < 0 ? cast->scenario->shot[cast->round[e->round].shot].name : cast->scenario->group[e->group].name;
    char text[scenario_name_size + 8];
    memset(marking, 0, 11);
    snprintf(text, sizeof text, "%s %u", name, e->number);
    memcpy(marking, text, strnlen(text, 11));
}
