/* Why a live node is silent: each reason from counters written down here, and what is said of a story on paper. */
#include "tests/check.h"

#include "dis/pdu/decode.h"
#include "sensor/node/live/health.h"

#include <errno.h>

static const HealthNames names = {.where = "239.1.2.3 port 3000",
                                  .to = "255.255.255.255 port 3000",
                                  .exercise = 7,
                                  .site = 4711,
                                  .application = 1,
                                  .host = "1:2:3"};

/* A node that began at 100 s and has heard nothing. */
static HealthSample silent_at(double now_s)
{
    Health h;
    health_begin(&h, 100);
    h.sample.now_s = now_s;
    return h.sample;
}

static HealthReason judge(HealthTopic topic, HealthSample s) { return health_evaluate(topic, &s); }

static void what_is_heard(void **state)
{
    (void)state;
    HealthSample s = silent_at(109.9);
    CHECK(judge(HEALTH_RECEIVE, s) == HEALTH_FINE);
    s.now_s = 110;
    CHECK(judge(HEALTH_RECEIVE, s) == HEALTH_NOTHING);
    s.junk = 1;
    CHECK(judge(HEALTH_RECEIVE, s) == HEALTH_NOTHING); /* that was long ago */
    s.any_s = 101;
    CHECK(judge(HEALTH_RECEIVE, s) == HEALTH_JUNK);
    s.now_s = 105;
    CHECK(judge(HEALTH_RECEIVE, s) == HEALTH_JUNK);
    s.now_s = 104.9; /* a heartbeat may be to come */
    CHECK(judge(HEALTH_RECEIVE, s) == HEALTH_FINE);
    s.now_s = 105;
    s.junk = 0;
    s.own = 3;
    CHECK(judge(HEALTH_RECEIVE, s) == HEALTH_OWN);
    s.junk = 1; /* others, too */
    CHECK(judge(HEALTH_RECEIVE, s) == HEALTH_JUNK);
    s.other[9] = 1;
    CHECK(judge(HEALTH_RECEIVE, s) == HEALTH_OTHER_EXERCISE);
    s.pdus = 1;
    CHECK(judge(HEALTH_RECEIVE, s) == HEALTH_NO_ENTITY);
    s.usable = 1;
    s.usable_s = 101;
    CHECK(judge(HEALTH_RECEIVE, s) == HEALTH_FINE);
    s.away = true;
    CHECK(judge(HEALTH_RECEIVE, s) == HEALTH_AWAY);
    /* an entity at rest may report once a minute: as long as the table holds it, it is heard */
    s.away = false;
    s.now_s = 150;
    s.rendering = true;
    s.entities = 1;
    CHECK(judge(HEALTH_RECEIVE, s) == HEALTH_FINE);
    s.entities = 0;
    CHECK(judge(HEALTH_RECEIVE, s) == HEALTH_NOTHING);
    s.any_s = 149;
    CHECK(judge(HEALTH_RECEIVE, s) == HEALTH_NO_ENTITY);
}

static void what_is_shown(void **state)
{
    (void)state;
    HealthSample s = silent_at(200);
    s.host = HEALTH_MUNITION;
    s.missing = 10;
    CHECK(judge(HEALTH_RENDER, s) == HEALTH_FINE); /* nothing is chosen yet */
    s.rendering = true;
    CHECK(judge(HEALTH_RENDER, s) == HEALTH_NO_MUNITION);
    s.frames = 1;
    CHECK(judge(HEALTH_RENDER, s) == HEALTH_MUNITION_GONE);
    s.host = HEALTH_BY_ID;
    CHECK(judge(HEALTH_RENDER, s) == HEALTH_HOST_GONE);
    s.frames = 0;
    CHECK(judge(HEALTH_RENDER, s) == HEALTH_NO_HOST);
    s.host = HEALTH_OBSERVER; /* is always there */
    CHECK(judge(HEALTH_RENDER, s) == HEALTH_FINE);
    /* frames are made */
    s.frames = 50;
    s.missing = 0;
    s.frame_s = 200;
    s.others = 4;
    s.in_view_s = s.visible_s = 191;
    CHECK(judge(HEALTH_RENDER, s) == HEALTH_FINE);
    s.visible_s = 190;
    CHECK(judge(HEALTH_RENDER, s) == HEALTH_HIDDEN);
    s.in_view_s = 190;
    CHECK(judge(HEALTH_RENDER, s) == HEALTH_NO_VIEW);
    s.others = 0;
    CHECK(judge(HEALTH_RENDER, s) == HEALTH_NO_TRAFFIC);
}

static void what_is_sent_lost_and_late(void **state)
{
    (void)state;
    HealthSample s = silent_at(200);
    s.unsent = 5;
    s.failing_s = 199;
    CHECK(judge(HEALTH_SEND, s) == HEALTH_FINE); /* nothing is to be sent */
    s.publishes = true;
    CHECK(judge(HEALTH_SEND, s) == HEALTH_NOT_SENT);
    s.failing_s = 199.5;
    CHECK(judge(HEALTH_SEND, s) == HEALTH_FINE);
    CHECK(judge(HEALTH_LOSS, s) == HEALTH_FINE && judge(HEALTH_PACE, s) == HEALTH_FINE);
    s.lost_s = 150;
    CHECK(judge(HEALTH_LOSS, s) == HEALTH_LOST && judge(HEALTH_PACE, s) == HEALTH_FINE);
    s.late_s = 150;
    CHECK(judge(HEALTH_PACE, s) == HEALTH_LATE);
    s.now_s = 210;
    CHECK(judge(HEALTH_LOSS, s) == HEALTH_FINE && judge(HEALTH_PACE, s) == HEALTH_FINE);
}

static void why_there_was_no_frame_at_all(void **state)
{
    (void)state;
    HealthSample s = silent_at(100.5); /* however short it was */
    CHECK(health_final(&s) == HEALTH_NOTHING);
    s.other[3] = 2;
    CHECK(health_final(&s) == HEALTH_OTHER_EXERCISE);
    s.usable = 1;
    CHECK(health_final(&s) == HEALTH_EARLY);
    s.rendering = true;
    s.host = HEALTH_MUNITION;
    CHECK(health_final(&s) == HEALTH_EARLY);
    s.missing = 1;
    CHECK(health_final(&s) == HEALTH_NO_MUNITION);
    s.away = true;
    CHECK(health_final(&s) == HEALTH_AWAY);
}

/* Each names a key, an option or a command that helps, and fits. */
static void every_reason_has_a_next_step(void **state)
{
    (void)state;
    HealthSample s = silent_at(1e6);
    char         text[health_text_size];
    s.error = ENETUNREACH;
    for (int e = 0; e < 256; e++) s.other[e] = UINT64_MAX;
    s.junk = s.own = s.pdus = UINT64_MAX;
    for (int r = HEALTH_FINE + 1; r <= HEALTH_EARLY; r++) {
        health_text(text, (HealthReason)r, &s, &names);
        CHECK(strlen(text) < health_text_size - 1 && *health_name((HealthReason)r));
        CHECK(strstr(text, "--") || strchr(text, '`') || strchr(text, '.'));
    }
    health_text(text, HEALTH_FINE, &s, &names);
    CHECK(*text == 0 && *health_name(HEALTH_FINE) == 0);
    memset(s.other, 0, sizeof s.other);
    s.other[9] = 4, s.other[2] = 14, s.other[0] = 1;
    health_text(text, HEALTH_OTHER_EXERCISE, &s, &names);
    CHECK(strstr(text, "2 (14 PDUs), 9 (4), 0 (1); this node hears exercise 7: --set exercise.exercise=2 "));
    health_text(text, HEALTH_NOT_SENT, &s, &names);
    CHECK(strstr(text, "255.255.255.255 port 3000: Network is unreachable; no route"));
    s.error = EPERM;
    health_text(text, HEALTH_NOT_SENT, &s, &names);
    CHECK(strstr(text, "firewall"));
}

/* ---- a story -------------------------------------------------------------------------------------------- */

static char     lines[64][health_text_size];
static LogLevel levels[64];
static int      said;

static void listen(void *user, LogLevel level, const char *line)
{
    (void)user;
    CHECK(said < 64);
    levels[said] = level;
    snprintf(lines[said++], health_text_size, "%s", line);
}

static void hear(Health *h, int exercise, double now_s)
{
    uint8_t        octets[256];
    DisEntityState pdu = {
        .header = {.version = 7, .exercise = (uint8_t)exercise, .type = dis_pdu_entity_state, .family = 1},
        .id = {10, 20, 30},
        .p_ecef = {6378137, 0, 0}};
    DisDatagram datagram = {.bytes = octets};
    datagram.octets = (uint32_t)dis_encode_entity_state(octets, sizeof octets, &pdu);
    health_received(h, &datagram, 7, true, now_s);
}

static void show(Health *h, double now_s)
{
    h->sample.frames++;
    h->sample.missing = 0;
    h->sample.frame_s = h->sample.in_view_s = h->sample.visible_s = now_s;
}

/* Nothing of it while no sender exceeds its rate. */
static void the_line_counts_what_is_over_the_rate(void **state)
{
    (void)state;
    Health h;
    char   line[health_line_size];
    health_begin(&h, 0);
    health_line(line, &h, &(HealthPace){5, 5, NULL, NAN, ""});
    CHECK(strstr(line, "over rate") == NULL);
    h.sample.over_rate = 1234;
    health_line(line, &h, &(HealthPace){5, 5, NULL, NAN, ""});
    CHECK(strstr(line, "  1234 over rate") != NULL);
}

static void the_line_says_what_is_kept_and_given_up(void **state)
{
    (void)state;
    Health h;
    char   line[health_line_size];
    health_begin(&h, 0);
    h.sample.entities = 12;
    health_line(line, &h, &(HealthPace){4.9, 5, "checkerboard", 0.034, ""});
    assert_string_equal(line, "12 entities  kept 4.9 of 5 frames/s  checkerboard  0 late  34 ms  0 lost");
    health_line(line, &h, &(HealthPace){4.9, 5, NULL, 0.034, ""});
    assert_string_equal(line, "12 entities  kept 4.9 of 5 frames/s  0 late  34 ms  0 lost");
    health_line(line, &h, &(HealthPace){0, 0, NULL, NAN, ""}); /* it listens: no rate yet */
    assert_string_equal(line, "12 entities  0 late  0 lost");
}

/* A frame that lacks a band that was asked for is not kept. */
static void kept_are_frames_with_all_bands(void **state)
{
    (void)state;
    LiveCounters c = {.frames_late = 2};
    CHECK(record_live_kept_share(&c, 8) == 0.8);
    c.frames_lacking = 4;
    CHECK(record_live_kept_share(&c, 8) == 0.4);
}

static void each_change_is_said_once(void **state)
{
    (void)state;
    Health       h;
    LiveCounters c = {0};
    said = 0;
    log_set_sink(listen, NULL);
    health_begin(&h, 0);
    h.sample.publishes = true;
    h.sample.error = ENETUNREACH;
    for (int tenth = 0; tenth < 3000; tenth++) { /* five minutes */
        const double now_s = 0.1 * tenth;
        if (now_s >= 20 && now_s < 40 && tenth % 10 == 0) hear(&h, 3, now_s);
        if (now_s >= 40 && now_s < 100 && tenth % 10 == 0) hear(&h, 7, now_s), hear(&h, 3, now_s);
        if (tenth == 450) health_rendering(&h, now_s);
        h.sample.entities = now_s >= 40 && now_s < 112;
        if (now_s >= 45 && now_s < 112) show(&h, now_s);
        if (now_s >= 50 && now_s < 60) c.send_failed++;
        if (now_s >= 60 && now_s < 70) c.sent++;
        if (now_s >= 70 && now_s < 75) c.lost_queue++;
        health_check(&h, &c, &names, now_s);
    }
    log_set_sink(NULL, NULL);
    static const char *const want[] = {
        "nothing heard on 239.1.2.3 port 3000 for 10 s",    "only other exercises are heard",
        "nothing can be sent to 255.255.255.255 port 3000", "sending to 255",
        "datagrams lost: in the kernel 0, in the queue 1",  "nothing heard"};
    CHECK(said == sizeof want / sizeof *want);
    for (int i = 0; i < said; i++) CHECK(strstr(lines[i], want[i]) && (levels[i] == LOG_WARN) == (i != 3));
}

/* A reason that comes and goes each second does not fill a log. */
static void what_flickers_is_said_once_a_minute(void **state)
{
    (void)state;
    Health       h;
    LiveCounters c = {0};
    said = 0;
    log_set_sink(listen, NULL);
    health_begin(&h, 0);
    health_rendering(&h, 0);
    h.sample.host = HEALTH_MUNITION;
    for (int s = 0; s < 600; s++) {
        const bool there = s / 6 % 2 == 0; /* six seconds in turn */
        h.sample.entities = 1;
        h.sample.missing += !there;
        if (there) show(&h, s);
        health_check(&h, &c, &names, s);
    }
    log_set_sink(NULL, NULL);
    CHECK(said == 10);
}

static void malformed_and_other_pdus_are_told_apart(void **state)
{
    (void)state;
    static const uint8_t word[] = "hello, this is no DIS at all";
    static const uint8_t comment[32] = {7, 7, 22, 5, 0, 0, 0, 0, 0, 32, 0, 0, 0, 1, 0, 1};
    Health               h;
    health_begin(&h, 0);
    health_received(&h, &(DisDatagram){.bytes = word, .octets = sizeof word}, 7, true, 1);
    health_received(&h, &(DisDatagram){.bytes = word, .octets = 0}, 7, true, 1);
    health_received(&h, &(DisDatagram){.bytes = comment, .octets = sizeof comment}, 7, true, 1);
    CHECK(h.sample.junk == 2 && h.sample.pdus == 1 && h.sample.type == 22 && h.sample.usable == 0);
    hear(&h, 9, 2);
    CHECK(h.sample.other[9] == 1 && h.sample.usable == 0 && h.sample.usable_s == 0);
    hear(&h, 7, 3);
    CHECK(h.sample.usable == 1 && h.sample.usable_s == 3 && h.sample.junk == 0 && h.sample.other[9] == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_heard),
        cmocka_unit_test(what_is_shown),
        cmocka_unit_test(what_is_sent_lost_and_late),
        cmocka_unit_test(why_there_was_no_frame_at_all),
        cmocka_unit_test(every_reason_has_a_next_step),
        cmocka_unit_test(the_line_counts_what_is_over_the_rate),
        cmocka_unit_test(the_line_says_what_is_kept_and_given_up),
        cmocka_unit_test(kept_are_frames_with_all_bands),
        cmocka_unit_test(each_change_is_said_once),
        cmocka_unit_test(what_flickers_is_said_once_a_minute),
        cmocka_unit_test(malformed_and_other_pdus_are_told_apart),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
