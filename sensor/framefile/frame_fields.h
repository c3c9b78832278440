/* sensor/framefile/frame_fields.h: the chunks of a frame file, field by field; each function writes or reads one. */
#ifndef SENSOR_FRAMEFILE_FRAME_FIELDS_H
#define SENSOR_FRAMEFILE_FRAME_FIELDS_H

#include "sensor/framefile/fields.h"
#include "sensor/framefile/frame_content.h"
#include "sensor/framefile/ground_cutout.h"

void frame_fields_about(Fields *f, FrameFile *file);
void frame_fields_settings(Fields *f, FrameFile *file);
void frame_fields_tables(Fields *f, FrameFile *file);
void frame_fields_models(Fields *f, FrameFile *file);
void frame_fields_snapshot(Fields *f, FrameFile *file);
void frame_fields_request(Fields *f, FrameFile *file);
void frame_fields_ground(Fields *f, FrameFile *file, const GroundCutout *kept);
void frame_fields_marks(Fields *f, FrameFile *file);
void frame_fields_woods(Fields *f, FrameFile *file);
void frame_fields_radar(Fields *f, FrameFile *file);
void frame_fields_planes(Fields *f, FrameFile *file);

#endif
