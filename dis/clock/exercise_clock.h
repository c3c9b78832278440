/* dis/clock/exercise_clock.h: DIS time stamps and capture times -> one exercise time, a clock per sender.
 *
 * A sender is (site, application). A stamp counts 3600 s / 2^31 past the hour, in the upper 31 bits; the
 * lowest bit marks absolute time (UTC). The first sender received with a stamp sets the exercise epoch: exercise
 * time = its seconds past the hour, unwrapped. Absolute senders share that scale when the first is
 * absolute too; every other sender is tied to it by capture time at its first PDU. Depends on the order of PDUs only.
 *
 * Offset and drift of such a sender follow the least of its delays (delay_line.c), so jitter
 * enters neither: after N PDUs with jitter J its offset is some J / N late, and improves; of a whole recording the
 * offsets at its end are used for all of it (exercise_clock_whole).
 *
 * Not every sender writes the time into the stamp: some leave a constant there, count milliseconds, microseconds,
 * Unix seconds or PDUs. Stamps are compared with arrival times from a sender's second PDU on. They are rejected, and
 * the arrival time is used instead, when
 *   - an entity's stamps are constant over three reports at least 0.1 s apart;
 *   - a sender deviates by 5 s from the least of its delays, a validated one in two consecutive PDUs (restart);
 *   - the delays of a sender have a trend of more than 0.15 s that chance makes once in ten thousand times and that
 *     is twelve times their scatter about it, of a validated one
 *     their lower edge too, or a rise of half a second along a straight line: a clock at another rate. Jitter has none.
 * A sender's second PDU counts from its arrival when that is 0.15 s from its stamp: nothing tells the rate yet.
 * Rate checks over 2 s, 4 s, .. 32 s: two that know the rate, to 2 %, as that of the arrivals validate a sender, new or
 * rejected; its stamps are then used again with a new offset. A validated sender's datagram that is seconds late keeps
 * its stamp. Clocks may drift by 1e-4. */
#ifndef DIS_CLOCK_EXERCISE_CLOCK_H
#define DIS_CLOCK_EXERCISE_CLOCK_H

#include "dis/pdu/pdu.h"

typedef struct ExerciseClock ExerciseClock;

Status exercise_clock_create(ExerciseClock **out);
void   exercise_clock_destroy(ExerciseClock *clock);
/* Exercise time of a PDU, with what is needed to find it again when all PDUs are known. */
typedef struct ExerciseInstant {
    double   t_s, ruler_s; /* t_s: exercise time; ruler_s: exercise time of the arrival */
    uint32_t stamp, segment;
    uint16_t sender;   /* slot of its sender */
    bool     by_stamp; /* whether t_s was taken from the stamp when the PDU came */
} ExerciseInstant;

/* capture_s: when the datagram was captured or received (Unix time, s). entity: which of the sender's entities the PDU
 * reports; -1: it is no report. */
ExerciseInstant exercise_clock_instant(ExerciseClock *clock, uint16_t site, uint16_t application, int entity,
                                       uint32_t timestamp, double capture_s);
/* The exercise time of a report alone, s. */
static inline double exercise_clock_report_time(ExerciseClock *clock, uint16_t site, uint16_t application, int entity,
                                                uint32_t timestamp, double capture_s)
{
    return exercise_clock_instant(clock, site, application, entity, timestamp, capture_s).t_s;
}
/* The exercise time of a PDU whose sender has a single entity. */
static inline double exercise_clock_time(ExerciseClock *clock, uint16_t site, uint16_t application, uint32_t timestamp,
                                         double capture_s)
{
    return exercise_clock_report_time(clock, site, application, 0, timestamp, capture_s);
}
/* The instant of a PDU whose sender and entity are read from the PDU itself. For a PDU that names no sender t_s is NaN
 * and the clock is unchanged. */
ExerciseInstant exercise_clock_pdu_instant(ExerciseClock *clock, const DisHeader *header, const uint8_t *pdu,
                                           double capture_s);

/* Call exercise_clock_whole once, after the last PDU of a recording: what is then known of each sender applies to all
 * of its PDUs. Then call the second function once for each PDU: it sets the PDU's time, and counts anew those timed by
 * arrival. The first one fails only for want of memory. */
Status exercise_clock_whole(ExerciseClock *clock);
void   exercise_clock_whole_time(ExerciseClock *clock, ExerciseInstant *at);

/* ---- senders with rejected stamps ------------------------------------------------------------- */

typedef enum ExerciseClockReason {
    EXERCISE_CLOCK_STILL,
    EXERCISE_CLOCK_RATE,
    EXERCISE_CLOCK_JUMP,
    EXERCISE_CLOCK_SHARED /* two senders use one site and application */
} ExerciseClockReason;

typedef struct ExerciseClockAnomaly {
    uint16_t            site, application;
    ExerciseClockReason reason;           /* reason of the first anomaly */
    uint64_t            pdus, by_arrival; /* stamped PDUs received, and how many of them were timed by arrival */
    double              passed_s;         /* time from the sender's first PDU to the anomaly */
    double              rate, raw_hz; /* over that time: seconds of stamp, and units of the stamp field, per second */
    double              counted;      /* units of the stamp field per PDU */
    double              apart_s;      /* with two senders: how far their clocks are apart */
} ExerciseClockAnomaly;

enum { exercise_clock_anomalies_listed_max = 16, exercise_clock_anomaly_text_size = 160 };

typedef struct ExerciseClockAnomalies {
    uint64_t by_arrival; /* stamped PDUs of all senders that are timed by arrival, those of senders beyond the 4096
                            checked ones included */
    uint64_t stamped,
        unstamped; /* PDUs with a stamp, and PDUs whose stamp is all zero bits, which are also timed by arrival */
    int count;     /* number of senders listed below, in the order of their first anomaly; later ones are not listed */
    ExerciseClockAnomaly sender[exercise_clock_anomalies_listed_max];
} ExerciseClockAnomalies;

const ExerciseClockAnomalies *exercise_clock_anomalies(const ExerciseClock *clock);
/* "time stamps of 1:2 stand still: 98 of its 99 PDUs count from their arrival" */
void exercise_clock_anomaly_text(char *out, size_t size, const ExerciseClockAnomaly *doubt);

/* The stamp of an instant in seconds, >= 0, from any full hour; rounded towards the past. */
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
static inline bool dis_timestamp_is_absolute(uint32_t timestamp) { return timestamp & 1; }

#endif
