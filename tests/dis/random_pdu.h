/* tests/dis/random_pdu.h: PDUs with every field random, from a counter: the same ones on every machine. */
#ifndef TESTS_DIS_RANDOM_PDU_H
#define TESTS_DIS_RANDOM_PDU_H

#include "dis/pdu/decode.h"

/* Random words in order. */
typedef struct Dice {
    uint32_t counter[4], key[2], word[4];
    int      used;
} Dice;

static inline Dice dice(uint32_t stream) { return (Dice){.key = {stream, 0x9D15}, .used = 4}; }

static inline uint32_t roll(Dice *d)
{
    if (d->used == 4) {
        random_u32x4(d->word, d->counter, d->key);
        d->counter[0]++;
        d->used = 0;
    }
    return d->word[d->used++];
}

static inline void roll_octets(Dice *d, uint8_t *out, size_t count)
{
    for (size_t i = 0; i < count; i++) out[i] = (uint8_t)roll(d);
}

enum { random_pdu_kinds = 7, random_pdu_octets = 104 + 16 * 255 + 144 };
static const uint8_t random_pdu_type[random_pdu_kinds] = {
    dis_pdu_entity_state,  dis_pdu_entity_state_update, dis_pdu_fire,       dis_pdu_detonation,
    dis_pdu_remove_entity, dis_pdu_start_resume,        dis_pdu_stop_freeze};
static const int random_pdu_fixed[random_pdu_kinds] = {144, 72, 96, 104, 28, 44, 40};

/* Where the count of variable records is; 0: the type has none. */
static inline int random_pdu_count_at(int kind) { return kind < 2 ? 19 : kind == 3 ? 101 : 0; }

/* Random octets under a true header: every pattern of every field, signalling NaNs too. Returns the length. */
static inline size_t random_pdu(uint8_t out[random_pdu_octets], Dice *d, int kind)
{
    const int    at = random_pdu_count_at(kind);
    const int    records = at == 0 ? 0 : roll(d) % 8 ? (int)(roll(d) % 6) : (int)(roll(d) % 256);
    const size_t length = (size_t)(random_pdu_fixed[kind] + 16 * records);
    roll_octets(d, out, length);
    out[0] = (uint8_t)(5 + roll(d) % 3);
    out[2] = random_pdu_type[kind];
    out[8] = (uint8_t)(length >> 8);
    out[9] = (uint8_t)length;
    if (at) out[at] = (uint8_t)records;
    /* record types that the decoder knows, most of the time */
    for (int i = 0; i < records; i++)
        if (roll(d) % 4) out[random_pdu_fixed[kind] + 16 * i] = (uint8_t)(roll(d) % 2);
    return length;
}

#endif
