/* sensor/world/frame_radar.h: the radar of the settings. */
#ifndef SENSOR_WORLD_FRAME_RADAR_H
#define SENSOR_WORLD_FRAME_RADAR_H

#include "sensor/radar/seeker_radar.h"
#include "sensor/settings/config.h"

/* Of radar.preset, which is not none. live: signatures that are missing are made in the background. */
Status frame_radar_open(SeekerRadar **out, const Config *config, const char *isa, bool live);

#endif
