/* entities/table/entity_rate.c: token buckets by sender. */
#include "entities/table/entity_rate.h"
#include "entities/table/entity_index.h"

#include <stdlib.h>

enum { sender_limit = 4096 };

typedef struct Bucket {
    uint64_t key;
    double   tokens, filled_s; /* tokens at filled_s, the latest time of a call */
} Bucket;

struct EntityRate {
    double      new_per_s;
    int         count, next;
    Bucket      bucket[sender_limit];
    EntityIndex index;
};

Status entity_rate_create(EntityRate **out, double new_per_s)
{
    EntityRate *r = calloc(1, sizeof *r);
    if (!r) return STATUS_NO_MEMORY;
    r->new_per_s = new_per_s;
    if (entity_index_create(&r->index, sender_limit) != STATUS_OK) {
        free(r);
        return STATUS_NO_MEMORY;
    }
    *out = r;
    return STATUS_OK;
}

void entity_rate_destroy(EntityRate *r)
{
    if (!r) return;
    entity_index_destroy(&r->index);
    free(r);
}

static Bucket *find_or_add(EntityRate *r, uint64_t key, double t_s)
{
    int place = entity_index_find(&r->index, key);
    if (place >= 0) return r->bucket + place;
    place   = r->next;
    r->next = (r->next + 1) % sender_limit;
    if (r->count < sender_limit) r->count++;
    else entity_index_remove(&r->index, r->bucket[place].key);
    r->bucket[place] = (Bucket){key, r->new_per_s, t_s};
    entity_index_insert(&r->index, key, place);
    return r->bucket + place;
}

bool entity_rate_take(EntityRate *r, DisEntityId id, double t_s)
{
    id.entity = 0;
    Bucket *b = find_or_add(r, entity_key(id), t_s);
    if (t_s > b->filled_s) {
        b->tokens   = fmin(b->tokens + (t_s - b->filled_s) * r->new_per_s, r->new_per_s);
        b->filled_s = t_s;
    }
    if (b->tokens < 1) return false;
    b->tokens--;
    return true;
}
