/* tests/dis/test_steady_clock.c: what a system's clock that is set does to arrival times: nothing. */
#include "tests/check.h"

#include "dis/clock/steady_clock.h"

static const int64_t s_ns = 1000000000, begun_ns = 1750000000ll * 1000000000;

/* Both clocks t_s after the beginning, the system's set by set_s. */
static ClockReading at(double t_s, double set_s)
{
    const int64_t passed_ns = (int64_t)(t_s * 1e9);
    return (ClockReading){begun_ns + passed_ns + (int64_t)(set_s * 1e9), 77 * s_ns + passed_ns};
}

static void a_clock_that_is_not_set_is_left_alone(void **state)
{
    (void)state;
    SteadyClock clock = steady_clock_begin(at(0, 0));
    for (int k = 0; k < 1000; k++) {
        const double       t_s = 0.37 * k;
        const ClockReading now = at(t_s, 1e-6 * (k % 7)); /* readings apart by microseconds */
        CHECK(steady_clock_look(&clock, now) == 0);
        CHECK(steady_clock_ns(&clock, now) == at(t_s, 0).system_ns);
        CHECK(steady_clock_of_stamp(&clock, now.system_ns - 12345, now) ==
              now.system_ns - 12345); /* to the nanosecond */
    }
}

static void a_clock_that_is_set_does_not_move_the_steady_one(void **state)
{
    (void)state;
    static const double set_s[] = {-3600, 3600, -1.5, 0.25, -1e9, 0};
    SteadyClock         clock = steady_clock_begin(at(0, 0));
    double              before_s = 0;
    for (int k = 0; k < 6; k++) {
        const double       t_s = 10.0 * (k + 1);
        const ClockReading now = at(t_s, set_s[k]);
        const int64_t      by_ns = steady_clock_look(&clock, now),
                      want_ns = (int64_t)(set_s[k] * 1e9) - (int64_t)(before_s * 1e9);
        CHECK(by_ns == want_ns && steady_clock_look(&clock, now) == 0); /* told once */
        CHECK(steady_clock_ns(&clock, now) == at(t_s, 0).system_ns);
        CHECK(steady_clock_of_stamp(&clock, now.system_ns - 5000, now) == at(t_s, 0).system_ns - 5000);
        before_s = set_s[k];
    }
}

/* Stamped before the clock was set back, read afterwards: not in the future. */
static void a_stamp_from_before_is_not_after_now(void **state)
{
    (void)state;
    SteadyClock        clock = steady_clock_begin(at(0, 0));
    const ClockReading now = at(2, -3600);
    const int64_t      stamp_ns = at(1.9, 0).system_ns;
    CHECK(steady_clock_look(&clock, now) == -3600 * s_ns);
    CHECK(steady_clock_of_stamp(&clock, stamp_ns, now) == at(2, 0).system_ns);
}

static void waits_are_on_the_monotonic_clock(void **state)
{
    (void)state;
    const int64_t         now_ns = steady_clock_now_ns();
    const struct timespec wait = steady_clock_monotonic(now_ns), none = steady_clock_monotonic(INT64_MIN);
    struct timespec       monotonic;
    clock_gettime(CLOCK_MONOTONIC, &monotonic);
    const double ahead_s = (double)(monotonic.tv_sec - wait.tv_sec) + 1e-9 * (double)(monotonic.tv_nsec - wait.tv_nsec);
    CHECK(ahead_s >= 0 && ahead_s < 60 && none.tv_sec == 0 && none.tv_nsec == 0);
    CHECK(steady_clock_now_ns() >= now_ns);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_clock_that_is_not_set_is_left_alone),
        cmocka_unit_test(a_clock_that_is_set_does_not_move_the_steady_one),
        cmocka_unit_test(a_stamp_from_before_is_not_after_now),
        cmocka_unit_test(waits_are_on_the_monotonic_clock),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
