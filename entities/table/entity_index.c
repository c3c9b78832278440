/* entities/table/entity_index.c: finds the slot of an entity id: a hash table with linear probing, at most half full.
 * Removal closes the gap, so there are no tombstones, and a probe always ends at the first empty cell. */
#include "entities/table/entity_index.h"

#include <stdlib.h>

/* The cell where a search begins. Ids are small consecutive numbers, so they are mixed by SplitMix64's finalizer
 * (Steele, Lea, Flood, OOPSLA 2014). */
static uint32_t home(const EntityIndex *index, uint64_t key_plus_1)
{
    uint64_t x = key_plus_1;
    x = (x ^ x >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    x = (x ^ x >> 27) * UINT64_C(0x94d049bb133111eb);
    return (uint32_t)(x ^ x >> 31) & index->mask;
}

/* The cell that holds the key, or the empty one where it would go. */
static uint32_t locate(const EntityIndex *index, uint64_t key_plus_1)
{
    uint32_t at = home(index, key_plus_1);
    while (index->cell[at].key_plus_1 && index->cell[at].key_plus_1 != key_plus_1) at = (at + 1) & index->mask;
    return at;
}

Status entity_index_create(EntityIndex *out, int capacity)
{
    uint32_t cells = 16;
    while (cells < 2 * (uint64_t)capacity && cells < UINT32_C(1) << 31) cells *= 2;
    EntityIndexCell *cell = calloc(cells, sizeof *cell);
    if (!cell) return STATUS_NO_MEMORY;
    *out = (EntityIndex){.mask = cells - 1, .cell = cell};
    return STATUS_OK;
}

void entity_index_destroy(EntityIndex *index)
{
    free(index->cell);
    *index = (EntityIndex){0};
}

int entity_index_find(const EntityIndex *index, uint64_t key)
{
    const EntityIndexCell *cell = index->cell + locate(index, key + 1);
    return cell->key_plus_1 ? cell->value : -1;
}

void entity_index_insert(EntityIndex *index, uint64_t key, int value)
{
    index->cell[locate(index, key + 1)] = (EntityIndexCell){key + 1, value};
}

void entity_index_remove(EntityIndex *index, uint64_t key)
{
    uint32_t gap = locate(index, key + 1);
    if (!index->cell[gap].key_plus_1) return;

    /* moves each later cell of the run into the gap, unless that would put it before its home */
    for (uint32_t at = (gap + 1) & index->mask; index->cell[at].key_plus_1; at = (at + 1) & index->mask) {
        const uint32_t from_home = (at - home(index, index->cell[at].key_plus_1)) & index->mask;
        const uint32_t from_gap = (at - gap) & index->mask;
        if (from_home < from_gap) continue;
        index->cell[gap] = index->cell[at];
        gap = at;
    }
    index->cell[gap] = (EntityIndexCell){0};
}

Status entity_index_grow(EntityIndex *index)
{
    EntityIndex    larger;
    const uint64_t cells = (uint64_t)index->mask + 1;
    if (cells >= UINT32_C(1) << 30) return STATUS_NO_MEMORY;
    const Status status = entity_index_create(&larger, (int)cells);
    if (status != STATUS_OK) return status;
    for (uint64_t c = 0; c < cells; c++)
        if (index->cell[c].key_plus_1) larger.cell[locate(&larger, index->cell[c].key_plus_1)] = index->cell[c];
    entity_index_destroy(index);
    *index = larger;
    return STATUS_OK;
}
