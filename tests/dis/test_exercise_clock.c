/* tests/dis/test_exercise_clock.c: stamps of several senders on one time, and what senders do to their stamps. */
#include "tests/check.h"
#include "tests/dis/random_pdu.h"

#include "dis/clock/exercise_clock_private.h"

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

/* Datagrams are bundled and delayed by up to 0.14 s; once the sender is proven, one in twenty comes up to 2 s late: the
 * stamps alone give the time. */
static void network_jitter_does_not_enter(void **state)
{
    (void)state;
    ExerciseClock *clock = new_clock();
    for (int i = 0; i < 1000; i++) {
        const double t_s = 100 + 0.1 * i;
        const double late_s = i > 60 && i % 20 == 7 ? 2 : 0.14;
        const double jitter_s = late_s * random_uniform(1, 0, 0, (uint64_t)i);
        const double got_s = exercise_clock_time(clock, 1, 2, stamp_of(t_s, false), 1.6e9 + t_s + jitter_s);
        CHECK_NEAR(got_s, t_s, tick_s);
    }
    CHECK(exercise_clock_anomalies(clock)->count == 0 && exercise_clock_anomalies(clock)->by_arrival == 0);
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
    CHECK_NEAR(exercise_clock_time(clock, 1, 1, stamp_of(510, false), 1010.1), 510, tick_s);
    CHECK_NEAR(exercise_clock_time(clock, 1, 2, stamp_of(2230, false), 1011.1), 511, tick_s);
    CHECK_NEAR(exercise_clock_time(clock, 2, 1, stamp_of(2230, false), 1011.1), 511.1, tick_s); /* site counts */
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
    CHECK_NEAR(exercise_clock_time(clock, 1, 2, stamp_of(1701, true), 1002.1), 12, tick_s);
    exercise_clock_destroy(clock);
}

/* A proven sender restarts: its stamps jump, then run on. The arrival time is used until they are proven again, and the
 * stamps from then on, however often it restarts. */
static void a_restart_is_tied_again(void **state)
{
    (void)state;
    ExerciseClock *clock = new_clock();
    double         ahead_s = 0;
    for (int i = 0; i < 5 * 60; i++) {
        const double t_s = 100 + i, late_s = 0.1 * random_uniform(1, 1, 0, (uint64_t)i);
        if (i % 60 == 0 && i) ahead_s = 600 * random_uniform(1, 2, 0, (uint64_t)i);
        const double got_s =
            exercise_clock_time(clock, 1, 1, stamp_of(t_s + ahead_s, false), 900 + t_s + (i ? late_s : 0));
        CHECK_NEAR(got_s, t_s, 0.1 + tick_s); /* never worse than arrival */
        if (i < 60) CHECK_NEAR(got_s, t_s, tick_s);
        static double off_s;
        if (i % 60 == 45) off_s = got_s - t_s;
        if (i % 60 > 45) CHECK(got_s - t_s <= off_s + 2 * tick_s && got_s - t_s >= -2 * tick_s); /* the stamps again */
        if (i % 60 > 45) off_s = got_s - t_s;                                                    /* and better known */
    }
    CHECK(exercise_clock_anomalies(clock)->count == 1 &&
          exercise_clock_anomalies(clock)->sender[0].reason == EXERCISE_CLOCK_JUMP);
    exercise_clock_destroy(clock);
}

/* One PDU with a wrong stamp does not move a proven sender. */
static void one_wrong_stamp_counts_from_its_arrival(void **state)
{
    (void)state;
    ExerciseClock *clock = new_clock();
    for (int i = 0; i < 40; i++) {
        const double t_s = 100 + i, late_s = 0.05 * (i % 3);
        const double got_s =
            exercise_clock_time(clock, 1, 1, stamp_of(i == 20 ? 2000 : t_s, false), 900 + t_s + late_s);
        CHECK_NEAR(got_s, i == 20 ? t_s + late_s : t_s, tick_s);
    }
    exercise_clock_destroy(clock);
}

/* A sender that stops its own clock in a pause and goes on from there; one that freezes its stamps but reports on. */
static void pauses_end_in_proven_stamps(void **state)
{
    (void)state;
    for (int silent = 0; silent < 2; silent++) {
        ExerciseClock *clock = new_clock();
        for (int i = 0; i < 200; i++) {
            const double t_s = 100 + i, own_s = i < 50 ? t_s : i < 80 ? 150 : t_s - 30;
            if (silent && i >= 50 && i < 80) continue;
            const double got_s = exercise_clock_time(clock, 1, 1, stamp_of(own_s, false), 900 + t_s);
            CHECK_NEAR(got_s, t_s, i == 51 ? 1 + tick_s : 1e-6 + tick_s); /* one frozen stamp might be a repetition */
        }
        const uint64_t before = exercise_clock_anomalies(clock)->by_arrival;
        CHECK(before > 0 && before < 60);
        exercise_clock_time(clock, 1, 1, stamp_of(270, false), 900 + 300);
        CHECK(exercise_clock_anomalies(clock)->by_arrival == before);
        exercise_clock_destroy(clock);
    }
}

typedef uint32_t StampOf(int i);
static uint32_t  constant_stamp(int i) { return 0xCAFE0000 + 0 * (uint32_t)i; }
static uint32_t  counter_stamp(int i) { return (uint32_t)i + 1; }
static uint32_t  ms_stamp(int i) { return 200 * (uint32_t)i + 5; }
static uint32_t  us_stamp(int i) { return 200000 * (uint32_t)i + 5; }
static uint32_t  unix_stamp(int i) { return 1750000000 + (uint32_t)i / 5; }
static uint32_t  half_stamp(int i) { return stamp_of(50 + 0.1 * i, false); }
static uint32_t  double_stamp(int i) { return stamp_of(50 + 0.4 * i, false); }
static uint32_t  wild_stamp(int i) { return (uint32_t)(4294967296.0 * random_uniform(3, 3, 3, (uint64_t)i)); }

/* From the second report on never farther from arrival than the jitter allowed, 5 reports a second; and what is said.
 */
static void stamps_that_are_no_clock_are_found_and_named(void **state)
{
    (void)state;
    static const struct {
        StampOf    *stamp;
        double      allowed_s;
        const char *said;
    } sender[] = {{constant_stamp, 0, "stand still"},      {counter_stamp, 0, "count its PDUs"},
                  {ms_stamp, 0, "look like milliseconds"}, {us_stamp, 0.15, "look like microseconds"},
                  {unix_stamp, 0, "look like seconds"},    {half_stamp, 0.15, "run at 0.5 times"},
                  {double_stamp, 0.15, "run at 2 times"},  {wild_stamp, 0, "jump about"}};
    for (size_t k = 0; k < sizeof sender / sizeof sender[0]; k++) {
        ExerciseClock *clock = new_clock();
        char           text[exercise_clock_anomaly_text_size];
        double         first_s = 0;
        for (int i = 0; i < 3000; i++) { /* ten minutes */
            const double got_s = exercise_clock_time(clock, 7, 8, sender[k].stamp(i), 1e9 + 0.2 * i);
            if (i == 0) first_s = got_s;
            CHECK_NEAR(got_s - first_s, 0.2 * i, sender[k].allowed_s + 1e-6);
        }
        const ExerciseClockAnomalies *doubts = exercise_clock_anomalies(clock);
        CHECK(doubts->count == 1 && doubts->by_arrival >= 2990 && doubts->sender[0].by_arrival == doubts->by_arrival);
        exercise_clock_anomaly_text(text, sizeof text, &doubts->sender[0]);
        CHECK(strncmp(text, "time stamps of 7:8 ", 19) == 0 && strstr(text, sender[k].said));
        exercise_clock_destroy(clock);
    }
}

/* A clock that is wrong by 0.15 % and more is found by the longer spans (0.15 s gained within the 128 s after which a
 * trend begins anew at the latest); 50 and 200 ppm are a clock. The stamps of a sender that sets the epoch are never
 * shifted, so until its clock is rejected it is wrong by all that it has gained: at the first report after a gain of
 * 0.15 s it is tied to its arrivals, so the error is between that and what one more report adds, never a whole second.
 */
static void slight_rates_are_found_in_time(void **state)
{
    (void)state;
    static const double rate[] = {0.95, 1.05, 0.98, 1.02, 1.005, 1.0015, 1.0002, 1.00005};
    for (int k = 0; k < 8; k++) {
        ExerciseClock *clock = new_clock();
        const double   gained_hz = fabs(rate[k] - 1);
        double         worst_s = 0;
        for (int i = 0; i < 3600; i++) {
            const double got_s = exercise_clock_time(clock, 1, 1, stamp_of(50 + rate[k] * i, false), 1e9 + i);
            worst_s = fmax(worst_s, fabs(got_s - 50 - i));
        }
        CHECK((exercise_clock_anomalies(clock)->count == 0) == (k >= 6));
        if (k >= 6) CHECK_NEAR(worst_s, 3599 * gained_hz, 2e-6); /* an hour of it */
        else CHECK(worst_s > 0.15 - 2 * gained_hz && worst_s <= 0.15 + gained_hz + 2e-6);
        exercise_clock_destroy(clock);
    }
}

/* A proven clock that begins to run at another rate is tied again as well. A trend is renewed after 32 s while it is
 * right, and judged again from 30 points on: a fast clock, whose delays fall, moves their lower edge at once and is
 * found within 62 s of the turn. A slow clock's delays rise like those of a queue that fills: they count once they have
 * risen by half a second within the 128 s of a trend, 50 s after the turn at 1 %, one report later at the latest or
 * where the trend began up to 8 s after the turn. A clock that is 0.3 % slow gains 0.38 s in that time: it is found
 * where the middle of all its points is past the turn, which is T after it. */
static void a_proven_clock_that_goes_wrong_is_tied_again(void **state)
{
    (void)state;
    static const struct {
        double rate;
        int    turn_s, within_s;
    } c[] = {{1.01, 100, 62}, {1.01, 117, 62}, {1.01, 131, 62},  {1.01, 2000, 62},   {1.003, 123, 62}, {0.99, 100, 60},
             {0.99, 117, 60}, {0.99, 131, 60}, {0.99, 2000, 60}, {0.995, 2000, 130}, {0.997, 150, 212}};
    for (size_t k = 0; k < sizeof c / sizeof *c; k++) {
        ExerciseClock *clock = new_clock();
        double         worst_s = 0, last_s = 0;
        for (int i = 0; i < c[k].turn_s + 1000; i++) {
            const double own_s = i < c[k].turn_s ? i : c[k].turn_s + c[k].rate * (i - c[k].turn_s);
            last_s = exercise_clock_time(clock, 1, 1, stamp_of(50 + own_s, false), 1e9 + i) - 50 - i;
            worst_s = fmax(worst_s, fabs(last_s));
        }
        CHECK(worst_s > 0.1 && worst_s <= fabs(c[k].rate - 1) * c[k].within_s);
        CHECK_NEAR(last_s, 0, 2e-6);
        CHECK(exercise_clock_anomalies(clock)->count == 1);
        exercise_clock_destroy(clock);
    }
}

/* A queue that fills for 50 s, stays full for 200 s and empties at once delays a validated sender's datagrams by 0.33
 * s, or by 2 s with 0.6 s of jitter: that is no other rate, and every stamp keeps its time. (The line of least squares
 * through a rise of any course rises by 1.5 of it at most, which it does through a step: by 0.495 s.) */
static void a_queue_that_fills_is_no_clock(void **state)
{
    (void)state;
    for (int jitters = 0; jitters < 2; jitters++) {
        ExerciseClock *clock = new_clock();
        for (int i = 0; i < 600; i++) {
            const double full = i < 200 || i >= 450 ? 0 : fmin((i - 200) / 50.0, 1);
            const double late_s =
                jitters ? full * 2 + (i ? 0.6 * random_uniform(5, 5, 0, (uint64_t)i) : 0) : 0.33 * full;
            const double got_s = exercise_clock_time(clock, 1, 1, stamp_of(100 + i, false), 900 + i + late_s);
            if (i != 1) CHECK_NEAR(got_s, 100 + i, tick_s);
        }
        CHECK(exercise_clock_anomalies(clock)->count == 0);
        exercise_clock_destroy(clock);
    }
}

/* Stamps up to 5 s from arrival are valid (IEEE 1278.1: timestamp ahead, timestamp behind), on both sides; farther ones
 * count from their arrival. One of either in a proven clock moves nothing else. */
static void five_seconds_are_the_limit(void **state)
{
    (void)state;
    static const double off_s[] = {-4.9, 4.9, -5.1, 5.1};
    for (int k = 0; k < 4; k++) {
        ExerciseClock *clock = new_clock();
        for (int i = 0; i < 60; i++) {
            const double t_s = 100 + i, own_s = t_s + (i == 40 ? off_s[k] : 0);
            const double got_s = exercise_clock_time(clock, 1, 1, stamp_of(own_s, false), 900 + t_s);
            CHECK_NEAR(got_s, k < 2 ? own_s : t_s, tick_s);
        }
        exercise_clock_destroy(clock);
    }
}

/* The first PDU of a sender that sets the epoch was 0.3 s on its way: all others were not, so exercise time is 0.3 s
 * ahead of what its arrival said. A second sender, tied by its arrival, is on that time as well. Where the first one
 * turns out to be no clock, its delays say nothing of the others. */
static void the_founders_delay_is_no_elses(void **state)
{
    (void)state;
    for (int wrong = 0; wrong < 2; wrong++) {
        ExerciseClock *clock = new_clock();
        double         first_s = 0;
        for (int i = 0; i < 20; i++) {
            const double t_s = 100 + i, own_s = wrong ? 100 + 1.05 * i : t_s, late_s = i == 0 && !wrong ? 0.3 : 0;
            const double got_s = exercise_clock_time(clock, 1, 1, stamp_of(own_s, false), 1e9 + t_s + late_s);
            if (!wrong && i != 1) CHECK_NEAR(got_s, t_s, tick_s); /* a second PDU far from its stamp is undecided */
            first_s = i == 0 ? got_s : first_s;
            if (i < 10) continue;
            const double other_s = exercise_clock_time(clock, 1, 2, stamp_of(2000 + i, false), 1e9 + t_s + 0.01);
            CHECK_NEAR(other_s, first_s + i + 0.01, 4e-6);
        }
        CHECK(exercise_clock_anomalies(clock)->count == wrong);
        exercise_clock_destroy(clock);
    }
}

/* A sender whose first PDU was 0.5 ms late is shifted by that once the next are not; by 0.05 ms, below the 0.1 ms that
 * count, it keeps the offset of its first to the bit. */
static void small_delays_are_not_applied(void **state)
{
    (void)state;
    static const double late_s[] = {0.5e-3, 0.12e-3, 0.08e-3, 0.05e-3};
    for (int k = 0; k < 4; k++) {
        ExerciseClock *clock = new_clock();
        exercise_clock_time(clock, 1, 1, stamp_of(100, false), 1000);
        for (int i = 0; i < 5; i++) {
            const double got_s =
                exercise_clock_time(clock, 1, 2, stamp_of(2000 + i, false), 1001 + i + (i == 0 ? late_s[k] : 0));
            CHECK_NEAR(got_s, 101 + i + (i == 0 || k >= 2 ? late_s[k] : 0), 4e-6);
        }
        exercise_clock_destroy(clock);
    }
}

/* A sender is proven by two checks, 2 s apart at first: a jump before the second one rejects it, after it is one odd
 * PDU. Each rejection doubles the time until it is proven anew, to 16 times at most: 64 s in all. */
static void proof_takes_its_time(void **state)
{
    (void)state;
    for (int at = 3; at <= 5; at += 2) {
        ExerciseClock *clock = new_clock();
        for (int i = 0; i < 20; i++)
            exercise_clock_time(clock, 1, 1, stamp_of(100 + i + (i == at ? 700 : 0), false), 1000 + i);
        CHECK(exercise_clock_anomalies(clock)->count == (at == 3));
        exercise_clock_destroy(clock);
    }
    ExerciseClock *clock = new_clock();
    double         ahead_s = 0;
    for (int i = 0; i < 12 * 100; i++) {
        if (i % 100 == 0 && i) ahead_s += 500;
        const ExerciseInstant now =
            exercise_clock_instant(clock, 1, 1, 1, stamp_of(100 + i + ahead_s, false), 1000 + i);
        const int restarts = i / 100, since_s = i % 100;
        if (restarts == 0 || since_s <= 2) continue;
        const int proof_s = 4 << (restarts > 5 ? 4 : restarts - 1); /* two spans of 2 s, doubled */
        CHECK(now.by_stamp == (since_s >= proof_s + 1));
    }
    exercise_clock_destroy(clock);
}

/* A new sender's second PDU that is 0.1 s and more behind the first one in its stamp was overtaken on the network, and
 * keeps its stamp's time. Less behind, and 0.15 s off by arrival, it leaves open how fast the stamps run: it counts
 * from its arrival. */
static void a_second_pdu_is_overtaken_or_undecided(void **state)
{
    (void)state;
    static const struct {
        double behind_s, later_s;
        bool   by_stamp;
    } c[] = {{0.104, 0.06, true}, {0.096, 0.07, false}, {0.096, 0.04, true}, {1, 0.01, true}, {4.9, 0.01, true}};
    for (int k = 0; k < 5; k++) {
        ExerciseClock *clock = new_clock();
        exercise_clock_instant(clock, 1, 1, 1, stamp_of(100, false), 1000);
        const ExerciseInstant second =
            exercise_clock_instant(clock, 1, 1, 2, stamp_of(100 - c[k].behind_s, false), 1000 + c[k].later_s);
        CHECK(second.by_stamp == c[k].by_stamp);
        CHECK_NEAR(second.t_s, 100 + (c[k].by_stamp ? -c[k].behind_s : c[k].later_s), 2 * tick_s);
        exercise_clock_destroy(clock);
    }
}

/* The capture clock is set back by an hour amid a sender's first PDUs, before the check: it begins again there, and
 * passes 2 and 4 s later. A jump of the stamps before that rejects the sender; after it is one odd PDU. */
static void a_check_begins_again_where_the_capture_steps_back(void **state)
{
    (void)state;
    for (int at = 5; at <= 8; at += 3) {
        ExerciseClock *clock = new_clock();
        for (int i = 0; i < 20; i++)
            exercise_clock_time(clock, 1, 1, stamp_of(100 + i + (i == at ? 700 : 0), false),
                                10000 + i - (i >= 2 ? 3600 : 0));
        CHECK(exercise_clock_anomalies(clock)->count == (at == 5));
        exercise_clock_destroy(clock);
    }
}

/* Two reports of an entity 0.1 .. 1800 s apart whose stamps differ by less than a twentieth of that, and, up to 5 s
 * apart, by 5 ms at most, repeat a stamp. A report that came sooner is not remembered. */
static void limits_of_stamps_that_stand_still(void **state)
{
    (void)state;
    static const struct {
        double passed_s, step_s;
        bool   repeats;
    } c[] = {{0.1, 0, true},       {0.104, 0.005, true}, {0.104, 0.0053, false}, {0.096, 0, false},
             {0.11, 0.0048, true}, {0.2, 0.0048, true},  {0.2, 0.0053, false},   {4.9, 0.0053, false},
             {5.1, 0.0053, true},  {5.1, 0.25, true},    {5.1, 0.26, false},     {100, 4.96, true},
             {100, 5.04, false},   {1790, 0, true},      {1810, 0, false},       {100, -4.96, true},
             {100, -5.04, false},  {-1, 0, false},       {0, 0, false}};
    for (size_t k = 0; k < sizeof c / sizeof *c; k++) {
        ExerciseClock *clock = new_clock();
        CHECK(exercise_clock_stands_still(clock, 7, (Moment){stamp_of(1000, false), 0}) == 0);
        const Moment then = {stamp_of(1000 + c[k].step_s, false), c[k].passed_s};
        CHECK(exercise_clock_stands_still(clock, 8, then) == 0);
        CHECK(exercise_clock_stands_still(clock, 7, then) == c[k].repeats);
        const Moment last = {then.stamp, c[k].passed_s + 0.15};
        const bool   kept = c[k].passed_s < 0 || c[k].passed_s >= 0.1; /* then it is the one compared with */
        CHECK(exercise_clock_stands_still(clock, 7, last) == (kept ? 1 + c[k].repeats : c[k].step_s == 0));
        exercise_clock_destroy(clock);
    }
}

/* The PDUs from a jump of the stamps on are one segment, also the first ones, which might have been single odd stamps;
 * a single one has a segment to itself. */
static void a_jump_begins_one_segment(void **state)
{
    (void)state;
    ExerciseClock *clock = new_clock();
    uint32_t       segment[40];
    for (int i = 0; i < 40; i++) {
        const double ahead_s = i == 20 ? 300 : i >= 30 ? 700 : 0;
        segment[i] = exercise_clock_instant(clock, 1, 1, 1, stamp_of(100 + i + ahead_s, false), 1000 + i).segment;
    }
    for (int i = 1; i < 30; i++) CHECK((segment[i] == segment[0]) == (i != 20));
    for (int i = 31; i < 40; i++) CHECK(segment[i] == segment[30]);
    CHECK(segment[30] != segment[0] && segment[30] != segment[20]);
    exercise_clock_destroy(clock);
}

/* All PDUs of a frame carry the frame's time and leave over the next second: each entity's stamps are a clock. */
static void a_sender_that_spreads_a_frame_is_proven(void **state)
{
    (void)state;
    ExerciseClock *clock = new_clock();
    for (int frame = 0; frame < 20; frame++)
        for (int e = 0; e < 100; e++) {
            const double t_s = 100 + 5 * frame;
            const double got_s =
                exercise_clock_report_time(clock, 1, 1, e, stamp_of(t_s, false), 900 + t_s + 0.001 * e);
            CHECK_NEAR(got_s, t_s, tick_s);
        }
    exercise_clock_destroy(clock);
}

/* On the hour a stamp is 0, of a sender that stamps. */
static void a_stamp_of_zero_is_on_the_hour(void **state)
{
    (void)state;
    ExerciseClock *clock = new_clock();
    for (int i = -20; i < 20; i++)
        CHECK_NEAR(
            exercise_clock_time(clock, 1, 1, stamp_of(3600 + 0.5 * i, false), 1000 + 0.5 * i + 0.1 * (i % 3 == 0)),
            3600 + 0.5 * i, tick_s);
    CHECK(exercise_clock_anomalies(clock)->unstamped == 0);
    exercise_clock_destroy(clock);
}

/* Two programs of one site and application, with clocks of their own. */
static void two_senders_of_one_id_are_named(void **state)
{
    (void)state;
    ExerciseClock *clock = new_clock();
    char           text[exercise_clock_anomaly_text_size];
    bool           said = false;
    for (int i = 0; i < 60; i++)
        exercise_clock_report_time(clock, 7, 8, i % 2, stamp_of(100 + 0.5 * i + (i % 2 ? 600 : 0), false),
                                   1e9 + 0.5 * i);
    for (int i = 0; i < exercise_clock_anomalies(clock)->count; i++) {
        exercise_clock_anomaly_text(text, sizeof text, &exercise_clock_anomalies(clock)->sender[i]);
        said |= strstr(text, "7:8 follow two clocks 600.0 s apart: two senders") != NULL;
    }
    CHECK(said);
    exercise_clock_destroy(clock);
}

/* Clocks that drift by 50 ppm against each other over ten minutes of jitter: offset and rate are found. */
static void drift_is_followed(void **state)
{
    (void)state;
    static ExerciseInstant at[6000];
    ExerciseClock         *clock = new_clock();
    for (int i = 0; i < 3000; i++)
        for (int s = 0; s < 2; s++) {
            const double t_s = 100 + 0.2 * i, late_s = i ? 0.4 * random_uniform(5, (uint64_t)s, 0, (uint64_t)i) : 0;
            at[2 * i + s] = exercise_clock_instant(clock, 1, (uint16_t)(1 + s), 1,
                                                   stamp_of(s ? 50 + 1.00005 * t_s : t_s, false), 1e9 + t_s + late_s);
        }
    exercise_clock_whole(clock);
    for (int i = 0; i < 6000; i++) {
        exercise_clock_whole_time(clock, &at[i]);
        CHECK_NEAR(at[i].t_s, 100 + 0.2 * (i / 2), i % 2 ? 0.002 : tick_s); /* 30 ms without */
    }
    exercise_clock_destroy(clock);
}

/* Bundles of four entities, the first one late, each again 0.4 s later: neither a rate nor a clock that stands still.
 */
static void bundles_that_come_twice_are_no_fault(void **state)
{
    (void)state;
    ExerciseClock *clock = new_clock();
    for (int i = 0; i < 60; i++)
        for (int copy = 0; copy < 2; copy++)
            for (int e = 0; e < 4; e++) {
                const double t_s = 100 + i, late_s = (i ? 0 : 0.3) + 0.4 * copy;
                CHECK_NEAR(exercise_clock_report_time(clock, 1, 1, e, stamp_of(t_s, false), 1e9 + t_s + late_s), t_s,
                           i == 0 && copy              ? 0.4 + tick_s
                           : i == 1 && !copy && e == 0 ? 0.3 + tick_s
                                                       : tick_s);
            }
    CHECK(exercise_clock_anomalies(clock)->count == 0);
    exercise_clock_destroy(clock);
}

static void unstamped_senders_use_capture_time(void **state)
{
    (void)state;
    ExerciseClock *clock = new_clock();
    CHECK_NEAR(exercise_clock_time(clock, 1, 1, 0, 1e9), 0, 0);
    CHECK_NEAR(exercise_clock_time(clock, 1, 1, 0, 1e9 + 3), 3, 1e-6);
    CHECK_NEAR(exercise_clock_time(clock, 1, 2, stamp_of(1000, false), 1e9 + 4), 4, 1e-6);
    CHECK_NEAR(exercise_clock_time(clock, 1, 2, stamp_of(1001, false), 1e9 + 5.1), 5, 1e-6);
    exercise_clock_destroy(clock);
}

/* Capture times count to 1e11 s (the year 5138), where a double still steps by 15 us; beyond, the last one is kept. */
static void capture_times_count_to_1e11_s(void **state)
{
    (void)state;
    for (int beyond = 0; beyond < 2; beyond++) {
        ExerciseClock *clock = new_clock();
        CHECK_NEAR(exercise_clock_time(clock, 1, 1, 0, 1000), 0, 0);
        const double late_s = beyond ? 1.02e11 : 0.98e11;
        CHECK_NEAR(exercise_clock_time(clock, 1, 1, 0, late_s), beyond ? 0 : late_s - 1000, 1e-4);
        exercise_clock_destroy(clock);
    }
}

static void foolish_capture_times_do_no_harm(void **state)
{
    (void)state;
    static const double foolish[] = {NAN, INFINITY, -INFINITY, 1e300, -1e300};
    for (int i = 0; i < 5; i++) {
        ExerciseClock *clock = new_clock();
        CHECK_NEAR(exercise_clock_time(clock, 1, 1, stamp_of(7, false), foolish[i]), 7, tick_s);
        CHECK_NEAR(exercise_clock_time(clock, 1, 1, stamp_of(9, false), foolish[i]), 7,
                   tick_s); /* no time has passed */
        exercise_clock_destroy(clock);
        clock = new_clock();
        CHECK_NEAR(exercise_clock_time(clock, 1, 1, stamp_of(7, false), 1000), 7, tick_s);
        CHECK_NEAR(exercise_clock_time(clock, 1, 1, stamp_of(7, false), foolish[i]), 7, tick_s);
        CHECK_NEAR(exercise_clock_time(clock, 1, 1, stamp_of(10, false), 1003.1), 10, tick_s);
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
            const double capture_s = 1000 + pass * 2.125;
            const double got_s = exercise_clock_time(clock, (uint16_t)(i / 100), (uint16_t)(i * 7),
                                                     stamp_of(50 + 2 * pass, false), capture_s);
            CHECK_NEAR(got_s, pass == 0 ? 50 : i < 4096 ? 52 : 52.125, 2 * tick_s);
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
        cmocka_unit_test(a_restart_is_tied_again),
        cmocka_unit_test(one_wrong_stamp_counts_from_its_arrival),
        cmocka_unit_test(pauses_end_in_proven_stamps),
        cmocka_unit_test(stamps_that_are_no_clock_are_found_and_named),
        cmocka_unit_test(slight_rates_are_found_in_time),
        cmocka_unit_test(a_proven_clock_that_goes_wrong_is_tied_again),
        cmocka_unit_test(a_queue_that_fills_is_no_clock),
        cmocka_unit_test(five_seconds_are_the_limit),
        cmocka_unit_test(the_founders_delay_is_no_elses),
        cmocka_unit_test(small_delays_are_not_applied),
        cmocka_unit_test(proof_takes_its_time),
        cmocka_unit_test(a_second_pdu_is_overtaken_or_undecided),
        cmocka_unit_test(a_check_begins_again_where_the_capture_steps_back),
        cmocka_unit_test(limits_of_stamps_that_stand_still),
        cmocka_unit_test(a_jump_begins_one_segment),
        cmocka_unit_test(a_sender_that_spreads_a_frame_is_proven),
        cmocka_unit_test(a_stamp_of_zero_is_on_the_hour),
        cmocka_unit_test(two_senders_of_one_id_are_named),
        cmocka_unit_test(drift_is_followed),
        cmocka_unit_test(bundles_that_come_twice_are_no_fault),
        cmocka_unit_test(unstamped_senders_use_capture_time),
        cmocka_unit_test(capture_times_count_to_1e11_s),
        cmocka_unit_test(foolish_capture_times_do_no_harm),
        cmocka_unit_test(senders_are_bounded),
        cmocka_unit_test(noise_is_deterministic),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
