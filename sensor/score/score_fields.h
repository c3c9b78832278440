/* sensor/score/score_fields.h: the fields of score.json: of ScoreReport. */
#ifndef SENSOR_SCORE_SCORE_FIELDS_H
#define SENSOR_SCORE_SCORE_FIELDS_H

#include "sensor/frame/field.h"

extern const FieldTable score_fields;

#endif
