/* tests/dis/random_cigi.h: CIGI packets with random fields, by a seed. */
#ifndef TESTS_DIS_RANDOM_CIGI_H
#define TESTS_DIS_RANDOM_CIGI_H

#include "tests/dis/random_pdu.h"

#include "dis/cigi/cigi_datagram.h"
#include "dis/cigi/cigi_fields.h"

static const uint8_t cigi_ids[] = {1, 2, 8, 16, 17, 21, 24, 25, 26, 101, 102, 103, 104, 105, 106, 107};
enum { cigi_id_count = (int)sizeof cigi_ids, cigi_host_ids = 9 };

/* Each field some value that it can hold; numbers are finite. */
static inline CigiPacket random_cigi(uint8_t id, Dice *d)
{
    CigiPacket        packet;
    const CigiLayout *layout = cigi_layout(id);
    memset(&packet, 0, sizeof packet);
    packet.id = id;
    for (int i = 0; i < layout->count; i++) {
        const CigiField *f = &layout->field[i];
        const uint32_t   word = roll(d);
        const double     signed_word = (double)(int32_t)word;
        switch (f->kind) {
        case CIGI_BITS:
        case CIGI_FLAG:
            cigi_field_set(&packet, f, word & ((1u << f->bits) - 1));
            break;
        case CIGI_S8:
            cigi_field_set(&packet, f, (int8_t)word);
            break;
        case CIGI_U8:
            cigi_field_set(&packet, f, (uint8_t)word);
            break;
        case CIGI_U16:
            cigi_field_set(&packet, f, (uint16_t)word);
            break;
        case CIGI_U32:
            cigi_field_set(&packet, f, word);
            break;
        case CIGI_F32:
            cigi_field_set(&packet, f, signed_word * 0x1p-23);
            break;
        case CIGI_F64:
            cigi_field_set(&packet, f, (signed_word + (double)roll(d) * 0x1p-32) * 0x1p-22);
            break;
        }
    }
    return packet;
}

static inline bool same_cigi(const CigiPacket *a, const CigiPacket *b)
{
    const CigiLayout *layout = cigi_layout(a->id);
    for (int i = 0; i < layout->count; i++)
        if (cigi_field_value(a, &layout->field[i]) != cigi_field_value(b, &layout->field[i])) return false;
    return a->id == b->id;
}

/* IG Control, or Start of Frame, of version 3.3 with random fields. */
static inline CigiPacket random_cigi_first(CigiSender sender, Dice *d)
{
    CigiPacket first = random_cigi(sender == CIGI_FROM_HOST ? cigi_ig_control : cigi_start_of_frame, d);
    if (sender == CIGI_FROM_HOST) {
        first.of.ig_control.major = first.of.ig_control.minor = 3;
        first.of.ig_control.mode %= cigi_mode_maintenance; /* which a host may not ask for */
    } else first.of.start_of_frame.major = first.of.start_of_frame.minor = 3;
    return first;
}

#endif
