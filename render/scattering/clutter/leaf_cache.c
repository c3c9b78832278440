/* render/scattering/clutter/leaf_cache.c: lists of crowns by a hash; those that a frame does not ask for make room. */
#include "render/scattering/clutter/leaf_cache.h"

#include <stdlib.h>

enum { lists = 1 << 12 };

struct LeafCache {
    CrownLeaves *list[lists];
    int          leaves; /* room of all */
    uint32_t     frame;
    bool         swept; /* all of it is this frame's */
};

Status leaf_cache_create(LeafCache **out)
{
    LeafCache *c = calloc(1, sizeof *c);
    if (!c) return STATUS_NO_MEMORY;
    *out = c;
    return STATUS_OK;
}

static void forget(CrownLeaves *of)
{
    free(of->leaf);
    free(of);
}

void leaf_cache_destroy(LeafCache *c)
{
    for (int i = 0; c && i < lists; i++)
        for (CrownLeaves *at = c->list[i], *next; at; at = next) {
            next = at->next;
            forget(at);
        }
    free(c);
}

void leaf_cache_begin(LeafCache *c)
{
    c->frame++;
    c->swept = false;
}

/* Gives up all that this frame has not asked for. */
static void sweep(LeafCache *c)
{
    for (int i = 0; i < lists && !c->swept; i++)
        for (CrownLeaves **at = &c->list[i]; *at;) {
            CrownLeaves *of = *at;
            if (of->asked == c->frame) {
                at = &of->next;
                continue;
            }
            *at = of->next;
            c->leaves -= of->room;
            forget(of);
        }
    c->swept = true;
}

static CrownLeaves *find(LeafCache *c, uint32_t crown)
{
    CrownLeaves *at = c->list[crown % lists];
    while (at && at->crown != crown) at = at->next;
    return at;
}

CrownLeaves *leaf_cache_crown(LeafCache *c, uint32_t crown, int count)
{
    CrownLeaves *of = find(c, crown);
    if (of) of->asked = c->frame;
    if (of && of->room >= count) return of;
    const int more = count - (of ? of->room : 0);
    if (c->leaves + more > leaves_most) sweep(c);
    if (c->leaves + more > leaves_most) return NULL;
    if (!of) {
        if (!(of = calloc(1, sizeof *of))) return NULL;
        of->crown = crown, of->asked = c->frame;
        of->next = c->list[crown % lists];
        c->list[crown % lists] = of;
    }
    CrownLeaf *larger = realloc(of->leaf, (size_t)count * sizeof *larger);
    if (!larger) return NULL;
    of->leaf = larger, of->room = count;
    c->leaves += more;
    return of;
}
