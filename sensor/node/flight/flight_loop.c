/* sensor/node/flight/flight_loop.c: the missile of the loop: launch, steps, closest approach, what ends the flight. */
#include "sensor/node/flight/flight_loop.h"

#include <stdlib.h>

static const double passed_m = 50; /* range beyond the closest approach at which nothing more is awaited */

Status flight_loop_begin(FlightLoop *l)
{
    pthread_condattr_t how;
    l->world = flight_world();
    l->miss = miss_begin();
    l->filter = sight_filter(l->memory);
    l->settled = -1;
    l->least_from_s = -INFINITY;
    if (pthread_mutex_init(&l->lock, NULL) != 0) return STATUS_NO_MEMORY;
    pthread_condattr_init(&how);
    pthread_condattr_setclock(&how, CLOCK_MONOTONIC);
    const bool made = pthread_cond_init(&l->arrived, &how) == 0;
    pthread_condattr_destroy(&how);
    return made ? STATUS_OK : STATUS_NO_MEMORY;
}

void flight_loop_free(FlightLoop *l)
{
    free(l->track);
    free(l->row);
    pthread_cond_destroy(&l->arrived);
    pthread_mutex_destroy(&l->lock);
}

void flight_loop_next(FlightLoop *l)
{
    static const FlightState at_rest;
    pthread_mutex_lock(&l->lock);
    if (l->count > 0) l->settled = l->waiting[(l->first + l->count - 1) % loop_waiting_most].number;
    l->first = l->count = 0;
    l->late = 0;
    pthread_mutex_unlock(&l->lock);
    l->launched = l->ended = l->hit = l->target_known = false;
    l->state = at_rest;
    l->miss = miss_begin();
    l->most_lateral_mps2 = 0;
    l->guided = l->coasted = 0;
    l->track_count = l->frames = 0;
    l->usable_count = 0;
    l->filter = sight_filter(l->memory);
    memset(l->verdicts, 0, sizeof l->verdicts);
}

/* One step of 1 ms by the sight that guides then. False: it left what is computed. */
static bool step(FlightVerdict *verdict, FlightState *s, const FlightLoop *l)
{
    FlightCommand command;
    flight_command(&command, &l->missile, &l->world, s, loop_sights_at(l, flight_time_s(s, &l->world)));
    *verdict = command.verdict;
    return flight_step(s, &l->missile, &l->world, &command);
}

bool flight_loop_at(FlightState *out, const FlightLoop *l, double t_s)
{
    FlightVerdict verdict;
    if (!l->launched || l->ended) return false;
    *out = l->state;
    while ((double)(out->tick + 1) * l->world.step_s <= t_s + 1e-9)
        if (!step(&verdict, out, l)) return false;
    v3_add_scaled(out->p_ecef, out->p_ecef, t_s - flight_time_s(out, &l->world), out->v_ecef_mps);
    return true;
}

static void keep_state(FlightLoop *l)
{
    if ((l->state.tick - l->launch_tick) % loop_tick_ms != 0) return;
    if (l->track_count == l->track_room) {
        const int    room = l->track_room ? 2 * l->track_room : 1024;
        FlightState *more = realloc(l->track, (size_t)room * sizeof *more);
        l->out_of_memory |= !more;
        if (!more) return;
        l->track = more, l->track_room = room;
    }
    l->track[l->track_count++] = l->state;
}

static void end_at(FlightLoop *l, FlightEnd end, double t_s, const double p_ecef[3])
{
    l->ended = true;
    l->end = end;
    l->end_s = t_s;
    memcpy(l->end_ecef, p_ecef, sizeof l->end_ecef);
}

/* What a step met: the ground, or its closest approach to the target, which moved from a to b. */
static void meet(FlightLoop *l, const LoopScene *scene, const FlightState *before, const double *a, const double *b)
{
    const double h = l->world.step_s, t_s = flight_time_s(before, &l->world);
    MissLeg      leg, target;
    double       on[3], normal[3], after_s, p[3], away[3];
    memcpy(leg.p0_ecef, before->p_ecef, sizeof leg.p0_ecef);
    memcpy(leg.v0_ecef_mps, before->v_ecef_mps, sizeof leg.v0_ecef_mps);
    memcpy(leg.p1_ecef, l->state.p_ecef, sizeof leg.p1_ecef);
    memcpy(leg.v1_ecef_mps, l->state.v_ecef_mps, sizeof leg.v1_ecef_mps);
    if (scene->ground_at(on, normal, scene->user, leg.p1_ecef) && plane_crossing(&after_s, p, h, &leg, on, normal))
        end_at(l, FLIGHT_END_GROUND, t_s + after_s, p);
    if (a && b) {
        for (int k = 0; k < 3; k++) {
            target.p0_ecef[k] = a[k], target.p1_ecef[k] = b[k];
            target.v0_ecef_mps[k] = target.v1_ecef_mps[k] = (b[k] - a[k]) / h;
        }
        miss_step(&l->miss, t_s, h, &leg, &target, l->missile.fuze_m);
        v3_sub(away, l->state.p_ecef, b);
        const double range_m = v3_length(away);
        if (l->miss.fuzed && (range_m > l->miss.least_m || l->ended)) {
            l->hit = true;
            v3_add(p, b, l->miss.fuze_away_ecef); /* the target moves by millimetres until then */
            end_at(l, FLIGHT_END_FUZE, l->miss.fuze_t_s, p);
        } else if (!l->ended && range_m > l->miss.least_m + passed_m) {
            end_at(l, FLIGHT_END_PASSED, t_s + h, l->state.p_ecef);
        }
    }
    if (!l->ended && (double)(l->state.tick - l->launch_tick) * h >= l->missile.life_s)
        end_at(l, FLIGHT_END_LIFE, t_s + h, l->state.p_ecef);
}

static void launch(FlightLoop *l, const double *target_ecef)
{
    double line[3];
    flight_launch(&l->state, &l->missile, &l->world, l->launch_tick, l->p_ecef, l->v_ecef_mps);
    l->launched = true;
    if (target_ecef) {
        v3_sub(line, target_ecef, l->p_ecef);
        if (v3_normalize(line, line)) flight_lock(&l->state, &l->missile, line);
    }
    keep_state(l);
}

void flight_loop_tick(FlightLoop *l, const LoopScene *scene, double t_s, const double target_ecef[3])
{
    const int64_t      tick = llround(t_s / l->world.step_s), from = tick - loop_tick_ms;
    const FlightHooks *hooks = l->hooks;
    if (hooks && hooks->before) hooks->before(hooks->user, t_s);
    if (!l->launched && l->launch_tick <= tick &&
        (!hooks || !hooks->launch || hooks->launch(hooks->user, scene, t_s, target_ecef)))
        launch(l, target_ecef);
    while (l->launched && !l->ended && l->state.tick < tick) {
        const FlightState before = l->state;
        FlightVerdict     verdict;
        double            ends[2][3];
        if (!step(&verdict, &l->state, l)) {
            end_at(l, FLIGHT_END_LOST, flight_time_s(&before, &l->world), before.p_ecef);
            break;
        }
        keep_state(l);
        if (verdict == FLIGHT_GUIDED) l->guided++;
        else l->coasted++;
        l->most_lateral_mps2 = fmax(l->most_lateral_mps2, l->state.lateral_mps2);
        const bool known = target_ecef && l->target_known;
        for (int e = 0; e < 2 && known; e++) /* between two ticks the target moves straight */
            for (int k = 0; k < 3; k++)
                ends[e][k] = l->target_ecef[k] +
                             (target_ecef[k] - l->target_ecef[k]) * (double)(before.tick + e - from) / loop_tick_ms;
        meet(l, scene, &before, known ? ends[0] : NULL, known ? ends[1] : NULL);
    }
    l->target_known = target_ecef != NULL;
    if (target_ecef) memcpy(l->target_ecef, target_ecef, sizeof l->target_ecef);
    if (hooks && hooks->flown && l->launched) hooks->flown(hooks->user, scene, t_s);
}
