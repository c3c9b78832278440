/* terrain/import/terrain_rebuild.c: a terrain store made again with the options that it has. */
#include "terrain/import/terrain_import.h"

#include <stdlib.h>

static bool tell(void *user, const char *stage, double share)
{
    char text[160];
    if (wall_clock_s() - *(double *)user < 1) return true;
    snprintf(text, sizeof text, "terrain: the store is made again: %s, %.0f %%", stage, 100 * share);
    log_status(text);
    return true;
}

Status terrain_store_rebuild(const char *path, const char *options)
{
    TerrainOptions *o = malloc(sizeof *o);
    TerrainReport   r;
    Pool           *pool = NULL;
    const char     *why = "its header cannot be read";
    int             line = 0;
    double          begun_s = wall_clock_s();
    if (!o) return STATUS_NO_MEMORY;
    Status status = options && terrain_options_parse(o, &why, &line, options) ? STATUS_OK : STATUS_BAD_VALUE;
    if (status != STATUS_OK)
        log_error("terrain.store: %s cannot be made again: line %d of its options: %s; run `pitviper terrain import`",
                  path, line, why);
    if (status == STATUS_OK) status = pool_create(&pool, thread_processors());
    if (status == STATUS_OK) status = terrain_import(&r, o, path, pool, tell, &begun_s);
    log_status(NULL);
    pool_destroy(pool);
    free(o);
    return status;
}
