/* tests/dis/test_cigi_session.c: the lockstep of a CIGI host and this image generator, with times and datagrams given:
 * what a test over the network (tests/system/test_cigi_host.sh) cannot time. */
#include "tests/check.h"
#include "dis/cigi/cigi_session.h"

static CigiSession s;
static CigiPacket  sent; /* Start of Frame that was sent last */
static double      now_s;

static uint8_t buffer[2048];

static size_t write_control(uint32_t frame, uint32_t stamp, uint8_t mode, uint32_t answers)
{
    const CigiPacket control = {
        .id = cigi_ig_control,
        .of.ig_control = {
            .mode = mode, .timestamp_valid = true, .host_frame = frame, .timestamp = stamp, .last_ig_frame = answers}};
    return cigi_write(buffer, sizeof buffer, &control, CIGI_BIG_ENDIAN);
}

static CigiEvent control(uint32_t frame, uint32_t stamp, uint32_t answers)
{
    return cigi_session_receive(&s, buffer, write_control(frame, stamp, cigi_mode_operate, answers), now_s);
}

/* Whether something is to be sent: a datagram that begins with Start of Frame, in `sent`. */
static bool sends(void)
{
    CigiCounters   counters = {0};
    CigiReader     reader;
    const uint8_t *datagram;
    size_t         octets;
    if (!cigi_session_send(&datagram, &octets, &s)) return false;
    CHECK(octets <= cigi_datagram_octets);
    CHECK(cigi_open(&reader, &sent, &counters, datagram, octets, CIGI_FROM_IG) == STATUS_OK);
    CHECK(!cigi_session_send(&datagram, &octets, &s));
    return true;
}

static void begin(void)
{
    CigiSessionConfig config = cigi_session_default_config();
    config.repeat_s = 0.25;
    config.silent_s = 5;
    now_s = 1000;
    cigi_session_begin(&s, &config, now_s);
    CHECK(sends() && sent.of.start_of_frame.ig_frame == 1 && sent.of.start_of_frame.mode == cigi_mode_standby);
    CHECK(!sent.of.start_of_frame.timestamp_valid && sent.of.start_of_frame.last_host_frame == 0);
}

static void a_frame_is_answered_once(void **state)
{
    (void)state;
    begin();
    CHECK(control(1, 500, 1) == CIGI_DUE && cigi_session_news(&s) == (CIGI_NEWS_FIRST | CIGI_NEWS_MODE));
    CHECK(cigi_session_time_s(&s) == 0.005 && cigi_session_mode(&s) == cigi_mode_operate);
    for (int i = 0; i < 100; i++) { /* while it is made nothing is sent, for however long */
        now_s += 10;
        CHECK(!cigi_session_look(&s, now_s) && !sends());
    }
    cigi_session_delivered(&s, now_s);
    CHECK(sends() && sent.of.start_of_frame.ig_frame == 2 && sent.of.start_of_frame.last_host_frame == 1);
    CHECK(sent.of.start_of_frame.timestamp == 500 && sent.of.start_of_frame.timestamp_valid);
    CHECK(control(2, 600, 2) == CIGI_DUE && cigi_session_news(&s) == 0 && s.events.frames == 2);
}

static void start_of_frame_is_repeated_and_silence_said_once(void **state)
{
    (void)state;
    begin();
    for (int i = 0; i < 100; i++) { /* before a host is heard, none is silent */
        now_s += 0.25;
        CHECK(!cigi_session_look(&s, now_s) && sends() && sent.of.start_of_frame.ig_frame == 1);
    }
    CHECK(control(1, 0, 1) == CIGI_DUE);
    cigi_session_delivered(&s, now_s);
    CHECK(sends());
    int said = 0, again = 0;
    for (int i = 1; i <= 80; i++) {
        now_s += 0.125;
        said += cigi_session_look(&s, now_s);
        again += sends();
        CHECK(said == (i >= 40) && sent.of.start_of_frame.ig_frame == 2);
    }
    CHECK(again == 40 && s.events.silences == 1);
    CHECK(control(2, 0, 2) == CIGI_DUE && cigi_session_news(&s) == CIGI_NEWS_BACK);
}

static void repeats_and_old_frames_make_none(void **state)
{
    (void)state;
    begin();
    CHECK(control(10, 0, 1) == CIGI_DUE);
    CHECK(control(10, 0, 1) == CIGI_REPEATED && !sends()); /* it is being made */
    cigi_session_delivered(&s, now_s);
    CHECK(sends());
    CHECK(control(10, 0, 1) == CIGI_REPEATED && sends() && sent.of.start_of_frame.ig_frame == 2);
    CHECK(control(9, 0, 2) == CIGI_OLD && !sends());
    CHECK(control(14, 0, 2) == CIGI_DUE && cigi_session_news(&s) == CIGI_NEWS_LOST && s.events.lost == 3);
    CHECK(s.events.frames == 2 && s.events.repeated == 2 && s.events.old == 1);
}

static void a_host_that_does_not_wait_makes_no_frames(void **state)
{
    (void)state;
    CigiPacket packet;
    begin();
    CHECK(control(1, 100, 0) == CIGI_DUE);
    const size_t head = write_control(2, 200, cigi_mode_operate, 1);
    const size_t rest =
        cigi_write(buffer + head, sizeof buffer - head, &(CigiPacket){.id = cigi_view_control}, CIGI_BIG_ENDIAN);
    CHECK(cigi_session_receive(&s, buffer, head + rest, now_s) == CIGI_EXTRA); /* while the first is made */
    CHECK(cigi_session_packet(&packet, &s) && packet.id == cigi_view_control && !cigi_session_packet(&packet, &s));
    CHECK(cigi_session_time_s(&s) == 0.001);
    cigi_session_delivered(&s, now_s);
    CHECK(sends() && sent.of.start_of_frame.last_host_frame == 2 && sent.of.start_of_frame.timestamp == 100);
    CHECK(control(3, 300, 1) == CIGI_EXTRA && !sends()); /* answers the first Start of Frame, not the second */
    CHECK(control(4, 400, 2) == CIGI_DUE && cigi_session_time_s(&s) == 0.004 && s.events.extra == 2);
}

static void a_host_that_begins_anew(void **state)
{
    (void)state;
    begin();
    CHECK(control(1000, 900000, 1) == CIGI_DUE && cigi_session_time_s(&s) == 9);
    cigi_session_delivered(&s, now_s);
    CHECK(control(999, 0, 2) == CIGI_OLD); /* the network's disorder */
    CHECK(control(1, 100, 2) == CIGI_DUE && cigi_session_news(&s) == CIGI_NEWS_RESTARTED);
    CHECK(cigi_session_time_s(&s) == 0.001 && s.events.restarts == 1);
    cigi_session_delivered(&s, now_s);
    CHECK(control(5, 200, 3) == CIGI_DUE);
    cigi_session_delivered(&s, now_s);
    CHECK(cigi_session_receive(&s, buffer, write_control(2, 0, cigi_mode_standby, 0), now_s) == CIGI_IDLE);
    CHECK(cigi_session_news(&s) == (CIGI_NEWS_RESTARTED | CIGI_NEWS_MODE));
    cigi_session_delivered(&s, now_s);
    CHECK(sends() && sent.of.start_of_frame.mode == cigi_mode_standby && !sent.of.start_of_frame.timestamp_valid);
}

/* Ticks that go on, whatever their 32 bits do: by sums that are exact in 64. */
static void time_goes_on_where_its_bits_end(void **state)
{
    (void)state;
    static const int64_t steps[] = {0, 1, 1666, 100000, 1 << 30, INT32_MAX};
    for (size_t k = 0; k < sizeof steps / sizeof *steps; k++) {
        int64_t ticks = 4294967000, exact = ticks;
        for (int i = 0; i < 50; i++) {
            exact += steps[k];
            ticks = cigi_unwrap(ticks, (uint32_t)exact);
            CHECK(ticks == exact);
        }
        CHECK(cigi_unwrap(ticks, (uint32_t)(exact - 5000)) == exact - 5000);
    }
    begin();
    CHECK(control(1, 0xFFFFFFFF, 1) == CIGI_DUE);
    CHECK_NEAR(cigi_session_time_s(&s), 42949.67295, 1e-10); /* 11.93 h */
    cigi_session_delivered(&s, now_s);
    CHECK(control(2, 9, 2) == CIGI_DUE);
    CHECK_NEAR(cigi_session_time_s(&s), 42949.67305, 1e-10);
    cigi_session_delivered(&s, now_s);
    CHECK(sends() && sent.of.start_of_frame.timestamp == 9);
}

static void time_that_goes_back_or_is_missing(void **state)
{
    (void)state;
    begin();
    CHECK(control(1, 1000, 1) == CIGI_DUE);
    cigi_session_delivered(&s, now_s);
    CHECK(control(2, 999, 2) == CIGI_IDLE && cigi_session_news(&s) == CIGI_NEWS_TIME_BACK);
    cigi_session_delivered(&s, now_s);
    CHECK(cigi_session_time_s(&s) == 0.01);
    CHECK(control(3, 1000, 3) == CIGI_DUE && s.events.time_back == 1); /* a host that stands still */
    cigi_session_delivered(&s, now_s);
    for (int unstamped = 0; unstamped < 2; unstamped++) {
        s.config.unstamped_ticks = unstamped ? 2000 : 0;
        const size_t octets = write_control((uint32_t)(4 + unstamped), 5, cigi_mode_operate, 0);
        buffer[4] &= (uint8_t)~4u;
        CHECK(cigi_session_receive(&s, buffer, octets, now_s) == (unstamped ? CIGI_DUE : CIGI_IDLE));
        cigi_session_delivered(&s, now_s);
    }
    CHECK(cigi_session_time_s(&s) == 0.03 && s.events.unstamped == 2);
}

/* Ten minutes and a tick more are too far, and time stays; less, and anything after Reset/Standby, is not. */
static void time_that_goes_far_ahead(void **state)
{
    (void)state;
    enum { most = 600 * 100000, hour = 3600 * 100000 };
    uint32_t frame = 1;
    begin();
    CHECK(control(frame, 7 * (uint32_t)hour, 0) == CIGI_DUE); /* the first is as it is */
    cigi_session_delivered(&s, now_s);
    for (int i = 0; i < 3; i++) {
        const uint32_t far[] = {7u * hour + most + 1, 8u * hour, 11u * hour};
        CHECK(control(++frame, far[i], 0) == CIGI_IDLE && cigi_session_news(&s) == CIGI_NEWS_TIME_AHEAD);
        cigi_session_delivered(&s, now_s);
        CHECK(cigi_session_time_s(&s) == 7 * 3600 && s.events.time_ahead == (uint64_t)i + 1);
    }
    CHECK(control(++frame, 7u * hour + most, 0) == CIGI_DUE && cigi_session_time_s(&s) == 7 * 3600 + 600);
    cigi_session_delivered(&s, now_s);
    CHECK(cigi_session_receive(&s, buffer, write_control(++frame, 0, cigi_mode_standby, 0), now_s) == CIGI_IDLE);
    cigi_session_delivered(&s, now_s);
    CHECK(control(++frame, 9u * hour, 0) == CIGI_DUE && cigi_session_time_s(&s) == 9 * 3600);
    cigi_session_delivered(&s, now_s);
    CHECK(control(++frame, 10u * hour, 0) == CIGI_IDLE); /* and that once */
    CHECK(s.events.time_ahead == 4 && s.events.restarts == 0);
}

static void answers_fit_into_a_datagram(void **state)
{
    (void)state;
    const CigiPacket answer = {.id = cigi_los_extended_response, .of.los_extended_response = {.host_frame = 3}};
    CigiPacket       packet;
    CigiReader       reader;
    CigiCounters     counters = {0};
    const uint8_t   *datagram;
    size_t           octets;
    begin();
    CHECK(control(0xABC, 0, 1) == CIGI_DUE);
    const int fit = (cigi_datagram_octets - 24) / 56;
    for (int i = 0; i < fit + 3; i++) CHECK(cigi_session_answer(&s, &answer) == (i < fit));
    CHECK(s.events.unanswered == 3 && !cigi_session_answer(&s, &(CigiPacket){.id = 77}));
    cigi_session_delivered(&s, now_s);
    CHECK(cigi_session_send(&datagram, &octets, &s) && octets == 24 + 56 * (size_t)fit);
    CHECK(cigi_open(&reader, &sent, &counters, datagram, octets, CIGI_FROM_IG) == STATUS_OK);
    for (int i = 0; i < fit; i++)
        CHECK(cigi_next(&packet, &reader, &counters) && packet.of.los_extended_response.host_frame == 0xC);
    now_s += 1;
    CHECK(!cigi_session_look(&s, now_s)); /* the repeat has the answers, too; the next Start of Frame has not */
    CHECK(cigi_session_send(&datagram, &octets, &s) && octets == 24 + 56 * (size_t)fit);
    CHECK(control(0xABD, 0, 2) == CIGI_DUE);
    cigi_session_delivered(&s, now_s);
    CHECK(cigi_session_send(&datagram, &octets, &s) && octets == 24);
}

static void what_is_refused_changes_nothing(void **state)
{
    (void)state;
    begin();
    CHECK(control(1, 1000, 1) == CIGI_DUE);
    cigi_session_delivered(&s, now_s);
    const size_t octets = write_control(2, 5000, cigi_mode_operate, 2);
    for (size_t cut = 0; cut < octets; cut++) CHECK(cigi_session_receive(&s, buffer, cut, now_s) == CIGI_REFUSED);
    buffer[2] = 2;
    CHECK(cigi_session_receive(&s, buffer, octets, now_s) == CIGI_REFUSED && !cigi_session_packet(&sent, &s));
    CHECK(cigi_session_time_s(&s) == 0.01 && s.host_frame == 1 && s.counters.dropped[CIGI_DROP_VERSION] == 1);
    CHECK(cigi_session_receive(&s, buffer, write_control(2, 1001, cigi_mode_maintenance, 2), now_s) == CIGI_DUE);
    CHECK(cigi_session_mode(&s) == cigi_mode_operate); /* no host may ask for maintenance */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_frame_is_answered_once),
        cmocka_unit_test(start_of_frame_is_repeated_and_silence_said_once),
        cmocka_unit_test(repeats_and_old_frames_make_none),
        cmocka_unit_test(a_host_that_does_not_wait_makes_no_frames),
        cmocka_unit_test(a_host_that_begins_anew),
        cmocka_unit_test(time_goes_on_where_its_bits_end),
        cmocka_unit_test(time_that_goes_back_or_is_missing),
        cmocka_unit_test(time_that_goes_far_ahead),
        cmocka_unit_test(answers_fit_into_a_datagram),
        cmocka_unit_test(what_is_refused_changes_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
