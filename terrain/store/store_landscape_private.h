/* terrain/store/store_landscape_private.h: the landscape of an attached store, for its reader and its writer. */
#ifndef TERRAIN_STORE_STORE_LANDSCAPE_PRIVATE_H
#define TERRAIN_STORE_STORE_LANDSCAPE_PRIVATE_H

#include "terrain/store/store_format.h"

/* Borrows from the store, whose frame is set; takes over map, where not NULL. */
Status store_landscape(Landscape *out, const TerrainStore *store, uint64_t seed, const LandscapeMap *map);

#endif
