/* entities/table/entity_ranks.h: which entity a full table evicts.
 *
 * Four tiers: an entity is new or known (it has kept reporting), and far from or near the focus. Each tier has a
 * reserved quarter of the table. Of the tiers with more than that, in the order far and new, near and new, far and
 * known, near and known, the first one loses an entity; in it the sender (site and application) with the most entities
 * there, of several the one with the highest number; of its entities the farthest, by classes of doubled distance; of
 * those the one with the oldest last report.
 *
 * So a sender with many entities loses its own first; of many spurious senders, entities reported once are evicted
 * before those that keep reporting, and tiers are shared fairly among senders. The result depends on the order of the
 * calls alone. Put, remove and worst: O(log senders). Memory is fixed when it is made. */
#ifndef ENTITIES_TABLE_ENTITY_RANKS_H
#define ENTITIES_TABLE_ENTITY_RANKS_H

#include "dis/pdu.h"

typedef struct EntityRanks EntityRanks;

/* Class 0: within 625 m; k: within 625 m * 2^k. Near: within 10 km. */
enum { entity_rank_classes = 16, entity_rank_near_classes = 5, entity_rank_unknown = entity_rank_classes - 1 };

/* Entities are numbered 0 .. slots - 1. capacity: most that a table keeps; what a quarter is. */
Status entity_ranks_create(EntityRanks **out, int slots, int capacity);
void   entity_ranks_destroy(EntityRanks *ranks);

int    entity_rank_class(const double p_ecef[3], const double from_ecef[3]);

/* A report of it was received: inserts it, or marks it the most recent. */
void   entity_ranks_put(EntityRanks *ranks, int slot, DisEntityId id, bool known, int distance_class);
/* Updates the distances of all; times of reports are unchanged. O(slots). */
void   entity_ranks_again(EntityRanks *ranks, int (*distance_class)(const void *user, int slot), const void *user);
void   entity_ranks_remove(EntityRanks *ranks, int slot); /* not there: nothing happens */
int    entity_ranks_worst(const EntityRanks *ranks);      /* -1: none is there */
/* The sender with the most entities, and how many. O(senders). */
int    entity_ranks_largest(DisEntityId *sender, const EntityRanks *ranks);

#endif
