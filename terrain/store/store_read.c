/* terrain/store/store_read.c: a terrain store opened: its header read and checked, its data mapped and not touched; and
 * the landscape of it. */
#include "pitviper_file.h"
#include "terrain/ground/landscape_parts.h"
#include "terrain/store/store_writer_private.h"

#include <errno.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

/* Reads the whole header with its texts, malloc'd. When the system fails, *why stays NULL and errno has the reason. */
static StoreHeader *read_header(const char **why, Status *status, int file, uint64_t file_octets)
{
    StoreHeader first, *all;
    size_t      octets = 0;
    *status = STATUS_BAD_VALUE;
    if (file_octets < sizeof first) *why = "it is shorter than a header";
    if (*why) return NULL;
    *status = STATUS_IO;
    errno = EIO;
    if (pread(file, &first, sizeof first, 0) != (ssize_t)sizeof first) return NULL;
    *status = store_header_size(&octets, why, &first, file_octets);
    if (*status != STATUS_OK) return NULL;
    all = malloc(octets);
    *status = STATUS_IO;
    errno = ENOMEM;
    if (!all) return NULL;
    errno = EIO;
    if (pread(file, all, octets, 0) == (ssize_t)octets) *status = store_header_check(why, all, octets, file_octets);
    if (*status == STATUS_OK) return all;
    free(all);
    return NULL;
}

Status store_open_why(TerrainStore *out, const char **why, const char *path)
{
    static _Thread_local char refused[file_why_size];
    uint64_t                  octets = 0;
    Status                    status = STATUS_IO;
    *out = (TerrainStore){0};
    *why = NULL;
    const int file = file_open(refused, &octets, path, FILE_FROM_DISK);
    if (file < 0) {
        *why = refused;
        return STATUS_IO;
    }
    StoreHeader *header = read_header(why, &status, file, octets);
    void        *map = header ? mmap(NULL, (size_t)octets, PROT_READ, MAP_SHARED, file, 0) : MAP_FAILED;
    if (map == MAP_FAILED) {
        if (!*why) *why = strerror(errno);
        free(header);
        close(file);
        return status == STATUS_OK ? STATUS_IO : status;
    }
    close(file);
    store_attach(out, header, map);
    out->header = header;
    const Geodetic origin = {header->lat_rad, header->lon_rad, header->h_m};
    status = local_frame_at(&out->frame, &origin);
    if (status == STATUS_OK) return STATUS_OK;
    *why = "its origin is out of range";
    store_close(out);
    return status;
}

Status store_open(TerrainStore *out, const char *path)
{
    const char  *why;
    const Status status = store_open_why(out, &why, path);
    if (status != STATUS_OK)
        log_error("store: %s cannot be used: %s; make it again with `pitviper terrain import`", path, why);
    return status;
}

void store_close(TerrainStore *store)
{
    if (store->map) munmap((void *)(uintptr_t)store->map, store->octets);
    free(store->header);
    *store = (TerrainStore){0};
}

StoreSources store_sources(const TerrainStore *store, char *which, size_t which_size)
{
    StoreSources found = STORE_FRESH;
    char        *texts = strdup(store->sources), *rest = texts, *line;
    which[0] = 0;
    while (texts && (line = strsep(&rest, "\n"))) {
        long long octets, mtime_ns;
        int       at = 0;
        if (sscanf(line, "%lld %lld %n", &octets, &mtime_ns, &at) < 2 || at == 0) continue;
        StoreSource  source = {.path = line + at};
        const bool   here = store_source_look(&source);
        StoreSources is = here ? STORE_CHANGED : STORE_SOURCES_MISSING;
        if (here && source.octets == octets && source.mtime_ns == mtime_ns) is = STORE_FRESH;
        if (is == STORE_FRESH || found == STORE_CHANGED || (found == STORE_SOURCES_MISSING && is == found)) continue;
        found = is;
        snprintf(which, which_size, "%s", source.path);
    }
    free(texts);
    return found;
}

bool store_verify(const TerrainStore *store, Pool *pool)
{
    return store_content(store->header, store->map, pool) == store->content;
}

int store_parts(StorePart out[store_sections_most], const TerrainStore *store)
{
    static const char *const name[STORE_SECTIONS] = {[STORE_TILES] = "tiles, level 0",
                                                     "tiles, level 1",
                                                     "tiles, level 2",
                                                     "tiles, level 3",
                                                     [STORE_POSTS] = "posts, level 0",
                                                     "posts, level 1",
                                                     "posts, level 2",
                                                     "posts, level 3",
                                                     [STORE_PYRAMID] = "pyramid, level 0",
                                                     "pyramid, level 1",
                                                     "pyramid, level 2",
                                                     "pyramid, level 3",
                                                     [STORE_SURFACE] = "classes",
                                                     "classes, wide",
                                                     [STORE_ALBEDO] = "photograph",
                                                     [STORE_CANOPY_HEIGHT] = "canopy height",
                                                     [STORE_CANOPY_COVER] = "canopy cover",
                                                     [STORE_CROWNS] = "crowns"};
    const StoreHeader       *h = store->header;
    int                      count = 0;
    out[count++] = (StorePart){"header", h->header_octets};
    for (int s = 0; s < STORE_SECTIONS; s++)
        if (h->section[s].octets) out[count++] = (StorePart){name[s], h->section[s].octets};
    return count;
}

/* ---- the landscape --------------------------------------------------------------------------------- */

Status store_landscape(Landscape *out, const TerrainStore *store, uint64_t seed, const LandscapeMap *map)
{
    const ElevationLevel *fine = &store->elevation.level[0];
    const ElevationLevel *wide = &store->elevation.level[store->elevation.level_count - 1];
    LandscapeParts        parts = {.frame = store->frame,
                                   .elevation = store->elevation,
                                   .photo = store->photo,
                                   .cover_seed = landscape_cover_seed(seed),
                                   .geoid_m = store->geoid_m};
    parts.config = (LandscapeConfig){.seed = seed,
                                     .spacing_m = fine->spacing_m,
                                     .half_width_m = 0.5 * fine->spacing_m * fmax(fine->nx - 1, fine->ny - 1),
                                     .horizon_m = 0.5 * wide->spacing_m * fmax(wide->nx - 1, wide->ny - 1)};
    memcpy(parts.cover, store->surface, sizeof parts.cover);
    return landscape_borrow(out, &parts, map);
}

Status store_open_landscape(Landscape *out, const char *path, uint64_t seed)
{
    TerrainStore store;
    Status       status = store_open(&store, path);
    if (status != STATUS_OK) return status;
    const LandscapeMap map = {.path = realpath(path, NULL),
                              .map = (void *)(uintptr_t)store.map,
                              .octets = store.octets,
                              .content = store.content};
    status = map.path ? store_landscape(out, &store, seed, &map) : STATUS_NO_MEMORY;
    if (status == STATUS_OK) store.map = NULL; /* the landscape owns the mapping now */
    else free(map.path);
    store_close(&store);
    return status;
}
