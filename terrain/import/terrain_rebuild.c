/* terrain/import/terrain_rebuild.c: a terrain store made again with the options that it has. */
#include "terrain/import/terrain_import.h"

#include "pitviper_file.h"
#include "terrain/elevation/raster.h"
#include "terrain/import/source_places.h"

#include <stdlib.h>

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
                      "`pitviper terrain again %s` makes it", path, outside, path);
    }
    if (status == STATUS_OK) status = pool_create(&pool, thread_processors());
    if (status == STATUS_OK) {
        raster_stay_within(anywhere ? NULL : folder); /* also what those files name */
        status = terrain_import(&r, o, path, pool, &(TerrainWatch){.progress = tell, .user = &begun_s});
        raster_stay_within(NULL);
    }
    log_status(NULL);
    pool_destroy(pool);
    free(o);
    return status;
}
