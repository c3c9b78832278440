/* sensor/world/frame_world.c: opens a world with the atmosphere, the radar and the plants of the settings. */
#include "sensor/world/frame_world.h"

Status frame_world(World *out, const Config *config, const Catalog *catalog, const Landscape *landscape,
                   const LocalFrame *frame, const char *isa)
{
    Status status = world_open(out, catalog, landscape, frame, isa);
    if (status == STATUS_OK)
        status = atmosphere_open_at(&out->atmosphere, config->weather.atmosphere, config->weather.visibility_m);
    if (status != STATUS_OK) return status;
    out->radar.lobe_rad = config->radar.lobe_deg * rad_per_deg;
    if (strcmp(config->terrain.detail, "off") == 0) {
        detail_table_close(out->detail);
        out->detail = NULL;
    }
    return status;
}

Status frame_world_plant(World *world, const Woods *woods, const Config *config, const char *isa, Pool *pool)
{
    const ForestConfig forest = {.leaves = strcmp(config->terrain.woods_leaves, "on") == 0,
                                 .level1_px = config->terrain.woods_level1_px, .sway = config->terrain.woods_sway};
    if (!woods) return STATUS_OK;
    const double begun_s = wall_clock_s();
    const Status status  = world_plant(world, woods, &forest, isa, pool);
    log_detail("woods: grown in %.0f ms", 1e3 * (wall_clock_s() - begun_s));
    return status;
}
