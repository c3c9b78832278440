/* sensor/frame/source_sensor.h: how MISB metadata names the sensor of a band (ST 0601 tag 11, ST 0903 tag 10), for
 * those who write it and those who read it back. */
#ifndef SENSOR_FRAME_SOURCE_SENSOR_H
#define SENSOR_FRAME_SOURCE_SENSOR_H

#include "render/scene/view.h"

static const char *const source_sensor_name[BAND_COUNT] = {"EO", "IR MWIR", "IR LWIR", "RADAR"};

#endif
