/* sensor/publish/json_read.h: JSON of a file. */
#ifndef SENSOR_PUBLISH_JSON_READ_H
#define SENSOR_PUBLISH_JSON_READ_H

#include "pitviper_file.h"

#include <jansson.h>
#include <stdio.h>

/* NULL: not there, no regular file, or not JSON. */
static inline json_t *json_read_file(const char *path)
{
    char    why[file_why_size];
    FILE   *file = file_open_stream(why, path);
    json_t *json = file ? json_loadf(file, 0, NULL) : NULL;
    if (file) fclose(file);
    return json;
}

#endif
