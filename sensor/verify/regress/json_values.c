/* sensor/verify/regress/json_values.c: JSON read into a flat list of paths and values. */
#include "sensor/verify/regress/verdict.h"

#include "sensor/frame/json_object.h"
#include <stdlib.h>

enum { path_size = 500, deepest = 16 };

static Status add(JsonValues *out, const char *path, const char *text, double number)
{
    if (out->count == json_values_most) return STATUS_BAD_VALUE;
    if (out->count == out->capacity) {
        const int  larger = out->capacity ? 2 * out->capacity : 256;
        JsonValue *grown = realloc(out->value, (size_t)larger * sizeof *grown);
        if (!grown) return STATUS_NO_MEMORY;
        out->value = grown;
        out->capacity = larger;
    }
    JsonValue value = {strdup(path), text ? strdup(text) : NULL, number};
    if (!value.path || (text && !value.text)) {
        free(value.path);
        free(value.text);
        return STATUS_NO_MEMORY;
    }
    out->value[out->count++] = value;
    return STATUS_OK;
}

/* path holds `length` characters, and is restored before return. */
static Status flatten(JsonValues *out, char path[path_size], size_t length, const json_t *json, int depth)
{
    Status      status = STATUS_OK;
    const char *key;
    json_t     *item;
    size_t      i;
    if (depth > deepest) return STATUS_BAD_VALUE;
    switch (json_typeof(json)) {
    case JSON_OBJECT:
        json_object_foreach((json_t *)json, key, item)
        {
            const int n = snprintf(path + length, path_size - length, "%s%s", length ? "." : "", key);
            if (n < 0 || (size_t)n >= path_size - length) return STATUS_BAD_VALUE;
            status = flatten(out, path, length + (size_t)n, item, depth + 1);
            if (status != STATUS_OK) return status;
        }
        break;
    case JSON_ARRAY:
        json_array_foreach(json, i, item)
        {
            const char *id = json_string_value(json_object_get(item, "entity"));
            const int   n = id ? snprintf(path + length, path_size - length, "[%s]", id)
                               : snprintf(path + length, path_size - length, "[%zu]", i);
            if (n < 0 || (size_t)n >= path_size - length) return STATUS_BAD_VALUE;
            status = flatten(out, path, length + (size_t)n, item, depth + 1);
            if (status != STATUS_OK) return status;
        }
        break;
    case JSON_STRING:
        status = add(out, path, json_string_value(json), NAN);
        break;
    case JSON_INTEGER:
    case JSON_REAL:
        status = add(out, path, NULL, json_number_value(json));
        break;
    case JSON_TRUE:
        status = add(out, path, NULL, 1);
        break;
    case JSON_FALSE:
        status = add(out, path, NULL, 0);
        break;
    case JSON_NULL:
        status = add(out, path, NULL, NAN);
        break;
    }
    path[length] = 0;
    return status;
}

static int compare_paths(const void *a, const void *b)
{
    return strcmp(((const JsonValue *)a)->path, ((const JsonValue *)b)->path);
}

/* Reads a JSON object. NULL, logged: it is not one. */
static json_t *object_of(const char *text, size_t octets, const char *module, const char *source)
{
    json_error_t error;
    json_t      *json = json_loadb(text, octets, JSON_REJECT_DUPLICATES, &error);
    if (json && json_is_object(json)) return json;
    log_error("%s: %s: not JSON as pitviper writes it: %s (line %d, column %d)", module, source,
              json ? "no object" : error.text, json ? 1 : error.line, json ? 1 : error.column);
    json_decref(json);
    return NULL;
}

Status json_values_read(JsonValues *out, const char *text, size_t octets, const char *module, const char *source)
{
    char path[path_size] = "";
    *out = (JsonValues){0};
    json_t *json = object_of(text, octets, module, source);
    if (!json) return STATUS_BAD_VALUE;
    const Status status = flatten(out, path, 0, json, 0);
    json_decref(json);
    if (status == STATUS_OK) {
        if (out->count > 1) qsort(out->value, (size_t)out->count, sizeof *out->value, compare_paths);
        return STATUS_OK;
    }
    if (status == STATUS_BAD_VALUE)
        log_error("%s: %s: not JSON as pitviper writes it: too deep, too long or too much of it", module, source);
    json_values_free(out);
    return status;
}

void json_values_free(JsonValues *values)
{
    for (int i = 0; i < values->count; i++) {
        free(values->value[i].path);
        free(values->value[i].text);
    }
    free(values->value);
    *values = (JsonValues){0};
}

const JsonValue *json_values_find(const JsonValues *values, const char *path)
{
    const JsonValue wanted = {.path = (char *)path};
    if (values->count == 0) return NULL;
    return bsearch(&wanted, values->value, (size_t)values->count, sizeof *values->value, compare_paths);
}

Status json_text_without(char **out, const char *text, size_t octets, const char *const *key, int keys,
                         const char *module, const char *source)
{
    json_t *json = object_of(text, octets, module, source);
    if (!json) return STATUS_BAD_VALUE;
    for (int i = 0; i < keys; i++) json_object_del(json, key[i]);
    char *written = json_dumps(json, JSON_INDENT(1));
    json_decref(json);
    if (!written) return STATUS_NO_MEMORY;
    *out = written;
    return STATUS_OK;
}
