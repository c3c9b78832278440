/* entities/table/entity_limits_private.h: what keeps the table within bounds whatever senders do: ranks say which
 * entity a full table evicts, rates how many a sender may add, tombstones which reports come too late. */
#ifndef ENTITIES_TABLE_ENTITY_LIMITS_PRIVATE_H
#define ENTITIES_TABLE_ENTITY_LIMITS_PRIVATE_H

#include "dis/pdu/pdu.h"

/* ---- ranks ------------------------------------------------------------------------------------- */

/* Which entity a full table evicts.
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
typedef struct EntityRanks EntityRanks;

/* Class 0: within 625 m; k: within 625 m * 2^k. Near: within 10 km. */
enum { entity_rank_classes = 16, entity_rank_near_classes = 5, entity_rank_unknown = entity_rank_classes - 1 };

/* Entities are numbered 0 .. slots - 1. capacity: most entities that the table keeps, of which each tier has a quarter.
 * */
Status entity_ranks_create(EntityRanks **out, int slots, int capacity);
void   entity_ranks_destroy(EntityRanks *ranks);

int entity_rank_class(const double p_ecef[3], const double from_ecef[3]);

/* Inserts an entity whose report was received, or marks it as the most recent. */
void entity_ranks_put(EntityRanks *ranks, int slot, DisEntityId id, bool known, int distance_class);
/* Updates the distances of all entities; the order of their reports is unchanged. O(slots). */
void entity_ranks_again(EntityRanks *ranks, int (*distance_class)(const void *user, int slot), const void *user);
void entity_ranks_remove(EntityRanks *ranks, int slot); /* does nothing when the entity is not ranked */
int  entity_ranks_worst(const EntityRanks *ranks);      /* the entity to be evicted; -1: none is ranked */
/* Sets the sender with the most entities; returns how many it has. O(senders). */
int entity_ranks_largest(DisEntityId *sender, const EntityRanks *ranks);

/* ---- rates ------------------------------------------------------------------------------------- */

/* How many entities a sender (site and application) may add to the table a second: a token bucket a sender, full at
 * first, that holds as many as one second gives.
 *
 * So a sender that reports all its entities at once is accepted, and one that keeps creating ids is held to the limit.
 * 4096 senders are remembered; beyond that the oldest is dropped, and starts with a full bucket if it returns. The
 * result depends on the order of the calls and their times alone. */
typedef struct EntityRate EntityRate;

/* new_per_s: at least 1. Memory is fixed when it is made. */
Status entity_rate_create(EntityRate **out, double new_per_s);
void   entity_rate_destroy(EntityRate *rate);
/* Whether one more entity of this sender is admitted at t_s; if so it is counted. Times that decrease add no tokens. */
bool entity_rate_take(EntityRate *rate, DisEntityId id, double t_s);

/* ---- tombstones -------------------------------------------------------------------------------- */

/* End times of entities: a late report must not recreate one.
 *
 * An entity has one tombstone, with its latest end. Capacity: that of the entity table and 256 more; when full the
 * oldest is dropped, and counted when a report could still be that late. */
typedef struct Tombstones Tombstones;

enum { tombstones_beyond_capacity = 256 };

/* keep_s: how late a report may be. Memory is fixed when it is made. */
Status tombstones_create(Tombstones **out, int capacity, double keep_s);
void   tombstones_destroy(Tombstones *tombstones);

/* Records that an entity ended at end_s. detonated: it ended by its Detonation. */
void tombstones_put(Tombstones *tombstones, DisEntityId id, double end_s, bool detonated);
/* Whether a report at t_s comes from an entity that had ended: it is before the end, or follows its Detonation by less
 * than after_s. */
bool tombstones_ended(const Tombstones *tombstones, DisEntityId id, double t_s, double after_s);
/* How many tombstones were dropped before they were keep_s old. */
uint64_t tombstones_dropped(const Tombstones *tombstones);

#endif
