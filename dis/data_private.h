/* dis/data_private.h: decodes Data and Set Data, for decode.c; contract: dis_decode. */
#ifndef DIS_DATA_PRIVATE_H
#define DIS_DATA_PRIVATE_H

#include "dis/data.h"

Status dis_decode_data(DisData *out, const uint8_t *pdu, size_t octets);

#endif
