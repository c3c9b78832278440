/* dis/exercise_clock.h: DIS time stamps and capture times -> one exercise time, a clock per sender.
 *
 * A sender is (site, application). A stamp counts 3600 s / 2^31 past the hour, in the upper 31 bits; the
 * lowest bit says absolute (UTC). The first sender heard with a stamp sets the exercise epoch: exercise
 * time = its seconds past the hour, unwrapped. Absolute senders share that scale when the first is
 * absolute too; every other sender is tied to it by capture time at its first PDU. A sender whose stamp
 * leaves capture time by more than 5 s (restart, frame counter) is tied again, and after three of those
 * its stamps are ignored and capture time is used. Depends on the order of PDUs only. */
#ifndef DIS_EXERCISE_CLOCK_H
#define DIS_EXERCISE_CLOCK_H

#include "dis/pdu.h"

typedef struct ExerciseClock ExerciseClock;

Status exercise_clock_create(ExerciseClock **out);
void   exercise_clock_destroy(ExerciseClock *clock);
/* Exercise time of a PDU, s. capture_s: when the datagram was captured or received (Unix time, s). */
double exercise_clock_time(ExerciseClock *clock, uint16_t site, uint16_t application, uint32_t timestamp,
                           double capture_s);

/* The same by the PDU itself; NaN, and the clock unmoved, for one that names no sender. */
static inline double exercise_clock_pdu_time(ExerciseClock *clock, const DisHeader *header, const uint8_t *pdu,
                                             double capture_s)
{
    uint16_t sender[2];
    if (!dis_pdu_sender(sender, header, pdu)) return NAN;
    return exercise_clock_time(clock, sender[0], sender[1], header->timestamp, capture_s);
}

/* Of an instant in seconds, >= 0, from any full hour; towards the past. */
static inline uint32_t dis_timestamp(double t_s, bool absolute)
{
    return (uint32_t)(fmod(t_s, 3600) / 3600 * 2147483648.0) << 1 | absolute;
}
static inline double dis_timestamp_seconds(uint32_t timestamp) { return (timestamp >> 1) * (3600.0 / 2147483648.0); }
/* Seconds from one stamp to the next, the short way round the hour: -1800 .. 1800. */
static inline double dis_timestamp_step_s(uint32_t from, uint32_t to)
{
    const int32_t ticks = (int32_t)(((to >> 1) - (from >> 1)) << 1) / 2; /* 31 bits, sign-extended */
    return ticks * (3600.0 / 2147483648.0);
}
static inline bool   dis_timestamp_is_absolute(uint32_t timestamp) { return timestamp & 1; }

#endif
