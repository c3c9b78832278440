/* dis/cigi/cigi_fields.h: where each field of a packet is in its octets: the tables by which packets are read, written,
 * and printed by tests. */
#ifndef DIS_CIGI_CIGI_FIELDS_H
#define DIS_CIGI_CIGI_FIELDS_H

#include "dis/cigi/cigi.h"

typedef enum CigiFieldKind {
    CIGI_BITS, /* within one octet: a member of type uint8_t */
    CIGI_FLAG, /* one bit: bool */
    CIGI_S8,
    CIGI_U8,
    CIGI_U16,
    CIGI_U32,
    CIGI_F32,
    CIGI_F64,
} CigiFieldKind;

typedef struct CigiField {
    const char   *name; /* of the document, in small letters */
    CigiFieldKind kind;
    uint8_t       octet;       /* of the packet's first one */
    uint8_t       shift, bits; /* CIGI_BITS and CIGI_FLAG */
    uint16_t      member;      /* offset in its struct */
} CigiField;

typedef struct CigiLayout {
    const char      *name;
    uint8_t          id, octets;
    const CigiField *field; /* [count] */
    int              count;
} CigiLayout;

/* NULL: this program neither reads nor writes packets of that id. */
const CigiLayout *cigi_layout(uint8_t id);
/* A field's value as a number; exact. */
double cigi_field_value(const CigiPacket *packet, const CigiField *field);
/* The member gets that value, cut to its type. */
void cigi_field_set(CigiPacket *packet, const CigiField *field, double value);

/* Reads fields that lie within the packet's octets; those beyond stay as they are. False: a number is not finite. */
bool cigi_read_fields(CigiPacket *out, const CigiLayout *layout, const uint8_t *octets, size_t count, CigiOrder order);
/* Into layout->octets, which are 0 at first. */
void cigi_write_fields(uint8_t *out, const CigiLayout *layout, const CigiPacket *packet, CigiOrder order);

#endif
