/* dis/datagram.c: iterates over the PDUs of a datagram; the sender of a PDU. */
#include "dis/datagram.h"

#include "dis/decode_private.h"
#include "dis/reader.h"

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

/* Octets of a PDU with a length field of 0, as some libraries leave it: by its type and counts, where these, and those of
 * the PDUs behind it, end exactly with the datagram. 0: not certain. */
static size_t certain_length(const uint8_t *pdu, const uint8_t *end)
{
    const uint8_t *at = pdu;
    size_t         first = 0;
    for (int n = 0; n < chain_limit && at < end; n++) {
        const size_t left = (size_t)(end - at);
        if (left < dis_header_octets) return 0;
        const DisHeader header = dis_load_header(at);
        const size_t    octets = header.length ? header.length : dis_whole_octets(at, left);
        if (!version_known(header.version) || octets < dis_least_octets(header.type) || octets > left) return 0;
        if (n == 0) first = octets;
        at = past_padding(at + octets, end);
    }
    return at == end ? first : 0;
}

bool dis_next_pdu(DisHeader *header, const uint8_t **pdu, const uint8_t **at, const uint8_t *end,
                  DisCounters *counters)
{
    const uint8_t *const begin = past_padding(*at, end);
    const size_t         left  = (size_t)(end - begin);
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
        } else if (next.length < dis_least_octets(next.type)) {
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
    *at = end; /* so that asking again does not count again */
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
