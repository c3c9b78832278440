/* sensor/publish/json_write.h: what writers of JSON share. */
#ifndef SENSOR_PUBLISH_JSON_WRITE_H
#define SENSOR_PUBLISH_JSON_WRITE_H

#include <jansson.h>
#include <math.h>

/* JSON has neither NaN nor infinity: values not computed are absent. */
static inline void set_number(json_t *object, const char *key, double value)
{
    if (isfinite(value)) json_object_set_new(object, key, json_real(value));
}

#endif
