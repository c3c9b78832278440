/* sensor/frame/radar_record.h: what a radar measured, as the object `radar` of truth.jsonl. */
#ifndef SENSOR_FRAME_RADAR_RECORD_H
#define SENSOR_FRAME_RADAR_RECORD_H

#include "sensor/radar/radar_frame.h"
#include "entities/catalog/catalog.h"
#include "entities/table/snapshot.h"
#include "sensor/frame/plane.h"

/* Of the map of all channels, before it is rounded for a file. */
Status radar_map_sha256(char out[sha256_text_size], const RadarFrame *radar);

/* Makes a JSON object (json_t), which the caller owns. */
struct json_t *radar_record_json(const RadarFrame *radar, const Snapshot *snapshot, const Catalog *catalog);

#endif
