/* render/trace/plants/plants_kept.h: what even light reaches the quads of prototypes, as octets for the cache. The
 * prototypes themselves grow in less time than they are read. */
#ifndef RENDER_TRACE_PLANTS_PLANTS_KEPT_H
#define RENDER_TRACE_PLANTS_PLANTS_KEPT_H

#include "render/trace/plants/plants.h"

#include "pitviper_kept.h"

/* Plants.shade, then PlantQuad.open_up and open_down of shape after shape, but for patterned ones, two floats a quad:
 * their length, and the octets where out is not NULL. */
size_t plants_light_to_octets(void *out, const Plants *plants);
/* STATUS_BAD_VALUE: they are not of these shapes, a share is not in 0 .. 1, or a shadow not in 0 .. plant_shade_most;
 * nothing has changed then. */
Status plants_light_from_octets(Plants *plants, const void *octets, size_t count);

/* Where what follows from prototypes is kept: beside them, by their name. */
typedef struct PlantsKept {
    Cache      *cache; /* NULL: nowhere */
    const char *name;  /* CacheKey.name of the prototypes */
} PlantsKept;

#endif
