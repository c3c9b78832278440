/* terrain/import/source_places.c: where the sources of a terrain store lie. */
#include "terrain/import/source_places.h"

#include "terrain/elevation/raster_choice.h"

#include <stdlib.h>

bool source_folder(char out[PATH_MAX], const char *store)
{
    if (!realpath(store, out)) return false;
    char *slash = strrchr(out, '/');
    slash[slash == out] = 0;
    return true;
}

static bool begins_with_folder(const char *path, const char *folder)
{
    const size_t length = strlen(folder);
    return strncmp(path, folder, length) == 0 && (path[length] == '/' || strcmp(folder, "/") == 0);
}

/* One name of a list, whatever is said after it. */
static bool lies_within(char *name, const char *folder)
{
    char         whole[PATH_MAX], bare[terrain_path_size];
    RasterChoice choice;
    const char  *why;
    snprintf(bare, sizeof bare, "%s", name);
    (void)raster_choice_take(&choice, &why, bare);
    if (realpath(bare, whole)) return begins_with_folder(whole, folder);
    return begins_with_folder(name, folder) && !strstr(name, "/..") && strncmp(name, "/vsi", 4) != 0;
}

bool sources_within(char *outside, size_t outside_size, const TerrainOptions *o, const char *folder)
{
    const char *const lists[] = {o->elevation, o->surface, o->cover, o->photo, o->canopy_height, o->canopy_cover, o->geoid,
                                 strpbrk(o->cover_table, "./") ? o->cover_table : ""};
    *outside = 0;
    for (size_t k = 0; k < sizeof lists / sizeof *lists; k++)
        for (const char *at = lists[k]; *at;) {
            char         name[terrain_path_size];
            const size_t length = strcspn(at, ","), skip = strspn(at, " ");
            const int    n = skip < length ? (int)(length - skip) : 0;
            const bool   fits = snprintf(name, sizeof name, "%.*s", n, at + skip) < (int)sizeof name;
            at += length + (at[length] == ',');
            if (n == 0 || (fits && lies_within(name, folder))) continue;
            snprintf(outside, outside_size, "%s", name);
            return false;
        }
    return true;
}
