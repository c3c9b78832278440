/* dis/data.h: Data (type 20): fixed and variable datums to whoever asked, or to all. IEEE 1278.1-1995 5.4.6.10. */
#ifndef DIS_DATA_H
#define DIS_DATA_H

#include "dis/pdu.h"

enum { dis_pdu_data = 20, dis_smallest_mtu = 1400 };

typedef struct DisFixedDatum {
    uint32_t id, value;
} DisFixedDatum;

typedef struct DisVariableDatum {
    uint32_t       id, bits;
    const uint8_t *value;   /* (bits + 7) / 8 octets; when read: inside the PDU */
    const uint8_t *padding; /* behind it, to the next multiple of 8 octets; NULL: zeros; when read: inside the PDU */
} DisVariableDatum;

enum { dis_data_fixed_max = 64, dis_data_variable_max = 64 };

typedef struct DisData {
    DisHeader        header;
    DisEntityId      originating, receiving;
    uint32_t         request;
    uint32_t         padding;
    int              fixed_count, variable_count;
    DisFixedDatum    fixed[dis_data_fixed_max];
    DisVariableDatum variable[dis_data_variable_max];
} DisData;

/* As the other decoders (entity_state.h): `out` untouched unless STATUS_OK, and then only the datums counted are
 * written; octets behind the last one are left alone. STATUS_BAD_VALUE: a count, or a number of bits, that the length
 * cannot hold. STATUS_UNSUPPORTED: more datums than there is room for. Reads Set Data (19) too: it is laid
 * out alike. */
Status dis_decode_data(DisData *out, const uint8_t *pdu, size_t octets);
/* 0 where it does not fit: into capacity, or into 65535 octets. */
size_t dis_encode_data(uint8_t *out, size_t capacity, const DisData *pdu);

#endif
