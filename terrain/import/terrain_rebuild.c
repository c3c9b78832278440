/* terrain/import/terrain_rebuild.c: a terrain store made again with the options that it has, where its sources lie in
 * its own folder. */
#include "pitviper_file.h"
#include "terrain/elevation/raster.h"
#include "terrain/import/terrain_import.h"

#include <errno.h>
#include <limits.h>
#include <stdlib.h>

/* ---- where the sources lie --------------------------------------------------------------------- */

/* The folder that a store lies in, after links are followed. Returns false when it does not exist. */
static bool source_folder(char out[PATH_MAX], const char *store)
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

/* Whether one name of a list lies within a folder, whatever follows the name. */
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

/* Whether all sources, and what is written beside the store, lie within a folder. Links are followed; a file that does
 * not exist is judged by its name; a name that is not a file's (on a server, in an archive) lies outside. outside: the
 * first source that does, "" when none does. */
static bool sources_within(char *outside, size_t outside_size, const TerrainOptions *o, const char *folder)
{
    const char *const lists[] = {
        o->elevation,     o->surface,      o->cover, o->photo,
        o->canopy_height, o->canopy_cover, o->geoid, strpbrk(o->cover_table, "./") ? o->cover_table : "",
        o->buildings};
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

/* Whether a file of buildings that a store names may be written without a word of the user's: there is none, or it is
 * one of an import (culture_write_geojson). */
static bool is_replaceable(const char *path)
{
    static const char begins[] = "{\"type\": \"FeatureCollection\", \"features\": [\n";
    static const char feature[] = "{\"type\": \"Feature\", \"id\": \"";
    enum { length = sizeof begins - 1, whole = sizeof begins - 1 + sizeof feature - 1 };
    char  text[whole];
    FILE *file = *path ? fopen(path, "rb") : NULL;
    if (!file) return !*path || errno == ENOENT;
    const size_t got = fread(text, 1, whole, file);
    fclose(file);
    return got >= length && memcmp(text, begins, length) == 0 &&
           (got < whole || memcmp(text + length, feature, whole - length) == 0);
}

/* ---- made again ------------------------------------------------------------------------------- */

static bool tell(void *user, const char *stage, double share)
{
    char text[160];
    if (file_stop_asked()) return false;
    if (share < 0) {
        log_detail("terrain: the store is made again: %s", stage);
        return true;
    }
    if (wall_clock_s() - *(double *)user < 1) return true;
    snprintf(text, sizeof text, "terrain: the store is made again: %s, %.0f %%", stage, 100 * share);
    log_status(text);
    return true;
}

bool terrain_store_foreign(char *outside, size_t outside_size, const char *path, const char *options)
{
    TerrainOptions *o = malloc(sizeof *o);
    char            folder[PATH_MAX];
    const char     *why;
    int             line;
    *outside = 0;
    const bool foreign = o && source_folder(folder, path) && terrain_options_parse(o, &why, &line, options) &&
                         !sources_within(outside, outside_size, o, folder);
    free(o);
    return foreign;
}

Status terrain_store_rebuild(const char *path, const char *options, bool anywhere)
{
    TerrainOptions *o = malloc(sizeof *o);
    TerrainReport   r;
    Pool           *pool = NULL;
    char            folder[PATH_MAX], outside[terrain_path_size];
    const char     *why = "its header cannot be read";
    int             line = 0;
    double          begun_s = wall_clock_s();
    if (!o) return STATUS_NO_MEMORY;
    Status status = options && terrain_options_parse(o, &why, &line, options) ? STATUS_OK : STATUS_BAD_VALUE;
    if (status != STATUS_OK)
        log_error("terrain.store: %s cannot be made again: line %d of its options: %s; run `pitviper terrain import`",
                  path, line, why);
    if (status == STATUS_OK && !anywhere) {
        status = source_folder(folder, path) ? STATUS_OK : STATUS_IO;
        if (status == STATUS_OK && !sources_within(outside, sizeof outside, o, folder)) status = STATUS_BAD_VALUE;
        if (status == STATUS_BAD_VALUE)
            log_error("terrain.store: %s is not made again: it names %s, outside its own folder; where you trust that, "
                      "`pitviper terrain again %s` makes it",
                      path, outside, path);
    }
    if (status == STATUS_OK && !anywhere && !is_replaceable(o->buildings)) {
        log_error(
            "terrain.store: %s is not made again: it would replace %s, which is no file of an import; where that is "
            "right, `pitviper terrain again %s` does it",
            path, o->buildings, path);
        status = STATUS_BAD_VALUE;
    }
    if (status == STATUS_OK) status = pool_create(&pool, thread_processors());
    if (status == STATUS_OK) {
        raster_stay_within(anywhere ? NULL : folder); /* this also concerns files that those files name */
        status = terrain_import(&r, o, path, pool, &(TerrainWatch){.progress = tell, .user = &begun_s});
        raster_stay_within(NULL);
    }
    log_status(NULL);
    pool_destroy(pool);
    free(o);
    return status;
}
