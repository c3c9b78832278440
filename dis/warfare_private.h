/* dis/warfare_private.h: decodes Fire and Detonation, for decode.c; contract: dis_decode. */
#ifndef DIS_WARFARE_PRIVATE_H
#define DIS_WARFARE_PRIVATE_H

#include "dis/warfare.h"

Status dis_decode_fire(DisFire *out, const uint8_t *pdu, size_t octets);
Status dis_decode_detonation(DisDetonation *out, const uint8_t *pdu, size_t octets);

#endif
