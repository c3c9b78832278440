/* dis/entity_state_private.h: decodes Entity State and its Update, for decode.c; contract: dis_decode. The
 * variable parameter records of these and of Detonation. */
#ifndef DIS_ENTITY_STATE_PRIVATE_H
#define DIS_ENTITY_STATE_PRIVATE_H

#include "dis/entity_state.h"

Status dis_decode_entity_state(DisEntityState *out, const uint8_t *pdu, size_t octets);
Status dis_decode_entity_state_update(DisEntityStateUpdate *out, const uint8_t *pdu, size_t octets);

enum { dis_variable_parameter_octets = 16 };

/* count records of 16 octets each; the caller has checked that they are there. */
void dis_load_variable_parameters(DisVariableParameter *out, const uint8_t *records, int count);
void dis_store_variable_parameters(uint8_t *records, const DisVariableParameter *from, int count);

#endif
