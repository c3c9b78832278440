/* sensor/publish/files/model_record.h: `pitviper model info --json`. */
#ifndef SENSOR_PUBLISH_FILES_MODEL_RECORD_H
#define SENSOR_PUBLISH_FILES_MODEL_RECORD_H

#include "entities/catalog/model_info.h"

/* One JSON object and a line end. False: no memory, or it cannot be written. */
bool model_record_print(FILE *to, const ModelInfo *info);

#endif
