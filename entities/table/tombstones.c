/* entities/table/tombstones.c: a ring buffer of end times, and an index into it by id. */
#include "entities/table/tombstones.h"
#include "entities/table/entity_index.h"

#include <stdlib.h>

typedef struct Tombstone {
    uint64_t key;
    double   end_s, detonated_s; /* the latest of each kind; -inf: none */
} Tombstone;

struct Tombstones {
    int         capacity, count, next; /* next: the oldest, where count is the capacity */
    double      keep_s;
    Tombstone  *stone; /* [capacity] */
    EntityIndex index;
    uint64_t    dropped;
};

Status tombstones_create(Tombstones **out, int capacity, double keep_s)
{
    Tombstones *t = calloc(1, sizeof *t);
    if (!t) return STATUS_NO_MEMORY;
    t->capacity = capacity + tombstones_beyond_capacity;
    t->keep_s   = keep_s;
    t->stone    = calloc((size_t)t->capacity, sizeof *t->stone);
    if (!t->stone || entity_index_create(&t->index, t->capacity) != STATUS_OK) {
        tombstones_destroy(t);
        return STATUS_NO_MEMORY;
    }
    *out = t;
    return STATUS_OK;
}

void tombstones_destroy(Tombstones *t)
{
    if (!t) return;
    entity_index_destroy(&t->index);
    free(t->stone);
    free(t);
}

/* The slot of a new one: a free slot, or that of the oldest. */
static int make_room(Tombstones *t, double now_s)
{
    const int place = t->next;
    t->next = (t->next + 1) % t->capacity;
    if (t->count < t->capacity) {
        t->count++;
        return place;
    }
    const Tombstone *oldest = t->stone + place;
    t->dropped += now_s - fmax(oldest->end_s, oldest->detonated_s) < t->keep_s;
    entity_index_remove(&t->index, oldest->key);
    return place;
}

void tombstones_put(Tombstones *t, DisEntityId id, double end_s, bool detonated)
{
    const uint64_t key   = entity_key(id);
    int            place = entity_index_find(&t->index, key);
    if (place < 0) {
        place           = make_room(t, end_s);
        t->stone[place] = (Tombstone){key, -INFINITY, -INFINITY};
        entity_index_insert(&t->index, key, place);
    }
    double *latest_s = detonated ? &t->stone[place].detonated_s : &t->stone[place].end_s;
    *latest_s = fmax(*latest_s, end_s);
}

bool tombstones_ended(const Tombstones *t, DisEntityId id, double t_s, double after_s)
{
    const int place = entity_index_find(&t->index, entity_key(id));
    return place >= 0 && (t_s < t->stone[place].end_s || t_s < t->stone[place].detonated_s + after_s);
}

uint64_t tombstones_dropped(const Tombstones *t) { return t->dropped; }
