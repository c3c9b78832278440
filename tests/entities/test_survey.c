/* tests/entities/test_survey.c: tracks, shots and clocks out of logs made here, and out of real ones. */
#include "tests/check.h"
#include "dis/pdu/decode.h"
#include "entities/motion/dead_reckoning.h"
#include "entities/survey/survey.h"

/* ---- a log in memory ---------------------------------------------------------------------- */

enum { log_capacity = 4000 };

typedef struct MadeLog {
    DisLog      log;
    DisDatagram datagram[log_capacity];
    uint8_t     octets[log_capacity * 150];
    size_t      used;
    double      epoch_s; /* capture time of t = 0 */
    bool        absolute;
} MadeLog;

static MadeLog made;

static MadeLog *new_log(double epoch_s)
{
    memset(&made, 0, sizeof made);
    made.log.datagram = made.datagram;
    made.epoch_s = epoch_s;
    return &made;
}

static uint32_t stamp(const MadeLog *m, double t_s)
{
    return (uint32_t)llround(fmod(t_s, 3600) / 3600 * 2147483648.0) << 1 | (m->absolute ? 1 : 0);
}

static DisHeader header(const MadeLog *m, uint8_t type, double t_s)
{
    return (DisHeader){.version = 6, .exercise = 1, .type = type, .timestamp = stamp(m, t_s)};
}

static uint8_t *room(MadeLog *m, double t_s)
{
    CHECK(m->log.count < log_capacity && m->used + 150 <= sizeof m->octets);
    m->datagram[m->log.count] = (DisDatagram){
        .capture_s = m->epoch_s + t_s, .packet = (uint32_t)m->log.count + 1, .bytes = m->octets + m->used};
    return m->octets + m->used;
}

static void filled(MadeLog *m, size_t octets)
{
    CHECK(octets > 0);
    m->datagram[m->log.count++].octets = (uint32_t)octets;
    m->used += octets;
}

static DisEntityId id_of(int entity) { return (DisEntityId){1, 2, (uint16_t)entity}; }

static DisEntityState state_of(int entity, double x_m)
{
    return (DisEntityState){
        .id = id_of(entity), .type = {2, 2, 225, 1, 0, 0, 0}, .dead_reckoning = 4, .p_ecef = {6.4e6 + x_m, 0, 0}};
}

static void say_state(MadeLog *m, double t_s, DisEntityState pdu)
{
    const DisHeader h = header(m, dis_pdu_entity_state, t_s);
    const uint8_t   exercise = pdu.header.exercise;
    pdu.header = h;
    if (exercise) pdu.header.exercise = exercise;
    filled(m, dis_encode_entity_state(room(m, t_s), 150, &pdu));
}

static void say_fire(MadeLog *m, double t_s, int firing, int target, int munition, int event)
{
    DisFire pdu = {.header = header(m, dis_pdu_fire, t_s), .firing = id_of(firing), .event = {1, 2, (uint16_t)event}};
    if (target) pdu.target = id_of(target);
    if (munition) pdu.munition = id_of(munition);
    filled(m, dis_encode_fire(room(m, t_s), 150, &pdu));
}

static void say_detonation(MadeLog *m, double t_s, int firing, int target, int munition, int event, double x_m)
{
    DisDetonation pdu = {.header = header(m, dis_pdu_detonation, t_s),
                         .firing = id_of(firing),
                         .event = {1, 2, (uint16_t)event},
                         .p_ecef = {6.4e6 + x_m, 0, 0},
                         .result = target ? 1 : 3};
    if (target) pdu.target = id_of(target);
    if (munition) pdu.munition = id_of(munition);
    filled(m, dis_encode_detonation(room(m, t_s), 150, &pdu));
}

static Survey survey_of(const MadeLog *m)
{
    Survey s;
    CHECK(survey_log(&s, &m->log, -1) == STATUS_OK);
    return s;
}

/* ---- tracks ------------------------------------------------------------------------------- */

static void tracks_are_sorted_and_in_world_axes(void **state)
{
    (void)state;
    MadeLog       *m = new_log(1.3e9);
    DisEntityState body = state_of(9, 0), world = state_of(3, 0);
    body.dead_reckoning = 8;
    body.psi_rad = 0.5f;
    body.theta_rad = -1;
    body.phi_rad = 2;
    body.velocity_mps[0] = world.velocity_mps[0] = 7;
    memcpy(body.marking, "ABCDEFGHIJK", 11);
    say_state(m, 10, body);
    say_state(m, 11, world);
    say_state(m, 12, body);
    DisEntityStateUpdate update = {.header = header(m, dis_pdu_entity_state_update, 13),
                                   .id = id_of(9),
                                   .p_ecef = {6.4e6, 5, 0},
                                   .velocity_mps = {7, 0, 0},
                                   .psi_rad = 0.5f,
                                   .theta_rad = -1,
                                   .phi_rad = 2};
    filled(m, dis_encode_entity_state_update(room(m, 13), 150, &update));
    update.id = id_of(77); /* never introduced */
    filled(m, dis_encode_entity_state_update(room(m, 13.1), 150, &update));
    say_state(m, 12.5, body); /* late */

    Survey s = survey_of(m);
    CHECK(s.track_count == 2 && s.track[0].id.entity == 3 && s.track[1].id.entity == 9);
    CHECK(!survey_track(&s, id_of(77)) && survey_track(&s, id_of(9)) == s.track + 1);
    const Track *t = s.track + 1;
    CHECK(t->count == 3 && s.late == 1 && strcmp(t->marking, "ABCDEFGHIJK") == 0);
    double r[9];
    r_ecef_from_body_euler(r, 0.5f, -1, 2);
    for (int p = 0; p < 3; p++)
        for (int i = 0; i < 3; i++) CHECK_NEAR(t->point[p].v_ecef_mps[i], 7 * r[3 * i], 1e-12);
    CHECK(s.track[0].point[0].v_ecef_mps[0] == 7 && s.track[0].point[0].v_ecef_mps[1] == 0);
    CHECK_NEAR(t->point[2].t_s - t->point[0].t_s, 3, 1e-5);
    CHECK_NEAR(s.first_s, 10, 1e-5);
    CHECK_NEAR(s.last_s, 13, 1e-5); /* stamped so, though captured later */
    CHECK(s.counters.datagrams == 6 && s.counters.pdus[1] == 4 && s.counters.pdus[67] == 2);
    survey_destroy(&s);
    CHECK(s.track == NULL && s.track_count == 0);
}

static void rubbish_is_counted_and_the_rest_kept(void **state)
{
    (void)state;
    MadeLog       *m = new_log(1.3e9);
    DisEntityState pdu = state_of(1, 0), bad = state_of(2, 0);
    say_state(m, 1, pdu);
    bad.p_ecef[0] = NAN;
    say_state(m, 2, bad);
    bad = state_of(2, -6.4e6);
    say_state(m, 3, bad);
    bad = state_of(2, 0);
    bad.header.exercise = 9;
    say_state(m, 4, bad);
    room(m, 5)[0] = 6; /* one octet */
    filled(m, 1);
    room(m, 6);
    filled(m, 12); /* twelve zeros: version 0 */
    say_detonation(m, 7, 1, 0, 5, 1, -6.4e6);

    Survey s;
    CHECK(survey_log(&s, &m->log, 1) == STATUS_OK);
    CHECK(s.track_count == 1 && s.shot_count == 0);
    CHECK(s.counters.dropped[DIS_DROP_NOT_FINITE] == 1 && s.counters.dropped[DIS_DROP_BAD_POSITION] == 2);
    CHECK(s.counters.dropped[DIS_DROP_OTHER_EXERCISE] == 1 && s.counters.dropped[DIS_DROP_SHORT_HEADER] == 1);
    CHECK(s.counters.dropped[DIS_DROP_BAD_VERSION] == 1);
    CHECK(isfinite(s.datagram_s[0]) && isnan(s.datagram_s[3]) && isnan(s.datagram_s[4]) && isnan(s.datagram_s[5]));
    survey_destroy(&s);

    m = new_log(1.3e9);
    s = survey_of(m);
    CHECK(s.track_count == 0 && s.shot_count == 0 && isnan(s.first_s) && isnan(s.last_s) && s.datagram_s);
    survey_destroy(&s);
}

/* ---- shots -------------------------------------------------------------------------------- */

static void shots_join_by_munition_then_event(void **state)
{
    (void)state;
    MadeLog *m = new_log(1.3e9);
    say_fire(m, 10, 1, 50, 7, 1);
    say_fire(m, 11, 2, 0, 8, 2);
    say_fire(m, 12, 3, 0, 0, 3); /* no munition entity: by event */
    say_detonation(m, 15, 2, 0, 8, 2, 80);
    say_detonation(m, 16, 1, 50, 7, 1, 70);
    say_detonation(m, 16.2, 1, 50, 7, 1, 70); /* heard twice */
    say_detonation(m, 17, 3, 51, 0, 3, 30);
    say_fire(m, 20, 1, 50, 7, 4); /* the id again */
    say_detonation(m, 25, 1, 0, 7, 4, 71);
    say_fire(m, 30, 1, 50, 7, 5);           /* and again, never ended */
    say_detonation(m, 40, 9, 0, 99, 9, 99); /* whose Fire was before the log */

    Survey s = survey_of(m);
    CHECK(s.shot_count == 6);
    static const double fire_s[6] = {10, 11, 12, 20, 30, NAN}, end_s[6] = {16, 15, 17, 25, NAN, 40},
                        x_m[6] = {70, 80, 30, 71, NAN, 99};
    static const int munition[6] = {7, 8, 0, 7, 7, 99}, hit[6] = {50, 0, 51, 0, 0, 0},
                     target[6] = {50, 0, 0, 50, 50, 0};
    for (int i = 0; i < 6; i++) {
        const Shot *shot = s.shot + i;
        CHECK(shot->munition.entity == munition[i] && shot->hit.entity == hit[i] && shot->target.entity == target[i]);
        CHECK(isnan(fire_s[i]) == isnan(shot->fire_s) && isnan(end_s[i]) == isnan(shot->detonation_s));
        if (!isnan(fire_s[i])) CHECK_NEAR(shot->fire_s, fire_s[i], 1e-5);
        if (!isnan(end_s[i])) CHECK_NEAR(shot->detonation_s, end_s[i], 1e-5);
        if (!isnan(end_s[i])) CHECK_NEAR(shot->p_burst_ecef[0], 6.4e6 + x_m[i], 1e-9);
    }
    CHECK(s.shot[0].result == 1 && s.shot[1].result == 3);
    survey_destroy(&s);
}

/* Bursts of one weapon: as many shots as Fires, each with its own end. */
static void many_shots_of_one_id(void **state)
{
    (void)state;
    MadeLog *m = new_log(1.3e9);
    for (int i = 0; i < 500; i++) {
        say_fire(m, 1 + i, 1, 50, 7, 1 + i);
        say_detonation(m, 1.6 + i, 1, 50, 7, 1 + i, i);
    }
    Survey s = survey_of(m);
    CHECK(s.shot_count == 500);
    for (int i = 0; i < 500; i++) {
        CHECK_NEAR(s.shot[i].detonation_s - s.shot[i].fire_s, 0.6, 1e-5);
        CHECK_NEAR(s.shot[i].p_burst_ecef[0], 6.4e6 + i, 1e-9);
    }
    survey_destroy(&s);
}

/* ---- clocks ------------------------------------------------------------------------------- */

static void clocks_tell_the_date(void **state)
{
    (void)state;
    const double date_s = 1371300000; /* 2013-06-15 12:40:00 UTC */
    MadeLog     *m = new_log(date_s - 2400);
    say_state(m, 2400, state_of(1, 0)); /* relative: says nothing of the date */
    Survey s = survey_of(m);
    CHECK(isnan(s.absolute_unix_s) && isnan(s.clock_start_unix_s));
    survey_destroy(&s);

    m->absolute = true;
    m->datagram[0].capture_s += 3; /* the capturing machine is three seconds fast */
    m->epoch_s += 3;
    say_state(m, 2401, state_of(1, 0));
    DisStartResume start = {.header = header(m, dis_pdu_start_resume, 2402),
                            .originating = id_of(1),
                            .receiving = {0xFFFF, 0xFFFF, 0xFFFF}};
    filled(m, dis_encode_start_resume(room(m, 2402), 150, &start)); /* a clock of zero is none */
    start.simulation = (DisClockTime){300000, stamp(m, 1800)};
    filled(m, dis_encode_start_resume(room(m, 2402), 150, &start));
    s = survey_of(m);
    const double t_start_s = s.datagram_s[3];
    CHECK_NEAR(s.clock_start_unix_s + t_start_s, 300000 * 3600.0 + 1800, 1e-5);
    CHECK_NEAR(s.absolute_unix_s + s.datagram_s[1], date_s + 1, 1e-5);
    survey_destroy(&s);

    m = new_log(1e9); /* a date nobody captured anything on: 2001-09-09 01:46:40 exactly */
    m->absolute = true;
    say_state(m, 0, state_of(1, 0));
    say_state(m, 10, state_of(1, 0));
    s = survey_of(m);
    CHECK(isnan(s.absolute_unix_s));
    survey_destroy(&s);
}

/* One absolute stamp among those of two proper senders, 25 minutes off, heard first or amid the others. */
static void one_absurd_stamp_does_not_tell_the_date(void **state)
{
    (void)state;
    const double date_s = 1371300000;
    for (int absurd = -1; absurd < 20; absurd++) { /* -1: none */
        MadeLog *m = new_log(date_s - 2400);
        m->absolute = true;
        for (int i = 0; i < 20; i++) {
            DisEntityState said = state_of(1 + i % 2, 0);
            if (i % 2) said.id.application = 5;
            if (i == absurd) said.id.application = 99;
            say_state(m, 2400 + i, said);
            if (i == absurd) { /* the header's stamp: octets 4 .. 7 */
                const uint32_t wrong = stamp(m, 3900);
                for (int k = 0; k < 4; k++)
                    ((uint8_t *)(uintptr_t)m->datagram[i].bytes)[4 + k] = (uint8_t)(wrong >> (24 - 8 * k));
            }
        }
        Survey s = survey_of(m);
        CHECK(s.absolute_stamps == 20 && s.absolute_left_out == (absurd >= 0));
        CHECK_NEAR(s.absolute_unix_s + s.datagram_s[19], date_s + 19, 1e-5);
        survey_destroy(&s);
    }
    MadeLog *m = new_log(date_s - 2400); /* alone it says nothing */
    m->absolute = true;
    say_state(m, 3900, state_of(1, 0));
    m->datagram[0].capture_s = date_s;
    m->absolute = false;
    for (int i = 0; i < 20; i++) say_state(m, 2400 + i, state_of(2, 0));
    Survey s = survey_of(m);
    CHECK(s.absolute_stamps == 1 && isnan(s.absolute_unix_s));
    survey_destroy(&s);
}

/* A sender of a constant absolute stamp says nothing of the date either, however often. */
static void a_constant_absolute_stamp_does_not_tell_the_date(void **state)
{
    (void)state;
    const double date_s = 1371300000;
    MadeLog     *m = new_log(date_s);
    m->absolute = true;
    for (int i = 0; i < 30; i++) {
        say_state(m, 777, state_of(1, 0));
        m->datagram[i].capture_s = date_s + i;
    }
    Survey s = survey_of(m);
    CHECK(s.absolute_stamps == 1 && isnan(s.absolute_unix_s));
    CHECK(s.doubts.count == 1 && s.doubts.by_arrival == 29 && s.counters.stamps_doubted == 29);
    CHECK_NEAR(s.last_s - s.first_s, 29, 1e-5);
    survey_destroy(&s);
}

/* ---- between reports ---------------------------------------------------------------------- */

static TrackPoint point_at(double t_s, double x_m, double vx_mps)
{
    TrackPoint p = {.t_s = t_s, .p_ecef = {6.4e6 + x_m, 0, 0}, .v_ecef_mps = {vx_mps, 0, 0}};
    return p;
}

/* Constant acceleration is a quadratic, and a cubic with the right ends is exact on it. */
static void constant_acceleration_is_exact(void **state)
{
    (void)state;
    TrackPoint          point[4];
    const Track         track = {.count = 4, .point = point};
    static const double t[4] = {0, 0.7, 2, 5};
    for (int i = 0; i < 4; i++) point[i] = point_at(t[i], 100 * t[i] + 15 * t[i] * t[i], 100 + 30 * t[i]);
    for (double t_s = 0; t_s <= 5; t_s += 0.03) {
        TrackPose pose;
        survey_track_at(&pose, &track, t_s);
        CHECK_NEAR(pose.p_ecef[0], 6.4e6 + 100 * t_s + 15 * t_s * t_s, 3e-9); /* one unit in the last place is 0.9 nm */
        CHECK_NEAR(pose.v_ecef_mps[0], 100 + 30 * t_s, 1e-6);
    }
}

/* A missile's first report has the launcher's speed, another has three times too much, another flies backwards:
 * the path stays between its ends and never turns round. */
static void no_overshoot(void **state)
{
    (void)state;
    static const double v[][2] = {{0, 300}, {28, 200}, {2000, 2000}, {-50, 100}, {0, 0}, {1e4, -1e4}};
    for (size_t n = 0; n < sizeof v / sizeof *v; n++) {
        TrackPoint  point[2] = {point_at(0, 0, v[n][0]), point_at(0.5, 60, v[n][1])};
        const Track track = {.count = 2, .point = point};
        double      last_m = 0;
        for (int k = 0; k <= 100; k++) {
            TrackPose pose;
            survey_track_at(&pose, &track, 0.005 * k);
            const double x_m = pose.p_ecef[0] - 6.4e6;
            CHECK(x_m >= last_m - 1e-8 && x_m <= 60 + 1e-8);
            last_m = x_m;
        }
        CHECK_NEAR(last_m, 60, 1e-8);
    }
}

/* Between which reports a track knows where its entity was: not where a Stop/Freeze that names it came between them,
 * and not between reports within one that lets it report (frozen behaviour, bit 1), until Start/Resume; a report ends
 * any other. Where it does not, it stands at the report before. */
static void a_stop_hides_what_was_between_reports(void **state)
{
    (void)state;
    static const struct {
        DisEntityId named;
        uint8_t     behaviour;
        bool        knows[4]; /* between the reports at 0, 1, 2, 3 and 4 s; the Stop is at 1.5 s, the Start at 2.5 s */
    } c[] = {{{0xFFFF, 0xFFFF, 0xFFFF}, 0, {true, false, true, true}},
             {{0xFFFF, 0xFFFF, 0xFFFF}, 2, {true, false, false, true}},
             {{1, 2, 0}, 1, {true, false, true, true}},
             {{1, 2, 7}, 0, {true, false, true, true}},
             {{1, 2, 8}, 2, {true, true, true, true}},
             {{1, 3, 0}, 2, {true, true, true, true}}};
    for (size_t k = 0; k < sizeof c / sizeof *c; k++) {
        MadeLog            *m = new_log(1e9);
        Survey              survey;
        const DisStopFreeze stop = {
            .header = header(m, dis_pdu_stop_freeze, 1.5), .receiving = c[k].named, .frozen_behaviour = c[k].behaviour};
        const DisStartResume start = {.header = header(m, dis_pdu_start_resume, 2.5),
                                      .receiving = {0xFFFF, 0xFFFF, 0xFFFF}};
        for (int t_s = 0; t_s < 5; t_s++) {
            say_state(m, t_s, state_of(7, 10 * t_s));
            if (t_s == 1) filled(m, dis_encode_stop_freeze(room(m, 1.5), 150, &stop));
            if (t_s == 2) filled(m, dis_encode_start_resume(room(m, 2.5), 150, &start));
        }
        assert_int_equal(survey_log(&survey, &m->log, -1), STATUS_OK);
        const Track *track = survey_track(&survey, id_of(7));
        CHECK(track && track->count == 5 && !survey_track_knows(track, 4.01) && survey_track_knows(track, 4));
        for (int t = 0; t < 4; t++) {
            TrackPose pose;
            CHECK(survey_track_knows(track, t + 0.75) == c[k].knows[t]);
            survey_track_at(&pose, track, t + 0.5);
            CHECK_NEAR(pose.p_ecef[0], 6.4e6 + 10 * t + (c[k].knows[t] ? 5 : 0), 2e-5); /* a stamp's tick is 1.7 us */
        }
        survey_destroy(&survey);
    }
}

static void ends_and_gaps_are_held(void **state)
{
    (void)state;
    TrackPoint point[5] = {point_at(1, 0, 5), point_at(2, 5, 5), point_at(2, 6, 5), point_at(3, 11, 5),
                           point_at(9, 500, 5)};
    point[3].deactivated = true;
    const Track track = {.count = 5, .point = point};
    TrackPose   pose;
    survey_track_at(&pose, &track, -100);
    CHECK(pose.p_ecef[0] == 6.4e6 && pose.v_ecef_mps[0] == 0);
    survey_track_at(&pose, &track, 1);
    CHECK(pose.p_ecef[0] == 6.4e6 && pose.v_ecef_mps[0] == 5);
    survey_track_at(&pose, &track, 2); /* two reports at one time: the later counts */
    CHECK(pose.p_ecef[0] == 6.4e6 + 6);
    survey_track_at(&pose, &track, 6); /* between two lives of one id */
    CHECK(pose.p_ecef[0] == 6.4e6 + 11 && pose.v_ecef_mps[0] == 0);
    survey_track_at(&pose, &track, 100);
    CHECK(pose.p_ecef[0] == 6.4e6 + 500 && pose.v_ecef_mps[0] == 0);
    const Track one = {.count = 1, .point = point};
    survey_track_at(&pose, &one, 7);
    CHECK(pose.p_ecef[0] == 6.4e6);
}

/* The shortest turn at an even rate: of any angle up to a half turn, about any axis, from any attitude. */
static void attitude_turns_evenly(void **state)
{
    (void)state;
    for (int n = 0; n < 500; n++) {
        const double angle = n < 10 ? pow(10, -n) : pi_rad * 0.9999 * random_uniform(5, 1, 0, (uint64_t)n);
        Kinematics   k = {.algorithm = 4};
        double       axis[3] = {random_normal(5, 2, 0, (uint64_t)n), random_normal(5, 3, 0, (uint64_t)n),
                                random_normal(5, 4, 0, (uint64_t)n)};
        CHECK(v3_normalize(axis, axis));
        v3_scale(k.w_body_rps, angle, axis);
        r_ecef_from_body_euler(k.r_ecef_from_body, 6 * axis[1], 3 * axis[2], 6 * axis[0]);
        Motion m;
        double turned[9];
        dead_reckon(&m, &k, 1);
        memcpy(turned, m.r_ecef_from_body, sizeof turned);
        for (double t_s = 0; t_s < 1; t_s += 0.23) {
            TrackPose pose;
            survey_turn(pose.r_ecef_from_body, k.r_ecef_from_body, turned, t_s);
            dead_reckon(&m, &k, t_s);
            for (int i = 0; i < 9; i++)
                CHECK_NEAR(pose.r_ecef_from_body[i], m.r_ecef_from_body[i], 2e-12); /* 1e-4 from the half turn */
        }
    }
}

/* ---- real logs ---------------------------------------------------------------------------- */

static void the_recorded_attack(void **state)
{
    (void)state;
    char   path[512];
    DisLog log;
    Survey s;
    if (!reference_path(path, "dis/vrf-dis5-tow-vs-armor.pcap")) skip();
    CHECK(dis_log_open(&log, path, dis_port) == STATUS_OK);
    CHECK(survey_log(&s, &log, -1) == STATUS_OK);
    CHECK(s.track_count == 22 && s.shot_count == 15 && s.late == 0 && s.refused == 0);
    CHECK_NEAR(s.last_s - s.first_s, 62.075, 0.001);
    CHECK(isnan(s.absolute_unix_s));
    int hits = 0, ground = 0, flying = 0;
    for (int i = 0; i < s.shot_count; i++) {
        const Shot *shot = s.shot + i;
        CHECK(isfinite(shot->fire_s) && shot->munition.entity == 81 + i);
        hits += shot->result == dis_result_entity_impact;
        ground += shot->result == dis_result_ground_impact;
        flying += isnan(shot->detonation_s);
        if (shot->result == dis_result_entity_impact)
            CHECK(shot->hit.entity == (shot->munition.entity == 82 ? 72 : 74));
    }
    CHECK(hits == 3 && ground == 10 && flying == 2);

    const Track *missile = survey_track(&s, (DisEntityId){1, 3001, 82}),
                *tank = survey_track(&s, (DisEntityId){1, 3001, 70});
    CHECK(missile && tank);
    CHECK(missile->point[missile->count - 1].deactivated);
    double way_m = 0;
    for (int p = 1; p < tank->count; p++) {
        double d[3];
        v3_sub(d, tank->point[p].p_ecef, tank->point[p - 1].p_ecef);
        way_m += v3_length(d);
    }
    CHECK_NEAR(way_m, 419, 1);
    /* In flight the path is as fast as the missile. Before that, and at impact where the sender moves it 9 m in half
     * a millisecond, at least the velocity stays one. */
    const double flight_s = missile->point[1].t_s, impact_s = missile->point[missile->count - 3].t_s;
    TrackPose    before, here;
    survey_track_at(&before, missile, flight_s);
    double fastest_mps = 0, slowest_mps = INFINITY, fastest_said_mps = 0;
    for (double t_s = missile->point[0].t_s; t_s < missile->point[missile->count - 1].t_s; t_s += 0.0001) {
        double d[3];
        survey_track_at(&here, missile, t_s);
        fastest_said_mps = fmax(fastest_said_mps, v3_length(here.v_ecef_mps));
        if (t_s < flight_s + 0.0002 || t_s > impact_s) {
            before = here;
            continue;
        }
        v3_sub(d, here.p_ecef, before.p_ecef);
        fastest_mps = fmax(fastest_mps, v3_length(d) / 0.0001);
        slowest_mps = fmin(slowest_mps, v3_length(d) / 0.0001);
        before = here;
    }
    printf("interpolated in flight %.1f .. %.1f m/s, said at most %.1f\n", slowest_mps, fastest_mps, fastest_said_mps);
    CHECK(fastest_mps < 1.1 * 329 && slowest_mps > 0.9 * 329 && fastest_said_mps < 1.1 * 329);
    survey_destroy(&s);
    dis_log_close(&log);
}

static void the_recorded_drives(void **state)
{
    (void)state;
    static const struct {
        const char *file;
        double      way_m, duration_s;
        int         reports;
    } want[2] = {{"dis/vrf-dis7-gaz69-blocks.pcap", 2449, 355.874, 775},
                 {"dis/vrf-dis7-gaz69-straight.pcap", 570, 65.278, 116}};
    for (int n = 0; n < 2; n++) {
        char   path[512];
        DisLog log;
        Survey s;
        if (!reference_path(path, want[n].file)) skip();
        CHECK(dis_log_open(&log, path, dis_port) == STATUS_OK);
        CHECK(survey_log(&s, &log, -1) == STATUS_OK);
        CHECK(s.track_count == 1 && s.shot_count == 0);
        const Track *truck = s.track;
        double       way_m = 0;
        for (int p = 1; p < truck->count; p++) {
            double d[3];
            v3_sub(d, truck->point[p].p_ecef, truck->point[p - 1].p_ecef);
            way_m += v3_length(d);
        }
        printf("%s: %d reports, %llu late, way %.1f m, %.3f s\n", want[n].file, truck->count,
               (unsigned long long)s.late, way_m, s.last_s - s.first_s);
        CHECK(truck->count + (int)s.late == want[n].reports);
        CHECK_NEAR(way_m, want[n].way_m, 1);
        CHECK_NEAR(s.last_s - s.first_s, want[n].duration_s, 1);
        for (int d = 0; d < log.count; d++) CHECK(isfinite(s.datagram_s[d]));
        survey_destroy(&s);
        dis_log_close(&log);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tracks_are_sorted_and_in_world_axes),
        cmocka_unit_test(rubbish_is_counted_and_the_rest_kept),
        cmocka_unit_test(shots_join_by_munition_then_event),
        cmocka_unit_test(many_shots_of_one_id),
        cmocka_unit_test(clocks_tell_the_date),
        cmocka_unit_test(one_absurd_stamp_does_not_tell_the_date),
        cmocka_unit_test(a_constant_absolute_stamp_does_not_tell_the_date),
        cmocka_unit_test(constant_acceleration_is_exact),
        cmocka_unit_test(no_overshoot),
        cmocka_unit_test(ends_and_gaps_are_held),
        cmocka_unit_test(a_stop_hides_what_was_between_reports),
        cmocka_unit_test(attitude_turns_evenly),
        cmocka_unit_test(the_recorded_attack),
        cmocka_unit_test(the_recorded_drives),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
