/* entities/flight/engagement.c: the loop of sight, command and step, until something ends it. */
#include "entities/flight/engagement.h"

/* Range beyond the closest approach at which nothing more is awaited. */
static const double passed_m = 50;

const char *flight_end_name(FlightEnd end)
{
    static const char *const name[flight_end_count] = {"until", "life", "fuze", "passed", "ground", "lost"};
    return name[end];
}

static void target_at(double p[3], double v[3], const Engagement *e, double t_s)
{
    for (int k = 0; k < 3; k++) {
        v[k] = e->target_v_ecef_mps[k] + t_s * e->target_a_ecef_mps2[k];
        p[k] = e->target_ecef[k] + t_s * (e->target_v_ecef_mps[k] + 0.5 * t_s * e->target_a_ecef_mps2[k]);
    }
}

/* Measures: from the missile, or from the launcher. */
static bool look(FlightSight *out, const Engagement *e, const Missile *missile, const FlightState *state, double t_s)
{
    const bool   launcher = missile->guidance == MISSILE_COMMAND;
    const double still[3] = {0};
    double       p[3], v[3];
    target_at(p, v, e, t_s);
    if (!flight_sight_true(out, t_s, launcher ? e->p_ecef : state->p_ecef, launcher ? still : state->v_ecef_mps, p, v,
                           e->target_a_ecef_mps2))
        return false;
    if (!e->ranged) out->range_m = out->closing_mps = NAN;
    return true;
}

/* The newest measurement that has arrived, of those that wait. */
typedef struct Line {
    FlightSight sight[engagement_waiting_most];
    int         first, count;
} Line;

static void put_in_line(Line *line, const FlightSight *sight)
{
    if (line->count == engagement_waiting_most)
        line->first = (line->first + 1) % engagement_waiting_most, line->count--;
    line->sight[(line->first + line->count++) % engagement_waiting_most] = *sight;
}

static const FlightSight *newest(Line *line, double t_s, double late_s)
{
    /* one that has arrived stays until a newer one does */
    while (line->count > 1 && line->sight[(line->first + 1) % engagement_waiting_most].t_s + late_s <= t_s + 1e-9)
        line->first = (line->first + 1) % engagement_waiting_most, line->count--;
    const FlightSight *s = &line->sight[line->first];
    return line->count > 0 && s->t_s + late_s <= t_s + 1e-9 ? s : NULL;
}

static double angle_off_axis(const FlightState *s)
{
    double       cross[3];
    const double x[3] = {s->r_ecef_from_body[0], s->r_ecef_from_body[3], s->r_ecef_from_body[6]};
    v3_cross(cross, x, s->gaze_ecef);
    return atan2(v3_length(cross), v3_dot(x, s->gaze_ecef));
}

static void leg_of(MissLeg *leg, const FlightState *from, const FlightState *to)
{
    memcpy(leg->p0_ecef, from->p_ecef, sizeof leg->p0_ecef);
    memcpy(leg->v0_ecef_mps, from->v_ecef_mps, sizeof leg->v0_ecef_mps);
    memcpy(leg->p1_ecef, to->p_ecef, sizeof leg->p1_ecef);
    memcpy(leg->v1_ecef_mps, to->v_ecef_mps, sizeof leg->v1_ecef_mps);
}

/* Takes the step's maxima. */
static void take_extremes(EngagementResult *r, const FlightState *s)
{
    r->most_lateral_mps2 = fmax(r->most_lateral_mps2, s->lateral_mps2);
    r->most_attack_rad = fmax(r->most_attack_rad, s->attack_rad);
    r->most_gimbal_rad = fmax(r->most_gimbal_rad, angle_off_axis(s));
    if (s->lateral_mps2 >= s->most_lateral_mps2 * (1 - 1e-12)) r->at_limit++;
}

void engagement_fly(EngagementResult *out, const Engagement *e, const Missile *missile, const FlightWorld *world)
{
    EngagementResult r = {.miss = miss_begin()};
    FlightState     *s = &r.state;
    Line             line = {.first = 0};
    FlightSight      sight;
    const double     h = world->step_s;
    const int64_t    last = (int64_t)round(fmin(e->until_s, missile->life_s) / h);
    double           next_look_s = 0;
    flight_launch(s, missile, world, 0, e->p_ecef, e->v_ecef_mps);
    if (e->target && look(&sight, e, missile, s, 0)) flight_lock(s, missile, sight.los_ecef);
    take_extremes(&r, s);
    r.end = e->until_s <= missile->life_s ? FLIGHT_END_UNTIL : FLIGHT_END_LIFE;
    while (s->tick < last) {
        const FlightState before = *s;
        FlightCommand     command;
        MissLeg           leg, target;
        const double      t_s = flight_time_s(s, world);
        if (e->target && t_s >= next_look_s - 1e-9) {
            if (look(&sight, e, missile, s, t_s)) put_in_line(&line, &sight);
            next_look_s += e->sight_every_s > 0 ? e->sight_every_s : h;
        }
        flight_command(&command, missile, world, s, newest(&line, t_s, e->sight_late_s));
        r.verdict = command.verdict;
        if (command.verdict == FLIGHT_GUIDED) r.guided++;
        else r.coasted++;
        if (!flight_step(s, missile, world, &command)) {
            r.end = FLIGHT_END_LOST;
            break;
        }
        take_extremes(&r, s);
        leg_of(&leg, &before, s);
        double after_s;
        if (e->ground && plane_crossing(&after_s, r.p_ecef, h, &leg, e->on_ecef, e->normal_ecef)) {
            r.end = FLIGHT_END_GROUND;
            r.t_s = t_s + after_s;
        }
        if (e->target) {
            target_at(target.p0_ecef, target.v0_ecef_mps, e, t_s);
            target_at(target.p1_ecef, target.v1_ecef_mps, e, flight_time_s(s, world));
            miss_step(&r.miss, t_s, h, &leg, &target, missile->fuze_m);
            double away[3];
            v3_sub(away, s->p_ecef, target.p1_ecef);
            const double range_m = v3_length(away);
            if (r.miss.fuzed && range_m > r.miss.least_m) r.end = FLIGHT_END_FUZE;
            else if (range_m > r.miss.least_m + passed_m) r.end = FLIGHT_END_PASSED;
        }
        if (r.end != FLIGHT_END_UNTIL && r.end != FLIGHT_END_LIFE) break;
    }
    if (r.end != FLIGHT_END_GROUND) {
        r.t_s = flight_time_s(s, world);
        memcpy(r.p_ecef, s->p_ecef, sizeof r.p_ecef);
    }
    *out = r;
}
