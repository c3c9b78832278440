/* tests/dis/test_exercise_clock.c: stamps of several senders on one time, and what senders do to their stamps. */
#include "tests/check.h"
#include "tests/dis/random_pdu.h"

#include "dis/exercise_clock.h"

static const double tick_s = 3600.0 / 2147483648.0; /* 1.7 us */

static ExerciseClock *new_clock(void)
{
    ExerciseClock *clock = NULL;
    CHECK(exercise_clock_create(&clock) == STATUS_OK);
    return clock;
}

/* The stamp of a moment, past the hour. */
static uint32_t stamp_of(double t_s, bool absolute)
{
    const double past_s = t_s - 3600 * floor(t_s / 3600);
    return (uint32_t)(uint64_t)llround(past_s / tick_s) << 1 | absolute;
}

static void stamps_as_seconds(void **state)
{
    (void)state;
    CHECK_NEAR(dis_timestamp_seconds(0xFFFFFFFE), 3600 - tick_s, 0);
    CHECK_NEAR(dis_timestamp_seconds(0x80000001), 1800, 0);
    CHECK(dis_timestamp_is_absolute(0x80000001) && !dis_timestamp_is_absolute(0x80000000));
}

/* Capture times jitter by a second; the stamps alone give the time. */
static void network_jitter_does_not_enter(void **state)
{
    (void)state;
    ExerciseClock *clock = new_clock();
    for (int i = 0; i < 1000; i++) {
        const double t_s = 100 + 0.1 * i;
        const double jitter_s = i ? random_uniform(1, 0, 0, (uint64_t)i) : 0;
        const double got_s = exercise_clock_time(clock, 1, 2, stamp_of(t_s, false), 1.6e9 + t_s + jitter_s);
        CHECK_NEAR(got_s, t_s, tick_s);
    }
    exercise_clock_destroy(clock);
}

static void hours_are_unwrapped(void **state)
{
    (void)state;
    for (int absolute = 0; absolute < 2; absolute++) {
        ExerciseClock *clock = new_clock();
        for (int i = 0; i < 300; i++) {
            const double t_s = 3590 + 60.0 * i; /* five hours */
            CHECK_NEAR(exercise_clock_time(clock, 1, 2, stamp_of(t_s, absolute), 5e8 + t_s), t_s, tick_s);
        }
        exercise_clock_destroy(clock);
    }
}

/* Just before the hour and just after it, in the wrong order: signed difference. */
static void late_datagrams_keep_their_time(void **state)
{
    (void)state;
    ExerciseClock *clock = new_clock();
    CHECK_NEAR(exercise_clock_time(clock, 1, 2, stamp_of(3599.9, false), 1000.0), 3599.9, tick_s);
    CHECK_NEAR(exercise_clock_time(clock, 1, 2, stamp_of(3600.2, false), 1000.3), 3600.2, tick_s);
    CHECK_NEAR(exercise_clock_time(clock, 1, 2, stamp_of(3599.8, false), 1000.31), 3599.8, tick_s);
    exercise_clock_destroy(clock);
}

/* A first PDU that is later than the ones behind it. */
static void time_may_go_below_the_first(void **state)
{
    (void)state;
    ExerciseClock *clock = new_clock();
    CHECK_NEAR(exercise_clock_time(clock, 1, 2, stamp_of(0.5, false), 1000.0), 0.5, tick_s);
    CHECK_NEAR(exercise_clock_time(clock, 1, 2, stamp_of(3599.5, false), 1000.01), -0.5, tick_s);
    exercise_clock_destroy(clock);
}

static void silence_of_hours_is_bridged_by_capture_time(void **state)
{
    (void)state;
    ExerciseClock *clock = new_clock();
    CHECK_NEAR(exercise_clock_time(clock, 1, 2, stamp_of(10, false), 1000), 10, tick_s);
    const double t_s = 10 + 2.7 * 3600;
    CHECK_NEAR(exercise_clock_time(clock, 1, 2, stamp_of(t_s, false), 1000.4 + 2.7 * 3600), t_s, tick_s);
    exercise_clock_destroy(clock);
}

/* Two relative senders with unrelated stamps: the second is tied where it was first captured. */
static void relative_senders_are_tied_by_capture_time(void **state)
{
    (void)state;
    ExerciseClock *clock = new_clock();
    CHECK_NEAR(exercise_clock_time(clock, 1, 1, stamp_of(500, false), 1000), 500, tick_s);
    CHECK_NEAR(exercise_clock_time(clock, 1, 2, stamp_of(2222, false), 1003), 503, tick_s);
    CHECK_NEAR(exercise_clock_time(clock, 1, 1, stamp_of(510, false), 1010.2), 510, tick_s);
    CHECK_NEAR(exercise_clock_time(clock, 1, 2, stamp_of(2230, false), 1011.3), 511, tick_s);
    CHECK_NEAR(exercise_clock_time(clock, 2, 1, stamp_of(2230, false), 1011.3), 511.3, tick_s); /* site counts */
    exercise_clock_destroy(clock);
}

/* Absolute senders share UTC: the second one's network delay of 0.3 s does not shift it. A relative one among
 * them is tied by capture. */
static void absolute_senders_share_one_scale(void **state)
{
    (void)state;
    ExerciseClock *clock = new_clock();
    CHECK_NEAR(exercise_clock_time(clock, 1, 1, stamp_of(3599.9, true), 1000), 3599.9, tick_s);
    CHECK_NEAR(exercise_clock_time(clock, 1, 2, stamp_of(3600.05, true), 1000.45), 3600.05, tick_s);
    CHECK_NEAR(exercise_clock_time(clock, 1, 3, stamp_of(77, false), 1000.6), 3600.5, tick_s);
    CHECK_NEAR(exercise_clock_time(clock, 1, 3, stamp_of(78, false), 1001.7), 3601.5, tick_s);
    exercise_clock_destroy(clock);
    /* an absolute one after a relative first is tied by capture as well */
    clock = new_clock();
    CHECK_NEAR(exercise_clock_time(clock, 1, 1, stamp_of(10, false), 1000), 10, tick_s);
    CHECK_NEAR(exercise_clock_time(clock, 1, 2, stamp_of(1700, true), 1001), 11, tick_s);
    CHECK_NEAR(exercise_clock_time(clock, 1, 2, stamp_of(1701, true), 1002.4), 12, tick_s);
    exercise_clock_destroy(clock);
}

/* Restarted three times: tied again each time; after the third its stamps are not believed any more. */
static void a_restart_is_tied_again_and_three_end_the_trust(void **state)
{
    (void)state;
    ExerciseClock *clock = new_clock();
    CHECK_NEAR(exercise_clock_time(clock, 1, 1, stamp_of(100, false), 1000), 100, tick_s);
    for (int restart = 1; restart <= 3; restart++) {
        const double base_s = 100 + 20 * restart;
        CHECK_NEAR(exercise_clock_time(clock, 1, 1, stamp_of(3, false), 900 + base_s), base_s, tick_s);
        const double after_s = exercise_clock_time(clock, 1, 1, stamp_of(4, false), 900 + base_s + 1.5);
        CHECK_NEAR(after_s, restart < 3 ? base_s + 1 : base_s + 1.5, tick_s);
        /* 4.9 s off is still the sender's business */
        const double off_s = exercise_clock_time(clock, 1, 1, stamp_of(5, false), 900 + base_s + 6.9);
        CHECK_NEAR(off_s, restart < 3 ? base_s + 2 : base_s + 6.9, tick_s);
    }
    exercise_clock_destroy(clock);
}

/* A frame counter where a stamp should be: never more than 5 s off, and capture time in the end. */
static void frame_counters_end_in_capture_time(void **state)
{
    (void)state;
    ExerciseClock *clock = new_clock();
    for (int frame = 1; frame < 2000; frame++) {
        const double capture_s = frame / 30.0;
        const double got_s = exercise_clock_time(clock, 1, 1, (uint32_t)frame << 1, 1e9 + capture_s);
        const double want_s = capture_s - 1 / 30.0;
        CHECK_NEAR(got_s, want_s, 5 + 1e-6);
        if (frame > 500) CHECK_NEAR(got_s, want_s, 1e-4);
    }
    exercise_clock_destroy(clock);
}

static void unstamped_senders_use_capture_time(void **state)
{
    (void)state;
    ExerciseClock *clock = new_clock();
    CHECK_NEAR(exercise_clock_time(clock, 1, 1, 0, 1e9), 0, 0);
    CHECK_NEAR(exercise_clock_time(clock, 1, 1, 0, 1e9 + 3), 3, 1e-6);
    CHECK_NEAR(exercise_clock_time(clock, 1, 2, stamp_of(1000, false), 1e9 + 4), 4, 1e-6);
    CHECK_NEAR(exercise_clock_time(clock, 1, 2, stamp_of(1001, false), 1e9 + 5.5), 5, 1e-6);
    exercise_clock_destroy(clock);
}

static void foolish_capture_times_do_no_harm(void **state)
{
    (void)state;
    static const double foolish[] = {NAN, INFINITY, -INFINITY, 1e300, -1e300};
    for (int i = 0; i < 5; i++) {
        ExerciseClock *clock = new_clock();
        CHECK_NEAR(exercise_clock_time(clock, 1, 1, stamp_of(7, false), foolish[i]), 7, tick_s);
        CHECK_NEAR(exercise_clock_time(clock, 1, 1, stamp_of(9, false), foolish[i]), 9, tick_s);
        exercise_clock_destroy(clock);
        clock = new_clock();
        CHECK_NEAR(exercise_clock_time(clock, 1, 1, stamp_of(7, false), 1000), 7, tick_s);
        CHECK_NEAR(exercise_clock_time(clock, 1, 1, stamp_of(9, false), foolish[i]), 9, tick_s);
        CHECK_NEAR(exercise_clock_time(clock, 1, 1, stamp_of(10, false), 1003.3), 10, tick_s);
        exercise_clock_destroy(clock);
    }
}

/* More senders than are remembered: the early ones keep their stamps, the late ones get capture time. */
static void senders_are_bounded(void **state)
{
    (void)state;
    ExerciseClock *clock = new_clock();
    for (int pass = 0; pass < 2; pass++) {
        for (int i = 0; i < 5000; i++) {
            const double capture_s = 1000 + pass * 2.5;
            const double got_s = exercise_clock_time(clock, (uint16_t)(i / 100), (uint16_t)(i * 7),
                                                     stamp_of(50 + 2 * pass, false), capture_s);
            CHECK_NEAR(got_s, pass == 0 ? 50 : i < 4096 ? 52 : 52.5, 2 * tick_s);
        }
    }
    exercise_clock_destroy(clock);
}

/* Any stamps, any capture times: finite, and the same bits twice. */
static void noise_is_deterministic(void **state)
{
    (void)state;
    ExerciseClock *a = new_clock(), *b = new_clock();
    Dice           d = dice(4);
    double         capture_s = 1.5e9;
    for (int i = 0; i < 100000; i++) {
        const uint16_t site = (uint16_t)(roll(&d) % 90), application = (uint16_t)(roll(&d) % 90);
        const uint32_t stamp = roll(&d);
        capture_s += roll(&d) % 100 == 0 ? (double)(int32_t)roll(&d) * 1e-6 : 1e-3;
        const double t_s = exercise_clock_time(a, site, application, stamp, capture_s);
        const double u_s = exercise_clock_time(b, site, application, stamp, capture_s);
        CHECK(isfinite(t_s) && memcmp(&t_s, &u_s, sizeof t_s) == 0);
    }
    exercise_clock_destroy(a);
    exercise_clock_destroy(b);
    exercise_clock_destroy(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stamps_as_seconds),
        cmocka_unit_test(network_jitter_does_not_enter),
        cmocka_unit_test(hours_are_unwrapped),
        cmocka_unit_test(late_datagrams_keep_their_time),
        cmocka_unit_test(time_may_go_below_the_first),
        cmocka_unit_test(silence_of_hours_is_bridged_by_capture_time),
        cmocka_unit_test(relative_senders_are_tied_by_capture_time),
        cmocka_unit_test(absolute_senders_share_one_scale),
        cmocka_unit_test(a_restart_is_tied_again_and_three_end_the_trust),
        cmocka_unit_test(frame_counters_end_in_capture_time),
        cmocka_unit_test(unstamped_senders_use_capture_time),
        cmocka_unit_test(foolish_capture_times_do_no_harm),
        cmocka_unit_test(senders_are_bounded),
        cmocka_unit_test(noise_is_deterministic),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
