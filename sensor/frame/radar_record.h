/* sensor/frame/radar_record.h: the hash of what a radar measured. Its fields: sensor/frame/record_fields.h. */
#ifndef SENSOR_FRAME_RADAR_RECORD_H
#define SENSOR_FRAME_RADAR_RECORD_H

#include "sensor/radar/radar_frame.h"
#include "sensor/frame/plane.h"

/* Of the map of all channels, before it is rounded for a file. */
Status radar_map_sha256(char out[sha256_text_size], const RadarFrame *radar);

#endif
