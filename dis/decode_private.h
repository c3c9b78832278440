/* dis/decode_private.h: the table of PDU types, for datagram.c. */
#ifndef DIS_DECODE_PRIVATE_H
#define DIS_DECODE_PRIVATE_H

#include "dis/decode.h"

/* What a type needs before its variable records: dis_next_pdu refuses shorter ones. */
unsigned dis_least_octets(uint8_t type);

#endif
