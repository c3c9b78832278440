/* sensor/node/ground_store.c: the ground of a node from a terrain store: whether it is fresh and of this place, and
 * what it has. */
#include "sensor/node/ground_store.h"

#include "terrain/import/terrain_import.h"
#include "terrain/store/store.h"

#include <stdlib.h>
#include <unistd.h>

/* ---- fresh ----------------------------------------------------------------------------------------- */

/* A file that cannot be used, but still has the options that it was made with. */
static Status made_again(TerrainStore *store, const char *path, const char *why)
{
    char *options = store_recall(path);
    if (!options) {
        log_error("terrain.store: %s cannot be used: %s; make it again with `pitviper terrain import`", path, why);
        return STATUS_BAD_VALUE;
    }
    char outside[1024];
    if (terrain_store_foreign(outside, sizeof outside, path, options)) {
        log_error("terrain.store: %s cannot be used: %s; it was made of %s, outside its own folder: where you trust that, "
                  "`pitviper terrain again %s` makes it again", path, why, outside, path);
        free(options);
        return STATUS_BAD_VALUE;
    }
    log_print("ground: %s cannot be used: %s; it is made again with the options that it was made with\n", path, why);
    Status status = terrain_store_rebuild(path, options, false);
    free(options);
    if (status == STATUS_OK) return store_open(store, path);
    log_error("terrain.store: %s cannot be used: %s, nor made again; run `pitviper terrain import` with sources that "
              "are here", path, why);
    return status;
}

static const char *name_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

/* Opens the store; made again before where its sources have changed. */
static Status open_fresh(TerrainStore *store, Choices *choices, const char *path)
{
    char        which[1024], outside[1024];
    const char *why;
    Status      status = store_open_why(store, &why, path);
    if (status == STATUS_BAD_VALUE || status == STATUS_UNSUPPORTED) return made_again(store, path, why);
    if (status != STATUS_OK) {
        log_error("terrain.store: cannot open %s: %s; `pitviper terrain import` makes a terrain store", path, why);
        return status;
    }
    switch (store_sources(store, which, sizeof which)) {
    case STORE_FRESH: return STATUS_OK;
    case STORE_SOURCES_MISSING:
        choice_add(choices, "ground: the terrain store is used as it is: %s, of which it was made, is not here", which);
        return STATUS_OK;
    case STORE_CHANGED: break;
    }
    if (terrain_store_foreign(outside, sizeof outside, path, store->options)) {
        choice_add(choices, "ground: the terrain store is used as it is: %.50s has changed, but %.50s lies outside the store's "
                   "own folder (`pitviper terrain again`)", name_of(which), name_of(outside));
        return STATUS_OK;
    }
    log_print("ground: %s has changed since %s was made of it (%s); it is made again\n", which, path, store->made);
    status = terrain_store_rebuild(path, store->options, false);
    store_close(store);
    return status == STATUS_OK ? store_open(store, path) : status;
}

/* ---- of this place --------------------------------------------------------------------------------- */

static Status on_its_ground(const TerrainStore *store, const LocalFrame *aim, const char *path)
{
    const ElevationLevel *wide = &store->elevation.level[store->elevation.level_count - 1];
    double                p_enu[3];
    enu_from_ecef(p_enu, &store->frame, aim->origin_ecef);
    const double x = (p_enu[0] - wide->x0_m) / wide->spacing_m, y = (p_enu[1] - wide->y0_m) / wide->spacing_m;
    /* a place on the Earth's other side has small x and y, and a z far below */
    if (x >= 0 && y >= 0 && x <= wide->nx - 1 && y <= wide->ny - 1 && fabs(p_enu[2]) < 1e6) return STATUS_OK;
    log_error("terrain.store: %s has the ground about %.4f N, %.4f E; the exercise is at %.4f N, %.4f E, %.0f km away: "
              "name the store of that place, or leave it out for synthetic terrain", path,
              store->frame.origin.lat_rad / rad_per_deg, store->frame.origin.lon_rad / rad_per_deg,
              aim->origin.lat_rad / rad_per_deg, aim->origin.lon_rad / rad_per_deg, 1e-3 * v3_length(p_enu));
    return STATUS_BAD_VALUE;
}

Status ground_store_frame(LocalFrame *out, Choices *choices, const Config *config, const LocalFrame *aim)
{
    TerrainStore store;
    const char  *path = config->terrain.store;
    Status       status = open_fresh(&store, choices, path);
    if (status != STATUS_OK) return status;
    status = on_its_ground(&store, aim, path);
    *out   = store.frame;
    store_close(&store);
    return status;
}

/* ---- what it has ----------------------------------------------------------------------------------- */

static void report(Choices *choices, const TerrainStore *store, const char *path)
{
    const ElevationLevel *fine = &store->elevation.level[0];
    const char           *name = strrchr(path, '/');
    choice_add(choices,
               "ground: terrain store %s, %.3g m posts shown at %.3g m over %.1f x %.1f km, %.0f MB (terrain.store)",
               name ? name + 1 : path, store->posting_m, fine->spacing_m, 1e-3 * (fine->nx - 1) * fine->spacing_m,
               1e-3 * (fine->ny - 1) * fine->spacing_m, 1e-6 * (double)store->octets);
    if (*store->vertical_datum) choice_add(choices, "ground: heights from %s", store->vertical_datum);
    if (store->crown_count || store->building_count)
        choice_add(choices, "ground: %llu trees were taken off it, %llu buildings stand on it",
                   (unsigned long long)store->crown_count, (unsigned long long)store->building_count);
    if (store->surface[0].nx) choice_add(choices, "cover: %.3g m classes of the store", store->surface[0].cell_m);
    else choice_add(choices, "cover: by slope and height, the store has no classes");
    if (store->photo.mips)
        choice_add(choices, "photograph: %.2g m pixels of the store, scaled to each class's reflectance",
                   store->photo.cell_m);
}

Status ground_store_open(Landscape *out, Choices *choices, const Config *config)
{
    TerrainStore store;
    const char  *path = config->terrain.store;
    Status       status = store_open(&store, path);
    if (status != STATUS_OK) return status;
    report(choices, &store, path);
    store_close(&store);
    return landscape_open_store(out, path, (uint64_t)config->seed);
}
