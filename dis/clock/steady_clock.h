/* dis/clock/steady_clock.h: Unix time without steps: the system clock at the start of the program, continued by the
 * monotonic clock. Setting the clock back or forward neither stops a live node nor makes it skip.
 *
 * The kernel stamps datagrams by the system's clock; its steps since are subtracted. Without steps the stamps are
 * unchanged, to the nanosecond: slewing (adjtime, NTP) moves both clocks alike. */
#ifndef DIS_CLOCK_STEADY_CLOCK_H
#define DIS_CLOCK_STEADY_CLOCK_H

#include "pitviper.h"

#include <time.h>

/* Both clocks at one instant, ns. */
typedef struct ClockReading {
    int64_t system_ns, monotonic_ns;
} ClockReading;

ClockReading steady_clock_reading(void);

typedef struct SteadyClock {
    int64_t base_ns; /* Unix time less monotonic time when the program started */
    int64_t set_ns;  /* by how much the system clock was set since then; 0 when below a millisecond */
} SteadyClock;

static inline SteadyClock steady_clock_begin(ClockReading now)
{
    return (SteadyClock){.base_ns = now.system_ns - now.monotonic_ns};
}
static inline int64_t steady_clock_ns(const SteadyClock *clock, ClockReading now)
{
    return clock->base_ns + now.monotonic_ns;
}

/* Checks for a step of the system clock; returns the step since the last check, ns. */
int64_t steady_clock_look(SteadyClock *clock, ClockReading now);
/* A kernel time stamp, corrected by the steps found. The result is never after now, since a stamp from before the clock
 * was set may be read afterwards. */
int64_t steady_clock_of_stamp(const SteadyClock *clock, int64_t stamp_ns, ClockReading now);

/* ---- the program's own, begun by the first call of any of these; thread-safe ----------------------------- */

SteadyClock     steady_clock(void); /* a clock as it is when the program starts */
int64_t         steady_clock_now_ns(void);
struct timespec steady_clock_monotonic(int64_t unix_ns); /* the CLOCK_MONOTONIC time to wait for; not below 0 */

#endif
