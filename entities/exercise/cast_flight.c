/* entities/exercise/cast_flight.c: shots that fly: entities/flight/ with true sight of the target, over the exercise's
 * ground, kept as samples, so that a munition's pose is a function of time as every other. */
#include "entities/exercise/cast_private.h"

#include "entities/flight/engagement.h"

#include "dis/pdu/decode.h"

#include <stdlib.h>

/* Between samples a cubic of positions and velocities: 10 ms of a jerk that changes by 1e4 m/s4 bend it by 0.3 um. */
enum { sample_ticks = 10 };

struct FlightSample {
    double p_enu[3], v_enu_mps[3], forward_enu[3], down_enu[3];
};

/* What one flight is flown through. */
typedef struct Scene {
    const Cast *cast;
    int         shooter, target; /* entities; target -1: at_ecef */
    double      at_ecef[3];
    CastFlight *out;
    int         room;
    bool        no_memory;
} Scene;

static const double above_base_m = 1.2; /* the aim point, as of shots on a line */

static void target_at(double p_ecef[3], double v_ecef_mps[3], double a_ecef_mps2[3], void *user, double t_s)
{
    const Scene *scene = user;
    if (scene->target < 0) {
        memcpy(p_ecef, scene->at_ecef, 3 * sizeof *p_ecef);
        for (int k = 0; k < 3; k++) v_ecef_mps[k] = a_ecef_mps2[k] = 0;
        return;
    }
    Kinematics k;
    cast_kinematics(&k, scene->cast, scene->target, t_s);
    for (int i = 0; i < 3; i++) {
        p_ecef[i] = k.p_ecef[i] - above_base_m * k.r_ecef_from_body[3 * i + 2];
        v_ecef_mps[i] = k.v_mps[i];
        a_ecef_mps2[i] = k.a_mps2[i];
    }
}

static void launcher_at(double p_ecef[3], double v_ecef_mps[3], void *user, double t_s)
{
    const Scene *scene = user;
    Kinematics   k;
    cast_kinematics(&k, scene->cast, scene->shooter, t_s);
    memcpy(p_ecef, k.p_ecef, sizeof k.p_ecef);
    memcpy(v_ecef_mps, k.v_mps, sizeof k.v_mps);
}

/* The tangent plane of the ground below a point. */
static void ground_at(double on_ecef[3], double normal_ecef[3], void *user, const double p_ecef[3])
{
    const Scene      *scene = user;
    const LocalFrame *frame = &scene->cast->ground.frame;
    double            p[3], slope[2];
    enu_from_ecef(p, frame, p_ecef);
    p[2] = exercise_ground_at(slope, &scene->cast->ground, p[0], p[1]);
    double up[3] = {-slope[0], -slope[1], 1};
    v3_normalize(up, up);
    ecef_from_enu(on_ecef, frame, p);
    m3_mul_v3(normal_ecef, frame->r_ecef_from_enu, up);
}

static void keep_sample(void *user, const FlightState *state)
{
    Scene            *scene = user;
    CastFlight       *f = scene->out;
    const LocalFrame *frame = &scene->cast->ground.frame;
    double            column[3];
    if ((state->tick - state->launch_tick) % sample_ticks != 0 || scene->no_memory) return;
    if (f->samples == scene->room) {
        const int     room = scene->room ? 2 * scene->room : 512;
        FlightSample *more = realloc(f->sample, (size_t)room * sizeof *more);
        scene->no_memory = !more;
        if (!more) return;
        f->sample = more, scene->room = room;
    }
    FlightSample *s = &f->sample[f->samples++];
    enu_from_ecef(s->p_enu, frame, state->p_ecef);
    m3_tmul_v3(s->v_enu_mps, frame->r_ecef_from_enu, state->v_ecef_mps);
    for (int axis = 0; axis < 3; axis += 2) {
        for (int k = 0; k < 3; k++) column[k] = state->r_ecef_from_body[3 * k + axis];
        m3_tmul_v3(axis ? s->down_enu : s->forward_enu, frame->r_ecef_from_enu, column);
    }
}

/* The velocity of a launch is its direction too. What stands or hovers moves slower than this, whichever way. */
static const double least_launch_mps = 1;

/* The direction of launch: to the target, or steeper by the loft's angle; and the speed of the row, which a launcher
 * that is faster already has. */
static void launch_velocity(double v_ecef_mps[3], const Scene *scene, const Missile *m, const double p_ecef[3],
                            double t_s)
{
    double target[3], v[3], a[3], line[3], up[3];
    target_at(target, v, a, (void *)(uintptr_t)scene, t_s);
    launcher_at(line, v_ecef_mps, (void *)(uintptr_t)scene, t_s);
    v3_sub(line, target, p_ecef);
    if (!v3_normalize(line, line)) return;
    if (m->guidance == MISSILE_LOFT) {
        const double z[3] = {0, 0, 1};
        double       level[3];
        m3_mul_v3(up, scene->cast->ground.frame.r_ecef_from_enu, z);
        v3_add_scaled(level, line, -v3_dot(line, up), up);
        if (v3_normalize(level, level)) {
            v3_scale(line, cos(m->loft_rad), level);
            v3_add_scaled(line, line, sin(m->loft_rad), up);
        }
    }
    v3_add_scaled(v_ecef_mps, v_ecef_mps, fmax(0, m->launch_mps - v3_dot(v_ecef_mps, line)), line);
}

/* A point aside of the target that is sighted in its place: two normal numbers a round, across the first line of sight.
 */
static void sight_error(double out_ecef[3], const Cast *cast, int round, const double line_ecef[3], double sigma_m)
{
    const uint64_t seed = (uint64_t)cast->scenario->seed;
    const double   up[3] = {0, 0, 1};
    double         aside[3], above[3], up_ecef[3], line[3];
    for (int k = 0; k < 3; k++) out_ecef[k] = 0;
    m3_mul_v3(up_ecef, cast->ground.frame.r_ecef_from_enu, up);
    v3_cross(aside, line_ecef, up_ecef);
    if (!(sigma_m > 0) || !v3_normalize(line, line_ecef) || !v3_normalize(aside, aside)) return;
    v3_cross(above, aside, line);
    v3_add_scaled(out_ecef, out_ecef, sigma_m * random_normal(seed, 11, (uint32_t)round, 0), aside);
    v3_add_scaled(out_ecef, out_ecef, sigma_m * random_normal(seed, 11, (uint32_t)round, 1), above);
}

/* Where it is at its launch, and nothing more. */
static Status keep_launch(Scene *scene)
{
    const CastFlight *f = scene->out;
    const FlightWorld world = flight_world();
    FlightState       state;
    flight_launch(&state, &f->missile, &world, f->tick, f->p_ecef, f->v_ecef_mps);
    keep_sample(scene, &state);
    return scene->no_memory ? STATUS_NO_MEMORY : STATUS_OK;
}

/* Fired, at its target, and nothing more. */
static Status hold(Cast *cast, CastRound *round, Scene *scene, const double at_enu[3])
{
    if (keep_launch(scene) != STATUS_OK) return STATUS_NO_MEMORY;
    scene->out->held = true;
    round->impact_s = INFINITY;
    round->result = dis_result_none;
    memcpy(round->impact_enu, at_enu, sizeof round->impact_enu);
    round->flight = cast->flight_count++;
    return STATUS_OK;
}

Status cast_hold_until(Cast *cast, int flight, double fire_s)
{
    CastFlight *f = &cast->flight[flight];
    CastRound  *round = &cast->round[f->round];
    Scene       scene = {.cast = cast, .shooter = round->shooter, .target = round->target, .out = f};
    if (!isfinite(fire_s)) {
        round->fire_s = INFINITY;
        return STATUS_OK;
    }
    f->tick = llround(fire_s / flight_world().step_s);
    round->fire_s = (double)f->tick * flight_world().step_s;
    cast_launch_place(round, cast);
    if (round->target < 0) ecef_from_enu(scene.at_ecef, &cast->ground.frame, round->impact_enu);
    ecef_from_enu(f->p_ecef, &cast->ground.frame, round->launch_enu);
    launch_velocity(f->v_ecef_mps, &scene, &f->missile, f->p_ecef, round->fire_s);
    free(f->sample);
    f->sample = NULL;
    f->samples = 0;
    return keep_launch(&scene);
}

Status cast_take_flight(Cast *cast, int flight, const CastFlown *flown)
{
    CastFlight *f = &cast->flight[flight];
    CastRound  *round = &cast->round[f->round];
    Scene       scene = {.cast = cast, .out = f};
    free(f->sample);
    f->sample = NULL;
    f->samples = 0;
    for (int i = 0; i < flown->states; i++) keep_sample(&scene, &flown->state[i]);
    if (scene.no_memory) return STATUS_NO_MEMORY;
    f->held = false;
    f->hit = flown->hit;
    f->end = flown->end;
    f->miss_m = flown->miss_m;
    f->flight_s = flown->impact_s - round->fire_s;
    round->impact_s = flown->impact_s;
    round->result = flown->hit                        ? dis_result_entity_impact
                    : flown->end == FLIGHT_END_GROUND ? dis_result_ground_impact
                                                      : dis_result_none;
    enu_from_ecef(round->impact_enu, &cast->ground.frame, flown->impact_ecef);
    if (flown->hit && round->target >= 0) cast_damage(cast, round);
    return STATUS_OK;
}

Status cast_fly(Cast *cast, CastRound *round, const Missile *row, const double at_enu[3])
{
    const ScenarioShot   *shot = &cast->scenario->shot[round->shot];
    const LocalFrame     *frame = &cast->ground.frame;
    const FlightWorld     world = flight_world();
    const int             number = (int)(round - cast->round);
    CastFlight           *f = &cast->flight[cast->flight_count];
    Missile               m = *row;
    Scene                 scene = {.cast = cast, .shooter = round->shooter, .target = round->target, .out = f};
    const EngagementScene through = {&scene, target_at, launcher_at, ground_at, keep_sample};
    EngagementResult      r;
    double                v[3], a[3], target[3], line[3];
    *f = (CastFlight){.round = number};
    if (cast->held && m.guidance == MISSILE_COMMAND) {
        log_error("scenario: %s:%d: shots: %s is commanded from its launcher and has no seeker, whose frames could "
                  "guide it",
                  cast->scenario->path, shot->line, m.name);
        return STATUS_BAD_VALUE;
    }
    ecef_from_enu(scene.at_ecef, frame, at_enu);
    m.fuze_m = round->target < 0 ? 0 : fmax(m.fuze_m, shot->hit_m);
    Engagement e = {.tick = llround(round->fire_s / world.step_s),
                    .scene = &through,
                    .target = true,
                    .sight_every_s = shot->sight_every_s,
                    .sight_late_s = shot->sight_late_s,
                    .filter_memory = shot->sight_memory,
                    .noise_rad = 1e-3 * shot->sight_noise_mrad,
                    .noise_seed = (uint64_t)cast->scenario->seed,
                    .noise_stream = 0x10000u + (uint32_t)number,
                    .ranged = true,
                    .until_s = INFINITY};
    round->fire_s = (double)e.tick * world.step_s;
    ecef_from_enu(e.p_ecef, frame, round->launch_enu);
    launch_velocity(e.v_ecef_mps, &scene, &m, e.p_ecef, round->fire_s);
    const double speed_mps = v3_length(e.v_ecef_mps);
    if (!(speed_mps >= least_launch_mps)) {
        log_error(
            "scenario: %s:%d: shots: %s leaves its launcher at %.2g m/s, too slow to have a direction; next: a row "
            "of missiles with a launch_mps of at least %g",
            cast->scenario->path, shot->line, m.name, speed_mps, least_launch_mps);
        return STATUS_BAD_VALUE;
    }
    target_at(target, v, a, &scene, round->fire_s);
    v3_sub(line, target, e.p_ecef);
    sight_error(e.aim_ecef, cast, number, line, shot->sight_error_m);
    f->missile = m;
    f->tick = e.tick;
    memcpy(f->p_ecef, e.p_ecef, sizeof f->p_ecef);
    memcpy(f->v_ecef_mps, e.v_ecef_mps, sizeof f->v_ecef_mps);
    if (cast->held) return hold(cast, round, &scene, at_enu);
    engagement_fly(&r, &e, &m, &world);
    if (scene.no_memory) {
        free(f->sample);
        return STATUS_NO_MEMORY;
    }

    const bool    hit = r.miss.fuzed;
    const double *where_ecef = r.p_ecef;
    double        at_ecef[3];
    round->impact_s = r.t_s;
    round->result = r.end == FLIGHT_END_GROUND ? dis_result_ground_impact : dis_result_none;
    if (hit) {
        round->impact_s = r.miss.fuze_t_s;
        round->result = dis_result_entity_impact;
        target_at(at_ecef, v, a, &scene, round->impact_s);
        v3_add(at_ecef, at_ecef, r.miss.fuze_away_ecef);
        where_ecef = at_ecef;
    }
    enu_from_ecef(round->impact_enu, frame, where_ecef);
    f->hit = hit;
    f->end = r.end;
    f->miss_m = r.miss.least_m;
    f->flight_s = round->impact_s - round->fire_s;
    f->end_mps = v3_length(r.state.v_ecef_mps);
    f->most_lateral_mps2 = r.most_lateral_mps2;
    f->guided_share = (double)r.guided / (double)(r.guided + r.coasted > 0 ? r.guided + r.coasted : 1);
    round->flight = cast->flight_count++;
    return STATUS_OK;
}

void cast_flight_pose(CastPose *out, const Cast *cast, const CastRound *round, double t_s)
{
    const CastFlight   *f = &cast->flight[round->flight];
    const double        every_s = sample_ticks * flight_world().step_s, at = (t_s - round->fire_s) / every_s;
    const int           k = (int)clamp(floor(at), 0, f->samples > 1 ? f->samples - 2 : 0);
    const FlightSample *a = &f->sample[k], *b = f->samples > 1 ? a + 1 : a;
    const double        u = at - k;
    double              nose[3], up[3];
    if (u < 0 || u > 1 || a == b) { /* before the launch, after the last sample: straight on */
        const FlightSample *end = u < 0 ? a : b;
        v3_add_scaled(out->p_enu, end->p_enu, every_s * (u < 0 || a == b ? u : u - 1), end->v_enu_mps);
        for (int i = 0; i < 3; i++) nose[i] = end->forward_enu[i], up[i] = -end->down_enu[i];
    } else {
        const double u2 = u * u, u3 = u2 * u;
        for (int i = 0; i < 3; i++) {
            out->p_enu[i] = a->p_enu[i] + (3 * u2 - 2 * u3) * (b->p_enu[i] - a->p_enu[i]) +
                            every_s * ((u3 - 2 * u2 + u) * a->v_enu_mps[i] + (u3 - u2) * b->v_enu_mps[i]);
            nose[i] = (1 - u) * a->forward_enu[i] + u * b->forward_enu[i];
            up[i] = -((1 - u) * a->down_enu[i] + u * b->down_enu[i]);
        }
    }
    cast_axes(out->r_enu_from_body, nose, up);
}
