/* sensor/score/track_fields.h: the fields of a TracksScore in score.json. */
#ifndef SENSOR_SCORE_TRACK_FIELDS_H
#define SENSOR_SCORE_TRACK_FIELDS_H

#include "sensor/frame/field.h"

extern const FieldTable score_track_fields;

#endif
