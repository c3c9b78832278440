/* sensor/publish/radar_scan_files.h: files of a radar's scan: OUT/radar/NNNNNN_scan, _dbs, _view. */
#ifndef SENSOR_PUBLISH_RADAR_SCAN_FILES_H
#define SENSOR_PUBLISH_RADAR_SCAN_FILES_H

#include "sensor/publish/frame.h"

/* Those of a frame with frame->radar->scan, each beginning with stem (PATH/NNNNNN). png: pictures to look at too. */
Status radar_scan_files(const char *stem, const Frame *frame, bool png);

#endif
