/* dis/clock/steady_clock.c: Unix time by the monotonic clock, and the steps of the system clock since. */
#include "dis/clock/steady_clock.h"

#include <pthread.h>
#include <stdlib.h>
#include <time.h>

static const int64_t ns_per_s = 1000000000;
static const int64_t least_set_ns = 1000000; /* a smaller difference is the time that passed between two readings */

static int64_t read_ns(clockid_t id)
{
    struct timespec t;
    clock_gettime(id, &t);
    return (int64_t)t.tv_sec * ns_per_s + t.tv_nsec;
}

/* Reads the system clock between two readings of the monotonic clock that are as close together as possible. */
ClockReading steady_clock_reading(void)
{
    enum { tries = 4 };
    static const int64_t close_ns = 2000;
    ClockReading         best = {0};
    int64_t              least_ns = INT64_MAX;
    for (int i = 0; i < tries && least_ns > close_ns; i++) {
        const int64_t before_ns = read_ns(CLOCK_MONOTONIC), system_ns = read_ns(CLOCK_REALTIME);
        const int64_t after_ns = read_ns(CLOCK_MONOTONIC);
        if (after_ns - before_ns >= least_ns) continue;
        least_ns = after_ns - before_ns;
        best = (ClockReading){system_ns, before_ns + least_ns / 2};
    }
    return best;
}

int64_t steady_clock_look(SteadyClock *clock, ClockReading now)
{
    const int64_t set_ns = now.system_ns - now.monotonic_ns - clock->base_ns, by_ns = set_ns - clock->set_ns;
    if (llabs(by_ns) < least_set_ns) return 0;
    clock->set_ns = llabs(set_ns) < least_set_ns ? 0 : set_ns;
    return by_ns;
}

int64_t steady_clock_of_stamp(const SteadyClock *clock, int64_t stamp_ns, ClockReading now)
{
    const int64_t at_ns = stamp_ns - clock->set_ns, now_ns = steady_clock_ns(clock, now);
    return at_ns - now_ns > least_set_ns ? now_ns : at_ns;
}

static SteadyClock    program;
static pthread_once_t once = PTHREAD_ONCE_INIT;

static void begin(void) { program = steady_clock_begin(steady_clock_reading()); }

SteadyClock steady_clock(void)
{
    pthread_once(&once, begin);
    return program;
}

int64_t steady_clock_now_ns(void) { return steady_clock().base_ns + read_ns(CLOCK_MONOTONIC); }

struct timespec steady_clock_monotonic(int64_t unix_ns)
{
    const int64_t base_ns = steady_clock().base_ns;
    if (unix_ns <= base_ns) return (struct timespec){0};
    const int64_t ns = unix_ns - base_ns;
    return (struct timespec){(time_t)(ns / ns_per_s), (long)(ns % ns_per_s)};
}
