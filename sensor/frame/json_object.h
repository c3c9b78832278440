/* sensor/frame/json_object.h: what writers and readers of JSON share. */
#ifndef SENSOR_FRAME_JSON_OBJECT_H
#define SENSOR_FRAME_JSON_OBJECT_H

#include "pitviper.h"
#include "pitviper_file.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>

/* JSON has neither NaN nor infinity: values not computed are absent. */
static inline void json_set_number(json_t *object, const char *key, double value)
{
    if (isfinite(value)) json_object_set_new(object, key, json_real(value));
}

/* Octets of others: those that are no printable text are escaped. */
static inline void json_set_text(json_t *object, const char *key, const char *bytes, size_t count)
{
    char text[256];
    text_escape(text, sizeof text, bytes, count);
    json_object_set_new(object, key, json_string(text));
}

static inline json_t *json_number_list(const double *value, int count)
{
    json_t *array = json_array();
    for (int i = 0; i < count; i++) json_array_append_new(array, json_real(value[i]));
    return array;
}

/* Reads the JSON of a file. NULL: it is absent, no regular file, or not JSON. */
static inline json_t *json_read_file(const char *path)
{
    char    why[file_why_size];
    FILE   *file = file_open_stream(why, path);
    json_t *json = file ? json_loadf(file, 0, NULL) : NULL;
    if (file) fclose(file);
    return json;
}

#endif
