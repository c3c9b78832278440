/* dis/simulation_management_private.h: decodes Remove Entity, Start/Resume and Stop/Freeze, for decode.c;
 * contract: dis_decode. */
#ifndef DIS_SIMULATION_MANAGEMENT_PRIVATE_H
#define DIS_SIMULATION_MANAGEMENT_PRIVATE_H

#include "dis/simulation_management.h"

Status dis_decode_remove_entity(DisRemoveEntity *out, const uint8_t *pdu, size_t octets);
Status dis_decode_start_resume(DisStartResume *out, const uint8_t *pdu, size_t octets);
Status dis_decode_stop_freeze(DisStopFreeze *out, const uint8_t *pdu, size_t octets);

#endif
