/* dis/decode_private.h: the table of PDU types, for datagram.c. */
#ifndef DIS_DECODE_PRIVATE_H
#define DIS_DECODE_PRIVATE_H

#include "dis/decode.h"

/* What a type needs before its variable records: dis_next_pdu refuses shorter ones. */
unsigned dis_least_octets(uint8_t type);
/* How many octets the PDU at pdu has by its type and its own counts, whatever its length field says; 0: not known of its
 * type, or more than there are octets. */
size_t   dis_whole_octets(const uint8_t *pdu, size_t octets);

#endif
