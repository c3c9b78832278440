/* sensor/frame/json_values.h: reads this program's JSON back, as a flat list of paths and values.
 *
 *     {"frame":3,"targets":[{"entity":"1:3001:12","box_px":[4,5]}]}
 *
 * gives `frame`, `targets[1:3001:12].entity`, `targets[1:3001:12].box_px[0]`, `...[1]`: an element of a list is
 * named by its `entity` where it has one, else by its index. Sorted by path. */
#ifndef SENSOR_FRAME_JSON_VALUES_H
#define SENSOR_FRAME_JSON_VALUES_H

#include "pitviper.h"

typedef struct JsonValue {
    char  *path;
    char  *text;   /* NULL: a number; true and false are 1 and 0, null is NaN */
    double number; /* of a text: NaN */
} JsonValue;

typedef struct JsonValues {
    int        count, capacity;
    JsonValue *value; /* [count] */
} JsonValues;

enum { json_values_most = 4000000 };

/* Any bytes. STATUS_BAD_VALUE, logged as the module's with source and position: not one JSON object, keys given twice,
 * deeper than 16, longer paths than 500, more values than json_values_most. On failure *out is empty. */
Status json_values_read(JsonValues *out, const char *text, size_t octets, const char *module, const char *source);
void   json_values_free(JsonValues *values);
const JsonValue *json_values_find(const JsonValues *values, const char *path); /* NULL: absent */
/* The object of `text` without these top-level keys, formatted as run.json. *out: the caller's, freed with free.
 * STATUS_BAD_VALUE, logged: not a JSON object. */
Status json_text_without(char **out, const char *text, size_t octets, const char *const *key, int keys,
                         const char *module, const char *source);

#endif
