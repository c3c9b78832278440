/* The notes by which a live node's missile flies again, its operator's datagrams, and what others are told of it. */
#include "tests/entities/flight_fixture.h"

#include "sensor/node/flight/flight_note.h"
#include "sensor/node/flight/flight_report.h"
#include "sensor/node/flight/operator_sight.h"

#include <arpa/inet.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <unistd.h>

static FlightNote some_note(void)
{
    FlightNote   note = {.taken_s = 1371.4000000000001, .after = true};
    FlightSight *s = &note.usable.sight;
    note.usable.from_s = 1371.5;
    s->t_s = 1371.3;
    for (int k = 0; k < 3; k++) {
        s->eye_ecef[k] = 4e6 + 1.0 / (k + 3), s->eye_v_ecef_mps[k] = -100.1 * k;
        s->los_ecef[k] = 1 / sqrt(3), s->los_rate_ecef_rps[k] = NAN, s->target_a_ecef_mps2[k] = NAN;
    }
    s->range_m = 0.1, s->closing_mps = NAN;
    return note;
}

static void notes_come_back_to_the_bit(void **state)
{
    (void)state;
    char             text[2 * flight_note_size + 100], *at = text;
    const FlightNote want = some_note(), launch = {.launch = true, .tick = 1371200};
    FlightNote      *got;
    int              count;
    flight_note_text(at, &launch);
    at += strlen(at);
    at += sprintf(at, "\npitviper: no radar in frame 3 at 1.000000 s\n");
    flight_note_text(at, &want);
    CHECK(flight_notes_read(&got, &count, text) == STATUS_OK);
    CHECK(count == 2 && got[0].launch && got[0].tick == 1371200);
    CHECK(!got[1].launch && got[1].after && got[1].taken_s == want.taken_s &&
          got[1].usable.from_s == want.usable.from_s);
    CHECK(memcmp(got[1].usable.sight.eye_ecef, want.usable.sight.eye_ecef, 9 * sizeof(double)) == 0);
    CHECK(got[1].usable.sight.range_m == 0.1 && isnan(got[1].usable.sight.closing_mps));
    for (int k = 0; k < 3; k++)
        CHECK(isnan(got[1].usable.sight.los_rate_ecef_rps[k]) && isnan(got[1].usable.sight.target_a_ecef_mps2[k]));
    free(got);
    CHECK(flight_notes_read(&got, &count, NULL) == STATUS_OK && count == 0 && !got);
}

static void what_is_no_note_is_passed_over(void **state)
{
    (void)state;
    static const char *const wrong[] = {"pitviper: missile launched at 5", "pitviper: missile launched at 05 ms",
                                        "pitviper: missile launched at 99999999999999999999 ms",
                                        "pitviper: sight before 1", "pitviper: sight"};
    char                     text[flight_note_size];
    FlightNote               note = some_note(), got;
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) CHECK(!flight_note_read(&got, wrong[i]));
    flight_note_text(text, &note);
    CHECK(flight_note_read(&got, text));
    text[strlen(text) - 1] = 0; /* an n of nan less */
    CHECK(!flight_note_read(&got, text));
    note.usable.sight.eye_ecef[0] = 1e12;
    flight_note_text(text, &note);
    CHECK(!flight_note_read(&got, text));
}

static Status parse(OperatorAim *out, const char *line)
{
    return operator_aim_parse(out, (const uint8_t *)line, strlen(line));
}

static void an_aim_is_a_line(void **state)
{
    (void)state;
    static const char *const wrong[] = {
        "",           "aim",           "aim 1 2",      "aim 1 2 91",          "aim 1 361 0",
        "aim -1 2 3", "aim 1 nan 3",   "aim 1 2 3 go", "aim 1 2 3  ",         "aim  1 2 3",
        "Aim 1 2 3",  "aim 1 2 3\n\n", "aim 1.5 2 3",  "aim 1 2 3 launch now"};
    OperatorAim aim;
    CHECK(parse(&aim, "aim 7 90 -30\n") == STATUS_OK && aim.number == 7 && !aim.launch);
    CHECK_NEAR(aim.azimuth_rad, 1.5707963267948966, 1e-15);
    CHECK_NEAR(aim.elevation_rad, -0.52359877559829882, 1e-15);
    CHECK(parse(&aim, "aim 8 0 0 launch") == STATUS_OK && aim.launch);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) CHECK(parse(&aim, wrong[i]) == STATUS_BAD_VALUE);
    CHECK(aim.number == 8);
}

/* Where the equator meets Greenwich, east is y, north is z, up is x. */
static void an_aim_is_of_the_level_at_the_missile(void **state)
{
    (void)state;
    const double p[3] = {6378137 + 500, 0, 0};
    double       los[3];
    OperatorAim  aim = {.azimuth_rad = 0.5, .elevation_rad = 0.2};
    CHECK(operator_direction(los, &aim, p));
    CHECK_NEAR(los[0], sin(0.2), 1e-12);
    CHECK_NEAR(los[1], cos(0.2) * sin(0.5), 1e-12);
    CHECK_NEAR(los[2], cos(0.2) * cos(0.5), 1e-12);
}

static void say(int from, int port, const char *text)
{
    const struct sockaddr_in to = {
        .sin_family = AF_INET, .sin_port = htons((uint16_t)port), .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    CHECK(sendto(from, text, strlen(text), 0, (const struct sockaddr *)&to, sizeof to) == (ssize_t)strlen(text));
}

static void the_newest_aim_counts_and_no_press_is_lost(void **state)
{
    (void)state;
    OperatorSight *sight = NULL;
    OperatorAim    aim;
    int            port = 21000 + (int)(getpid() % 9000);
    const int      from = socket(AF_INET, SOCK_DGRAM, 0);
    log_set_level((LogLevel)(LOG_ERROR + 1));
    while (operator_sight_open(&sight, port) != STATUS_OK) port++;
    CHECK(!operator_sight_newest(&aim, sight));
    say(from, port, "aim 1 10 0 launch");
    say(from, port, "aim 3 30 0");
    say(from, port, "aim 2 20 0"); /* old */
    say(from, port, "garbage");
    CHECK(operator_sight_newest(&aim, sight));
    CHECK(aim.number == 3 && aim.launch);
    CHECK(!operator_sight_newest(&aim, sight));
    operator_sight_close(sight);
    operator_sight_close(NULL);
    close(from);
}

/* ---- what others are told ------------------------------------------------------------------------------ */

typedef struct Told {
    int    fires, states, bursts;
    double last_s;
    DisPdu pdu;
    double worst_m; /* of dead reckoning, at ticks, by the formula alone */
    double said_s;
} Told;

static uint32_t no_stamp(void *user, double t_s)
{
    (void)user, (void)t_s;
    return 0;
}

static void hear(void *user, double t_s, const uint8_t *pdu, size_t octets)
{
    Told *told = user;
    CHECK(octets > 0 && dis_decode(&told->pdu, pdu, octets) == STATUS_OK);
    CHECK(t_s >= told->last_s);
    told->last_s = t_s;
    told->fires += told->pdu.type == dis_pdu_fire;
    told->bursts += told->pdu.type == dis_pdu_detonation;
    if (told->pdu.type == dis_pdu_entity_state) told->states++, told->said_s = t_s;
}

static bool no_ground(double on[3], double normal[3], void *user, const double p[3])
{
    (void)on, (void)normal, (void)user, (void)p;
    return false;
}

/* At every tick of a flight that turns, a receiver that knows FVW has it within the threshold; Fire first, then the
 * Detonation, once, and last the state that deactivates. */
static void reports_keep_dead_reckoning_within_the_threshold(void **state)
{
    (void)state;
    static const double threshold_m = 0.4;
    const LocalFrame    frame = place_at(47, 13, 900);
    const double        target[3] = {300, 2000, -400}, v[3] = {40, 5, 0}, a[3] = {0};
    Missile             m;
    Told                told = {.last_s = -1};
    FlightLoop         *l = calloc(1, sizeof *l);
    FlightReport        report = {.of = {.version = 7,
                                         .exercise = 1,
                                         .threshold_m = threshold_m,
                                         .threshold_rad = 0.05,
                                         .heartbeat_s = 5,
                                         .user = &told,
                                         .stamp = no_stamp,
                                         .send = hear}};
    row_of_etc(&m, "ir_ag");
    m.fuze_m = 2;
    Engagement e = engagement_of(&frame, &m, 4, -5, target, v, a);
    CHECK(l != NULL);
    l->missile = m;
    l->id = (DisEntityId){1, 2, 3};
    l->launch_tick = 2000;
    memcpy(l->p_ecef, e.p_ecef, sizeof l->p_ecef);
    memcpy(l->v_ecef_mps, e.v_ecef_mps, sizeof l->v_ecef_mps);
    CHECK(flight_loop_begin(l) == STATUS_OK);
    const LoopScene scene = {.ground_at = no_ground};
    for (int tick = 200; !l->ended && tick < 4000; tick++) {
        const double t_s = tick / 100.0;
        double       at[3];
        v3_add_scaled(at, e.target_ecef, t_s - 2, e.target_v_ecef_mps);
        flight_loop_tick(l, &scene, t_s, at);
        flight_report_tick(&report, l, &scene, t_s);
        if (l->ended || l->miss.fuzed) continue;
        CHECK(told.pdu.type == dis_pdu_entity_state);
        const DisEntityState *es = &told.pdu.entity_state;
        const double          dt = t_s - told.said_s;
        double                off[3];
        for (int k = 0; k < 3; k++)
            off[k] = es->p_ecef[k] + dt * es->velocity_mps[k] + 0.5 * dt * dt * es->acceleration_mps2[k] -
                     l->state.p_ecef[k];
        told.worst_m = fmax(told.worst_m, v3_length(off));
        l->eye = (LoopCamera){.t_s = t_s, .target_known = true};
        memcpy(l->eye.p_ecef, l->state.p_ecef, sizeof l->eye.p_ecef);
        memcpy(l->eye.v_ecef_mps, l->state.v_ecef_mps, sizeof l->eye.v_ecef_mps);
        memcpy(l->eye.target_ecef, at, sizeof at);
        memcpy(l->eye.target_v_ecef_mps, e.target_v_ecef_mps, sizeof at);
        loop_sights_frame(l, tick); /* by truth */
    }
    CHECK(l->ended && l->hit);
    CHECK(told.worst_m < threshold_m && told.worst_m > 0.5 * threshold_m);
    CHECK(told.fires == 1 && told.bursts == 1 && told.states > 4 && told.states < 100);
    CHECK(told.pdu.type == dis_pdu_entity_state && told.pdu.entity_state.appearance >> 23 & 1);
    const int states = told.states;
    flight_report_tick(&report, l, &scene, 50);
    CHECK(told.states == states); /* nothing after the end */
    flight_loop_free(l);
    free(l);
}

/* Echoes: the strongest within the gate about the boresight, with its range; none far off. */
static void the_strongest_echo_in_the_gate_is_followed(void **state)
{
    (void)state;
    FlightLoop    *l = calloc(1, sizeof *l);
    const LoopEcho weak = {{sin(0.001), 0, cos(0.001)}, 900, 300, 10};
    const LoopEcho strong = {{-sin(0.002), 0, cos(0.002)}, 800, 310, 20};
    const LoopEcho aside = {{sin(0.04), 0, cos(0.04)}, 700, 320, 90}, all[] = {weak, strong, aside};
    CHECK(l != NULL);
    l->source = LOOP_RADAR;
    l->memory = 0.5;
    CHECK(flight_loop_begin(l) == STATUS_OK);
    l->eye = (LoopCamera){.t_s = 3, .p_ecef = {6.4e6, 0, 0}, .v_ecef_mps = {0, 0, 300}};
    l->eye.view.width = 96, l->eye.view.height = 64, l->eye.view.focal_px = view_focal_px(96, 3 * rad_per_deg);
    m3_identity(l->eye.r_ecef_from_cam);
    loop_sights_echoes(l, NULL, 0);
    loop_sights_echoes(l, &aside, 1);
    CHECK(l->verdicts[LOOP_EMPTY] == 1 && l->verdicts[LOOP_OUTSIDE] == 1 && !loop_sights_at(l, 9));
    loop_sights_echoes(l, all, 3);
    const FlightSight *s = loop_sights_at(l, 9);
    CHECK(s && s->range_m == 800 && s->closing_mps == 310 && s->t_s == 3);
    CHECK_NEAR(s->los_ecef[0], -sin(0.002), 1e-9);
    flight_loop_free(l);
    free(l);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {cmocka_unit_test(notes_come_back_to_the_bit),
                                              cmocka_unit_test(what_is_no_note_is_passed_over),
                                              cmocka_unit_test(an_aim_is_a_line),
                                              cmocka_unit_test(an_aim_is_of_the_level_at_the_missile),
                                              cmocka_unit_test(the_newest_aim_counts_and_no_press_is_lost),
                                              cmocka_unit_test(reports_keep_dead_reckoning_within_the_threshold),
                                              cmocka_unit_test(the_strongest_echo_in_the_gate_is_followed)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
