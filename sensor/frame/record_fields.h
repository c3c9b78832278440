/* sensor/frame/record_fields.h: the tables of truth.jsonl, for its reference and for regress. */
#ifndef SENSOR_FRAME_RECORD_FIELDS_H
#define SENSOR_FRAME_RECORD_FIELDS_H

#include "sensor/frame/field.h"

extern const FieldTable record_frame_fields; /* a line: of FrameRecord */
extern const FieldTable target_fields;       /* of it targets[]: of TargetRecord */
extern const FieldTable clutter_fields;      /* of it clutter[]: of ClutterRecord */
extern const FieldTable radar_fields;        /* of it radar: of RadarFrame */

#endif
