/* sensor/framefile/frame_ground.c: the ground of a frame file, and its plants. Of a terrain store, which may have
 * gigabytes, the file has the path and the hash of the content. */
#include "sensor/framefile/frame_ground.h"

#include "sensor/world/frame_world.h"
#include "terrain/store/store.h"

static Status open_store(Landscape *out, const LandscapeParts *parts)
{
    const Status status = landscape_open_store(out, parts->store, parts->config.seed);
    if (status != STATUS_OK) {
        log_error("frame: the frame was made over the terrain store %s; put it back there, or make it again with "
                  "`pitviper terrain import` from the same files", parts->store);
        return status;
    }
    if (landscape_map(out).content == parts->store_content) return STATUS_OK;
    log_error("frame: the terrain store %s is not the one that the frame was made over: its content has another hash; "
              "put the old one back, or make it again with `pitviper terrain import` from the same files", parts->store);
    landscape_destroy(out);
    return STATUS_BAD_VALUE;
}

Status frame_ground_open(Landscape *out, const LandscapeParts *parts)
{
    if (parts->store && *parts->store) return open_store(out, parts);
    const char  *why = NULL;
    const Status status = landscape_from_parts(out, &why, parts);
    if (status == STATUS_BAD_VALUE)
        log_error("frame: the ground in the file cannot be used: %s", why ? why : "values out of range");
    return status;
}

Status frame_ground_plant(World *world, Woods *woods, const FrameFile *file, const Config *config, const char *isa,
                          Pool *pool)
{
    WoodsConfig how = file->woods;
    if (!file->planted) return STATUS_OK;
    how.store = file->ground.store && *file->ground.store ? file->ground.store : NULL;
    const Status status = woods_create(woods, world->landscape, &how, pool);
    if (status == STATUS_OK) return frame_world_plant(world, woods, config, isa, pool);
    log_error("frame: its plants cannot be grown again: %s", status_name(status));
    return status;
}
