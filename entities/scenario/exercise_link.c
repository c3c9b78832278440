/* entities/scenario/exercise_link.c: PDUs stamped and bundled into datagrams, dropped, delayed and duplicated as
 * configured. */
#include "entities/scenario/exercise_link.h"

#include "dis/exercise_clock.h"

static void put_u16(uint8_t *at, unsigned v)
{
    at[0] = (uint8_t)(v >> 8);
    at[1] = (uint8_t)v;
}

static uint32_t stamp(const ExerciseLink *link, double t_s)
{
    const char  *stamps = link->scenario->dis.stamps;
    const double hour_s = link->scenario->dis.stamp_s;
    const bool   absolute = strcmp(stamps, "absolute") == 0;
    if (strcmp(stamps, "none") == 0) return 0;
    if (strcmp(stamps, "constant") == 0) return 12345678;
    if (strcmp(stamps, "counter") == 0) return (uint32_t)link->number + 1;
    if (strcmp(stamps, "milliseconds") == 0) return (uint32_t)(uint64_t)((hour_s + t_s) * 1e3);
    if (strcmp(stamps, "microseconds") == 0) return (uint32_t)(uint64_t)((hour_s + t_s) * 1e6);
    if (strcmp(stamps, "unix") == 0) return (uint32_t)(uint64_t)(link->epoch_unix_s + t_s);
    if (strcmp(stamps, "half-rate") == 0) return dis_timestamp(hour_s + 0.5 * t_s, false);
    if (strcmp(stamps, "double-rate") == 0) return dis_timestamp(hour_s + 2 * t_s, false);
    return dis_timestamp((absolute ? fmod(link->epoch_unix_s, 3600) : hour_s) + t_s, absolute);
}

DisHeader link_header(const ExerciseLink *link, uint8_t type, uint8_t family, double t_s)
{
    enum { constructive = 6 }; /* status of version 7: live-virtual-constructive, bits 1 and 2 */
    const int version = link->scenario->dis.version;
    return (DisHeader){.version = (uint8_t)version, .exercise = (uint8_t)link->scenario->dis.exercise, .type = type,
                       .family = family, .timestamp = stamp(link, t_s), .status = version == 7 ? constructive : 0};
}

/* ---- the network ------------------------------------------------------------------------------ */

static void hand_out(ExerciseLink *link, double t_s, const uint8_t *bytes, size_t octets)
{
    if (link->stopped) return;
    link->counts.datagrams++;
    link->counts.octets += octets;
    if (!link->sink(link->user, t_s, bytes, octets)) link->stopped = true;
}

static bool chance(const ExerciseLink *link, uint32_t which, double share)
{
    return share > 0 && random_uniform((uint64_t)link->scenario->seed, 5, which, link->number) < share;
}

void link_datagram(ExerciseLink *link, double t_s, const uint8_t *bytes, size_t octets)
{
    const Scenario *s = link->scenario;
    const bool      lost = chance(link, 0, s->faults.loss), twice = chance(link, 1, s->faults.duplicate);
    const bool      late = chance(link, 2, s->faults.reorder);
    link->number++;
    if (lost) {
        link->counts.lost++;
        return;
    }
    if (late && link->held == 0 && octets > 0 && octets <= link_capacity) {
        memcpy(link->behind, bytes, octets);
        link->held = octets;
        return;
    }
    hand_out(link, t_s, bytes, octets);
    if (twice) {
        link->counts.duplicated++;
        hand_out(link, t_s, bytes, octets);
    }
    if (link->held) {
        link->counts.overtaken++;
        hand_out(link, t_s, link->behind, link->held);
        link->held = 0;
    }
}

void link_finish(ExerciseLink *link, double t_s)
{
    link_flush(link);
    if (link->held) hand_out(link, t_s, link->behind, link->held);
    link->held = 0;
}

/* ---- bundles ---------------------------------------------------------------------------------- */

void link_flush(ExerciseLink *link)
{
    const size_t octets = link->pending;
    link->pending = 0;
    if (octets) link_datagram(link, link->pending_s, link->bundle, octets);
}

static void append(ExerciseLink *link, double t_s, const uint8_t *bytes, size_t octets)
{
    const size_t most = link->scenario->dis.bundle ? (size_t)link->scenario->dis.mtu : octets;
    if (link->pending && (link->pending_s != t_s || link->pending + octets > most)) link_flush(link);
    memcpy(link->bundle + link->pending, bytes, octets);
    link->pending += octets;
    link->pending_s = t_s;
    link->counts.pdus++;
    if (!link->scenario->dis.bundle) link_flush(link);
}

/* A PDU that a receiver skips: Attribute (72) in version 7, else Data (20). */
static size_t filler(uint8_t *out, const ExerciseLink *link, double t_s)
{
    enum { attribute = 72, data = 20, information = 1, management = 5 };
    const bool      v7 = link->scenario->dis.version == 7;
    const size_t    octets = v7 ? 32 : 40;
    const DisHeader header = link_header(link, v7 ? attribute : data, v7 ? information : management, t_s);
    memset(out, 0, octets);
    out[0] = header.version;
    out[1] = header.exercise;
    out[2] = header.type;
    out[3] = header.family;
    put_u16(out + 4, header.timestamp >> 16);
    put_u16(out + 6, header.timestamp & 0xffff);
    put_u16(out + 8, (unsigned)octets);
    put_u16(out + 12, (unsigned)link->scenario->dis.site);
    put_u16(out + 14, (unsigned)link->scenario->dis.application);
    return octets;
}

void link_pdu(ExerciseLink *link, double t_s, const uint8_t *bytes, size_t octets)
{
    uint8_t more[64];
    append(link, t_s, bytes, octets);
    if (link->scenario->dis.fillers) append(link, t_s, more, filler(more, link, t_s));
}
