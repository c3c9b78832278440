/* dis/network/udp_ring.c: a ring buffer of datagrams with their headers, each padded to a whole number of units of 32
 * octets. */
#include "dis/network/udp_private.h"

#include <stdlib.h>

enum { unit = 32 };

_Static_assert(sizeof(DisRingRecord) == unit, "a record is one unit");
static const uint32_t skip = UINT32_MAX;

Status dis_ring_create(DisRing *out, uint64_t octets)
{
    const uint64_t whole = octets / unit * unit;
    uint8_t       *bytes = aligned_alloc(unit, whole);
    if (!bytes) return STATUS_NO_MEMORY;
    *out = (DisRing){.bytes = bytes, .octets = whole};
    return STATUS_OK;
}

void dis_ring_destroy(DisRing *r)
{
    free(r->bytes);
    *r = (DisRing){0};
}

static DisRingRecord *record_at(const DisRing *r, uint64_t position)
{
    return (DisRingRecord *)(void *)(r->bytes +
                                     position % r->octets); /* records are whole units, so every position is aligned */
}

static uint64_t units(uint64_t octets) { return (octets + unit - 1) / unit * unit; }

bool dis_ring_put(DisRing *r, const DisRingRecord *head, const uint8_t *bytes)
{
    /* an empty ring begins at its start again, so that a large ring touches no more memory than needed */
    if (r->held == r->end) r->held = r->next = r->end = (r->end + r->octets - 1) / r->octets * r->octets;
    const uint64_t octets = units(sizeof *head + head->octets), to_end = r->octets - r->end % r->octets;
    const uint64_t gap = octets > to_end ? to_end : 0;
    if (r->end - r->held + gap + octets > r->octets) return false;
    if (gap) record_at(r, r->end)->octets = skip;
    r->end += gap;
    DisRingRecord *record = record_at(r, r->end);
    *record = *head;
    if (head->octets) memcpy(record + 1, bytes, head->octets);
    r->end += octets;
    return true;
}

const DisRingRecord *dis_ring_take(DisRing *r, int64_t until_ns)
{
    r->held = r->next;
    if (r->next == r->end) return NULL;
    const DisRingRecord *record = record_at(r, r->next);
    if (record->octets == skip) {
        r->next += r->octets - r->next % r->octets;
        r->held = r->next;
        record = record_at(r, r->next);
    }
    if (record->capture_ns > until_ns) return NULL;
    r->next += units(sizeof *record + record->octets);
    return record;
}
