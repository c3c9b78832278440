/* dis/decode_private.h: the decoders by type, for the table in decode.c. Contract: dis_decode; each is given a PDU of its
 * own type, writes its member of the union and leaves the tag to the table. */
#ifndef DIS_DECODE_PRIVATE_H
#define DIS_DECODE_PRIVATE_H

#include "dis/decode.h"

typedef Status DisDecoder(DisPdu *out, const uint8_t *pdu, size_t octets);

DisDecoder dis_decode_entity_state, dis_decode_entity_state_update, dis_decode_fire, dis_decode_detonation,
    dis_decode_remove_entity, dis_decode_start_resume, dis_decode_stop_freeze, dis_decode_data;

/* What a type needs before its variable records: dis_next_pdu refuses shorter ones. */
unsigned dis_least_octets(uint8_t type);

#endif
