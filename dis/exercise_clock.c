/* dis/exercise_clock.c: a clock per sender, all on one exercise time.
 *
 * The capture clock is the reference: capture time shifted so that the first PDU has its own stamp's seconds. A
 * sender's stamps are tied to it at the sender's first PDU; from then on they give its own time, and the lower edge of its
 * delays (dis/delay_line.h) says by how much that is to be shifted. The sender that set the epoch is never shifted: its
 * edge says where zero delay is for the others. So neither network jitter nor half an hour without PDUs affects the times
 * of a sender with valid stamps. */
#include "dis/exercise_clock.h"

#include "dis/datagram.h"
#include "dis/delay_line.h"

#include <stdio.h>
#include <stdlib.h>

enum {
    sender_limit = 4096,  /* beyond that capture time is used */
    slot_count   = 8192,  /* a power of two, at most half full */
    memory_slots = 16384, /* entities remembered for the check; a later one replaces an earlier one */
    odd_limit    = 2,     /* consecutive reports against a sender */
    votes_needed = 2,     /* consecutive, for a new or rejected sender */
    most_failures = 5,    /* the validation time is doubled at most this often: 2 minutes */
    switches_needed = 6,  /* from one clock to another and back, to be two senders */
    points_again = 30,    /* before a trend is judged that begins amid stamps that were right */
    points_known = 8,     /* a new sender with that many stamps in order may have one that is not */
    segment_limit = 1 << 20,
};

static const double hour_s = 3600.0;
static const double leave_s = 5.0;         /* stamps ahead or behind: IEEE 1278.1, timestamp ahead/behind */
static const double capture_limit_s = 1e11; /* the year 5138: beyond it a double no longer resolves 0.02 ms */

/* What stamps at another rate must have gained before they are rejected; and the drift of clocks, s a second. */
static const double gain_s = 0.15, drift = 1e-4;
/* Of PDUs in the order of their arrival the latest stamps are of those that were quick: that is a trend too, over as long a
 * time as the jitter. So a trend is one where it exceeds the scatter about it by this. */
static const double trend_over_scatter = 12;
/* A stamp that far behind its sender's latest is of a reordered datagram, not of a counter. */
static const double overtaken_s = 0.1;
static const double vote_s = 2.0, longest_vote_s = 32.0; /* spans over which the rate of stamps is checked */
static const double rate_known = 0.02; /* to be validated: three standard errors of the rate */
/* Two reports of one entity that far apart, with stamps that advance less than a twentieth of it: they are constant.
 * Jitter makes that of stamps that advance by more than still_step_s, but not over leave_s. */
static const double still_least_s = 0.1, still_most_s = 1800, still_rate = 0.05, still_step_s = 0.005;

typedef struct Moment {
    uint32_t stamp;
    double   capture_s;
} Moment;

/* Stamps tied to exercise time. */
typedef struct Tie {
    uint32_t stamp;
    double   t_s;
} Tie;

typedef enum Standing { SENDER_NEW, SENDER_PROVEN, SENDER_INCONSISTENT } Standing;

/* Whose scale a sender's stamps are on: its own, that of the sender that set the epoch, that of all absolute stamps. */
typedef enum Scale { SCALE_OWN, SCALE_EPOCH, SCALE_ABSOLUTE } Scale;

typedef struct Sender {
    uint32_t key; /* site, application */
    bool     used, founds; /* its delays are those of its scale */
    uint8_t  standing, scale;
    uint8_t  failures; /* number of rejections, most_failures at most */
    uint8_t  odd;      /* consecutive reports that deviate from the reference */
    uint8_t  agree;    /* consecutive passed checks, votes_needed at most */
    uint8_t  switches; /* consecutive, from one of two clocks to the other */
    bool     shared;   /* reported as two senders */
    bool     on_other;
    bool     renewed;  /* the trend is not of all PDUs since the tie */
    int      doubt;    /* index into the clock's anomalies; -1: never rejected, or list full */
    uint32_t segment, next_segment; /* next: of PDUs that may begin it; 0: none */
    uint32_t latest_stamp;
    Tie      tie;
    DelayLine  line;     /* since the tie */
    DelayTrend trend;    /* since the mark */
    double   mark_s, next_vote_s; /* capture times: begin of the check's span; from which on there is one */
    Moment   first, one, other; /* one, other: the latest of each of two clocks */
    uint64_t pdus;
} Sender;

/* The last report of an entity that is still_least_s after the one kept before it. */
typedef struct Memory {
    uint64_t key_plus_1; /* 0: none */
    Moment   last;
    int      repeats;    /* consecutive reports with the stamp of the one before */
} Memory;

/* A time over which a sender's stamps were valid. */
typedef struct Segment {
    uint32_t number;
    uint8_t  scale;
    Tie      tie;
    DelayLine line;
} Segment;

struct ExerciseClock {
    bool      started, first_is_absolute, scales[3]; /* scales: has a founder */
    double    start_s;         /* exercise time of the first PDU */
    double    start_capture_s; /* and when it was captured */
    double    last_capture_s;
    int       senders;
    uint32_t  segments; /* begun */
    ExerciseClockAnomalies doubts;
    DelayLine founder[3];      /* delays of the scales' founders; of SCALE_OWN none */
    Tie       absolute;        /* of SCALE_ABSOLUTE */
    Segment  *valid;           /* by number once whole */
    int       valid_count, valid_capacity;
    bool      lost_segment;    /* memory ran out for one */
    Sender    slot[slot_count];
    Memory    memory[memory_slots];
};

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

/* NULL when the table is full and this one is not in it, or it is not and none may be added. */
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

static double whole_hours(double of_s) { return hour_s * round(of_s / hour_s); }

/* Time of a stamp by a tie: the shorter way round the hour, then whole hours towards the reference. */
static double tied_time(const Tie *tie, uint32_t stamp, double ruler_s)
{
    const double t_s = tie->t_s + dis_timestamp_step_s(tie->stamp, stamp);
    return t_s + whole_hours(ruler_s - t_s);
}

/* A sender's own time as exercise time. */
static double shifted_time(const ExerciseClock *clock, Scale scale, const DelayLine *own, double t_s)
{
    if (scale == SCALE_EPOCH) return t_s;
    const double z_s = t_s + delay_line_at(scale == SCALE_ABSOLUTE ? &clock->founder[scale] : own, t_s);
    return z_s - delay_line_at(&clock->founder[SCALE_EPOCH], z_s);
}

/* Whether absolute stamps are on the common scale of them all, and then where. */
static bool on_absolute_scale(Tie *tie, ExerciseClock *clock, Scale scale, uint32_t stamp, double ruler_s)
{
    const double past_s = dis_timestamp_seconds(stamp);
    if (!clock->scales[scale]) return false;
    *tie = (Tie){stamp, scale == SCALE_EPOCH ? past_s + whole_hours(ruler_s - past_s)
                                             : tied_time(&clock->absolute, stamp, ruler_s)};
    return fabs(tie->t_s - ruler_s) <= leave_s;
}

/* From this PDU on: a new segment. may_found: its delays may be those of its scale. */
static void tie_sender(ExerciseClock *clock, Sender *sender, Moment now, double ruler_s, bool may_found)
{
    const bool  absolute = dis_timestamp_is_absolute(now.stamp);
    const Scale scale = clock->first_is_absolute ? SCALE_EPOCH : SCALE_ABSOLUTE;
    sender->scale  = SCALE_OWN;
    sender->founds = false;
    sender->tie    = (Tie){now.stamp, ruler_s};
    if (absolute && on_absolute_scale(&sender->tie, clock, scale, now.stamp, ruler_s)) {
        sender->scale = scale;
    } else if (may_found && !clock->scales[SCALE_EPOCH]) {
        sender->scale = SCALE_EPOCH;
    } else if (may_found && absolute && !clock->scales[scale]) {
        sender->scale   = SCALE_ABSOLUTE;
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
    sender->trend   = (DelayTrend){0};
    delay_trend_add(&sender->trend, sender->tie.t_s, ruler_s - sender->tie.t_s);
    sender->mark_s  = now.capture_s;
    sender->agree = sender->odd = 0;
    const int times = sender->standing == SENDER_INCONSISTENT ? 1 << (sender->failures - 1) : 1;
    sender->next_vote_s = now.capture_s + vote_s * times;
}

static void keep_segment(ExerciseClock *clock, const Sender *sender)
{
    if (clock->valid_count == segment_limit) return;
    if (clock->valid_count == clock->valid_capacity) {
        const int larger = clock->valid_capacity ? 2 * clock->valid_capacity : 64;
        Segment  *grown  = realloc(clock->valid, (size_t)larger * sizeof *grown);
        if (!grown) {
            clock->lost_segment = true;
            return;
        }
        clock->valid          = grown;
        clock->valid_capacity = larger;
    }
    clock->valid[clock->valid_count++] = (Segment){sender->segment, sender->scale, sender->tie, sender->line};
}

/* ---- checking ------------------------------------------------------------------------------------- */

/* Elapsed time of stamps less that of arrivals since a moment, s; modulo whole hours. */
static double gained_s(Moment since, Moment now)
{
    const double gained = dis_timestamp_step_s(since.stamp, now.stamp) - (now.capture_s - since.capture_s);
    return gained - whole_hours(gained);
}

/* How many reports of an entity in a row have the stamp of the one before: one may be a datagram twice, of a bundle as many
 * entities; two are a clock that stands still. Remembers this one. */
static int stands_still(ExerciseClock *clock, uint64_t entity_key, Moment now)
{
    Memory      *memory = &clock->memory[(entity_key * 0x9E3779B97F4A7C15u) >> 50];
    _Static_assert(memory_slots == 1 << (64 - 50), "the hash has as many bits as there are slots");
    const double passed_s = now.capture_s - memory->last.capture_s;
    const bool   known = memory->key_plus_1 == entity_key + 1;
    if (known && passed_s >= 0 && passed_s < still_least_s) return 0;
    const double step_s = fabs(dis_timestamp_step_s(memory->last.stamp, now.stamp));
    const bool   stands = known && passed_s >= 0 && passed_s < still_most_s && step_s <= still_rate * passed_s &&
                        (step_s <= still_step_s || passed_s > leave_s);
    *memory = (Memory){entity_key + 1, now, stands ? memory->repeats + (memory->repeats < odd_limit) : 0};
    return memory->repeats;
}

static bool is_overtaken(const Sender *sender, uint32_t stamp)
{
    const double step_s = dis_timestamp_step_s(sender->latest_stamp, stamp);
    return step_s <= -overtaken_s && step_s >= -leave_s;
}

/* Whether a sender's stamps have advanced since its first PDU: one that repeats may then be a datagram twice. */
static bool advances(const Sender *sender, Moment now)
{
    const double passed_s = now.capture_s - sender->first.capture_s;
    return passed_s >= still_least_s && dis_timestamp_step_s(sender->first.stamp, sender->latest_stamp) >= 0.5 * passed_s;
}

/* Whether stamps alternate between two clocks that both run: two senders of one id. */
static bool is_shared(Sender *sender, Moment now)
{
    const bool on_one = fabs(gained_s(sender->one, now)) <= 0.5 * leave_s;
    const bool on_other = !on_one && sender->other.stamp && fabs(gained_s(sender->other, now)) <= 0.5 * leave_s;
    if (!on_one && !on_other) sender->switches = 0;
    else if (sender->on_other != on_other && sender->switches < switches_needed) sender->switches++;
    sender->on_other = !on_one;
    *(on_one ? &sender->one : &sender->other) = now;
    return sender->switches >= switches_needed;
}

/* Whether absolute stamps are the time of day of their arrival. */
static bool is_utc(const Sender *sender, Moment now)
{
    const double off_s = dis_timestamp_seconds(now.stamp) - now.capture_s;
    return dis_timestamp_is_absolute(now.stamp) && sender->scale != SCALE_OWN && fabs(off_s - whole_hours(off_s)) <= leave_s;
}

/* Of a sender's second PDU: it may run at any rate. */
static bool is_undecided(const Sender *sender, Moment now)
{
    const double gained = gained_s(sender->first, now);
    return sender->pdus == 2 && fabs(gained) > gain_s + drift * fabs(now.capture_s - sender->first.capture_s);
}

static int list_doubt(ExerciseClock *clock, const Sender *sender, ExerciseClockReason reason)
{
    if (clock->doubts.count == exercise_clock_anomalies_listed_max) return -1;
    clock->doubts.sender[clock->doubts.count] = (ExerciseClockAnomaly){
        .site = (uint16_t)(sender->key >> 16), .application = (uint16_t)sender->key, .reason = reason};
    return clock->doubts.count++;
}

static void doubt(ExerciseClock *clock, Sender *sender, Moment now, double ruler_s, ExerciseClockReason reason)
{
    if (sender->standing == SENDER_PROVEN) keep_segment(clock, sender);
    else if (sender->founds) clock->founder[sender->scale].offset_s = clock->founder[sender->scale].slope = 0;
    if (sender->standing != SENDER_INCONSISTENT && sender->failures < most_failures) sender->failures++;
    if (sender->standing != SENDER_INCONSISTENT && sender->doubt < 0) sender->doubt = list_doubt(clock, sender, reason);
    sender->standing = SENDER_INCONSISTENT;
    tie_sender(clock, sender, now, ruler_s, false);
}

/* Takes this PDU's delay into the sender's and, where it is their founder, into all others'. */
static void observe(ExerciseClock *clock, Sender *sender, double t_s, double ruler_s)
{
    delay_line_add(&sender->line, t_s, ruler_s - t_s);
    delay_trend_add(&sender->trend, t_s, ruler_s - t_s);
    if (sender->founds) clock->founder[sender->scale] = sender->line;
}

/* Whether the stamps run at another rate than their arrivals: by the trend of all PDUs, of a validated sender by the lower
 * edge too, which a queue that fills does not move. */
static bool runs_wrong(const Sender *sender)
{
    const DelayTrend *trend = &sender->trend;
    double            slope, error, edge_span_s, middle_s;
    if (sender->renewed && trend->points < points_again) return false;
    if (!delay_trend_slope(&slope, &error, trend) || fabs(slope) <= 3 * drift ||
        fabs(slope) * (trend->last_x_s - trend->first_x_s) <= gain_s ||
        fabs(slope) <= delay_trend_critical(trend->points) * error ||
        fabs(slope) * (trend->last_x_s - trend->first_x_s) <= trend_over_scatter * delay_trend_scatter(trend))
        return false;
    if (sender->standing != SENDER_PROVEN) return true;
    const double edge = delay_line_edge(&edge_span_s, &middle_s, &sender->line);
    return fabs(edge) > 2 * drift && edge * slope > 0;
}

/* Whether the rate is known to be that of the arrivals. */
static bool runs_right(const Sender *sender)
{
    double slope, error;
    return delay_trend_slope(&slope, &error, &sender->trend) && 3 * error <= rate_known &&
           fabs(slope) <= fmax(3 * drift, 3 * error);
}

/* Rate check over the span since the mark. */
static void vote(ExerciseClock *clock, Sender *sender, Moment now, double t_s, double ruler_s)
{
    if (now.capture_s < sender->mark_s) { /* the capture clock stepped back */
        sender->mark_s      = now.capture_s;
        sender->next_vote_s = now.capture_s + vote_s;
        sender->renewed     = true;
        sender->trend       = (DelayTrend){0};
        delay_trend_add(&sender->trend, t_s, ruler_s - t_s);
    }
    if (runs_wrong(sender)) {
        doubt(clock, sender, now, ruler_s, EXERCISE_CLOCK_RATE);
        return;
    }
    if (now.capture_s < sender->next_vote_s) return;
    const double span_s = now.capture_s - sender->mark_s;
    const bool   right  = runs_right(sender);
    if (right && sender->agree < votes_needed) sender->agree++;
    if (sender->agree == votes_needed) sender->standing = SENDER_PROVEN;
    if (span_s >= longest_vote_s && (right || span_s >= 4 * longest_vote_s)) {
        sender->mark_s  = now.capture_s;
        sender->renewed = true;
        sender->trend   = (DelayTrend){0};
        delay_trend_add(&sender->trend, t_s, ruler_s - t_s);
    }
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

static void note_shared(ExerciseClock *clock, Sender *sender, Moment now)
{
    if (!is_shared(sender, now) || sender->shared) return;
    sender->shared = true;
    const int d = list_doubt(clock, sender, EXERCISE_CLOCK_SHARED);
    if (d < 0) return;
    clock->doubts.sender[d].pdus    = sender->pdus;
    clock->doubts.sender[d].apart_s = fabs(gained_s(sender->one, sender->other));
}

/* Of a stamped PDU of a sender that is checked. */
static ExerciseInstant judge(ExerciseClock *clock, Sender *sender, Moment now, int entity, double ruler_s)
{
    const bool overtaken = is_overtaken(sender, now.stamp);
    sender->pdus++;
    note_shared(clock, sender, now);
    if (!overtaken) sender->latest_stamp = now.stamp;

    const int    repeats = entity < 0 ? 0 : stands_still(clock, (uint64_t)sender->key << 16 | (uint16_t)entity, now);
    const bool   stands = repeats > 0;
    const double t_s = tied_time(&sender->tie, now.stamp, ruler_s);
    const bool   leaves = !(fabs(ruler_s - t_s - delay_line_at(&sender->line, t_s)) <= leave_s);
    const ExerciseClockReason reason = leaves ? EXERCISE_CLOCK_JUMP : EXERCISE_CLOCK_STILL;
    bool by_arrival = leaves;

    sender->odd = leaves ? sender->odd + 1 : 0;
    if (leaves && !sender->next_segment) sender->next_segment = ++clock->segments;
    if (leaves && sender->standing != SENDER_PROVEN && sender->trend.points < points_known) {
        doubt(clock, sender, now, ruler_s, reason);
    } else if (sender->odd >= odd_limit || repeats >= odd_limit) {
        doubt(clock, sender, now, ruler_s, reason);
    } else if (stands) {
        by_arrival = leaves || (sender->standing != SENDER_PROVEN && !advances(sender, now));
    } else if (!leaves) {
        sender->next_segment = 0;
        observe(clock, sender, t_s, ruler_s);
        by_arrival = sender->standing == SENDER_NEW && !overtaken && !is_utc(sender, now) && is_undecided(sender, now);
        vote(clock, sender, now, t_s, ruler_s);
    }
    ExerciseInstant at = {.t_s = ruler_s, .ruler_s = ruler_s, .stamp = now.stamp, .segment = sender->segment,
                          .sender = (uint16_t)(sender - clock->slot)};
    if (leaves && sender->next_segment) at.segment = sender->next_segment;
    if (sender->standing == SENDER_INCONSISTENT) {
        note_inconsistent(clock, sender, now);
    } else if (!by_arrival) {
        at.t_s     = shifted_time(clock, sender->scale, &sender->line, tied_time(&sender->tie, now.stamp, ruler_s));
        at.by_stamp = true;
    }
    return at;
}

ExerciseInstant exercise_clock_instant(ExerciseClock *clock, uint16_t site, uint16_t application, int entity,
                                       uint32_t timestamp, double capture_s)
{
    const bool     absolute = dis_timestamp_is_absolute(timestamp);
    const uint32_t key = (uint32_t)site << 16 | application;
    bool           is_new;
    if (!(fabs(capture_s) <= capture_limit_s)) capture_s = clock->last_capture_s; /* NaN too */
    clock->last_capture_s = capture_s;

    const bool opens = !clock->started;
    if (opens) {
        clock->started = true;
        clock->first_is_absolute = absolute;
        clock->start_s = dis_timestamp_seconds(timestamp);
        clock->start_capture_s = capture_s;
    }
    const double ruler_s = clock->start_s + (capture_s - clock->start_capture_s);
    const Moment now = {timestamp, capture_s};
    const ExerciseInstant arrival = {.t_s = ruler_s, .ruler_s = ruler_s, .stamp = timestamp};

    /* All bits zero: a sender that does not stamp, or one that does, on the hour. */
    Sender *sender = find_sender(&is_new, clock, key, timestamp != 0);
    if (timestamp == 0 && !sender) {
        clock->doubts.unstamped++;
        return arrival;
    }
    clock->doubts.stamped++;
    if (!sender) { /* more senders than are checked: counted as rejected */
        clock->doubts.by_arrival++;
        return arrival;
    }
    if (!is_new) return judge(clock, sender, now, entity, ruler_s);
    sender->first = sender->one = now;
    sender->latest_stamp = timestamp;
    sender->pdus = 1;
    if (entity >= 0) stands_still(clock, (uint64_t)key << 16 | (uint16_t)entity, now);
    tie_sender(clock, sender, now, ruler_s, true);
    return (ExerciseInstant){.t_s = shifted_time(clock, sender->scale, &sender->line, sender->tie.t_s), .ruler_s = ruler_s,
                             .stamp = timestamp, .segment = sender->segment, .by_stamp = true,
                             .sender = (uint16_t)(sender - clock->slot)};
}

double exercise_clock_report_time(ExerciseClock *clock, uint16_t site, uint16_t application, int entity,
                                  uint32_t timestamp, double capture_s)
{
    return exercise_clock_instant(clock, site, application, entity, timestamp, capture_s).t_s;
}

ExerciseInstant exercise_clock_pdu_instant(ExerciseClock *clock, const DisHeader *header, const uint8_t *pdu,
                                           double capture_s)
{
    uint16_t sender[2];
    if (!dis_pdu_sender(sender, header, pdu)) return (ExerciseInstant){.t_s = NAN, .ruler_s = NAN};
    return exercise_clock_instant(clock, sender[0], sender[1], dis_pdu_entity(header, pdu), header->timestamp, capture_s);
}

double exercise_clock_pdu_time(ExerciseClock *clock, const DisHeader *header, const uint8_t *pdu, double capture_s)
{
    return exercise_clock_pdu_instant(clock, header, pdu, capture_s).t_s;
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
            keep_segment(clock, sender);
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
    const bool same = at->by_stamp && at->t_s == at->ruler_s; /* as the first PDU of a sender */
    at->t_s = s ? shifted_time(clock, s->scale, &s->line, tied_time(&s->tie, at->stamp, at->ruler_s)) : at->ruler_s;
    if (s || same) return;
    clock->doubts.by_arrival++;
    const int doubted = at->segment ? clock->slot[at->sender].doubt : -1;
    if (doubted >= 0) clock->doubts.sender[doubted].by_arrival++;
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
    if (d->reason == EXERCISE_CLOCK_SHARED) {
        snprintf(out, size, "time stamps of %u:%u follow two clocks %.1f s apart: two senders have this site and "
                 "application; give one another", d->site, d->application, d->apart_s);
        return;
    }
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
