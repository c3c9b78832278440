/* entities/exercise/exercise_link.c: PDUs stamped and bundled into datagrams, dropped, delayed and duplicated as
 * configured. */

#include "entities/exercise/exercise_private.h"

#include "dis/clock/exercise_clock.h"

static void put_u16(uint8_t *at, unsigned v)
{
    at[0] = (uint8_t)(v >> 8);
    at[1] = (uint8_t)v;
}

static uint32_t stamp(const ExerciseLink *link, double t_s)
{
    const double hour_s = link->scenario->dis.stamp_s;
    switch (link->scenario->dis.stamps) {
    case SCENARIO_STAMPS_NONE:
        return 0;
    case SCENARIO_STAMPS_CONSTANT:
        return 12345678;
    case SCENARIO_STAMPS_COUNTER:
        return (uint32_t)link->number + 1;
    case SCENARIO_STAMPS_MILLISECONDS:
        return (uint32_t)(uint64_t)((hour_s + t_s) * 1e3);
    case SCENARIO_STAMPS_MICROSECONDS:
        return (uint32_t)(uint64_t)((hour_s + t_s) * 1e6);
    case SCENARIO_STAMPS_UNIX:
        return (uint32_t)(uint64_t)(link->epoch_unix_s + t_s);
    case SCENARIO_STAMPS_HALF_RATE:
        return dis_timestamp(hour_s + 0.5 * t_s, false);
    case SCENARIO_STAMPS_DOUBLE_RATE:
        return dis_timestamp(hour_s + 2 * t_s, false);
    case SCENARIO_STAMPS_ABSOLUTE:
        return dis_timestamp(fmod(link->epoch_unix_s, 3600) + t_s, true);
    case SCENARIO_STAMPS_RELATIVE:
        break;
    }
    return dis_timestamp(hour_s + t_s, false);
}

DisHeader link_header(const ExerciseLink *link, uint8_t type, uint8_t family, double t_s)
{
    enum { constructive = 6 }; /* status of version 7: live-virtual-constructive, bits 1 and 2 */
    const int version = link->scenario->dis.version;
    return (DisHeader){.version = (uint8_t)version,
                       .exercise = (uint8_t)link->scenario->dis.exercise,
                       .type = type,
                       .family = family,
                       .timestamp = stamp(link, t_s),
                       .status = version == 7 ? constructive : 0};
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

/* These octets as a datagram, without validation. */
static void send_datagram(ExerciseLink *link, double t_s, const uint8_t *bytes, size_t octets)
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
    if (octets) send_datagram(link, link->pending_s, link->bundle, octets);
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

/* ---- malformed datagrams -------------------------------------------------------------------- */

/* Every one must be dropped and counted, or accepted where valid; none may affect the others. */

static uint8_t random_octet(const Cast *cast, double t_s, size_t at)
{
    return (uint8_t)(256 * random_uniform((uint64_t)cast->scenario->seed, 9, (uint32_t)(t_s * 60), at));
}

void exercise_send_bad(ExerciseLink *link, const Cast *cast, DisEntityState *es, int kind, double t_s)
{
    uint8_t    bytes[8192];
    Kinematics k;
    if (cast->entity_count == 0) return;
    cast_kinematics(&k, cast, 0, t_s);
    /* random states that are valid are placed beside the first entity, not inside it */
    const double right[3] = {k.r_ecef_from_body[1], k.r_ecef_from_body[4], k.r_ecef_from_body[7]};
    v3_add_scaled(k.p_ecef, k.p_ecef, kind == 5 ? 25 : -25, right);
    exercise_fill_state(es, link, cast, 0, &k, 0, t_s);
    es->id.entity = (uint16_t)(64900 + kind);
    switch (kind) {
    case 1:
        es->p_ecef[1] = NAN;
        break;
    case 2:
        memset(es->p_ecef, 0, sizeof es->p_ecef);
        break;
    case 3:
        es->velocity_mps[2] = INFINITY;
        break;
    case 4:
        es->psi_rad = NAN;
        break;
    case 5: /* an unassigned type, and a hostile marking */
        es->type = (DisEntityType){9, 9, 999, 99, 9, 9, 9};
        memcpy(es->marking, "\x01\xff\x80<b>\n\r\t\"'", 11);
        break;
    case 7:
        es->id = (DisEntityId){65535, 65535, 65535};
        break;
    case 8: { /* joints with extreme and non-finite values */
        static const float value[4] = {NAN, INFINITY, -1e30f, 0};
        es->variable_count = 4;
        for (int i = 0; i < 4; i++)
            es->variable[i] = (DisVariableParameter){.record_type = dis_variable_articulated,
                                                     .attached_to = (uint16_t)(i / 2),
                                                     .value = value[i],
                                                     .parameter = i < 2 ? 4107u + (unsigned)i : 4427u + (unsigned)i};
        break;
    }
    }
    size_t count = dis_encode_entity_state(bytes, sizeof bytes, es);
    switch (kind) {
    case 0:
        bytes[8] = bytes[9] = 0;
        break; /* length field 0 */
    case 6:
        bytes[0] = 42;
        break;
    case 9:
        count = 100;
        break; /* truncated */
    case 10:
        bytes[19] = 255;
        break; /* more parts than the table holds */
    case 11:
        bytes[2] = 200;
        break; /* an unknown type */
    case 12:   /* noise */
        for (size_t i = 0; i < count; i++) bytes[i] = random_octet(cast, t_s, i);
        break;
    case 13:
        count = random_octet(cast, t_s, 0) % 7;
        break; /* 0 .. 6 octets */
    }
    link->counts.malformed++;
    send_datagram(link, t_s, bytes, count);
}
