/* dis/udp_ring.h: queue of datagrams in a ring buffer; for udp.c only, under its lock.
 *
 * Each is contiguous after its record. A datagram taken is valid until the next take. Memory is allocated once. */
#ifndef DIS_UDP_RING_H
#define DIS_UDP_RING_H

#include "pitviper.h"

/* Record and octets are whole units, so that a gap at the end of the ring holds at least this. */
typedef struct DisRingRecord {
    int64_t  capture_ns;
    uint32_t octets; /* UINT32_MAX: nothing more before the end of the ring */
    uint16_t from_port;
    uint8_t  from[16];
} DisRingRecord;

/* Positions count octets since the beginning: held <= next <= end <= held + octets. */
typedef struct DisRing {
    uint8_t *bytes;
    uint64_t octets, held, next, end; /* held .. next: the taker's */
} DisRing;

Status dis_ring_create(DisRing *out, uint64_t octets);
void   dis_ring_destroy(DisRing *ring); /* a zeroed one is fine */
/* head: with its number of octets, which follow from bytes. False: the ring is full, and the oldest are kept. */
bool   dis_ring_put(DisRing *ring, const DisRingRecord *head, const uint8_t *bytes);
/* The next, not after until_ns, its octets behind it; NULL: none. The previous one becomes invalid. */
const DisRingRecord *dis_ring_take(DisRing *ring, int64_t until_ns);
static inline bool dis_ring_waits(const DisRing *ring) { return ring->next != ring->end; }

#endif
