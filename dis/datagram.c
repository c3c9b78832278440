/* dis/datagram.c: iterates over the PDUs of a datagram; the sender of a PDU. */
#include "dis/datagram.h"

#include "dis/decode_private.h"
#include "dis/reader.h"

bool dis_next_pdu(DisHeader *header, const uint8_t **pdu, const uint8_t **at, const uint8_t *end,
                  DisCounters *counters)
{
    const size_t left = (size_t)(end - *at);
    DisDrop      why;
    if (left == 0) return false;
    if (left < dis_header_octets) {
        why = DIS_DROP_SHORT_HEADER;
    } else {
        const DisHeader next = dis_load_header(*at);
        /* A length too short for its type ends the bundle as well: a sender that wrote 496 for 508 has its next PDU at
         * another offset than the length gives. */
        if (next.version < 5 || next.version > 7) {
            why = DIS_DROP_BAD_VERSION;
        } else if (next.length < dis_least_octets(next.type)) {
            why = DIS_DROP_LENGTH_TOO_SHORT;
        } else if (next.length > left) {
            why = DIS_DROP_LENGTH_TOO_LONG;
        } else {
            counters->pdus[next.type]++;
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
