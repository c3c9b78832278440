/* dis/exercise_clock.c: a clock per sender, all on one exercise time.
 *
 * The capture clock is the reference: capture time shifted so that the first PDU has its own stamp's seconds. A
 * sender's stamps are placed on it once, at its first PDU, and from then on give the time; the reference selects the
 * hour of a stamp and is what stamps are checked against. So neither network jitter nor half an hour without PDUs
 * affects the times of a sender with valid stamps. */
#include "dis/exercise_clock.h"

#include "dis/datagram.h"

#include <stdio.h>
#include <stdlib.h>

enum {
    sender_limit = 4096,  /* beyond that capture time is used */
    slot_count   = 8192,  /* a power of two, at most half full */
    memory_slots = 16384, /* entities remembered for the check; a later one replaces an earlier one */
    odd_limit    = 2,     /* consecutive reports against a validated sender */
    votes_needed = 2,     /* consecutive, for a rejected sender */
    most_failures = 5,    /* the validation time is doubled at most this often: 2 minutes */
};

static const double hour_s = 3600.0;
static const double leave_s = 5.0;         /* stamps ahead or behind: IEEE 1278.1, timestamp ahead/behind */
static const double capture_limit_s = 1e11; /* the year 5138: beyond it a double no longer resolves 0.02 ms */

/* What is expected of a network: datagrams bundled or delayed by some 100 ms, both ways about the first one's delay. */
static const double jitter_s = 0.15, drift = 1e-4; /* and of clocks: s a second */
/* A stamp that far behind its sender's latest is of a reordered datagram, not of a counter. */
static const double overtaken_s = 0.1;
static const double settled_s = 1.0;       /* drift of a validated sender at which its offset is renewed */
static const double vote_s = 2.0, longest_vote_s = 32.0; /* spans over which the rate of stamps is checked */
/* Two reports of one entity that far apart, with stamps that advance less than a twentieth of it: they are constant. */
static const double still_least_s = 0.1, still_most_s = 1800, still_rate = 0.05;

typedef struct Moment {
    uint32_t stamp;
    double   capture_s;
} Moment;

typedef enum Standing { SENDER_NEW, SENDER_PROVEN, SENDER_INCONSISTENT } Standing;

typedef struct Sender {
    uint32_t key; /* site, application */
    bool     used;
    uint8_t  standing;
    uint8_t  failures; /* number of rejections, most_failures at most */
    uint8_t  odd;      /* consecutive reports that deviate from the reference or are constant */
    uint8_t  agree;    /* consecutive passed checks, votes_needed at most */
    bool     disagrees; /* the last check */
    int      doubt;    /* index into the clock's anomalies; -1: never rejected, or list full */
    uint32_t tied_stamp, latest_stamp;
    double   tied_s;   /* exercise time of the tied one */
    Moment   mark;     /* start of the span of the next check */
    double   next_vote_s; /* capture time from which on there is one */
    Moment   first;
    uint64_t pdus;
} Sender;

/* The last report of an entity that is still_least_s after the one kept before it. */
typedef struct Memory {
    uint64_t key_plus_1; /* 0: none */
    Moment   last;
} Memory;

struct ExerciseClock {
    bool    started, first_is_absolute;
    double  start_s;         /* exercise time of the first PDU */
    double  start_capture_s; /* and when it was captured */
    double  last_capture_s;
    int     senders;
    ExerciseClockAnomalies doubts;
    Sender  slot[slot_count];
    Memory  memory[memory_slots];
};

Status exercise_clock_create(ExerciseClock **out)
{
    ExerciseClock *clock = calloc(1, sizeof *clock);
    if (!clock) return STATUS_NO_MEMORY;
    *out = clock;
    return STATUS_OK;
}

void exercise_clock_destroy(ExerciseClock *clock) { free(clock); }

const ExerciseClockAnomalies *exercise_clock_anomalies(const ExerciseClock *clock) { return &clock->doubts; }

/* NULL when the table is full and this one is not in it. */
static Sender *find_sender(bool *is_new, ExerciseClock *clock, uint32_t key)
{
    /* multiplicative hashing: 2^32 / golden ratio */
    uint32_t i = (key * 2654435769u) >> 19;
    _Static_assert(slot_count == 1 << (32 - 19), "the hash has as many bits as there are slots");
    *is_new = false;
    for (;; i = (i + 1) % slot_count) {
        Sender *sender = &clock->slot[i];
        if (sender->used && sender->key == key) return sender;
        if (sender->used) continue;
        if (clock->senders == sender_limit) return NULL;
        clock->senders++;
        *sender = (Sender){.key = key, .used = true, .doubt = -1};
        *is_new = true;
        return sender;
    }
}

/* ---- placing -------------------------------------------------------------------------------------- */

/* Time of a stamp by the sender's own offset: the shorter way round the hour, then whole hours towards the
 * reference. */
static double stamped_time(const Sender *sender, uint32_t stamp, double ruler_s)
{
    const double t_s = sender->tied_s + dis_timestamp_step_s(sender->tied_stamp, stamp);
    return t_s + hour_s * round((ruler_s - t_s) / hour_s);
}

static void tie(Sender *sender, Moment now, double t_s)
{
    sender->tied_stamp = now.stamp;
    sender->tied_s     = t_s;
    sender->mark       = now;
    sender->agree = sender->odd = 0;
    sender->disagrees  = false;
    const int times = sender->standing == SENDER_INCONSISTENT ? 1 << (sender->failures - 1) : 1;
    sender->next_vote_s = now.capture_s + vote_s * times;
}

static void tie_first(Sender *sender, Moment now, double ruler_s, bool absolute)
{
    tie(sender, now, ruler_s);
    sender->first        = now;
    sender->latest_stamp = now.stamp;
    if (!absolute) return;
    /* UTC on both sides: the stamp itself, in the hour of the reference */
    const double past_s = dis_timestamp_seconds(now.stamp);
    const double t_s = past_s + hour_s * round((ruler_s - past_s) / hour_s);
    if (fabs(t_s - ruler_s) <= leave_s) sender->tied_s = t_s;
}

/* ---- checking ------------------------------------------------------------------------------------- */

/* Elapsed time of stamps less that of arrivals since a moment, s; modulo whole hours. */
static double gained_s(Moment since, Moment now)
{
    const double gain_s = dis_timestamp_step_s(since.stamp, now.stamp) - (now.capture_s - since.capture_s);
    return gain_s - hour_s * round(gain_s / hour_s);
}

/* Whether the elapsed times of stamps and arrivals since a moment agree. */
static bool keeps_pace(Moment since, Moment now)
{
    return fabs(gained_s(since, now)) <= jitter_s + drift * fabs(now.capture_s - since.capture_s);
}

/* Whether an entity's stamps are constant between two of its reports; remembers this one. */
static bool stands_still(ExerciseClock *clock, uint64_t entity_key, Moment now)
{
    Memory      *memory = &clock->memory[(entity_key * 0x9E3779B97F4A7C15u) >> 50];
    _Static_assert(memory_slots == 1 << (64 - 50), "the hash has as many bits as there are slots");
    const double passed_s = now.capture_s - memory->last.capture_s;
    const bool   known = memory->key_plus_1 == entity_key + 1;
    if (known && passed_s >= 0 && passed_s < still_least_s) return false;
    const bool   stands = known && passed_s >= 0 && passed_s < still_most_s &&
                          fabs(dis_timestamp_step_s(memory->last.stamp, now.stamp)) <= still_rate * passed_s;
    *memory = (Memory){entity_key + 1, now};
    return stands;
}

static bool is_overtaken(const Sender *sender, uint32_t stamp)
{
    const double step_s = dis_timestamp_step_s(sender->latest_stamp, stamp);
    return step_s <= -overtaken_s && step_s >= -leave_s;
}

static void doubt(ExerciseClock *clock, Sender *sender, Moment now, double ruler_s, ExerciseClockReason reason)
{
    if (sender->standing != SENDER_INCONSISTENT && sender->failures < most_failures) sender->failures++;
    if (sender->standing != SENDER_INCONSISTENT && sender->doubt < 0 && clock->doubts.count < exercise_clock_anomalies_listed_max) {
        sender->doubt = clock->doubts.count++;
        clock->doubts.sender[sender->doubt] = (ExerciseClockAnomaly){
            .site = (uint16_t)(sender->key >> 16), .application = (uint16_t)sender->key, .reason = reason};
    }
    sender->standing = SENDER_INCONSISTENT;
    tie(sender, now, ruler_s);
}

/* Rate check over the span since the mark: are the elapsed times of stamps and arrivals equal? After a failure the
 * first PDU that passes revokes it; without one for two seconds the failure is final. */
static void vote(ExerciseClock *clock, Sender *sender, Moment now, double off_s, double ruler_s)
{
    if (now.capture_s < sender->mark.capture_s) { /* the capture clock stepped back */
        sender->mark        = now;
        sender->next_vote_s = now.capture_s + vote_s;
    }
    const bool due = now.capture_s >= sender->next_vote_s;
    if (!due && !sender->disagrees) return;
    if (!(keeps_pace(sender->mark, now) && fabs(off_s) <= settled_s)) {
        if (!due) return;
        if (sender->disagrees) doubt(clock, sender, now, ruler_s, EXERCISE_CLOCK_RATE);
        else sender->disagrees = true, sender->agree = 0, sender->next_vote_s = now.capture_s + vote_s;
        return;
    }
    const double span_s = now.capture_s - sender->mark.capture_s;
    sender->disagrees = false;
    if (sender->agree < votes_needed) sender->agree++;
    if (sender->agree == votes_needed) sender->standing = SENDER_PROVEN;
    if (span_s >= longest_vote_s) sender->mark = now;
    sender->next_vote_s = now.capture_s + (span_s >= longest_vote_s ? longest_vote_s : fmax(span_s, vote_s));
}

static void note_inconsistent(ExerciseClock *clock, const Sender *sender, Moment now)
{
    clock->doubts.by_arrival++;
    if (sender->doubt < 0) return;
    ExerciseClockAnomaly *d = &clock->doubts.sender[sender->doubt];
    const double        passed_s = now.capture_s - sender->first.capture_s;
    d->by_arrival++;
    d->pdus = sender->pdus;
    if (!(passed_s > 0)) return;
    d->passed_s = passed_s;
    d->raw_hz = (uint32_t)(now.stamp - sender->first.stamp) / passed_s;
    d->rate   = dis_timestamp_step_s(sender->first.stamp, now.stamp) / passed_s;
    d->counted = (uint32_t)(now.stamp - sender->first.stamp) / fmax((double)(sender->pdus - 1), 1);
}

double exercise_clock_report_time(ExerciseClock *clock, uint16_t site, uint16_t application, int entity,
                                  uint32_t timestamp, double capture_s)
{
    const bool     absolute = dis_timestamp_is_absolute(timestamp);
    const uint32_t key = (uint32_t)site << 16 | application;
    bool           is_new;
    if (!(fabs(capture_s) <= capture_limit_s)) capture_s = clock->last_capture_s; /* NaN too */
    clock->last_capture_s = capture_s;

    if (!clock->started) {
        clock->started = true;
        clock->first_is_absolute = absolute;
        clock->start_s = dis_timestamp_seconds(timestamp);
        clock->start_capture_s = capture_s;
    }
    const double ruler_s = clock->start_s + (capture_s - clock->start_capture_s);
    const Moment now = {timestamp, capture_s};

    /* All bits zero: a sender that does not stamp. */
    if (timestamp == 0) {
        clock->doubts.unstamped++;
        return ruler_s;
    }
    clock->doubts.stamped++;

    Sender *sender = find_sender(&is_new, clock, key);
    if (!sender) { /* more senders than are checked: counted as rejected */
        clock->doubts.by_arrival++;
        return ruler_s;
    }
    if (is_new) tie_first(sender, now, ruler_s, absolute && clock->first_is_absolute);
    sender->pdus++;
    const bool overtaken = is_overtaken(sender, timestamp);
    if (!overtaken) sender->latest_stamp = timestamp;

    const bool   stands = entity >= 0 && stands_still(clock, (uint64_t)key << 16 | (uint16_t)entity, now);
    const double t_s = stamped_time(sender, timestamp, ruler_s), off_s = t_s - ruler_s;
    const bool   leaves = !(fabs(off_s) <= leave_s);
    const ExerciseClockReason reason =
        stands ? EXERCISE_CLOCK_STILL : leaves ? EXERCISE_CLOCK_JUMP : EXERCISE_CLOCK_RATE;

    if (sender->standing == SENDER_PROVEN) {
        sender->odd = stands || leaves ? sender->odd + 1 : 0;
        if (sender->odd >= odd_limit) doubt(clock, sender, now, ruler_s, reason);
        else if (!sender->odd) vote(clock, sender, now, off_s, ruler_s);
    } else if (sender->standing == SENDER_NEW && !stands && !leaves && overtaken) {
        return t_s;
    } else if (stands || !keeps_pace(sender->mark, now)) {
        doubt(clock, sender, now, ruler_s, reason);
    } else {
        vote(clock, sender, now, off_s, ruler_s);
    }
    if (sender->standing != SENDER_INCONSISTENT) return leaves ? ruler_s : stamped_time(sender, timestamp, ruler_s);
    note_inconsistent(clock, sender, now);
    return ruler_s;
}

double exercise_clock_pdu_time(ExerciseClock *clock, const DisHeader *header, const uint8_t *pdu, double capture_s)
{
    uint16_t sender[2];
    if (!dis_pdu_sender(sender, header, pdu)) return NAN;
    return exercise_clock_report_time(clock, sender[0], sender[1], dis_pdu_entity(header, pdu), header->timestamp,
                                      capture_s);
}

/* ---- reporting ------------------------------------------------------------------------------------- */

/* Whether something counted at about a rate; whole counts at both ends. */
static bool near_rate(double hz, double of_hz, double passed_s)
{
    return hz > 0 && passed_s >= 4 && fabs(hz - of_hz) <= 0.03 * of_hz + 1 / passed_s;
}

void exercise_clock_anomaly_text(char *out, size_t size, const ExerciseClockAnomaly *d)
{
    static const struct { double hz; const char *what; } unit[] = {
        {1e6, "look like microseconds"}, {2e6, "look like microseconds"}, {1e3, "look like milliseconds"},
        {2e3, "look like milliseconds"}, {1, "look like seconds"}, {2, "look like seconds"}};
    char        rate[64];
    const char *what = "jump about";
    if (d->reason != EXERCISE_CLOCK_JUMP) {
        snprintf(rate, sizeof rate, "run at %.3g times the rate of their arrivals", d->rate);
        what = d->raw_hz == 0 ? "stand still" : rate;
        if (d->raw_hz > 0 && fabs(d->rate) <= still_rate) what = "count something else than time";
        for (size_t i = 0; i < sizeof unit / sizeof unit[0]; i++)
            if (near_rate(d->raw_hz, unit[i].hz, d->passed_s)) what = unit[i].what;
        if (near_rate(d->counted, 1, INFINITY) || near_rate(d->counted, 2, INFINITY)) what = "count its PDUs";
    }
    snprintf(out, size, "time stamps of %u:%u %s: %llu of its %llu PDUs count from their arrival", d->site,
             d->application, what, (unsigned long long)d->by_arrival, (unsigned long long)d->pdus);
}
