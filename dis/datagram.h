/* dis/datagram.h: iterates over the PDUs of a datagram; the sender of a PDU. */
#ifndef DIS_DATAGRAM_H
#define DIS_DATAGRAM_H

#include "dis/pdu.h"

/* Next PDU of a datagram: *at advances by the length field. True and header/pdu set when there is one;
 * false at the end or at the first inconsistent length, which is counted. PDUs returned are counted by type.
 * Up to 7 zeros before a PDU or at the end are padding. A length field of 0 is replaced in header, and counted, where the
 * types and counts of the PDUs from there on end exactly with the datagram.
 *
 *     for (const uint8_t *at = bytes; dis_next_pdu(&header, &pdu, &at, bytes + count, counters);) ...
 *
 * pdu: header.length octets starting at the header, inside the datagram. */
bool dis_next_pdu(DisHeader *header, const uint8_t **pdu, const uint8_t **at, const uint8_t *end,
                  DisCounters *counters);

/* The sender of a PDU: every type of the standard names its site and application right after the header.
 * False, and out untouched, for a type outside it or one too short. */
bool dis_pdu_sender(uint16_t site_application[2], const DisHeader *header, const uint8_t *pdu);
/* Of which of its sender's entities it is a report (Entity State, Entity State Update); -1: of none. */
int  dis_pdu_entity(const DisHeader *header, const uint8_t *pdu);

#endif
