/* A missile in the loop, without frames: with true sights and with answers that know the target it flies as the
 * engagement does, whose flights another program has judged; which detection is taken; what comes late; the recording.
 */
#include "tests/entities/flight_fixture.h"

#include "sensor/node/flight/flight_loop.h"

#include <stdlib.h>
#include <unistd.h>

static const double every_s = 0.1, late_s = 0.05, memory = 0.5;

static bool no_ground(double on[3], double normal[3], void *user, const double p[3])
{
    (void)on, (void)normal, (void)user, (void)p;
    return false;
}

static Engagement engagement(Missile *m)
{
    static const double target[3] = {300, 3000, -400}, v[3] = {12, 5, 0}, a[3] = {0};
    const LocalFrame    frame = place_at(47, 13, 900);
    row_of_etc(m, "ir_ag");
    m->fuze_m = 2;
    Engagement e = engagement_of(&frame, m, 4, -5, target, v, a);
    e.tick = 2000;
    e.sight_every_s = every_s;
    e.sight_late_s = late_s;
    return e;
}

static FlightLoop *loop_of(const Engagement *e, const Missile *m, LoopSource source)
{
    FlightLoop *l = calloc(1, sizeof *l);
    CHECK(l != NULL);
    l->source = source;
    l->missile = *m;
    l->launch_tick = e->tick;
    memcpy(l->p_ecef, e->p_ecef, sizeof l->p_ecef);
    memcpy(l->v_ecef_mps, e->v_ecef_mps, sizeof l->v_ecef_mps);
    l->late_s = late_s;
    l->memory = memory;
    l->limit_s = l->start_s = 100;
    CHECK(flight_loop_begin(l) == STATUS_OK);
    return l;
}

static void drop(FlightLoop *l)
{
    flight_loop_free(l);
    free(l);
}

static void target_at(double p[3], const Engagement *e, double t_s)
{
    v3_add_scaled(p, e->target_ecef, t_s - 0.001 * (double)e->tick, e->target_v_ecef_mps);
}

/* A camera of 3 degrees and 96 x 64 along the gaze. */
static void look(LoopCamera *c, const FlightLoop *l, const Engagement *e, double t_s)
{
    FlightState  s;
    const double other[3] = {0, 0, 1};
    double       right[3], down[3];
    CHECK(flight_loop_at(&s, l, t_s));
    *c = (LoopCamera){.t_s = t_s, .target_known = true};
    c->view.width = 96, c->view.height = 64;
    c->view.focal_px = view_focal_px(96, 3 * rad_per_deg);
    memcpy(c->p_ecef, s.p_ecef, sizeof c->p_ecef);
    memcpy(c->v_ecef_mps, s.v_ecef_mps, sizeof c->v_ecef_mps);
    v3_cross(right, s.gaze_ecef, other);
    v3_normalize(right, right);
    v3_cross(down, s.gaze_ecef, right);
    for (int k = 0; k < 3; k++) {
        c->r_ecef_from_cam[3 * k] = right[k];
        c->r_ecef_from_cam[3 * k + 1] = down[k];
        c->r_ecef_from_cam[3 * k + 2] = s.gaze_ecef[k];
    }
    target_at(c->target_ecef, e, t_s);
    memcpy(c->target_v_ecef_mps, e->target_v_ecef_mps, sizeof c->target_v_ecef_mps);
}

/* The pinhole's formula, written out. */
static bool project(double px[2], const LoopCamera *c)
{
    double off[3], cam[3];
    v3_sub(off, c->target_ecef, c->p_ecef);
    m3_tmul_v3(cam, c->r_ecef_from_cam, off);
    px[0] = 48 + c->view.focal_px * cam[0] / cam[2];
    px[1] = 32 + c->view.focal_px * cam[1] / cam[2];
    return cam[2] > 0;
}

static AnswerDetection detection_at(double column, double row)
{
    return (AnswerDetection){.box_px = {column - 3, row - 1, column + 3, row + 1}, .point_px = {NAN, NAN}};
}

/* Answers with the target and another 20 pixels beside it, which comes first and is as good. */
static void answer(FlightLoop *l, const LoopCamera *c, int frame)
{
    static Answer a;
    double        px[2];
    a = (Answer){.frame = frame};
    if (!project(px, c)) return;
    a.count = 2;
    a.detection[0] = detection_at(px[0] + 20, px[1]);
    a.detection[1] = detection_at(px[0], px[1]);
    loop_sights_taken(l, &a);
}

static void fly(FlightLoop *l, const Engagement *e)
{
    const LoopScene scene = {.ground_at = no_ground};
    for (int tick = 195, frame = 0; !l->ended && tick < 12000; tick++) {
        const double t_s = tick / 100.0;
        double       target[3];
        if (tick > 200 && tick % 10 == 1) /* as the clock: before anything is flown until the next frame */
            while (!loop_sights_settle(l, (tick + 9) / 100.0)) {
            }
        target_at(target, e, t_s);
        flight_loop_tick(l, &scene, t_s, target);
        if (tick < 200 || tick % 10 != 0 || l->ended) continue;
        look(&l->eye, l, e, t_s);
        loop_sights_frame(l, frame);
        if (l->source == LOOP_ANSWERS) answer(l, &l->eye, frame);
        frame++;
    }
}

static void true_sights_fly_the_engagement(void **state)
{
    (void)state;
    Missile           m;
    EngagementResult  r;
    Engagement        e = engagement(&m);
    const FlightWorld world = flight_world();
    FlightLoop       *l = loop_of(&e, &m, LOOP_TRUE);
    engagement_fly(&r, &e, &m, &world);
    fly(l, &e);
    CHECK(l->ended && l->end == r.end && l->hit);
    CHECK(l->state.tick == r.state.tick);
    for (int k = 0; k < 3; k++) CHECK_NEAR(l->state.p_ecef[k], r.state.p_ecef[k], 1e-5);
    CHECK_NEAR(l->miss.least_m, r.miss.least_m, 1e-5);
    CHECK_NEAR(l->end_s, r.miss.fuze_t_s, 1e-7);
    CHECK(l->guided == r.guided && l->coasted == r.coasted);
    drop(l);
}

/* Directions alone, by the filter: 8 s, until the target is so near that a last frame may have it outside its gate, the
 * flight of answers is that of the engagement's own filter. */
static void answers_fly_the_engagement(void **state)
{
    (void)state;
    Missile           m;
    EngagementResult  r;
    Engagement        e = engagement(&m);
    const FlightWorld world = flight_world();
    FlightLoop       *l = loop_of(&e, &m, LOOP_ANSWERS);
    e.filter_memory = memory;
    e.until_s = 8;
    engagement_fly(&r, &e, &m, &world);
    fly(l, &e);
    CHECK(r.end == FLIGHT_END_UNTIL && l->track_count > 800);
    for (int k = 0; k < 3; k++) CHECK_NEAR(l->track[800].p_ecef[k], r.state.p_ecef[k], 1e-5);
    for (int k = 0; k < 3; k++) CHECK_NEAR(l->track[800].v_ecef_mps[k], r.state.v_ecef_mps[k], 1e-5);
    CHECK(l->ended && l->hit && l->end == FLIGHT_END_FUZE);
    CHECK(l->verdicts[LOOP_NONE] == 0 && l->verdicts[LOOP_EMPTY] == 0);
    CHECK(l->verdicts[LOOP_SEEN] >= l->frames - 3);
    drop(l);
}

/* What is not near where the target is expected is none of it; what comes after its frame is settled is refused. */
static void answers_are_taken_or_refused(void **state)
{
    (void)state;
    Missile       m;
    Engagement    e = engagement(&m);
    FlightLoop   *l = loop_of(&e, &m, LOOP_ANSWERS);
    static Answer a;
    double        target[3];
    l->limit_s = l->start_s = 0.03;
    target_at(target, &e, 2);
    flight_loop_tick(l, &(LoopScene){.ground_at = no_ground}, 2, target);
    for (int frame = 0; frame < 3; frame++) {
        look(&l->eye, l, &e, 2);
        l->eye.t_s = 2 + 0.1 * frame;
        loop_sights_frame(l, frame);
    }
    a = (Answer){.frame = 0, .count = 1};
    a.detection[0] = detection_at(48 + 17, 32); /* further than a sixth of 96 */
    loop_sights_taken(l, &a);
    a = (Answer){.frame = 1};
    loop_sights_taken(l, &a);
    CHECK(loop_sights_settle(l, 2.05)); /* guides then, not before: none is asked for */
    CHECK(l->count == 3);
    while (!loop_sights_settle(l, 9)) {
    }
    CHECK(l->verdicts[LOOP_OUTSIDE] == 1 && l->verdicts[LOOP_EMPTY] == 1 && l->verdicts[LOOP_NONE] == 1);
    CHECK(l->count == 0 && l->usable_count == 0 && l->late == 0);
    a.frame = 2;
    loop_sights_taken(l, &a);
    CHECK(l->late == 1);
    CHECK(loop_sights_at(l, 9) == NULL);
    drop(l);
}

/* More answers than the loop keeps, to frames that were never made, before and after a true one, and again and again to
 * its own: it is taken all the same, and they are counted. */
static void answers_that_were_not_asked_for_take_no_place(void **state)
{
    (void)state;
    enum { many = 3 * loop_waiting_most };
    Missile       m;
    Engagement    e = engagement(&m);
    FlightLoop   *l = loop_of(&e, &m, LOOP_ANSWERS);
    static Answer empty;
    double        target[3];
    target_at(target, &e, 2);
    flight_loop_tick(l, &(LoopScene){.ground_at = no_ground}, 2, target);
    for (int i = 0; i < 2; i++) {
        const int frame = 7 + 3 * i; /* as where frames between were dropped */
        for (int k = 0; k < many; k++) {
            empty = (Answer){.frame = 11 + k};
            loop_sights_taken(l, &empty);
        }
        look(&l->eye, l, &e, 2);
        l->eye.t_s = 2 + 0.1 * i;
        loop_sights_frame(l, frame);
        answer(l, &l->eye, frame);
        for (int k = 0; k < many; k++) {
            empty = (Answer){.frame = k % 2 ? frame : 8};
            loop_sights_taken(l, &empty);
        }
    }
    CHECK(l->unasked == 3 * many && l->late == 0);
    CHECK(loop_sights_settle(l, 9)); /* without a wait */
    CHECK(l->verdicts[LOOP_SEEN] == 2 && l->count == 0);
    flight_loop_next(l); /* answers to the missile before are late, not unasked */
    empty.frame = 10;
    loop_sights_taken(l, &empty);
    CHECK(l->late == 1 && l->unasked == 3 * many);
    drop(l);
}

static void the_recording_is_the_flight(void **state)
{
    (void)state;
    Missile     m;
    char        path[] = "/tmp/pitviper-sights-XXXXXX";
    Engagement  e = engagement(&m);
    FlightLoop *l = loop_of(&e, &m, LOOP_ANSWERS), *again = loop_of(&e, &m, LOOP_RECORDED);
    const int   file = mkstemp(path);
    CHECK(file >= 0);
    close(file);
    fly(l, &e);
    CHECK(loop_sights_write(l, path) == STATUS_OK);
    CHECK(loop_sights_read(again, path) == STATUS_OK);
    unlink(path);
    fly(again, &e);
    CHECK(again->row_count == l->row_count && !again->strange);
    CHECK(again->track_count == l->track_count);
    CHECK(memcmp(again->track[l->track_count - 1].p_ecef, l->track[l->track_count - 1].p_ecef, 3 * sizeof(double)) ==
          0);
    CHECK(again->end_s == l->end_s && again->miss.least_m == l->miss.least_m);
    drop(l);
    drop(again);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(true_sights_fly_the_engagement), cmocka_unit_test(answers_fly_the_engagement),
        cmocka_unit_test(answers_are_taken_or_refused), cmocka_unit_test(answers_that_were_not_asked_for_take_no_place),
        cmocka_unit_test(the_recording_is_the_flight)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
