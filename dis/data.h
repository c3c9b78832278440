/* dis/data.h: Data (type 20) and Set Data (19): fixed and variable datums, to one entity or to all.
 * IEEE 1278.1-1995 5.4.6.10. */
#ifndef DIS_DATA_H
#define DIS_DATA_H

#include "dis/pdu.h"

enum { dis_pdu_set_data = 19, dis_pdu_data = 20, dis_smallest_mtu = 1400 };

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

/* Set Data is laid out alike. 0 where it does not fit: into capacity, or into 65535 octets. */
size_t dis_encode_data(uint8_t *out, size_t capacity, const DisData *pdu);

#endif
