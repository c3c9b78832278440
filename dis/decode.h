/* dis/decode.h: decodes and encodes PDUs: a tagged union of the plain structs. */
#ifndef DIS_DECODE_H
#define DIS_DECODE_H

#include "dis/data.h"
#include "dis/entity_state.h"
#include "dis/simulation_management.h"
#include "dis/warfare.h"

/* 11 KiB, most of it for 255 variable records: allocate one per loop, not one per PDU. */
typedef struct DisPdu {
    uint8_t type; /* which of these: dis_pdu_entity_state, ...; as in the header */
    union {
        DisHeader            header; /* first member of every struct */
        DisEntityState       entity_state;
        DisEntityStateUpdate update;
        DisFire              fire;
        DisDetonation        detonation;
        DisRemoveEntity      remove;
        DisStartResume       start;
        DisStopFreeze        stop;
        DisData              data; /* its values stay inside the octets */
    };
} DisPdu;

/* pdu: header.length octets from dis_next_pdu. On failure `out` is untouched; when it succeeds, variable records and
 * datums beyond the counted ones are unchanged. Values are not validated here: see dis_entity_is_usable.
 * STATUS_TRUNCATED: fewer octets than the header or the type needs, or than the length field gives (0: all octets).
 * STATUS_BAD_VALUE: a count that the length cannot hold.
 * STATUS_UNSUPPORTED: a type that is not decoded, or more datums than the output holds. */
Status dis_decode(DisPdu *out, const uint8_t *pdu, size_t octets);
/* Writes header.length as computed. Returns the octets written; 0: capacity is too small, or no such type. */
size_t dis_encode(uint8_t *out, size_t capacity, const DisPdu *pdu);
/* Counts a PDU that dis_decode refused, by reason; one of a type that is not acted upon is no drop. */
void   dis_count_refused(DisCounters *counters, uint8_t type, Status status);
/* `Entity State`, `Attribute`, ...; `unknown type` beyond 72. */
const char *dis_pdu_type_name(uint8_t type);

#endif
