/* dis/log_time.c: when the packet times of a capture are not those of the exercise.
 *
 * A capture made out of a text log, or of a playback at another speed, has packet times that are equal,
 * compressed or stretched; the stamps inside are then the better clock. They are believed only when they
 * behave like one. */
#include "dis/log.h"

#include "dis/exercise_clock.h"

enum { sender_limit = 256, least_pdus = 10 };

static const double least_span_s = 5;      /* shorter logs say nothing about their clock */
static const double pace_low = 0.8, pace_high = 1.25; /* capture time over stamp time that is left alone */
static const double counter_pace = 20;     /* stamps this much slower than packets count something else */
static const double back_s = 1, ahead_s = 120; /* step of a clock: network order, and the longest heartbeat twice */
static const double gap_s = 1500;          /* a silence that the hour of a stamp cannot bridge */

typedef struct Voice {
    uint16_t sender[2];
    int      pdus;
} Voice;

/* Header and sender of a datagram's first PDU. False for what names none, or is not stamped. */
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
        DisHeader header;
        uint16_t  sender[2];
        int       v = 0;
        if (!first_pdu(&header, sender, &log->datagram[i])) continue;
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

/* Walks the sender's datagrams. write: sets capture_s of all datagrams by its stamps. Returns whether the
 * stamps step like a clock; spans of stamps and of packet times. */
static bool walk(DisLog *log, const uint16_t sender[2], bool write, double *stamps_s, double *packets_s)
{
    bool     begun = false;
    uint32_t last_stamp = 0;
    double   first_s = 0, last_s = 0, now_s = 0, most_s = 0;
    for (int i = 0; i < log->count; i++) {
        DisDatagram *datagram = &log->datagram[i];
        DisHeader    header;
        uint16_t     who[2];
        if (first_pdu(&header, who, datagram) && who[0] == sender[0] && who[1] == sender[1]) {
            if (!begun) {
                begun   = true;
                first_s = last_s = datagram->capture_s;
            }
            const double step = last_stamp ? dis_timestamp_step_s(last_stamp, header.timestamp) : 0;
            if (!write && (!(step >= -back_s && step <= ahead_s) || !(fabs(datagram->capture_s - last_s) < gap_s)))
                return false;
            last_stamp = header.timestamp;
            last_s     = datagram->capture_s;
            now_s += step;
            most_s = fmax(most_s, now_s);
        }
        if (write) datagram->capture_s = first_s + most_s;
    }
    *stamps_s  = now_s;
    *packets_s = last_s - first_s;
    return begun;
}

bool dis_log_retime(DisLog *log)
{
    uint16_t sender[2];
    double   stamps_s, packets_s;
    if (!loudest_sender(sender, log) || !walk(log, sender, false, &stamps_s, &packets_s)) return false;
    if (!(stamps_s >= least_span_s) || !(stamps_s * counter_pace >= packets_s)) return false;
    if (packets_s >= pace_low * stamps_s && packets_s <= pace_high * stamps_s) return false;
    walk(log, sender, true, &stamps_s, &packets_s);
    return true;
}
