/* dis/pdu/decode.c: the table of PDU types, by which tagged PDUs are decoded and encoded; iteration over a datagram. */

#include "dis/pdu/decode.h"
#include "dis/pdu/octets.h"

/* ---- types of PDUs -------------------------------------------------------------------------- */

/* These read and write the member of the union that belongs to the type; dis_decode sets the tag. */
static Status decode_entity_state(DisPdu *out, const uint8_t *pdu, size_t octets)
{
    return dis_decode_entity_state(&out->entity_state, pdu, octets);
}

static size_t encode_entity_state(uint8_t *out, size_t capacity, const DisPdu *pdu)
{
    return dis_encode_entity_state(out, capacity, &pdu->entity_state);
}

static Status decode_entity_state_update(DisPdu *out, const uint8_t *pdu, size_t octets)
{
    return dis_decode_entity_state_update(&out->update, pdu, octets);
}

static size_t encode_entity_state_update(uint8_t *out, size_t capacity, const DisPdu *pdu)
{
    return dis_encode_entity_state_update(out, capacity, &pdu->update);
}

static Status decode_fire(DisPdu *out, const uint8_t *pdu, size_t octets)
{
    return dis_decode_fire(&out->fire, pdu, octets);
}

static size_t encode_fire(uint8_t *out, size_t capacity, const DisPdu *pdu)
{
    return dis_encode_fire(out, capacity, &pdu->fire);
}

static Status decode_detonation(DisPdu *out, const uint8_t *pdu, size_t octets)
{
    return dis_decode_detonation(&out->detonation, pdu, octets);
}

static size_t encode_detonation(uint8_t *out, size_t capacity, const DisPdu *pdu)
{
    return dis_encode_detonation(out, capacity, &pdu->detonation);
}

static Status decode_remove_entity(DisPdu *out, const uint8_t *pdu, size_t octets)
{
    return dis_decode_remove_entity(&out->remove, pdu, octets);
}

static size_t encode_remove_entity(uint8_t *out, size_t capacity, const DisPdu *pdu)
{
    return dis_encode_remove_entity(out, capacity, &pdu->remove);
}

static Status decode_start_resume(DisPdu *out, const uint8_t *pdu, size_t octets)
{
    return dis_decode_start_resume(&out->start, pdu, octets);
}

static size_t encode_start_resume(uint8_t *out, size_t capacity, const DisPdu *pdu)
{
    return dis_encode_start_resume(out, capacity, &pdu->start);
}

static Status decode_stop_freeze(DisPdu *out, const uint8_t *pdu, size_t octets)
{
    return dis_decode_stop_freeze(&out->stop, pdu, octets);
}

static size_t encode_stop_freeze(uint8_t *out, size_t capacity, const DisPdu *pdu)
{
    return dis_encode_stop_freeze(out, capacity, &pdu->stop);
}

static Status decode_data(DisPdu *out, const uint8_t *pdu, size_t octets)
{
    return dis_decode_data(&out->data, pdu, octets);
}

static size_t encode_data(uint8_t *out, size_t capacity, const DisPdu *pdu)
{
    return dis_encode_data(out, capacity, &pdu->data);
}

/* Types of IEEE 1278.1-2012, table of PDU types. Those with functions are decoded; of these, the lengths of those that
 * are acted upon are validated while iterating over a datagram, and a PDU that cannot be decoded is counted as dropped.
 * The lengths of the others are not validated. */
typedef struct PduType {
    const char *name;
    unsigned    least_octets; /* octets before the variable records; 0: the type is not acted upon */
    Status (*decode)(DisPdu *out, const uint8_t *pdu, size_t octets); /* NULL: the type is not decoded */
    size_t (*encode)(uint8_t *out, size_t capacity, const DisPdu *pdu);
} PduType;

static const PduType pdu_type[256] = {
    [0] = {"Other"},
    [1] = {"Entity State", 144, decode_entity_state, encode_entity_state},
    [2] = {"Fire", 96, decode_fire, encode_fire},
    [3] = {"Detonation", 104, decode_detonation, encode_detonation},
    [4] = {"Collision"},
    [5] = {"Service Request"},
    [6] = {"Resupply Offer"},
    [7] = {"Resupply Received"},
    [8] = {"Resupply Cancel"},
    [9] = {"Repair Complete"},
    [10] = {"Repair Response"},
    [11] = {"Create Entity"},
    [12] = {"Remove Entity", 28, decode_remove_entity, encode_remove_entity},
    [13] = {"Start/Resume", 44, decode_start_resume, encode_start_resume},
    [14] = {"Stop/Freeze", 40, decode_stop_freeze, encode_stop_freeze},
    [15] = {"Acknowledge"},
    [16] = {"Action Request"},
    [17] = {"Action Response"},
    [18] = {"Data Query"},
    [19] = {"Set Data", 0, decode_data, encode_data},
    [20] = {"Data", 0, decode_data, encode_data},
    [21] = {"Event Report"},
    [22] = {"Comment"},
    [23] = {"Electromagnetic Emission"},
    [24] = {"Designator"},
    [25] = {"Transmitter"},
    [26] = {"Signal"},
    [27] = {"Receiver"},
    [28] = {"IFF"},
    [29] = {"Underwater Acoustic"},
    [30] = {"Supplemental Emission/Entity State"},
    [31] = {"Intercom Signal"},
    [32] = {"Intercom Control"},
    [33] = {"Aggregate State"},
    [34] = {"IsGroupOf"},
    [35] = {"Transfer Ownership"},
    [36] = {"IsPartOf"},
    [37] = {"Minefield State"},
    [38] = {"Minefield Query"},
    [39] = {"Minefield Data"},
    [40] = {"Minefield Response NACK"},
    [41] = {"Environmental Process"},
    [42] = {"Gridded Data"},
    [43] = {"Point Object State"},
    [44] = {"Linear Object State"},
    [45] = {"Areal Object State"},
    [46] = {"TSPI"},
    [47] = {"Appearance"},
    [48] = {"Articulated Parts"},
    [49] = {"LE Fire"},
    [50] = {"LE Detonation"},
    [51] = {"Create Entity-R"},
    [52] = {"Remove Entity-R", 32, decode_remove_entity, encode_remove_entity},
    [53] = {"Start/Resume-R", 48, decode_start_resume, encode_start_resume},
    [54] = {"Stop/Freeze-R", 40, decode_stop_freeze, encode_stop_freeze},
    [55] = {"Acknowledge-R"},
    [56] = {"Action Request-R"},
    [57] = {"Action Response-R"},
    [58] = {"Data Query-R"},
    [59] = {"Set Data-R"},
    [60] = {"Data-R"},
    [61] = {"Event Report-R"},
    [62] = {"Comment-R"},
    [63] = {"Record-R"},
    [64] = {"Set Record-R"},
    [65] = {"Record Query-R"},
    [66] = {"Collision-Elastic"},
    [67] = {"Entity State Update", 72, decode_entity_state_update, encode_entity_state_update},
    [68] = {"Directed Energy Fire"},
    [69] = {"Entity Damage Status"},
    [70] = {"Information Operations Action"},
    [71] = {"Information Operations Report"},
    [72] = {"Attribute"},
};

const char *dis_pdu_type_name(uint8_t type) { return pdu_type[type].name ? pdu_type[type].name : "unknown type"; }

/* The octets of a type before its variable records; dis_next_pdu refuses shorter PDUs. */
static unsigned least_octets(uint8_t type)
{
    return pdu_type[type].least_octets ? pdu_type[type].least_octets : dis_header_octets;
}

/* How many octets the PDU at pdu has by its type and its own counts, whatever its length field says; 0: not known of
 * its type, or more than there are octets. */
static size_t whole_octets(const uint8_t *pdu, size_t octets)
{
    static const struct {
        uint8_t type, count_at; /* count_at: where the number of variable records is */
    } counted[] = {{dis_pdu_entity_state, 19}, {dis_pdu_entity_state_update, 19}, {dis_pdu_detonation, 101}};
    enum { record_octets = 16 };
    if (octets < dis_header_octets) return 0;
    const uint8_t  type = dis_load_header(pdu).type;
    const unsigned least = pdu_type[type].least_octets;
    if (least == 0 || least > octets) return 0;
    for (size_t i = 0; i < sizeof counted / sizeof counted[0]; i++)
        if (counted[i].type == type) return least + record_octets * (size_t)pdu[counted[i].count_at];
    return least;
}

Status dis_decode(DisPdu *out, const uint8_t *pdu, size_t octets)
{
    if (octets < dis_header_octets) return STATUS_TRUNCATED;
    const uint8_t type = dis_load_header(pdu).type;
    if (!pdu_type[type].decode) return STATUS_UNSUPPORTED;
    const Status status = pdu_type[type].decode(out, pdu, octets);
    if (status == STATUS_OK) out->type = type;
    return status;
}

size_t dis_encode(uint8_t *out, size_t capacity, const DisPdu *pdu)
{
    return pdu_type[pdu->type].encode ? pdu_type[pdu->type].encode(out, capacity, pdu) : 0;
}

void dis_count_refused(DisCounters *counters, uint8_t type, Status status)
{
    if (!pdu_type[type].least_octets) return;
    if (status == STATUS_BAD_VALUE) counters->dropped[DIS_DROP_BAD_COUNT]++;
    else if (status == STATUS_TRUNCATED) counters->dropped[DIS_DROP_TRUNCATED]++;
}

/* ---- the PDUs of a datagram -------------------------------------------------------------------- */

enum { chain_limit = 64 };

static bool version_known(uint8_t version) { return version >= 5 && version <= 7; }

static const uint8_t *past_zeros(const uint8_t *at, const uint8_t *end)
{
    while (at < end && *at == 0) at++;
    return at;
}

/* Zeros before a PDU, with which some senders fill a bundle up to a multiple of 8 octets: no header begins with one.
 * Where nothing follows but zeros, these are the end of it. */
static const uint8_t *past_padding(const uint8_t *at, const uint8_t *end)
{
    enum { padding_most = 7 };
    const uint8_t *next = past_zeros(at, end);
    if (next == end) return next - at <= padding_most ? end : at;
    return next - at <= padding_most && version_known(*next) ? next : at;
}

/* Octets of a PDU with a length field of 0, as some libraries leave it: by its type and counts, where these, and those
 * of the PDUs behind it, end exactly with the datagram. 0: not certain. */
static size_t certain_length(const uint8_t *pdu, const uint8_t *end)
{
    const uint8_t *at = pdu;
    size_t         first = 0;
    for (int n = 0; n < chain_limit && at < end; n++) {
        const size_t left = (size_t)(end - at);
        if (left < dis_header_octets) return 0;
        const DisHeader header = dis_load_header(at);
        const size_t    octets = header.length ? header.length : whole_octets(at, left);
        if (!version_known(header.version) || octets < least_octets(header.type) || octets > left) return 0;
        if (n == 0) first = octets;
        at = past_padding(at + octets, end);
    }
    return at == end ? first : 0;
}

bool dis_next_pdu(DisHeader *header, const uint8_t **pdu, const uint8_t **at, const uint8_t *end, DisCounters *counters)
{
    const uint8_t *const begin = past_padding(*at, end);
    const size_t         left = (size_t)(end - begin);
    DisDrop              why;
    counters->padded += begin != *at;
    *at = begin;
    if (left == 0) return false;
    if (left < dis_header_octets) {
        why = DIS_DROP_SHORT_HEADER;
    } else {
        DisHeader  next = dis_load_header(*at);
        const bool made = next.length == 0 && version_known(next.version);
        if (made) next.length = (uint16_t)certain_length(*at, end);
        /* A length too short for its type ends the bundle as well: a sender that wrote 496 for 508 has its next PDU at
         * another offset than the length gives. */
        if (!version_known(next.version)) {
            why = DIS_DROP_BAD_VERSION;
        } else if (next.length == 0) {
            why = DIS_DROP_LENGTH_ZERO;
        } else if (next.length < least_octets(next.type)) {
            why = DIS_DROP_LENGTH_TOO_SHORT;
        } else if (next.length > left) {
            why = DIS_DROP_LENGTH_TOO_LONG;
        } else {
            counters->pdus[next.type]++;
            counters->lengths_made += made;
            *header = next;
            *pdu = *at;
            *at += next.length;
            return true;
        }
    }
    counters->dropped[why]++;
    *at = end; /* moves to the end, so that asking again does not count again */
    return false;
}

bool dis_pdu_sender(uint16_t site_application[2], const DisHeader *header, const uint8_t *pdu)
{
    enum { last_type = 72 };
    if (header->type < 1 || header->type > last_type || header->length < dis_header_octets + 4) return false;
    site_application[0] = dis_load_u16(pdu + dis_header_octets);
    site_application[1] = dis_load_u16(pdu + dis_header_octets + 2);
    return true;
}

int dis_pdu_entity(const DisHeader *header, const uint8_t *pdu)
{
    const bool reports = header->type == dis_pdu_entity_state || header->type == dis_pdu_entity_state_update;
    return reports && header->length >= dis_header_octets + 6 ? dis_load_u16(pdu + dis_header_octets + 4) : -1;
}
