/* pitviper_arena.c: per-frame memory, in blocks that are reused. */
#include "pitviper.h"

#include <pthread.h>
#include <stdlib.h>

enum { arena_alignment = 64, arena_block_octets = 1 << 20 };

typedef struct ArenaBlock {
    struct ArenaBlock *next;
    size_t             size, used; /* of data */
    unsigned char     *data;       /* aligned */
} ArenaBlock;

struct Arena {
    ArenaBlock     *first, *current;
    pthread_mutex_t mutex; /* of arena_alloc */
};

Arena *arena_create(void)
{
    Arena *arena = calloc(1, sizeof *arena);
    if (!arena) return NULL;
    if (pthread_mutex_init(&arena->mutex, NULL) == 0) return arena;
    free(arena);
    return NULL;
}

void arena_destroy(Arena *arena)
{
    if (!arena) return;
    for (ArenaBlock *block = arena->first, *next; block; block = next) {
        next = block->next;
        free(block->data);
        free(block);
    }
    pthread_mutex_destroy(&arena->mutex);
    free(arena);
}

void arena_reset(Arena *arena)
{
    for (ArenaBlock *block = arena->first; block; block = block->next) block->used = 0;
    arena->current = arena->first;
}

static ArenaBlock *add_block(Arena *arena, size_t octets)
{
    ArenaBlock *block = calloc(1, sizeof *block);
    if (!block) return NULL;
    block->size = octets > arena_block_octets ? octets : arena_block_octets;
    block->data = aligned_alloc(arena_alignment, block->size);
    if (!block->data) {
        free(block);
        return NULL;
    }
    /* after the current one: the blocks after it are still empty and are used next */
    if (arena->current) {
        block->next          = arena->current->next;
        arena->current->next = block;
    } else {
        arena->first = block;
    }
    return block;
}

static void *take(Arena *arena, size_t octets)
{
    while (arena->current && arena->current->size - arena->current->used < octets && arena->current->next)
        arena->current = arena->current->next;
    if (!arena->current || arena->current->size - arena->current->used < octets) {
        ArenaBlock *block = add_block(arena, octets);
        if (!block) return NULL;
        arena->current = block;
    }
    void *memory = arena->current->data + arena->current->used;
    arena->current->used += octets;
    return memory;
}

void *arena_alloc(Arena *arena, size_t count, size_t size)
{
    size_t octets;
    if (__builtin_mul_overflow(count, size, &octets) || octets > SIZE_MAX - arena_alignment) return NULL;
    octets = (octets + arena_alignment - 1) & ~(size_t)(arena_alignment - 1);
    if (octets == 0) octets = arena_alignment;

    pthread_mutex_lock(&arena->mutex);
    void *memory = take(arena, octets);
    pthread_mutex_unlock(&arena->mutex);
    if (memory) memset(memory, 0, octets);
    return memory;
}

size_t arena_bytes(const Arena *arena)
{
    size_t octets = 0;
    for (const ArenaBlock *block = arena->first; block; block = block->next) octets += block->size;
    return octets;
}
