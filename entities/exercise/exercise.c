/* entities/exercise/exercise.c: the simulator of an exercise: when each entity reports, shoots and is hit. */
#include "entities/exercise/exercise_private.h"

#include "dis/pdu/pdu.h"
#include "dis/clock/exercise_clock.h"
#include "dis/pdu/decode.h"

#include <stdlib.h>

/* What the last report of an entity said, as rounded in the PDU. */
typedef struct Said {
    bool        known, gone;
    double      t_s;
    uint32_t    appearance;
    int         joints;
    JointReport joint[cast_max_joints];
    Kinematics  k; /* kinematics in the axes of its algorithm */
} Said;

typedef struct Event {
    double t_s;
    int    round;
    bool   ends;
} Event;

struct Exercise {
    const Cast          *cast;
    ExerciseLink         link;
    long long            tick, last_tick;
    double               tick_s;
    long long            bad; /* number of bad PDUs sent so far */
    int                  event_count, next_event, heard;
    Event               *event;
    long long           *look; /* [entity_count] tick of each entity's next check */
    Said                *said;
    DisEntityState       es;
    DisEntityStateUpdate esu;
    DisDetonation        detonation;
    uint8_t              bytes[8192];
};

static int compare_events(const void *a, const void *b)
{
    const Event *x = a, *y = b;
    if (x->t_s != y->t_s) return x->t_s < y->t_s ? -1 : 1;
    if (x->round != y->round) return x->round < y->round ? -1 : 1;
    return (int)x->ends - (int)y->ends;
}

static DisEntityId id_of(const Exercise *x, int entity)
{
    const Scenario *s = x->cast->scenario;
    if (entity < 0) return (DisEntityId){0, 0, 0};
    return (DisEntityId){(uint16_t)s->dis.site, (uint16_t)s->dis.application, x->cast->entity[entity].number};
}

/* ---- an entity's state -------------------------------------------------------------------------- */

/* World axes into those of the algorithm: 6 .. 9 have body axes, and their acceleration is the derivative of the
 * velocity there, a - w x v. 1 is static. */
static void into_axes(Kinematics *k, int algorithm)
{
    k->algorithm = algorithm;
    if (!dead_reckoning_in_body_axes(algorithm)) return;
    double v[3], a[3], turn[3];
    m3_tmul_v3(v, k->r_ecef_from_body, k->v_mps);
    m3_tmul_v3(a, k->r_ecef_from_body, k->a_mps2);
    v3_cross(turn, k->w_body_rps, v);
    v3_sub(k->a_mps2, a, turn);
    memcpy(k->v_mps, v, sizeof v);
}

void exercise_fill_state(DisEntityState *es, const ExerciseLink *link, const Cast *cast, int entity,
                         const Kinematics *k, uint32_t appearance, double t_s)
{
    const CastEntity *e = &cast->entity[entity];
    Kinematics        said = *k;
    double            psi_rad, theta_rad, phi_rad;
    into_axes(&said, e->algorithm);
    es->header = link_header(link, dis_pdu_entity_state, 1, t_s);
    es->id = (DisEntityId){(uint16_t)cast->scenario->dis.site, (uint16_t)cast->scenario->dis.application, e->number};
    es->force = e->force;
    es->variable_count = 0;
    es->type = es->alternative_type = e->type;
    es->appearance = appearance;
    es->dead_reckoning = e->algorithm;
    es->marking_set = 1; /* ASCII */
    es->capabilities = 0;
    memset(es->dead_reckoning_other, 0, sizeof es->dead_reckoning_other);
    cast_marking(es->marking, cast, entity);
    euler_from_r_ecef_from_body(&psi_rad, &theta_rad, &phi_rad, k->r_ecef_from_body);
    es->psi_rad = (float)psi_rad;
    es->theta_rad = (float)theta_rad;
    es->phi_rad = (float)phi_rad;
    for (int i = 0; i < 3; i++) {
        es->p_ecef[i] = k->p_ecef[i];
        es->velocity_mps[i] = (float)said.v_mps[i];
        es->acceleration_mps2[i] = (float)said.a_mps2[i];
        es->angular_rate_rps[i] = (float)said.w_body_rps[i];
    }
}

/* Writes the records of joints: for each the angle, then its rate. A gun is attached to the first part. */
static int joint_records(DisVariableParameter *record, const JointReport *joint, int count)
{
    for (int i = 0; i < count; i++)
        for (int rate = 0; rate < 2; rate++)
            record[2 * i + rate] = (DisVariableParameter){.record_type = dis_variable_articulated,
                                                          .attached_to = (uint16_t)(i > 0),
                                                          .parameter = joint[i].parameter + rate,
                                                          .value = rate ? joint[i].rate : joint[i].value};
    return 2 * count;
}

static void send_state(Exercise *x, int entity, const Kinematics *k, uint32_t appearance, bool whole, double t_s)
{
    DisEntityState *es = &x->es;
    Said           *said = &x->said[entity];
    size_t          octets;
    exercise_fill_state(es, &x->link, x->cast, entity, k, appearance, t_s);
    said->joints = cast_joints(said->joint, x->cast, entity, t_s);
    es->variable_count = (uint8_t)joint_records(es->variable, said->joint, said->joints);
    if (whole) {
        octets = dis_encode_entity_state(x->bytes, sizeof x->bytes, es);
        said->k.algorithm = es->dead_reckoning;
        for (int i = 0; i < 3; i++) {
            said->k.a_mps2[i] = es->acceleration_mps2[i];
            said->k.w_body_rps[i] = es->angular_rate_rps[i];
        }
    } else { /* acceleration and rates stay those of the last Entity State */
        DisEntityStateUpdate *esu = &x->esu;
        esu->header = es->header;
        esu->header.type = dis_pdu_entity_state_update;
        esu->id = es->id;
        esu->variable_count = es->variable_count;
        esu->psi_rad = es->psi_rad, esu->theta_rad = es->theta_rad, esu->phi_rad = es->phi_rad;
        esu->appearance = appearance;
        memcpy(esu->velocity_mps, es->velocity_mps, sizeof esu->velocity_mps);
        memcpy(esu->p_ecef, es->p_ecef, sizeof esu->p_ecef);
        memcpy(esu->variable, es->variable, es->variable_count * sizeof *es->variable);
        octets = dis_encode_entity_state_update(x->bytes, sizeof x->bytes, esu);
    }
    link_pdu(&x->link, t_s, x->bytes, octets);
    for (int i = 0; i < 3; i++) {
        said->k.p_ecef[i] = es->p_ecef[i];
        said->k.v_mps[i] = es->velocity_mps[i];
    }
    r_ecef_from_body_euler(said->k.r_ecef_from_body, es->psi_rad, es->theta_rad, es->phi_rad);
    if (!said->known) x->heard++;
    said->known = true;
    said->t_s = t_s;
    said->appearance = appearance;
}

/* ---- when to report ----------------------------------------------------------------------------- */

/* Time until e + r t + b t^2 / 2 reaches the limit; a fifth less, since b is an estimate. */
static double safe_s(double limit, double error, double rate, double bend)
{
    const double left = limit - error;
    if (left <= 0) return 0;
    return 0.8 * 2 * left / (rate + sqrt(rate * rate + 2 * bend * left));
}

/* Whether the last report exceeds a threshold by now, and when to check again if not. */
static bool wrong(double *again_s, const Exercise *x, const Said *said, const Kinematics *truth,
                  const JointReport *joint, int joints, double age_s)
{
    const Scenario *s = x->cast->scenario;
    const double    threshold_rad = s->dis.threshold_deg * rad_per_deg;
    Motion          believed;
    double          off[3], pace[3], turn[9], spin[3] = {0};
    dead_reckon(&believed, &said->k, age_s);
    v3_sub(off, believed.p_ecef, truth->p_ecef);
    v3_sub(pace, believed.v_ecef_mps, truth->v_mps);
    const double off_m = v3_length(off);
    m3_tmul(turn, believed.r_ecef_from_body, truth->r_ecef_from_body);
    /* a small angle follows from the skew part, a large one from the trace, since arc cosine loses its digits near 1 */
    const double skew[3] = {turn[7] - turn[5], turn[2] - turn[6], turn[3] - turn[1]};
    const double angle_rad = atan2(0.5 * v3_length(skew), 0.5 * (turn[0] + turn[4] + turn[8] - 1));
    if (!(off_m < s->dis.threshold_m) || !(angle_rad < threshold_rad)) return true;

    /* both can change by their accelerations, with a margin */
    const double turned_mps2 =
        dead_reckoning_in_body_axes(said->k.algorithm) ? v3_length(said->k.w_body_rps) * v3_length(said->k.v_mps) : 0;
    const double bend_mps2 = v3_length(truth->a_mps2) + v3_length(said->k.a_mps2) + turned_mps2 + 0.3;
    if (dead_reckoning_turns(said->k.algorithm)) v3_sub(spin, truth->w_body_rps, said->k.w_body_rps);
    else memcpy(spin, truth->w_body_rps, sizeof spin);
    const double spin_rps = v3_length(spin), bend_rps2 = 0.3 + spin_rps * spin_rps;
    *again_s = fmin(safe_s(s->dis.threshold_m, off_m, v3_length(pace), bend_mps2),
                    safe_s(threshold_rad, angle_rad, spin_rps, bend_rps2));
    for (int i = 0; i < joints && i < said->joints; i++) {
        const double error = fabs(said->joint[i].value + said->joint[i].rate * age_s - joint[i].value);
        if (!(error < threshold_rad)) return true;
        *again_s = fmin(*again_s, safe_s(threshold_rad, error, fabs((double)said->joint[i].rate - joint[i].rate), 0.6));
    }
    return false;
}

static long long ticks_until(const Exercise *x, double t_s) /* the first at or after t_s */
{
    return t_s > 1e9 ? INT64_MAX / 4 : (long long)ceil(t_s / x->tick_s - 1e-6);
}

static void send_removal(Exercise *x, int entity, double t_s)
{
    DisRemoveEntity pdu = {.header = link_header(&x->link, dis_pdu_remove_entity, 5, t_s),
                           .originating = id_of(x, entity),
                           .receiving = id_of(x, entity),
                           .request = (uint32_t)entity + 2};
    pdu.originating.entity = 0;
    link_pdu(&x->link, t_s, x->bytes, dis_encode_remove_entity(x->bytes, sizeof x->bytes, &pdu));
}

static void leave(Exercise *x, int entity, double t_s)
{
    Said *said = &x->said[entity];
    x->look[entity] = INT64_MAX;
    if (!said->known || said->gone) return;
    said->gone = true;
    const CastEntity *e = &x->cast->entity[entity];
    if (e->group < 0) return; /* a munition ends by its Detonation */
    const enum ScenarioLeaves how = x->cast->scenario->group[e->group].leaves;
    Kinematics                k;
    if (how == SCENARIO_LEAVES_REMOVED) send_removal(x, entity, t_s);
    if (how != SCENARIO_LEAVES_DEACTIVATED) return;
    cast_kinematics(&k, x->cast, entity, t_s);
    send_state(x, entity, &k, said->appearance | 1u << dis_appearance_deactivated_bit, true, t_s);
}

static bool said_still(const Kinematics *k)
{
    return k->algorithm == 1 || v3_length(k->v_mps) + v3_length(k->a_mps2) + v3_length(k->w_body_rps) < 1e-6;
}

/* Whether acceleration and rates of the last Entity State, which an update keeps, would cause an error above a
 * threshold at once. */
static bool outdated(const Said *said, const Cast *cast, int entity, const Kinematics *k)
{
    static const double unfelt_mps2 = 1, unfelt_rps = 0.1;
    Kinematics          now = *k;
    double              a[3], w[3];
    into_axes(&now, cast->entity[entity].algorithm);
    v3_sub(a, now.a_mps2, said->k.a_mps2);
    v3_sub(w, now.w_body_rps, said->k.w_body_rps);
    return v3_length(a) > unfelt_mps2 || v3_length(w) > unfelt_rps;
}

static void look_at(Exercise *x, int entity, double t_s)
{
    static const double longest_look_s = 1; /* a check follows within this time, in case the bend was underestimated */
    const Scenario     *s = x->cast->scenario;
    Said               *said = &x->said[entity];
    const double        change_s = cast_next_change(x->cast, entity, t_s + 0.5 * x->tick_s), age_s = t_s - said->t_s;
    if (!cast_present(x->cast, entity, t_s)) {
        if (said->known || !isfinite(change_s)) leave(x, entity, t_s);
        else x->look[entity] = ticks_until(x, change_s);
        return;
    }
    const uint32_t appearance = cast_appearance(x->cast, entity, t_s);
    const bool     beats = said->known && age_s >= s->dis.heartbeat_s - 0.5 * x->tick_s;
    bool           sends = !said->known || beats || appearance != said->appearance;
    double         again_s = 0;
    Kinematics     k;
    JointReport    joint[cast_max_joints];
    int            joints = 0;
    cast_kinematics(&k, x->cast, entity, t_s);
    if (!sends) {
        joints = cast_joints(joint, x->cast, entity, t_s);
        sends = wrong(&again_s, x, said, &k, joint, joints, age_s);
    }
    if (sends) {
        const bool whole = !said->known || beats || !s->dis.updates || outdated(said, x->cast, entity, &k);
        send_state(x, entity, &k, appearance, whole, t_s);
        if (wrong(&again_s, x, said, &k, said->joint, said->joints, 0)) again_s = 0;
    }
    if (cast_is_flown(x->cast, entity)) again_s = 0; /* its motor and guidance change what no bound foresees */
    const double beat_s = said->t_s + s->dis.heartbeat_s;
    double       next_s = t_s + fmin(again_s, longest_look_s);
    if (said->joints == 0 && said_still(&said->k) && cast_still(x->cast, entity, t_s)) next_s = beat_s;
    const long long next = ticks_until(x, fmin(fmin(next_s, beat_s - 0.5 * x->tick_s), change_s));
    x->look[entity] = next > x->tick ? next : x->tick + 1;
}

/* ---- shots --------------------------------------------------------------------------------------- */

static void shot_kinematics(Kinematics *out, const Cast *cast, const CastRound *round, double t_s)
{
    static const double h_s = 0.005;
    const double       *r = cast->ground.frame.r_ecef_from_enu;
    CastPose            at, before, after;
    double              v_enu[3];
    cast_munition_pose(&at, cast, round, t_s);
    cast_munition_pose(&before, cast, round, t_s - h_s);
    cast_munition_pose(&after, cast, round, t_s + h_s);
    for (int i = 0; i < 3; i++) v_enu[i] = (after.p_enu[i] - before.p_enu[i]) / (2 * h_s);
    m3_mul_v3(out->v_mps, r, v_enu);
    ecef_from_enu(out->p_ecef, &cast->ground.frame, at.p_enu);
}

static DisDescriptor descriptor_of(const CastRound *round)
{
    return (DisDescriptor){round->type, 1000, 1000, 1, 0}; /* high explosive, contact fuse */
}

static DisEventId event_of(const Exercise *x, const CastRound *round)
{
    const Scenario *s = x->cast->scenario;
    return (DisEventId){(uint16_t)s->dis.site, (uint16_t)s->dis.application, (uint16_t)(round - x->cast->round + 1)};
}

static void send_fire(Exercise *x, const CastRound *round)
{
    const double t_s = round->fire_s;
    double       line[3];
    Kinematics   k;
    shot_kinematics(&k, x->cast, round, t_s);
    v3_sub(line, round->impact_enu, round->launch_enu);
    DisFire pdu = {.header = link_header(&x->link, dis_pdu_fire, 2, t_s),
                   .firing = id_of(x, round->shooter),
                   .target = id_of(x, round->target),
                   .munition = id_of(x, round->munition),
                   .event = event_of(x, round),
                   .descriptor = descriptor_of(round),
                   .range_m = (float)v3_length(line)};
    for (int i = 0; i < 3; i++) pdu.p_ecef[i] = k.p_ecef[i], pdu.velocity_mps[i] = (float)k.v_mps[i];
    link_pdu(&x->link, t_s, x->bytes, dis_encode_fire(x->bytes, sizeof x->bytes, &pdu));
}

static void send_detonation(Exercise *x, const CastRound *round)
{
    const Cast    *cast = x->cast;
    const double   t_s = round->impact_s;
    DisDetonation *pdu = &x->detonation;
    Kinematics     k, target;
    shot_kinematics(&k, cast, round, t_s);
    ecef_from_enu(k.p_ecef, &cast->ground.frame, round->impact_enu);
    pdu->header = link_header(&x->link, dis_pdu_detonation, 2, t_s);
    pdu->firing = id_of(x, round->shooter);
    const int target_of = round->result == dis_result_entity_impact ? round->target : -1;
    pdu->target = id_of(x, target_of);
    pdu->munition = id_of(x, round->munition);
    pdu->event = event_of(x, round);
    pdu->descriptor = descriptor_of(round);
    pdu->result = (uint8_t)round->result;
    memset(pdu->p_target_m, 0, sizeof pdu->p_target_m);
    for (int i = 0; i < 3; i++) pdu->p_ecef[i] = k.p_ecef[i], pdu->velocity_mps[i] = (float)k.v_mps[i];
    if (target_of >= 0) {
        double off[3], off_body[3];
        cast_kinematics(&target, cast, target_of, t_s);
        v3_sub(off, k.p_ecef, target.p_ecef);
        m3_tmul_v3(off_body, target.r_ecef_from_body, off);
        for (int i = 0; i < 3; i++) pdu->p_target_m[i] = (float)off_body[i];
        x->look[target_of] = 0; /* its damage appears at this tick */
    }
    link_pdu(&x->link, t_s, x->bytes, dis_encode_detonation(x->bytes, sizeof x->bytes, pdu));
    if (round->munition >= 0 && !(cast->scenario->shot[round->shot].silent_s > 0) && x->said[round->munition].known) {
        cast_kinematics(&k, cast, round->munition, t_s);
        send_state(x, round->munition, &k, 1u << dis_appearance_deactivated_bit, true, t_s);
    }
}

static void send_events(Exercise *x, double until_s)
{
    for (; x->next_event < x->event_count && x->event[x->next_event].t_s <= until_s; x->next_event++) {
        const CastRound *round = &x->cast->round[x->event[x->next_event].round];
        if (x->event[x->next_event].ends) send_detonation(x, round);
        else send_fire(x, round);
    }
}

/* ---- time steps ---------------------------------------------------------------------------------- */

static void send_start(Exercise *x)
{
    const Scenario *s = x->cast->scenario;
    double          clock_s;
    if (!*s->dis.clock || !text_to_unix_s(&clock_s, s->dis.clock)) return;
    const DisClockTime   clock = {(uint32_t)(clock_s / 3600), dis_timestamp(clock_s, true)};
    const DisStartResume start = {.header = link_header(&x->link, dis_pdu_start_resume, 5, 0),
                                  .originating = {(uint16_t)s->dis.site, (uint16_t)s->dis.application, 0},
                                  .receiving = {65535, 65535, 65535},
                                  .real_world = clock,
                                  .simulation = clock,
                                  .request = 1};
    link_pdu(&x->link, 0, x->bytes, dis_encode_start_resume(x->bytes, sizeof x->bytes, &start));
}

Status exercise_create(Exercise **out, const Cast *cast, double epoch_unix_s, ExerciseSink *sink, void *user)
{
    const Scenario *s = cast->scenario;
    Exercise       *x = calloc(1, sizeof *x);
    if (!x) return STATUS_NO_MEMORY;
    x->cast = cast;
    x->link = (ExerciseLink){.scenario = s, .epoch_unix_s = epoch_unix_s, .sink = sink, .user = user};
    x->event = calloc(2 * (size_t)cast->round_count + 1, sizeof *x->event);
    x->look = calloc((size_t)cast->entity_count + 1, sizeof *x->look);
    x->said = calloc((size_t)cast->entity_count + 1, sizeof *x->said);
    if (!x->event || !x->look || !x->said) {
        exercise_destroy(x);
        return STATUS_NO_MEMORY;
    }
    x->tick_s = 1 / s->dis.rate_hz;
    x->last_tick = (long long)floor(s->duration_s * s->dis.rate_hz + 1e-6);
    for (int i = 0; i < cast->round_count; i++) {
        x->event[x->event_count++] = (Event){cast->round[i].fire_s, i, false};
        x->event[x->event_count++] = (Event){cast->round[i].impact_s, i, true};
    }
    qsort(x->event, (size_t)x->event_count, sizeof *x->event, compare_events);
    for (int i = 0; i < cast->entity_count; i++)
        x->look[i] = cast->entity[i].group < 0 ? 0 : (long long)(i / s->dis.announce_per_s / x->tick_s);
    *out = x;
    return STATUS_OK;
}

void exercise_destroy(Exercise *exercise)
{
    if (!exercise) return;
    free(exercise->event);
    free(exercise->look);
    free(exercise->said);
    free(exercise);
}

double exercise_time(const Exercise *exercise) { return (double)exercise->tick * exercise->tick_s; }

bool exercise_step(Exercise *x)
{
    const Scenario *s = x->cast->scenario;
    const double    t_s = exercise_time(x);
    if (x->tick > x->last_tick || x->link.stopped) {
        exercise_finish(x);
        return false;
    }
    if (x->tick == 0) send_start(x);
    send_events(x, t_s);
    for (int i = 0; i < x->cast->entity_count; i++)
        if (x->look[i] <= x->tick) look_at(x, i, t_s);
    link_flush(&x->link);
    for (; s->faults.bad_every_s > 0 && !x->link.stopped && ((double)x->bad + 0.5) * s->faults.bad_every_s <= t_s;
         x->bad++)
        exercise_send_bad(&x->link, x->cast, &x->es, (int)(x->bad % exercise_bad_kinds), t_s);
    x->tick++;
    return true;
}

void exercise_finish(Exercise *x) { link_finish(&x->link, fmin(exercise_time(x), (double)x->last_tick * x->tick_s)); }

const ExerciseCounts *exercise_counts(const Exercise *exercise) { return &exercise->link.counts; }

int exercise_most_received(const Exercise *exercise) { return exercise->heard; }
