/* pitviper_arena.c: per-frame memory, in blocks that are reused. What is larger than a block has one of its own, in
 * steps of a quarter of a power of two, so that a request that grows from frame to frame finds the block of the frame
 * before. */
#include "pitviper.h"

#include <pthread.h>
#include <stdlib.h>

enum { arena_alignment = 64, arena_block_octets = 1 << 20 };

typedef struct ArenaBlock {
    struct ArenaBlock *next;
    size_t             size, used; /* octets of the block, and how many are in use */
    unsigned char     *data;       /* aligned */
} ArenaBlock;

struct Arena {
    ArenaBlock     *first, *current; /* blocks, all of one size */
    ArenaBlock     *large;           /* larger blocks, each for one request */
    pthread_mutex_t mutex;           /* is held by arena_alloc */
};

Arena *arena_create(void)
{
    Arena *arena = calloc(1, sizeof *arena);
    if (!arena) return NULL;
    if (pthread_mutex_init(&arena->mutex, NULL) == 0) return arena;
    free(arena);
    return NULL;
}

static void free_block(ArenaBlock *block)
{
    free(block->data);
    free(block);
}

static void free_blocks(ArenaBlock *block)
{
    for (ArenaBlock *next; block; block = next) {
        next = block->next;
        free_block(block);
    }
}

void arena_destroy(Arena *arena)
{
    if (!arena) return;
    free_blocks(arena->first);
    free_blocks(arena->large);
    pthread_mutex_destroy(&arena->mutex);
    free(arena);
}

/* Frees large blocks that have not been used since the last reset. */
void arena_reset(Arena *arena)
{
    for (ArenaBlock *block = arena->first; block; block = block->next) block->used = 0;
    arena->current = arena->first;
    for (ArenaBlock **at = &arena->large; *at;) {
        ArenaBlock *block = *at;
        if (block->used == 0) {
            *at = block->next;
            free_block(block);
        } else {
            block->used = 0;
            at = &block->next;
        }
    }
}

static ArenaBlock *new_block(size_t octets)
{
    ArenaBlock *block = calloc(1, sizeof *block);
    if (!block) return NULL;
    block->size = octets;
    block->data = aligned_alloc(arena_alignment, octets);
    if (block->data) return block;
    free(block);
    return NULL;
}

static size_t rounded(size_t octets)
{
    size_t step = arena_block_octets / 4;
    while (step < octets / 8) step *= 2;
    return octets > SIZE_MAX - step ? octets : (octets + step - 1) / step * step;
}

/* Returns the smallest large block that is free. */
static void *take_large(Arena *arena, size_t octets)
{
    ArenaBlock *best = NULL;
    for (ArenaBlock *block = arena->large; block; block = block->next)
        if (block->used == 0 && block->size >= octets && (!best || block->size < best->size)) best = block;
    if (!best) {
        best = new_block(rounded(octets));
        if (!best) return NULL;
        best->next = arena->large;
        arena->large = best;
    }
    best->used = octets;
    return best->data;
}

static void *take(Arena *arena, size_t octets)
{
    if (octets > arena_block_octets) return take_large(arena, octets);
    while (arena->current && arena->current->size - arena->current->used < octets && arena->current->next)
        arena->current = arena->current->next;
    if (!arena->current || arena->current->size - arena->current->used < octets) {
        ArenaBlock *block = new_block(arena_block_octets);
        if (!block) return NULL;
        if (arena->current) arena->current->next = block; /* it is the last */
        else arena->first = block;
        arena->current = block;
    }
    void *memory = arena->current->data + arena->current->used;
    arena->current->used += octets;
    return memory;
}

/* *octets: gets how many were taken. */
static void *take_aligned(size_t *octets, Arena *arena, size_t count, size_t size)
{
    if (__builtin_mul_overflow(count, size, octets) || *octets > SIZE_MAX - arena_alignment) return NULL;
    *octets = (*octets + arena_alignment - 1) & ~(size_t)(arena_alignment - 1);
    if (*octets == 0) *octets = arena_alignment;

    pthread_mutex_lock(&arena->mutex);
    void *memory = take(arena, *octets);
    pthread_mutex_unlock(&arena->mutex);
    return memory;
}

void *arena_alloc_raw(Arena *arena, size_t count, size_t size)
{
    size_t octets;
    return take_aligned(&octets, arena, count, size);
}

void *arena_alloc(Arena *arena, size_t count, size_t size)
{
    size_t octets;
    void  *memory = take_aligned(&octets, arena, count, size);
    if (memory) memset(memory, 0, octets);
    return memory;
}

size_t arena_bytes(const Arena *arena)
{
    size_t octets = 0;
    for (const ArenaBlock *block = arena->first; block; block = block->next) octets += block->size;
    for (const ArenaBlock *block = arena->large; block; block = block->next) octets += block->size;
    return octets;
}
