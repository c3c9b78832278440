/* render/trace/plants/plants_kept.h: prototypes as octets, for the cache.
 *
 * The struct Plants with its pointers 0, then the patterns of leaves, then the quads of each kind and level, as they
 * lie in memory. */
#ifndef RENDER_TRACE_PLANTS_PLANTS_KEPT_H
#define RENDER_TRACE_PLANTS_PLANTS_KEPT_H

#include "render/trace/plants/plants.h"

#include "pitviper_kept.h"

/* Their length, and the octets where out is not NULL. */
size_t plants_to_octets(void *out, const Plants *plants);
/* STATUS_BAD_VALUE: they are not such octets: a number is out of range, or not finite. */
Status plants_from_octets(Plants **out, const void *octets, size_t count);

/* Where what follows from prototypes is kept: beside them, by their name. */
typedef struct PlantsKept {
    Cache      *cache; /* NULL: nowhere */
    const char *name;  /* CacheKey.name of the prototypes */
} PlantsKept;

#endif
