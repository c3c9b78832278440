/* sensor/world/frame_world.c: opens a world with the atmosphere and the radar of the settings. */
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
