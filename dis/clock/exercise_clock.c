/* dis/clock/exercise_clock.c: a clock per sender, all on one exercise time.
 *
 * The capture clock is the reference: capture time shifted so that the first PDU has its own stamp's seconds. A
 * sender's stamps are tied to it at the sender's first PDU; from then on they give its own time, and the lower edge of
 * its delays (delay_line.c) says by how much that is to be shifted. The sender that set the epoch
 * is never shifted: its edge says where zero delay is for the others. So neither network jitter nor half an hour
 * without PDUs affects the times of a sender with valid stamps. */
#include "dis/clock/exercise_clock_private.h"

#include "dis/pdu/decode.h"

#include <stdlib.h>

enum {
    sender_limit = 4096, /* senders beyond this number are timed by capture time */
    segment_limit = 1 << 20,
};

static const double hour_s = 3600.0;
static const double capture_limit_s = 1e11; /* the year 5138: beyond it a double no longer resolves 0.02 ms */

Status exercise_clock_create(ExerciseClock **out)
{
    ExerciseClock *clock = calloc(1, sizeof *clock);
    if (!clock) return STATUS_NO_MEMORY;
    *out = clock;
    return STATUS_OK;
}

void exercise_clock_destroy(ExerciseClock *clock)
{
    if (clock) free(clock->valid);
    free(clock);
}

const ExerciseClockAnomalies *exercise_clock_anomalies(const ExerciseClock *clock) { return &clock->doubts; }

/* Returns NULL when the table is full and the sender is not in it, or when it is not in it and may not be added. */
static Sender *find_sender(bool *is_new, ExerciseClock *clock, uint32_t key, bool add)
{
    /* multiplicative hashing: 2^32 / golden ratio */
    uint32_t i = (key * 2654435769u) >> 19;
    _Static_assert(slot_count == 1 << (32 - 19), "the hash has as many bits as there are slots");
    *is_new = false;
    for (;; i = (i + 1) % slot_count) {
        Sender *sender = &clock->slot[i];
        if (sender->used && sender->key == key) return sender;
        if (sender->used) continue;
        if (!add || clock->senders == sender_limit) return NULL;
        clock->senders++;
        *sender = (Sender){.key = key, .used = true, .doubt = -1};
        *is_new = true;
        return sender;
    }
}

/* ---- placing -------------------------------------------------------------------------------------- */

double exercise_clock_whole_hours(double of_s) { return hour_s * round(of_s / hour_s); }

double exercise_clock_tied_time(const Tie *tie, uint32_t stamp, double ruler_s)
{
    const double t_s = tie->t_s + dis_timestamp_step_s(tie->stamp, stamp);
    return t_s + exercise_clock_whole_hours(ruler_s - t_s);
}

double exercise_clock_shifted_time(const ExerciseClock *clock, Scale scale, const DelayLine *own, double t_s)
{
    if (scale == SCALE_EPOCH) return t_s;
    const double z_s = t_s + delay_line_at(scale == SCALE_ABSOLUTE ? &clock->founder[scale] : own, t_s);
    return z_s - delay_line_at(&clock->founder[SCALE_EPOCH], z_s);
}

/* Whether the sender's absolute stamps are on the scale that all absolute senders share; if so, sets where. */
static bool on_absolute_scale(Tie *tie, ExerciseClock *clock, Scale scale, uint32_t stamp, double ruler_s)
{
    const double past_s = dis_timestamp_seconds(stamp);
    if (!clock->scales[scale]) return false;
    *tie = (Tie){stamp, scale == SCALE_EPOCH ? past_s + exercise_clock_whole_hours(ruler_s - past_s)
                                             : exercise_clock_tied_time(&clock->absolute, stamp, ruler_s)};
    return fabs(tie->t_s - ruler_s) <= leave_s;
}

void exercise_clock_tie(ExerciseClock *clock, Sender *sender, Moment now, double ruler_s, bool may_found)
{
    const bool  absolute = dis_timestamp_is_absolute(now.stamp);
    const Scale scale = clock->first_is_absolute ? SCALE_EPOCH : SCALE_ABSOLUTE;
    sender->scale = SCALE_OWN;
    sender->founds = false;
    sender->tie = (Tie){now.stamp, ruler_s};
    if (absolute && on_absolute_scale(&sender->tie, clock, scale, now.stamp, ruler_s)) {
        sender->scale = scale;
    } else if (may_found && !clock->scales[SCALE_EPOCH]) {
        sender->scale = SCALE_EPOCH;
    } else if (may_found && absolute && !clock->scales[scale]) {
        sender->scale = SCALE_ABSOLUTE;
        clock->absolute = (Tie){now.stamp, ruler_s};
    }
    if (sender->scale == SCALE_OWN) sender->tie = (Tie){now.stamp, ruler_s};
    delay_line_begin(&sender->line, sender->tie.t_s, ruler_s - sender->tie.t_s);
    if (sender->scale != SCALE_OWN && !clock->scales[sender->scale]) {
        sender->founds = clock->scales[sender->scale] = true;
        clock->founder[sender->scale] = sender->line;
    }
    sender->segment = sender->next_segment ? sender->next_segment : ++clock->segments;
    sender->next_segment = 0;
    sender->renewed = false;
    sender->trend = (DelayTrend){0};
    delay_trend_add(&sender->trend, sender->tie.t_s, ruler_s - sender->tie.t_s);
    sender->mark_s = now.capture_s;
    sender->agree = sender->odd = 0;
    const int times = sender->standing == SENDER_INCONSISTENT ? 1 << (sender->failures - 1) : 1;
    sender->next_vote_s = now.capture_s + vote_s * times;
}

void exercise_clock_keep(ExerciseClock *clock, const Sender *sender)
{
    if (clock->valid_count == segment_limit) return;
    if (clock->valid_count == clock->valid_capacity) {
        const int larger = clock->valid_capacity ? 2 * clock->valid_capacity : 64;
        Segment  *grown = realloc(clock->valid, (size_t)larger * sizeof *grown);
        if (!grown) {
            clock->lost_segment = true;
            return;
        }
        clock->valid = grown;
        clock->valid_capacity = larger;
    }
    clock->valid[clock->valid_count++] = (Segment){sender->segment, sender->scale, sender->tie, sender->line};
}

/* ---- instants ---------------------------------------------------------------------------------- */

ExerciseInstant exercise_clock_instant(ExerciseClock *clock, uint16_t site, uint16_t application, int entity,
                                       uint32_t timestamp, double capture_s)
{
    const bool     absolute = dis_timestamp_is_absolute(timestamp);
    const uint32_t key = (uint32_t)site << 16 | application;
    bool           is_new;
    if (!(fabs(capture_s) <= capture_limit_s)) capture_s = clock->last_capture_s; /* true for NaN as well */
    clock->last_capture_s = capture_s;

    const bool opens = !clock->started;
    if (opens) {
        clock->started = true;
        clock->first_is_absolute = absolute;
        clock->start_s = dis_timestamp_seconds(timestamp);
        clock->start_capture_s = capture_s;
    }
    const double          ruler_s = clock->start_s + (capture_s - clock->start_capture_s);
    const Moment          now = {timestamp, capture_s};
    const ExerciseInstant arrival = {.t_s = ruler_s, .ruler_s = ruler_s, .stamp = timestamp};

    /* A stamp of which all bits are zero comes from a sender that does not stamp, or from one that does, on the hour.
     * */
    Sender *sender = find_sender(&is_new, clock, key, timestamp != 0);
    if (timestamp == 0 && !sender) {
        clock->doubts.unstamped++;
        return arrival;
    }
    clock->doubts.stamped++;
    if (!sender) { /* there are more senders than can be checked: this PDU is counted as rejected */
        clock->doubts.by_arrival++;
        return arrival;
    }
    if (!is_new) return exercise_clock_judge(clock, sender, now, entity, ruler_s);
    sender->first = sender->one = now;
    sender->latest_stamp = timestamp;
    sender->pdus = 1;
    if (entity >= 0) exercise_clock_stands_still(clock, (uint64_t)key << 16 | (uint16_t)entity, now);
    exercise_clock_tie(clock, sender, now, ruler_s, true);
    return (ExerciseInstant){.t_s = exercise_clock_shifted_time(clock, sender->scale, &sender->line, sender->tie.t_s),
                             .ruler_s = ruler_s,
                             .stamp = timestamp,
                             .segment = sender->segment,
                             .by_stamp = true,
                             .sender = (uint16_t)(sender - clock->slot)};
}

ExerciseInstant exercise_clock_pdu_instant(ExerciseClock *clock, const DisHeader *header, const uint8_t *pdu,
                                           double capture_s)
{
    uint16_t sender[2];
    if (!dis_pdu_sender(sender, header, pdu)) return (ExerciseInstant){.t_s = NAN, .ruler_s = NAN};
    return exercise_clock_instant(clock, sender[0], sender[1], dis_pdu_entity(header, pdu), header->timestamp,
                                  capture_s);
}

/* ---- of a whole recording --------------------------------------------------------------------------- */

static int by_number(const void *a, const void *b)
{
    const Segment *p = a, *q = b;
    return p->number < q->number ? -1 : p->number > q->number;
}

Status exercise_clock_whole(ExerciseClock *clock)
{
    clock->doubts.by_arrival = 0;
    for (int i = 0; i < clock->doubts.count; i++) clock->doubts.sender[i].by_arrival = 0;
    for (int i = 0; i < slot_count; i++) {
        const Sender *sender = &clock->slot[i];
        const bool    known = sender->trend.points > 2 || fabs(sender->line.mean_y_s) <= gain_s;
        if (sender->used && sender->doubt >= 0) clock->doubts.sender[sender->doubt].pdus = sender->pdus;
        if (sender->used && (sender->standing == SENDER_PROVEN || (sender->standing == SENDER_NEW && known)))
            exercise_clock_keep(clock, sender);
    }
    if (clock->valid_count > 1) qsort(clock->valid, (size_t)clock->valid_count, sizeof *clock->valid, by_number);
    return clock->lost_segment ? STATUS_NO_MEMORY : STATUS_OK;
}

void exercise_clock_whole_time(ExerciseClock *clock, ExerciseInstant *at)
{
    const Segment  key = {.number = at->segment};
    const Segment *s = NULL;
    if (!(fabs(at->ruler_s) < INFINITY) || (at->stamp == 0 && at->segment == 0)) return;
    if (at->segment && clock->valid_count)
        s = bsearch(&key, clock->valid, (size_t)clock->valid_count, sizeof key, by_number);
    const bool same = at->by_stamp && at->t_s == at->ruler_s; /* it gets the same time as a sender's first PDU would */
    at->t_s = !s ? at->ruler_s
                 : exercise_clock_shifted_time(clock, s->scale, &s->line,
                                               exercise_clock_tied_time(&s->tie, at->stamp, at->ruler_s));
    if (s || same) return;
    clock->doubts.by_arrival++;
    const int doubted = at->segment ? clock->slot[at->sender].doubt : -1;
    if (doubted >= 0) clock->doubts.sender[doubted].by_arrival++;
}
