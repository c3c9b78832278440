/* render/scattering/clutter/leaf_cache.h: scatterers of crowns, kept from frame to frame.
 *
 * Drawing one costs some 2 us, finding it again next to nothing. They are functions of seed, crown and number, so what
 * is kept changes no bit. Up to leaves_most of them, 39 MB; with more in a frame some are drawn each time. */
#ifndef RENDER_SCATTERING_CLUTTER_LEAF_CACHE_H
#define RENDER_SCATTERING_CLUTTER_LEAF_CACHE_H

#include "render/scattering/clutter/clutter.h"

enum { leaves_most = 1 << 17 };

typedef struct CrownLeaf {
    double           p_enu[3];
    ClutterScatterer scatterer;
} CrownLeaf;

/* The first scatterers of a crown. The caller that asked for them fills leaf[drawn ..], and sets `drawn`. */
typedef struct CrownLeaves {
    uint32_t            crown;
    int                 room, drawn;
    CrownLeaf          *leaf; /* [room] */
    uint32_t            asked;
    struct CrownLeaves *next;
} CrownLeaves;

/* Of one seed, one foliage and one row of the clutter table for each class. */
typedef struct LeafCache LeafCache;

Status leaf_cache_create(LeafCache **out);
void   leaf_cache_destroy(LeafCache *cache); /* accepts NULL */
/* What is asked for from here on stays until this is called again. */
void leaf_cache_begin(LeafCache *cache);
/* Room for the first `count` scatterers of a crown, with those that were drawn before. NULL: there is none, as this
 * frame has asked for too many. One thread at a time; different crowns may then be filled by any threads. */
CrownLeaves *leaf_cache_crown(LeafCache *cache, uint32_t crown, int count);

#endif
