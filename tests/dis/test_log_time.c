/* Packet times against stamps: which of the two is the clock. */
#include "tests/check.h"

#include "dis/pdu/decode.h"
#include "dis/capture/log.h"

enum { pdus = 200 };

static uint8_t     bytes[pdus][160];
static DisDatagram datagram[pdus];

static double speed_mps, motion_rate; /* what the reports say, and seconds of motion a second of stamp */
static double leap_m;                 /* a leap of the place amid the motion */

/* PDU k stamped at stamp_s(k), captured at capture_s(k); every fifth from another sender, unstamped. */
static DisLog make(double stamp_s[pdus], double capture_s[pdus])
{
    for (int k = 0; k < pdus; k++) {
        const double   past_s = fmod(stamp_s[k] + 7200, 3600);
        DisEntityState pdu = {.header = {.version = 7,
                                         .exercise = 1,
                                         .type = dis_pdu_entity_state,
                                         .family = 1,
                                         .timestamp = k % 5 == 4 ? 0 : (uint32_t)(past_s / 3600 * 2147483648.0) << 1},
                              .id = {1, (uint16_t)(k % 5 == 4 ? 2 : 1), 7},
                              .p_ecef = {6.4e6, 0, speed_mps * motion_rate * stamp_s[k] + (k < 100 ? 0 : leap_m)},
                              .velocity_mps = {0, (float)(0.6 * speed_mps), (float)(0.8 * speed_mps)}};
        const size_t   octets = dis_encode_entity_state(bytes[k], sizeof bytes[k], &pdu);
        CHECK(octets > 0);
        datagram[k] = (DisDatagram){.capture_s = capture_s[k], .octets = (uint32_t)octets, .bytes = bytes[k]};
    }
    return (DisLog){.count = pdus, .datagram = datagram};
}

/* rate: packet seconds a stamp second; jitter_s on the packets. Stamps begin just before the hour. */
static bool retimed(double rate, double jitter_s)
{
    double stamp_s[pdus], capture_s[pdus];
    for (int k = 0; k < pdus; k++) {
        stamp_s[k] = 3580 + 0.3 * k;
        capture_s[k] = 1e9 + rate * 0.3 * k + jitter_s * random_uniform(1, 2, 3, (uint64_t)k);
    }
    DisLog     log = make(stamp_s, capture_s);
    const bool did = dis_log_retime(&log);
    for (int k = 0; k < pdus; k++) {
        if (!did) CHECK(datagram[k].capture_s == capture_s[k]);
        /* the unstamped one stands where the one before it stood */
        if (did) CHECK_NEAR(datagram[k].capture_s - capture_s[0], 0.3 * (k - (k % 5 == 4)), 1e-5);
    }
    return did;
}

static void packets_at_another_pace_take_the_stamps(void **state)
{
    (void)state;
    CHECK(retimed(0, 0));    /* all at one instant */
    CHECK(retimed(1e-5, 0)); /* a microsecond or so apart */
    CHECK(retimed(0.05, 0)); /* played back 20 times as fast */
    CHECK(retimed(2, 0));    /* at half speed */
}

static void an_honest_capture_is_left_alone(void **state)
{
    (void)state;
    CHECK(!retimed(1, 0));
    CHECK(!retimed(1, 0.5));
    CHECK(!retimed(1.1, 0));
    /* a quarter is the network's and the sender's to lose: 0.8 .. 1.25 packet seconds a stamp second */
    CHECK(!retimed(0.81, 0) && !retimed(1.24, 0));
    CHECK(retimed(0.78, 0) && retimed(1.28, 0));
}

/* Stamps at half and at twice the rate of packets: what moves says which of the two is the clock. */
static void motion_decides_between_two_clocks(void **state)
{
    (void)state;
    static const double rate[] = {0.5, 0.6, 2};
    speed_mps = 250;
    for (int k = 0; k < 3; k++) {
        motion_rate = 1; /* a playback at another speed */
        CHECK(retimed(rate[k], 0));
        motion_rate = rate[k]; /* stamps that run wrong */
        CHECK(!retimed(rate[k], 0));
        CHECK(!retimed(rate[k], 0.1));
        motion_rate = 0.1 * rate[k]; /* says nothing */
        CHECK(retimed(rate[k], 0));
    }
    speed_mps = motion_rate = 0;
}

static void stamps_that_are_no_clock_are_not_believed(void **state)
{
    (void)state;
    double stamp_s[pdus], capture_s[pdus];
    for (int k = 0; k < pdus; k++) {
        stamp_s[k] = 100 + 1e-4 * k; /* a counter */
        capture_s[k] = 1e9 + 0.3 * k;
    }
    DisLog log = make(stamp_s, capture_s);
    CHECK(!dis_log_retime(&log));
    for (int k = 0; k < pdus; k++) stamp_s[k] = 100 + (k < 100 ? 0 : -60) + 0.3 * k, capture_s[k] = 1e9;
    log = make(stamp_s, capture_s); /* a restart */
    CHECK(!dis_log_retime(&log));
    for (int k = 0; k < pdus; k++) stamp_s[k] = 100 + 0.3 * k, capture_s[k] = 1e9 + (k < 100 ? 0 : 7200) + 0.3 * k;
    log = make(stamp_s, capture_s); /* two hours of silence, which stamps cannot tell */
    CHECK(!dis_log_retime(&log));
    log.count = 3;
    CHECK(!dis_log_retime(&log));
    log.count = 0;
    CHECK(!dis_log_retime(&log));
}

/* Stamps 0.3 s apart but for one step more, all captured at one instant but for a gap. */
static bool retimed_over(double step_s, double gap_s, int count)
{
    double stamp_s[pdus], capture_s[pdus];
    for (int k = 0; k < pdus; k++) {
        stamp_s[k] = 100 + 0.3 * k + (k < 100 ? 0 : step_s - 0.6); /* the 99th is another sender's */
        capture_s[k] = 1e9 + (k < 100 ? 0 : gap_s);
    }
    DisLog log = make(stamp_s, capture_s);
    log.count = count;
    return dis_log_retime(&log);
}

/* A clock's stamps step back by 1 s at most (reordered datagrams), and ahead by 120 s (two heartbeats of 60 s); over 25
 * minutes without a packet the stamp's hour is uncertain; a log of less than 5 s or of fewer than 10 PDUs is too short;
 * stamps 20 times slower than packets count something else. */
static void limits_of_a_clock(void **state)
{
    (void)state;
    CHECK(retimed_over(-0.97, 0, pdus) && !retimed_over(-1.03, 0, pdus));
    CHECK(retimed_over(119, 0, pdus) && !retimed_over(121, 0, pdus));
    CHECK(retimed_over(110, 1490, pdus) && !retimed_over(110, 1510, pdus));
    CHECK(retimed_over(0.6, 0, 18) && !retimed_over(0.6, 0, 17)); /* 5.1 s, 4.8 s */
    CHECK(retimed(19.8, 0) && !retimed(20.2, 0));
    for (int count = 11; count <= 12; count++) { /* 9 and 10 of the sender, 0.7 s apart */
        double stamp_s[pdus], capture_s[pdus];
        for (int k = 0; k < pdus; k++) stamp_s[k] = 100 + 0.7 * k, capture_s[k] = 1e9;
        DisLog log = make(stamp_s, capture_s);
        log.count = count;
        CHECK(dis_log_retime(&log) == (count == 12));
    }
}

/* Motion counts from 1 m/s, and where it agrees with the packets' pace to 20 %. */
static void limits_of_motion(void **state)
{
    (void)state;
    speed_mps = 250;
    motion_rate = 2 / 1.19;
    CHECK(!retimed(2, 0));
    motion_rate = 2 / 1.21;
    CHECK(retimed(2, 0));
    motion_rate = 2;
    speed_mps = 1.02;
    CHECK(!retimed(2, 0));
    speed_mps = 0.98;
    CHECK(retimed(2, 0));
    speed_mps = 250; /* 30 km of way: a leap below 100 km counts as way, and spoils it; a longer one is left out */
    leap_m = 0.95e5;
    CHECK(retimed(2, 0));
    leap_m = 1.05e5;
    CHECK(!retimed(2, 0));
    leap_m = 0;
    speed_mps = 1.98e4; /* faster than 20 km/s is no entity's speed */
    CHECK(!retimed(2, 0));
    speed_mps = 2.02e4;
    CHECK(retimed(2, 0));
    speed_mps = motion_rate = 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(packets_at_another_pace_take_the_stamps),
        cmocka_unit_test(an_honest_capture_is_left_alone),
        cmocka_unit_test(motion_decides_between_two_clocks),
        cmocka_unit_test(limits_of_a_clock),
        cmocka_unit_test(limits_of_motion),
        cmocka_unit_test(stamps_that_are_no_clock_are_not_believed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
