/* dis/capture/log_time.c: when the packet times of a capture are not those of the exercise.
 *
 * A capture made out of a text log, or of a playback at another speed, has packet times that are equal,
 * compressed or stretched; the stamps inside are then the better clock. They are used only when they advance like a
 * clock and are consistent with the reported motion: the distance an entity moves is its speed times the elapsed
 * seconds of the right clock. */

#include "dis/pdu/decode.h"
#include "dis/capture/log.h"
#include "dis/clock/exercise_clock.h"

#include <stdlib.h>

enum { sender_limit = 256, least_pdus = 10, entity_slots = 4096 };

static const double least_span_s = 5;                 /* shorter logs are too short to check the clock */
static const double pace_low = 0.8, pace_high = 1.25; /* accepted ratio of capture time to stamp time */
static const double counter_pace = 20; /* stamps this many times slower than packets count something other than time */
static const double back_s = 1, ahead_s = 120; /* steps that a clock may make: back by the network's reordering, ahead
                                                  by twice the longest heartbeat */
static const double least_path_m = 30, least_speed_mps = 1, motion_pace = 0.2,
                    longest_step_s = 60; /* least path and speed of an entity that counts as moving */
static const double gap_s = 1500;        /* over a longer gap the stamp's hour is uncertain */

typedef struct Voice {
    uint16_t sender[2];
    int      pdus;
} Voice;

/* Header and sender of a datagram's first PDU. Returns false for a PDU that names no sender, or is not stamped. */
static bool first_pdu(DisHeader *header, uint16_t sender[2], const DisDatagram *datagram)
{
    DisCounters    ignored = {0};
    const uint8_t *at = datagram->bytes, *pdu;
    return dis_next_pdu(header, &pdu, &at, datagram->bytes + datagram->octets, &ignored) &&
           dis_pdu_sender(sender, header, pdu) && header->timestamp != 0;
}

static bool loudest_sender(uint16_t out[2], const DisLog *log)
{
    Voice voice[sender_limit];
    int   voices = 0, loudest = -1;
    for (int i = 0; i < log->count; i++) {
        DisHeader         header;
        uint16_t          sender[2];
        int               v = 0;
        const DisDatagram datagram = dis_log_datagram(log, i);
        if (!first_pdu(&header, sender, &datagram)) continue;
        while (v < voices && (voice[v].sender[0] != sender[0] || voice[v].sender[1] != sender[1])) v++;
        if (v == sender_limit) continue;
        if (v == voices) voice[voices++] = (Voice){{sender[0], sender[1]}, 0};
        voice[v].pdus++;
    }
    for (int v = 0; v < voices; v++)
        if (loudest < 0 || voice[v].pdus > voice[loudest].pdus) loudest = v;
    if (loudest < 0 || voice[loudest].pdus < least_pdus) return false;
    out[0] = voice[loudest].sender[0];
    out[1] = voice[loudest].sender[1];
    return true;
}

/* Walks the sender's datagrams. Returns whether the stamps step like a clock, and the spans of stamps and of packet
 * times. write: also sets capture_s of all datagrams by its stamps. */
static bool walk(DisLog *log, const uint16_t sender[2], bool write, double *stamps_s, double *packets_s)
{
    bool     begun = false;
    uint32_t last_stamp = 0;
    double   first_s = 0, last_s = 0, now_s = 0, most_s = 0;
    for (int i = 0; i < log->count; i++) {
        DisDatagram      *datagram = &log->datagram[i];
        DisHeader         header;
        uint16_t          who[2];
        const DisDatagram there = dis_log_datagram(log, i);
        if (first_pdu(&header, who, &there) && who[0] == sender[0] && who[1] == sender[1]) {
            if (!begun) {
                begun = true;
                first_s = last_s = datagram->capture_s;
            }
            const double step = last_stamp ? dis_timestamp_step_s(last_stamp, header.timestamp) : 0;
            if (!write && (!(step >= -back_s && step <= ahead_s) || !(fabs(datagram->capture_s - last_s) < gap_s)))
                return false;
            last_stamp = header.timestamp;
            last_s = datagram->capture_s;
            now_s += step;
            most_s = fmax(most_s, now_s);
        }
        if (write) datagram->capture_s = first_s + most_s;
    }
    *stamps_s = now_s;
    *packets_s = last_s - first_s;
    return begun;
}

typedef struct Seen {
    bool     used;
    uint16_t entity;
    uint32_t stamp;
    double   capture_s, p_ecef[3], speed_mps;
} Seen;

/* Whether moving entities have moved by speed times packet time, rather than by speed times stamp time. */
static bool motion_is_at_packet_pace(const DisLog *log, const uint16_t sender[2])
{
    double path_m = 0, by_stamps_m = 0, by_packets_m = 0;
    Seen  *seen = calloc(entity_slots, sizeof *seen);
    for (int i = 0; seen && i < log->count; i++) {
        DisCounters       ignored = {0};
        DisHeader         header;
        DisPdu            decoded;
        uint16_t          who[2];
        const DisDatagram d = dis_log_datagram(log, i);
        const uint8_t    *at = d.bytes, *pdu, *end = at + d.octets;
        while (dis_next_pdu(&header, &pdu, &at, end, &ignored)) {
            if (header.type != dis_pdu_entity_state || !dis_pdu_sender(who, &header, pdu) || who[0] != sender[0] ||
                who[1] != sender[1] || dis_decode(&decoded, pdu, header.length) != STATUS_OK)
                continue;
            const DisEntityState *state = &decoded.entity_state;
            const double         *p = state->p_ecef, capture_s = d.capture_s;
            Seen                 *s = &seen[state->id.entity % entity_slots],
                 now = {true, state->id.entity, header.timestamp, capture_s, {p[0], p[1], p[2]}, 0};
            const double v[3] = {state->velocity_mps[0], state->velocity_mps[1], state->velocity_mps[2]};
            const double stamps_s = dis_timestamp_step_s(s->stamp, now.stamp), packets_s = capture_s - s->capture_s;
            double       moved[3];
            now.speed_mps = v3_length(v);
            v3_sub(moved, now.p_ecef, s->p_ecef);
            if (s->used && s->entity == now.entity && stamps_s > 0 && stamps_s <= longest_step_s && packets_s >= 0 &&
                packets_s <= longest_step_s && fmin(s->speed_mps, now.speed_mps) >= least_speed_mps &&
                v3_length(moved) < 1e5 && now.speed_mps < 2e4) { /* false for NaN too */
                path_m += v3_length(moved);
                by_stamps_m += 0.5 * (s->speed_mps + now.speed_mps) * stamps_s;
                by_packets_m += 0.5 * (s->speed_mps + now.speed_mps) * packets_s;
            }
            *s = now;
        }
    }
    free(seen);
    return path_m >= least_path_m && fabs(by_packets_m / path_m - 1) <= motion_pace &&
           fabs(by_packets_m - path_m) < fabs(by_stamps_m - path_m);
}

bool dis_log_retime(DisLog *log)
{
    uint16_t sender[2];
    double   stamps_s, packets_s;
    if (!loudest_sender(sender, log) || !walk(log, sender, false, &stamps_s, &packets_s)) return false;
    if (!(stamps_s >= least_span_s) || !(stamps_s * counter_pace >= packets_s)) return false;
    if (packets_s >= pace_low * stamps_s && packets_s <= pace_high * stamps_s) return false;
    if (motion_is_at_packet_pace(log, sender)) return false;
    walk(log, sender, true, &stamps_s, &packets_s);
    return true;
}

/* ---- exercise times ------------------------------------------------------------------------- */

/* Adds PDUs to the times. They go through the exercise clock twice: first it learns the senders' clocks, then it gives
 * the times. */

static Status add(DisLogTimes *times, size_t *capacity, ExerciseInstant at)
{
    if (times->count == *capacity) {
        const size_t     larger = *capacity ? 2 * *capacity : 4096;
        ExerciseInstant *grown = realloc(times->pdu, larger * sizeof *grown);
        if (!grown) return STATUS_NO_MEMORY;
        times->pdu = grown;
        *capacity = larger;
    }
    times->pdu[times->count++] = at;
    return STATUS_OK;
}

/* Drops the anomalies of senders all of whose PDUs are timed by their stamps in the end. */
static void keep_anomalies(ExerciseClockAnomalies *doubts)
{
    int kept = 0;
    for (int i = 0; i < doubts->count; i++)
        if (doubts->sender[i].by_arrival > 0 || doubts->sender[i].reason == EXERCISE_CLOCK_SHARED)
            doubts->sender[kept++] = doubts->sender[i];
    doubts->count = kept;
}

Status dis_log_times(DisLogTimes *out, const DisLog *log, int exercise)
{
    DisLogTimes    times = {0};
    size_t         capacity = 0;
    DisCounters    ignored = {0};
    ExerciseClock *clock = NULL;
    Status         status = exercise_clock_create(&clock);
    for (int i = 0; i < log->count && status == STATUS_OK; i++) {
        const DisDatagram d = dis_log_datagram(log, i);
        const uint8_t    *at = d.bytes, *pdu;
        DisHeader         header;
        while (status == STATUS_OK && dis_next_pdu(&header, &pdu, &at, d.bytes + d.octets, &ignored))
            if (exercise < 0 || header.exercise == exercise)
                status = add(&times, &capacity, exercise_clock_pdu_instant(clock, &header, pdu, d.capture_s));
    }
    if (status == STATUS_OK) status = exercise_clock_whole(clock);
    if (status == STATUS_OK) {
        for (size_t i = 0; i < times.count; i++) exercise_clock_whole_time(clock, &times.pdu[i]);
        times.doubts = *exercise_clock_anomalies(clock);
        keep_anomalies(&times.doubts);
        *out = times;
    } else {
        dis_log_times_release(&times);
    }
    exercise_clock_destroy(clock);
    return status;
}

void dis_log_times_release(DisLogTimes *times)
{
    free(times->pdu);
    *times = (DisLogTimes){0};
}
