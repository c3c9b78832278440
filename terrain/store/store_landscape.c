/* terrain/store/store_landscape.c: the landscape of a terrain store. */
#include "terrain/store/store_landscape_private.h"

#include "terrain/landscape/landscape_private.h"

#include <stdlib.h>

Status store_landscape(Landscape *out, const TerrainStore *store, uint64_t seed)
{
    Landscape             landscape = {.frame = store->frame, .elevation = store->elevation};
    const ElevationLevel *fine = &store->elevation.level[0];
    const ElevationLevel *wide = &store->elevation.level[store->elevation.level_count - 1];
    Cover                *cover = calloc(1, sizeof *cover);
    if (!cover) return STATUS_NO_MEMORY;
    landscape.config = (LandscapeConfig){.seed = seed, .spacing_m = fine->spacing_m,
                                         .half_width_m = 0.5 * fine->spacing_m * fmax(fine->nx - 1, fine->ny - 1),
                                         .horizon_m = 0.5 * wide->spacing_m * fmax(wide->nx - 1, wide->ny - 1)};
    landscape.cover   = cover;
    cover->seed       = landscape_hash(seed, 2, 0);
    cover->real       = true;
    cover->geoid_m    = store->geoid_m;
    cover->treeline_m = landscape_treeline_m(store->frame.origin.lat_rad);
    cover->photo      = store->photo;
    memcpy(cover->grid, store->surface, sizeof cover->grid);
    curve_of_frame(&cover->curve, &store->frame);
    *out = landscape;
    return STATUS_OK;
}

void store_landscape_means(float mean[store_classes][photo_channels], Landscape *landscape)
{
    const Cover *cover = landscape->cover;
    cover_measure_photo(landscape);
    for (int s = 0; s < SURFACE_COUNT; s++) memcpy(mean[s], cover->photo.mean[s], sizeof mean[s]);
}

Status landscape_open_store(Landscape *out, const char *path, uint64_t seed)
{
    TerrainStore store;
    Landscape    landscape = {0};
    Status       status = store_open(&store, path);
    if (status != STATUS_OK) return status;
    char *name = realpath(path, NULL);
    status = name ? store_landscape(&landscape, &store, seed) : STATUS_NO_MEMORY;
    if (status != STATUS_OK) {
        free(name);
        store_close(&store);
        return status;
    }
    Cover *cover = landscape.cover;
    cover->store = (StoreMap){.path = name, .map = (void *)(uintptr_t)store.map, .octets = store.octets,
                              .content = store.content};
    store.map = NULL; /* the landscape's now */
    store_close(&store);
    *out = landscape;
    return STATUS_OK;
}
