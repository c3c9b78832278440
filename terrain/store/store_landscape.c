/* terrain/store/store_landscape.c: the landscape of a terrain store. */
#include "terrain/store/store_landscape_private.h"

#include "terrain/landscape/landscape_parts.h"

#include <stdlib.h>

Status store_landscape(Landscape *out, const TerrainStore *store, uint64_t seed, const LandscapeMap *map)
{
    const ElevationLevel *fine = &store->elevation.level[0];
    const ElevationLevel *wide = &store->elevation.level[store->elevation.level_count - 1];
    LandscapeParts        parts = {.frame = store->frame, .elevation = store->elevation, .photo = store->photo,
                                   .cover_seed = landscape_cover_seed(seed), .geoid_m = store->geoid_m};
    parts.config = (LandscapeConfig){.seed = seed, .spacing_m = fine->spacing_m,
                                     .half_width_m = 0.5 * fine->spacing_m * fmax(fine->nx - 1, fine->ny - 1),
                                     .horizon_m = 0.5 * wide->spacing_m * fmax(wide->nx - 1, wide->ny - 1)};
    memcpy(parts.cover, store->surface, sizeof parts.cover);
    return landscape_borrow(out, &parts, map);
}

Status landscape_open_store(Landscape *out, const char *path, uint64_t seed)
{
    TerrainStore store;
    Status       status = store_open(&store, path);
    if (status != STATUS_OK) return status;
    const LandscapeMap map = {.path = realpath(path, NULL), .map = (void *)(uintptr_t)store.map,
                              .octets = store.octets, .content = store.content};
    status = map.path ? store_landscape(out, &store, seed, &map) : STATUS_NO_MEMORY;
    if (status == STATUS_OK) store.map = NULL; /* the landscape's now */
    else free(map.path);
    store_close(&store);
    return status;
}
