/* entities/table/entity_index.h: entity id -> slot number, by open addressing. Memory is fixed when it is made; results
 * do not depend on the order of insertions. */
#ifndef ENTITIES_TABLE_ENTITY_INDEX_H
#define ENTITIES_TABLE_ENTITY_INDEX_H

#include "dis/pdu/pdu.h"

/* The three parts of an id in one number; these sort as dis_entity_id_compare does. */
static inline uint64_t entity_key(DisEntityId id)
{
    return (uint64_t)id.site << 32 | (uint64_t)id.application << 16 | id.entity;
}

typedef struct EntityIndexCell {
    uint64_t key_plus_1; /* 0: empty */
    int      value;
} EntityIndexCell;

typedef struct EntityIndex {
    uint32_t         mask; /* cells - 1, at least twice the capacity */
    EntityIndexCell *cell;
} EntityIndex;

Status entity_index_create(EntityIndex *out, int capacity);
void   entity_index_destroy(EntityIndex *index);
int    entity_index_find(const EntityIndex *index, uint64_t key); /* -1: the key is not there */
/* The key must not be there yet, and there are never more keys than the capacity. */
void entity_index_insert(EntityIndex *index, uint64_t key, int value);
void entity_index_remove(EntityIndex *index, uint64_t key);
/* Doubles the capacity; on failure the index is unchanged. */
Status entity_index_grow(EntityIndex *index);

#endif
