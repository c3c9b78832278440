/* dis/exercise_clock.c: a clock per sender, all on one exercise time.
 *
 * The capture clock is the ruler: capture time shifted so that the first PDU has its own stamp's seconds. A
 * sender's stamps are placed on it once, at its first PDU, and from then on give the time; the ruler only
 * chooses the hour a stamp belongs to and notices when a sender has left it. So neither network jitter nor a
 * half hour of silence enters the times. */
#include "dis/exercise_clock.h"

#include <stdlib.h>

enum {
    sender_limit = 4096,      /* beyond that capture time is used */
    slot_count = 8192,        /* a power of two, at most half full */
    ties_before_distrust = 3, /* after the first: dis/exercise_clock.h */
};

static const double hour_s = 3600.0;
static const double leave_s = 5.0;         /* stamps ahead or behind: IEEE 1278.1, timestamp ahead/behind */
static const double capture_limit_s = 1e11; /* the year 5138: beyond it a double no longer resolves 0.02 ms */

typedef struct Sender {
    uint32_t key; /* site, application */
    bool     used, distrusted;
    int      ties;
    uint32_t tied_stamp;
    double   tied_s;     /* exercise time of it */
} Sender;

struct ExerciseClock {
    bool   started, first_is_absolute;
    double start_s;         /* exercise time of the first PDU */
    double start_capture_s; /* and when it was captured */
    double last_capture_s;
    int    senders;
    Sender slot[slot_count];
};

Status exercise_clock_create(ExerciseClock **out)
{
    ExerciseClock *clock = calloc(1, sizeof *clock);
    if (!clock) return STATUS_NO_MEMORY;
    *out = clock;
    return STATUS_OK;
}

void exercise_clock_destroy(ExerciseClock *clock) { free(clock); }

/* NULL when the table is full and this one is not in it. */
static Sender *find_sender(ExerciseClock *clock, uint32_t key)
{
    /* multiplicative hashing: 2^32 / golden ratio */
    uint32_t i = (key * 2654435769u) >> 19;
    _Static_assert(slot_count == 1 << (32 - 19), "the hash has as many bits as there are slots");
    for (;; i = (i + 1) % slot_count) {
        Sender *sender = &clock->slot[i];
        if (sender->used && sender->key == key) return sender;
        if (sender->used) continue;
        if (clock->senders == sender_limit) return NULL;
        clock->senders++;
        *sender = (Sender){.key = key, .used = true, .ties = -1};
        return sender;
    }
}

/* Time of a stamp by the sender's own tie: the short way round the hour, then whole hours towards the ruler. */
static double stamped_time(const Sender *sender, uint32_t stamp, double ruler_s)
{
    const double t_s = sender->tied_s + dis_timestamp_step_s(sender->tied_stamp, stamp);
    return t_s + hour_s * round((ruler_s - t_s) / hour_s);
}

static void tie(Sender *sender, uint32_t stamp, double t_s)
{
    sender->ties++;
    sender->tied_stamp = stamp;
    sender->tied_s = t_s;
}

double exercise_clock_time(ExerciseClock *clock, uint16_t site, uint16_t application, uint32_t timestamp,
                           double capture_s)
{
    const bool     absolute = dis_timestamp_is_absolute(timestamp);
    if (!(fabs(capture_s) <= capture_limit_s)) capture_s = clock->last_capture_s; /* NaN too */
    clock->last_capture_s = capture_s;

    if (!clock->started) {
        clock->started = true;
        clock->first_is_absolute = absolute;
        clock->start_s = dis_timestamp_seconds(timestamp);
        clock->start_capture_s = capture_s;
    }
    const double ruler_s = clock->start_s + (capture_s - clock->start_capture_s);

    /* All bits zero: a sender that does not stamp. It must not be held still until it is distrusted. */
    if (timestamp == 0) return ruler_s;

    Sender *sender = find_sender(clock, (uint32_t)site << 16 | application);
    if (!sender || sender->distrusted) return ruler_s;

    if (sender->ties < 0) {
        tie(sender, timestamp, ruler_s);
        if (absolute && clock->first_is_absolute) {
            /* UTC on both sides: the stamp itself, in the hour of the ruler */
            const double past_s = dis_timestamp_seconds(timestamp);
            sender->tied_s = past_s + hour_s * round((ruler_s - past_s) / hour_s);
        }
    }
    double t_s = stamped_time(sender, timestamp, ruler_s);
    if (!(fabs(t_s - ruler_s) <= leave_s)) {
        tie(sender, timestamp, ruler_s);
        if (sender->ties >= ties_before_distrust) sender->distrusted = true;
        t_s = ruler_s;
    }
    return t_s;
}
