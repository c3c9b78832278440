/* render/radar/clutter_cache.c: see clutter_cache.h. */
#include "render/radar/clutter_cache.h"

#include <pthread.h>
#include <stdlib.h>

enum { sets = 1 << 15, ways = 4, locks = 64 };

/* One way of a set. */
typedef struct Entry {
    ClutterCell      cell;
    uint8_t          surface;
    bool             used;
    ClutterScatterer scatterer;
} Entry;

struct ClutterCache {
    Entry          (*set)[ways];
    uint8_t         *next;           /* [sets]: the way that is given up next */
    pthread_mutex_t  lock[locks];    /* of set % locks, and of its counters */
    uint64_t         drawn[locks], found[locks];
};

Status clutter_cache_create(ClutterCache **out)
{
    ClutterCache *c = calloc(1, sizeof *c);
    if (!c) return STATUS_NO_MEMORY;
    for (int i = 0; i < locks; i++) pthread_mutex_init(&c->lock[i], NULL);
    c->set = calloc(sets, sizeof *c->set);
    c->next = calloc(sets, sizeof *c->next);
    if (!c->set || !c->next) {
        clutter_cache_destroy(c);
        return STATUS_NO_MEMORY;
    }
    *out = c;
    return STATUS_OK;
}

void clutter_cache_destroy(ClutterCache *c)
{
    if (!c) return;
    for (int i = 0; i < locks; i++) pthread_mutex_destroy(&c->lock[i]);
    free(c->set);
    free(c->next);
    free(c);
}

/* Neighbours are in different sets: a field of 256 x 128 cells of a level fills all of them once. */
static int set_of(const ClutterCell *cell)
{
    const uint32_t x = (uint32_t)cell->x, y = (uint32_t)cell->y, level = (uint32_t)cell->level;
    return (int)(((x & 255) | (y & 127) << 8) ^ (x >> 8) * 0x9E5u ^ (y >> 7) * 0x6A7Bu ^ level * 0x3D1Fu) & (sets - 1);
}

static bool find(ClutterScatterer *out, ClutterCache *c, const ClutterCell *cell, uint8_t surface)
{
    const int set = set_of(cell), lock = set % locks;
    bool      found = false;
    pthread_mutex_lock(&c->lock[lock]);
    for (int w = 0; w < ways && !found; w++) {
        const Entry *e = &c->set[set][w];
        found = e->used && e->surface == surface && e->cell.x == cell->x && e->cell.y == cell->y && e->cell.level == cell->level;
        if (found) *out = e->scatterer;
    }
    c->found[lock] += found;
    pthread_mutex_unlock(&c->lock[lock]);
    return found;
}

static void keep(ClutterCache *c, const ClutterScatterer *scatterer, const ClutterCell *cell, uint8_t surface)
{
    const int set = set_of(cell), lock = set % locks;
    pthread_mutex_lock(&c->lock[lock]);
    c->set[set][c->next[set]] = (Entry){*cell, surface, true, *scatterer};
    c->next[set] = (uint8_t)((c->next[set] + 1) % ways);
    c->drawn[lock]++;
    pthread_mutex_unlock(&c->lock[lock]);
}

void clutter_cache_draw(ClutterScatterer *out, ClutterCache *cache, const ClutterGrid *grid, const ClutterTable *table,
                        ClutterBand band, int count, const ClutterCell *cell, const uint8_t *surface)
{
    if (!cache) {
        clutter_draw(out, grid, table, band, count, cell, surface);
        return;
    }
    for (int i = 0; i < count; i++) {
        if (find(&out[i], cache, &cell[i], surface[i])) continue;
        clutter_draw(&out[i], grid, table, band, 1, &cell[i], &surface[i]);
        keep(cache, &out[i], &cell[i], surface[i]);
    }
}

void clutter_cache_counters(uint64_t out[2], ClutterCache *c)
{
    out[0] = out[1] = 0;
    for (int i = 0; i < locks; i++) {
        pthread_mutex_lock(&c->lock[i]);
        out[0] += c->drawn[i];
        out[1] += c->found[i];
        pthread_mutex_unlock(&c->lock[i]);
    }
}
