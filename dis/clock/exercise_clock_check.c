/* dis/clock/exercise_clock_check.c: whether a sender's stamps are those of a clock, by its PDUs' arrivals: rates,
 * jumps, stamps that stand still, two senders of one id. */
#include "dis/clock/exercise_clock_private.h"

#include <stdio.h>

enum {
    odd_limit = 2,       /* so many consecutive reports against a sender reject it */
    votes_needed = 2,    /* consecutive passed checks that validate a new or rejected sender */
    most_failures = 5,   /* the validation time is doubled at most this often: 2 minutes */
    switches_needed = 6, /* so many changes from one clock to the other and back show two senders */
    points_again = 30,   /* points needed to judge a trend that begins amid stamps that were right */
    points_known = 8,    /* one stamp out of order is tolerated from a new sender after so many in order */
};

/* Among PDUs in the order of their arrival, the latest stamps belong to those that travelled quickly. That alone makes
 * a trend, over a time as long as the jitter. So a trend counts only where it exceeds the scatter about it by this
 * factor. */
static const double trend_over_scatter = 12;
/* Delays of a validated sender that have risen by this much along a straight line, over 30 points or more, are those of
 * a clock that runs slow: a queue would have to fill evenly for as long. Until then the two look alike. */
static const double filling_queue_s = 0.5;
/* A stamp that is this far behind its sender's latest one comes from a reordered datagram, not from a counter. */
static const double overtaken_s = 0.1;
static const double longest_vote_s = 32.0; /* the longest span over which the rate of stamps is checked */
static const double rate_known = 0.02; /* the rate counts as known when three of its standard errors are below this */
/* Stamps are constant when two reports of one entity arrive so far apart and their stamps advance by less than a
 * twentieth of that. Jitter can make this appear of stamps that advance by more than still_step_s, but not over
 * leave_s. */
static const double still_least_s = 0.1, still_most_s = 1800, still_rate = 0.05, still_step_s = 0.005;

/* By how much stamps have advanced more than arrivals since a moment, s; modulo whole hours. */
static double gained_s(Moment since, Moment now)
{
    const double gained = dis_timestamp_step_s(since.stamp, now.stamp) - (now.capture_s - since.capture_s);
    return gained - exercise_clock_whole_hours(gained);
}

int exercise_clock_stands_still(ExerciseClock *clock, uint64_t entity_key, Moment now)
{
    Memory *memory = &clock->memory[(entity_key * 0x9E3779B97F4A7C15u) >> 50];
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

/* Whether a sender's stamps have advanced since its first PDU. If so, a PDU that repeats a stamp may be a datagram
 * received twice. */
static bool advances(const Sender *sender, Moment now)
{
    const double passed_s = now.capture_s - sender->first.capture_s;
    return passed_s >= still_least_s &&
           dis_timestamp_step_s(sender->first.stamp, sender->latest_stamp) >= 0.5 * passed_s;
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
    return dis_timestamp_is_absolute(now.stamp) && sender->scale != SCALE_OWN &&
           fabs(off_s - exercise_clock_whole_hours(off_s)) <= leave_s;
}

/* Whether this is a sender's second PDU and far from its stamp: the sender may then run at any rate. */
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
    if (sender->standing == SENDER_PROVEN) exercise_clock_keep(clock, sender);
    else if (sender->founds) clock->founder[sender->scale].offset_s = clock->founder[sender->scale].slope = 0;
    if (sender->standing != SENDER_INCONSISTENT && sender->failures < most_failures) sender->failures++;
    if (sender->standing != SENDER_INCONSISTENT && sender->doubt < 0) sender->doubt = list_doubt(clock, sender, reason);
    sender->standing = SENDER_INCONSISTENT;
    exercise_clock_tie(clock, sender, now, ruler_s, false);
}

/* Adds this PDU's delay to the sender's delays and, where the sender founded its scale, to the delays of that scale. */
static void observe(ExerciseClock *clock, Sender *sender, double t_s, double ruler_s)
{
    delay_line_add(&sender->line, t_s, ruler_s - t_s);
    delay_trend_add(&sender->trend, t_s, ruler_s - t_s);
    if (sender->founds) clock->founder[sender->scale] = sender->line;
}

/* Whether the stamps run at another rate than their arrivals. The trend of all PDUs decides; for a validated sender the
 * lower edge of the delays since its tie must agree, or the trend be that of a clock that runs slow, which moves that
 * edge late. */
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
    if (trend->points >= points_again && slope * (trend->last_x_s - trend->first_x_s) > filling_queue_s) return true;
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

/* Checks the rate of the stamps over the span since the mark. */
static void vote(ExerciseClock *clock, Sender *sender, Moment now, double t_s, double ruler_s)
{
    if (now.capture_s < sender->mark_s) { /* the capture clock stepped back */
        sender->mark_s = now.capture_s;
        sender->next_vote_s = now.capture_s + vote_s;
        sender->renewed = true;
        sender->trend = (DelayTrend){0};
        delay_trend_add(&sender->trend, t_s, ruler_s - t_s);
    }
    if (runs_wrong(sender)) {
        doubt(clock, sender, now, ruler_s, EXERCISE_CLOCK_RATE);
        return;
    }
    if (now.capture_s < sender->next_vote_s) return;
    const double span_s = now.capture_s - sender->mark_s;
    const bool   right = runs_right(sender);
    if (right && sender->agree < votes_needed) sender->agree++;
    if (sender->agree == votes_needed) sender->standing = SENDER_PROVEN;
    if (span_s >= longest_vote_s && (right || span_s >= 4 * longest_vote_s)) {
        sender->mark_s = now.capture_s;
        sender->renewed = true;
        sender->trend = (DelayTrend){0};
        delay_trend_add(&sender->trend, t_s, ruler_s - t_s);
    }
    sender->next_vote_s = now.capture_s + (span_s >= longest_vote_s ? longest_vote_s : fmax(span_s, vote_s));
}

static void note_inconsistent(ExerciseClock *clock, const Sender *sender, Moment now)
{
    clock->doubts.by_arrival++;
    if (sender->doubt < 0) return;
    ExerciseClockAnomaly *d = &clock->doubts.sender[sender->doubt];
    const double          passed_s = now.capture_s - sender->first.capture_s;
    d->by_arrival++;
    d->pdus = sender->pdus;
    if (!(passed_s > 0)) return;
    d->passed_s = passed_s;
    d->raw_hz = (uint32_t)(now.stamp - sender->first.stamp) / passed_s;
    d->rate = dis_timestamp_step_s(sender->first.stamp, now.stamp) / passed_s;
    d->counted = (uint32_t)(now.stamp - sender->first.stamp) / fmax((double)(sender->pdus - 1), 1);
}

static void note_shared(ExerciseClock *clock, Sender *sender, Moment now)
{
    if (!is_shared(sender, now) || sender->shared) return;
    sender->shared = true;
    const int d = list_doubt(clock, sender, EXERCISE_CLOCK_SHARED);
    if (d < 0) return;
    clock->doubts.sender[d].pdus = sender->pdus;
    clock->doubts.sender[d].apart_s = fabs(gained_s(sender->one, sender->other));
}

ExerciseInstant exercise_clock_judge(ExerciseClock *clock, Sender *sender, Moment now, int entity, double ruler_s)
{
    const bool overtaken = is_overtaken(sender, now.stamp);
    sender->pdus++;
    note_shared(clock, sender, now);
    if (!overtaken) sender->latest_stamp = now.stamp;

    const uint64_t            entity_key = (uint64_t)sender->key << 16 | (uint16_t)entity;
    const int                 repeats = entity < 0 ? 0 : exercise_clock_stands_still(clock, entity_key, now);
    const bool                stands = repeats > 0;
    const double              t_s = exercise_clock_tied_time(&sender->tie, now.stamp, ruler_s);
    const bool                leaves = !(fabs(ruler_s - t_s - delay_line_at(&sender->line, t_s)) <= leave_s);
    const ExerciseClockReason reason = leaves ? EXERCISE_CLOCK_JUMP : EXERCISE_CLOCK_STILL;
    bool                      by_arrival = leaves;

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
    ExerciseInstant at = {.t_s = ruler_s,
                          .ruler_s = ruler_s,
                          .stamp = now.stamp,
                          .segment = sender->segment,
                          .sender = (uint16_t)(sender - clock->slot)};
    if (leaves && sender->next_segment) at.segment = sender->next_segment;
    if (sender->standing == SENDER_INCONSISTENT) {
        note_inconsistent(clock, sender, now);
    } else if (!by_arrival) {
        at.t_s = exercise_clock_shifted_time(clock, sender->scale, &sender->line,
                                             exercise_clock_tied_time(&sender->tie, now.stamp, ruler_s));
        at.by_stamp = true;
    }
    return at;
}

/* ---- reporting ------------------------------------------------------------------------------------- */

/* Whether something was counted at about a rate, given that counts at both ends are whole numbers. */
static bool near_rate(double hz, double of_hz, double passed_s)
{
    return hz > 0 && passed_s >= 4 && fabs(hz - of_hz) <= 0.03 * of_hz + 1 / passed_s;
}

void exercise_clock_anomaly_text(char *out, size_t size, const ExerciseClockAnomaly *d)
{
    static const struct {
        double      hz;
        const char *what;
    } unit[] = {{1e6, "look like microseconds"}, {2e6, "look like microseconds"}, {1e3, "look like milliseconds"},
                {2e3, "look like milliseconds"}, {1, "look like seconds"},        {2, "look like seconds"}};
    char        rate[64];
    const char *what = "jump about";
    if (d->reason == EXERCISE_CLOCK_SHARED) {
        snprintf(out, size,
                 "time stamps of %u:%u follow two clocks %.1f s apart: two senders have this site and "
                 "application; give one another",
                 d->site, d->application, d->apart_s);
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
