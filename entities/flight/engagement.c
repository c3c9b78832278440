/* entities/flight/engagement.c: the loop of sight, command and step, until something ends it. */
#include "entities/flight/engagement.h"

#include "entities/flight/sight_filter.h"

/* Range beyond the closest approach at which nothing more is awaited. */
static const double passed_m = 50;

const char *flight_end_name(FlightEnd end)
{
    static const char *const name[flight_end_count] = {"until", "life", "fuze", "passed", "ground", "lost"};
    return name[end];
}

/* An engagement as it is flown. */
typedef struct Course {
    const Engagement  *e;
    const Missile     *missile;
    const FlightWorld *world;
    EngagementScene    scene;
} Course;

static void target_at(double p[3], double v[3], double a[3], const Course *c, double t_s)
{
    const Engagement *e = c->e;
    if (c->scene.target_at) {
        c->scene.target_at(p, v, a, c->scene.user, t_s);
        return;
    }
    const double age_s = t_s - (double)e->tick * c->world->step_s;
    for (int k = 0; k < 3; k++) {
        a[k] = e->target_a_ecef_mps2[k];
        v[k] = e->target_v_ecef_mps[k] + age_s * a[k];
        p[k] = e->target_ecef[k] + age_s * (e->target_v_ecef_mps[k] + 0.5 * age_s * a[k]);
    }
}

/* Measures: from the missile, or from the launcher. */
static bool look(FlightSight *out, const Course *c, const FlightState *state, double t_s)
{
    double eye[3], eye_mps[3] = {0}, p[3], v[3], a[3];
    target_at(p, v, a, c, t_s);
    v3_add(p, p, c->e->aim_ecef);
    memcpy(eye, c->e->p_ecef, sizeof eye);
    if (c->missile->guidance != MISSILE_COMMAND) {
        memcpy(eye, state->p_ecef, sizeof eye);
        memcpy(eye_mps, state->v_ecef_mps, sizeof eye_mps);
    } else if (c->scene.launcher_at) {
        c->scene.launcher_at(eye, eye_mps, c->scene.user, t_s);
    }
    if (!flight_sight_true(out, t_s, eye, eye_mps, p, v, a)) return false;
    if (!c->e->ranged) out->range_m = out->closing_mps = NAN;
    return true;
}

/* Turns a direction by the noise of the measurement of that number. */
static void add_noise(double los[3], const Engagement *e, uint64_t number)
{
    const double other[3] = {fabs(los[2]) > 0.9, 0, fabs(los[2]) <= 0.9};
    double       aside[3], above[3];
    v3_cross(aside, los, other);
    v3_normalize(aside, aside);
    v3_cross(above, aside, los);
    v3_add_scaled(los, los, e->noise_rad * random_normal(e->noise_seed, e->noise_stream, 0, number), aside);
    v3_add_scaled(los, los, e->noise_rad * random_normal(e->noise_seed, e->noise_stream, 1, number), above);
    v3_normalize(los, los);
}

/* A measurement as the filter has it. False: none that guides. */
static bool measure(FlightSight *sight, SightFilter *filter, const Engagement *e)
{
    double eye[3], eye_mps[3];
    if (!(e->filter_memory > 0)) return true;
    add_noise(sight->los_ecef, e, (uint64_t)filter->count);
    if (!sight_filter_take(filter, sight->t_s, sight->los_ecef)) return false;
    memcpy(eye, sight->eye_ecef, sizeof eye);
    memcpy(eye_mps, sight->eye_v_ecef_mps, sizeof eye_mps);
    sight_filter_sight(sight, filter, eye, eye_mps);
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

/* Whether the ground, or the plane, was met in this step: when and where. */
static bool meets_ground(double *after_s, double p_ecef[3], const Course *c, const MissLeg *leg)
{
    double on[3], normal[3];
    if (c->scene.ground_at) c->scene.ground_at(on, normal, c->scene.user, leg->p1_ecef);
    else if (!c->e->ground) return false;
    else memcpy(on, c->e->on_ecef, sizeof on), memcpy(normal, c->e->normal_ecef, sizeof normal);
    return plane_crossing(after_s, p_ecef, c->world->step_s, leg, on, normal);
}

/* Looks when it is time to, commands, and takes a step. */
static bool advance(EngagementResult *r, Line *line, SightFilter *filter, double *next_look_s, const Course *c)
{
    FlightState  *s = &r->state;
    FlightCommand command;
    FlightSight   sight;
    const double  t_s = flight_time_s(s, c->world);
    if (c->e->target && t_s >= *next_look_s - 1e-9) {
        if (look(&sight, c, s, t_s) && measure(&sight, filter, c->e)) put_in_line(line, &sight);
        *next_look_s += c->e->sight_every_s > 0 ? c->e->sight_every_s : c->world->step_s;
    }
    flight_command(&command, c->missile, c->world, s, newest(line, t_s, c->e->sight_late_s));
    r->verdict = command.verdict;
    if (command.verdict == FLIGHT_GUIDED) r->guided++;
    else r->coasted++;
    return flight_step(s, c->missile, c->world, &command);
}

void engagement_fly(EngagementResult *out, const Engagement *e, const Missile *missile, const FlightWorld *world)
{
    const Course     c = {e, missile, world, e->scene ? *e->scene : (EngagementScene){0}};
    EngagementResult r = {.miss = miss_begin()};
    FlightState     *s = &r.state;
    Line             line = {.first = 0};
    SightFilter      filter = sight_filter(e->filter_memory);
    MissLeg          leg, target;
    FlightSight      sight;
    double           none[3], next_look_s = (double)e->tick * world->step_s;
    const double     h = world->step_s;
    const int64_t    last = e->tick + (int64_t)round(fmin(e->until_s, missile->life_s) / h);
    flight_launch(s, missile, world, e->tick, e->p_ecef, e->v_ecef_mps);
    if (e->target) {
        if (look(&sight, &c, s, next_look_s)) flight_lock(s, missile, sight.los_ecef);
        target_at(target.p1_ecef, target.v1_ecef_mps, none, &c, next_look_s);
    }
    take_extremes(&r, s);
    if (c.scene.seen) c.scene.seen(c.scene.user, s);
    r.end = e->until_s <= missile->life_s ? FLIGHT_END_UNTIL : FLIGHT_END_LIFE;
    while (s->tick < last && (r.end == FLIGHT_END_UNTIL || r.end == FLIGHT_END_LIFE)) {
        const FlightState before = *s;
        const double      t_s = flight_time_s(s, world);
        double            after_s;
        if (!advance(&r, &line, &filter, &next_look_s, &c)) {
            r.end = FLIGHT_END_LOST;
            break;
        }
        take_extremes(&r, s);
        if (c.scene.seen) c.scene.seen(c.scene.user, s);
        leg_of(&leg, &before, s);
        if (meets_ground(&after_s, r.p_ecef, &c, &leg)) {
            r.end = FLIGHT_END_GROUND;
            r.t_s = t_s + after_s;
        }
        if (!e->target) continue;
        memcpy(target.p0_ecef, target.p1_ecef, sizeof target.p0_ecef);
        memcpy(target.v0_ecef_mps, target.v1_ecef_mps, sizeof target.v0_ecef_mps);
        target_at(target.p1_ecef, target.v1_ecef_mps, none, &c, flight_time_s(s, world));
        miss_step(&r.miss, t_s, h, &leg, &target, missile->fuze_m);
        double away[3];
        v3_sub(away, s->p_ecef, target.p1_ecef);
        const double range_m = v3_length(away);
        if (r.miss.fuzed && range_m > r.miss.least_m) r.end = FLIGHT_END_FUZE;
        else if (r.end != FLIGHT_END_GROUND && range_m > r.miss.least_m + passed_m) r.end = FLIGHT_END_PASSED;
    }
    if (r.end != FLIGHT_END_GROUND) {
        r.t_s = flight_time_s(s, world);
        memcpy(r.p_ecef, s->p_ecef, sizeof r.p_ecef);
    }
    *out = r;
}
