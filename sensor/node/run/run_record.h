/* sensor/node/run/run_record.h: run.json: what a host's run was made with and what it counted. */
#ifndef SENSOR_NODE_RUN_RUN_RECORD_H
#define SENSOR_NODE_RUN_RUN_RECORD_H

#include "sensor/frame/field.h"

/* For its reference and for regress; written by run_write (sensor/node/run/host_run_private.h). */
extern const FieldTable run_record_fields;

#endif
