/* entities/table/tombstones.h: end times of entities: a late report must not recreate one.
 *
 * An entity has one tombstone, with its latest end. Capacity: that of the entity table and 256 more; when full the
 * oldest is dropped, and counted when a report could still be that late. */
#ifndef ENTITIES_TABLE_TOMBSTONES_H
#define ENTITIES_TABLE_TOMBSTONES_H

#include "dis/pdu.h"

typedef struct Tombstones Tombstones;

enum { tombstones_beyond_capacity = 256 };

/* keep_s: how late a report may be. Memory is fixed when it is made. */
Status tombstones_create(Tombstones **out, int capacity, double keep_s);
void   tombstones_destroy(Tombstones *tombstones);

/* An entity ended at end_s; detonated: by its Detonation. */
void   tombstones_put(Tombstones *tombstones, DisEntityId id, double end_s, bool detonated);
/* Whether a report at t_s is of one that had ended: before its end, or sooner than after_s after its Detonation. */
bool   tombstones_ended(const Tombstones *tombstones, DisEntityId id, double t_s, double after_s);
/* Those that went younger than keep_s. */
uint64_t tombstones_dropped(const Tombstones *tombstones);

#endif
