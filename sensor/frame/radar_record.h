/* sensor/frame/radar_record.h: the hash of what a radar measured. Its fields: sensor/frame/record_fields.h. */
#ifndef SENSOR_FRAME_RADAR_RECORD_H
#define SENSOR_FRAME_RADAR_RECORD_H

#include "sensor/radar/radar_frame.h"
#include "sensor/frame/frame.h"

/* What a radar measured, as arrays: the map of all channels, of a beam that scans also both pictures of its sector.
 * Returns how many. They are borrowed from it. */
enum { radar_arrays_most = 3 };
int radar_arrays(FrameArray array[radar_arrays_most], const RadarFrame *radar);
/* Of these arrays from `first` on, `most` of them or as many as there are, before anything is rounded for a file. */
Status radar_sha256(char out[sha256_text_size], const RadarFrame *radar, int first, int most);

#endif
