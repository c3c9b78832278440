/* sensor/world/frame_radar.c: see frame_radar.h. */
#include "sensor/world/frame_radar.h"

Status frame_radar_open(SeekerRadar **out, const Config *config, const char *isa, bool live)
{
    char catalog[4096];
    if (!etc_path(catalog, sizeof catalog, "catalog.csv")) return STATUS_BAD_VALUE;
    return seeker_radar_create(out, &(SeekerRadarConfig){.preset = config->radar.preset, .table = config->radar.table,
                                                         .catalog = catalog, .isa = isa,
                                                         .ground = config->radar.ground,
                                                         .ground_bounce = config->radar.ground_bounce,
                                                         .warp_m = 1e-3 * config->radar.warp_mm,
                                                         .given = config->radar.given, .wind_mps = config->weather.wind_mps,
                                                         .chaff_dipoles = config->radar.chaff_dipoles,
                                                         .scan_rad = config->radar.scan_deg * rad_per_deg,
                                                         .scan_step = config->radar.scan_step,
                                                         .seed = (uint64_t)config->seed,
                                                         .library = config->radar.library, .background = live});
}
