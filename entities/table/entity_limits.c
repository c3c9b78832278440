/* entities/table/entity_limits.c: ranks: per sender a list of entities for each distance class, oldest report first,
 * and of each tier a heap of senders by how many they have in it; token buckets of senders; a ring buffer of
 * tombstones. */

#include "entities/table/entity_limits_private.h"
#include "entities/table/entity_index.h"

#include <stdlib.h>

enum {
    tier_count = 4,                       /* tier known * 2 + near; entities are evicted from the lowest tier first */
    list_count = 2 * entity_rank_classes, /* list known * entity_rank_classes + class */
    nothing = -1,
};

static const double   first_class_m = 625;
static const uint32_t near_lists = (UINT32_C(1) << entity_rank_near_classes) - 1,
                      new_lists = (UINT32_C(1) << entity_rank_classes) - 1;

typedef struct Node {
    int     older, newer;  /* neighbours in its list */
    int     before, after; /* neighbours in the order of the last reports of all entities */
    int     sender;        /* none: the slot is not ranked */
    uint8_t list;
} Node;

typedef struct Sender {
    uint32_t key;                               /* site, application */
    uint32_t lists;                             /* bit l: list l is not empty */
    int      count[tier_count], at[tier_count]; /* entities of each tier; place in that tier's heap, where count > 0 */
    int      oldest[list_count], newest[list_count]; /* oldest and newest entity of each list */
} Sender;

struct EntityRanks {
    int     room, first, last; /* room: entities reserved for a tier; first, last: reported least and most recently */
    Node   *node;              /* [slots] */
    Sender *sender;            /* [slots]; elements below sender_end are in use */
    int    *free_sender;
    int     sender_end, free_count;
    EntityIndex index; /* index of senders by key */
    int         total[tier_count], heap_count[tier_count];
    int        *heap[tier_count]; /* [slots] heaps of senders, one for each tier */
};

Status entity_ranks_create(EntityRanks **out, int slots, int capacity)
{
    EntityRanks *r = calloc(1, sizeof *r);
    if (!r) return STATUS_NO_MEMORY;
    const size_t n = (size_t)slots;
    r->room = capacity / tier_count;
    r->first = r->last = nothing;
    r->node = calloc(n, sizeof *r->node);
    r->sender = calloc(n, sizeof *r->sender);
    r->free_sender = calloc(n, sizeof *r->free_sender);
    bool made = r->node && r->sender && r->free_sender;
    for (int t = 0; t < tier_count; t++) made = (r->heap[t] = calloc(n, sizeof *r->heap[t])) && made;
    if (!made || entity_index_create(&r->index, slots) != STATUS_OK) {
        entity_ranks_destroy(r);
        return STATUS_NO_MEMORY;
    }
    for (int i = 0; i < slots; i++) r->node[i].sender = nothing;
    *out = r;
    return STATUS_OK;
}

void entity_ranks_destroy(EntityRanks *r)
{
    if (!r) return;
    for (int t = 0; t < tier_count; t++) free(r->heap[t]);
    entity_index_destroy(&r->index);
    free(r->free_sender);
    free(r->sender);
    free(r->node);
    free(r);
}

int entity_rank_class(const double p_ecef[3], const double from_ecef[3])
{
    double d[3], reach_m = first_class_m;
    int    rank = 0;
    v3_sub(d, p_ecef, from_ecef);
    for (const double far_m = v3_length(d); rank < entity_rank_classes - 1 && !(far_m <= reach_m); rank++) reach_m *= 2;
    return rank;
}

/* ---- ranks: the heap of a tier: the sender with the most is first -------------------------------------- */

static bool goes_before(const EntityRanks *r, int tier, int a, int b)
{
    const Sender *p = r->sender + a, *q = r->sender + b;
    return p->count[tier] != q->count[tier] ? p->count[tier] > q->count[tier] : p->key > q->key;
}

static void set_place(EntityRanks *r, int tier, int place, int sender)
{
    r->heap[tier][place] = sender;
    r->sender[sender].at[tier] = place;
}

/* Sifts a sender from a free place of the heap to the place where it belongs. */
static void sift(EntityRanks *r, int tier, int place, int sender)
{
    const int *heap = r->heap[tier], count = r->heap_count[tier];
    for (int above; place > 0 && goes_before(r, tier, sender, heap[above = (place - 1) / 2]); place = above)
        set_place(r, tier, place, heap[above]);
    for (int below; (below = 2 * place + 1) < count; place = below) {
        if (below + 1 < count && goes_before(r, tier, heap[below + 1], heap[below])) below++;
        if (!goes_before(r, tier, heap[below], sender)) break;
        set_place(r, tier, place, heap[below]);
    }
    set_place(r, tier, place, sender);
}

static void add_to_count(EntityRanks *r, int sender, int tier, int more)
{
    Sender *s = r->sender + sender;
    if (s->count[tier] == 0) s->at[tier] = r->heap_count[tier]++;
    s->count[tier] += more;
    r->total[tier] += more;
    if (s->count[tier] > 0) {
        sift(r, tier, s->at[tier], sender);
        return;
    }
    const int last = r->heap[tier][--r->heap_count[tier]];
    if (last != sender) sift(r, tier, s->at[tier], last);
}

/* ---- ranks: senders -------------------------------------------------------------------------------------- */

static int find_or_add_sender(EntityRanks *r, uint32_t key)
{
    int s = entity_index_find(&r->index, key);
    if (s >= 0) return s;
    s = r->free_count > 0 ? r->free_sender[--r->free_count] : r->sender_end++;
    r->sender[s] = (Sender){.key = key};
    entity_index_insert(&r->index, key, s);
    return s;
}

static void drop_if_empty(EntityRanks *r, int sender)
{
    if (r->sender[sender].lists) return;
    entity_index_remove(&r->index, r->sender[sender].key);
    r->free_sender[r->free_count++] = sender;
}

/* ---- ranks: lists ---------------------------------------------------------------------------------------- */

static int list_of(bool known, int class) { return known * entity_rank_classes + class; }
static int tier_of(int list)
{
    return list / entity_rank_classes * 2 + (list % entity_rank_classes < entity_rank_near_classes);
}

static uint32_t lists_of(int tier)
{
    const uint32_t lists = tier & 1 ? near_lists : new_lists & ~near_lists;
    return tier & 2 ? lists << entity_rank_classes : lists;
}

static void unlink_node(EntityRanks *r, int slot)
{
    Node   *n = r->node + slot;
    Sender *s = r->sender + n->sender;
    if (n->older != nothing) r->node[n->older].newer = n->newer;
    else s->oldest[n->list] = n->newer;
    if (n->newer != nothing) r->node[n->newer].older = n->older;
    else s->newest[n->list] = n->older;
    if (s->oldest[n->list] == nothing) s->lists &= ~(UINT32_C(1) << n->list);
}

static void append_node(EntityRanks *r, int slot, int sender, int list)
{
    Node      *n = r->node + slot;
    Sender    *s = r->sender + sender;
    const bool empty = !(s->lists >> list & 1);
    n->older = empty ? nothing : s->newest[list];
    n->newer = nothing;
    n->sender = sender;
    n->list = (uint8_t)list;
    if (empty) s->oldest[list] = slot;
    else r->node[n->older].newer = slot;
    s->newest[list] = slot;
    s->lists |= UINT32_C(1) << list;
}

static void change_list(EntityRanks *r, int slot, int list)
{
    const Node before = r->node[slot];
    unlink_node(r, slot);
    append_node(r, slot, before.sender, list);
    if (tier_of(before.list) == tier_of(list)) return;
    add_to_count(r, before.sender, tier_of(before.list), -1);
    add_to_count(r, before.sender, tier_of(list), 1);
}

/* ---- ranks: all entities in the order of their last report ---------------------------------------------------- */

static void receive_last(EntityRanks *r, int slot)
{
    Node *n = r->node + slot;
    n->before = r->last;
    n->after = nothing;
    if (r->last != nothing) r->node[r->last].after = slot;
    else r->first = slot;
    r->last = slot;
}

static void forget(EntityRanks *r, int slot)
{
    const Node *n = r->node + slot;
    if (n->before != nothing) r->node[n->before].after = n->after;
    else r->first = n->after;
    if (n->after != nothing) r->node[n->after].before = n->before;
    else r->last = n->before;
}

/* ---- ranks: queries of the table -------------------------------------------------------------------------- */

void entity_ranks_put(EntityRanks *r, int slot, DisEntityId id, bool known, int class)
{
    Node     *n = r->node + slot;
    const int list = list_of(known, class);
    if (n->sender != nothing) {
        forget(r, slot);
        change_list(r, slot, list);
    } else {
        n->sender = find_or_add_sender(r, (uint32_t)id.site << 16 | id.application);
        append_node(r, slot, n->sender, list);
        add_to_count(r, n->sender, tier_of(list), 1);
    }
    receive_last(r, slot);
}

void entity_ranks_again(EntityRanks *r, int (*distance_class)(const void *user, int slot), const void *user)
{
    for (int slot = r->first; slot != nothing; slot = r->node[slot].after)
        change_list(r, slot, list_of(r->node[slot].list >= entity_rank_classes, distance_class(user, slot)));
}

void entity_ranks_remove(EntityRanks *r, int slot)
{
    Node *n = r->node + slot;
    if (n->sender == nothing) return;
    forget(r, slot);
    unlink_node(r, slot);
    add_to_count(r, n->sender, tier_of(n->list), -1);
    drop_if_empty(r, n->sender);
    n->sender = nothing;
}

int entity_ranks_worst(const EntityRanks *r)
{
    int tier = nothing;
    for (int t = 0; t < tier_count && tier == nothing; t++)
        if (r->total[t] > r->room) tier = t;
    for (int t = 0; t < tier_count && tier == nothing;
         t++) /* reached only where some entities of the table are not ranked */
        if (r->total[t] > 0) tier = t;
    if (tier == nothing) return nothing;
    const Sender *s = r->sender + r->heap[tier][0];
    return s->oldest[31 - __builtin_clz(s->lists & lists_of(tier))];
}

int entity_ranks_largest(DisEntityId *sender, const EntityRanks *r)
{
    int      most = 0;
    uint32_t key = 0;
    for (int i = 0; i < r->sender_end; i++) {
        const Sender *s = r->sender + i;
        const int     count = s->lists ? s->count[0] + s->count[1] + s->count[2] + s->count[3] : 0;
        if (count < most || count == 0 || (count == most && s->key < key)) continue;
        most = count;
        key = s->key;
        *sender = (DisEntityId){.site = (uint16_t)(s->key >> 16), .application = (uint16_t)s->key};
    }
    return most;
}

/* ---- rates: token buckets by sender --------------------------------------------------------- */

enum { sender_limit = 4096 };

typedef struct Bucket {
    uint64_t key;
    double   tokens, filled_s; /* tokens there were at filled_s, the latest time of a call */
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
    place = r->next;
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
        b->tokens = fmin(b->tokens + (t_s - b->filled_s) * r->new_per_s, r->new_per_s);
        b->filled_s = t_s;
    }
    if (b->tokens < 1) return false;
    b->tokens--;
    return true;
}

/* ---- tombstones: a ring buffer of end times, and an index into it by id --------------------- */

typedef struct Tombstone {
    uint64_t key;
    double end_s, detonated_s; /* end_s: latest end of any kind; detonated_s: latest end by a Detonation; -inf: none */
} Tombstone;

struct Tombstones {
    int capacity, count, next; /* next: the element that the next tombstone takes, the oldest once the buffer is full */
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
    t->keep_s = keep_s;
    t->stone = calloc((size_t)t->capacity, sizeof *t->stone);
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

/* Returns a slot for a new tombstone: a free one, or that of the oldest. */
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
    const uint64_t key = entity_key(id);
    int            place = entity_index_find(&t->index, key);
    if (place < 0) {
        place = make_room(t, end_s);
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
