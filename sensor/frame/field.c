/* sensor/frame/field.c: writes structs as JSON by the rows of a table, and finds a row by its path. */
#include "sensor/frame/field.h"

#include "sensor/frame/json_object.h"

/* ---- values -------------------------------------------------------------------------------------- */

double field_deg(double rad) { return rad / rad_per_deg; }
double field_db(double ratio) { return 10 * log10(ratio); }
double field_milli(double value) { return 1e3 * value; }
double field_micro(double value) { return 1e6 * value; }
double field_ms(double ms) { return round(1e3 * ms) * 1e-3; }

json_t *field_number(double value) { return isfinite(value) ? json_real(value) : NULL; }

json_t *field_id(DisEntityId id)
{
    char text[dis_id_text_size];
    dis_entity_id_text(text, id);
    return json_string(text);
}

static double turned(const Field *f, double value) { return f->as ? f->as(value) : value; }

static json_t *doubles(const Field *f, const double *value)
{
    json_t *array = json_array();
    for (size_t i = 0; i < f->size / sizeof *value; i++) json_array_append_new(array, json_real(turned(f, value[i])));
    return array;
}

static json_t *counts(const Field *f, const uint64_t *value)
{
    json_t *array = json_array();
    for (size_t i = 0; i < f->size / sizeof *value; i++)
        json_array_append_new(array, json_integer((json_int_t)value[i]));
    return array;
}

static json_t *ints(const Field *f, const int *value)
{
    json_t *array = json_array();
    for (size_t i = 0; i < f->size / sizeof *value; i++) json_array_append_new(array, json_integer(value[i]));
    return array;
}

static json_t *whole(const Field *f, json_int_t value)
{
    return f->unless_0 && value == 0 ? NULL : json_integer(value);
}

static json_t *octets(const Field *f, const char *bytes)
{
    char text[256];
    text_escape(text, sizeof text, bytes, strnlen(bytes, f->size - 1));
    return json_string(text);
}

static json_t *member(const Field *f, const void *of)
{
    const void *at = (const char *)of + f->offset;
    switch (f->kind) {
    case FIELD_OF_NONE:
        return NULL;
    case FIELD_OF_DOUBLE:
        return field_number(turned(f, *(const double *)at));
    case FIELD_OF_DOUBLES:
        return doubles(f, at);
    case FIELD_OF_INT:
        return whole(f, *(const int *)at);
    case FIELD_OF_INTS:
        return ints(f, at);
    case FIELD_OF_LONG:
        return whole(f, *(const long *)at);
    case FIELD_OF_LONG_LONG:
        return whole(f, *(const long long *)at);
    case FIELD_OF_COUNT:
        return whole(f, (json_int_t) * (const uint64_t *)at);
    case FIELD_OF_COUNTS:
        return counts(f, at);
    case FIELD_OF_BOOL:
        return json_boolean(*(const bool *)at);
    case FIELD_OF_TEXT:
        return *(const char *const *)at ? json_string(*(const char *const *)at) : NULL;
    case FIELD_OF_OCTETS:
        return octets(f, at);
    case FIELD_OF_ID:
        return field_id(*(const DisEntityId *)at);
    }
    return NULL;
}

/* ---- objects ------------------------------------------------------------------------------------- */

static json_t *object_of(const FieldTable *table, const void *of, const void *record);

static json_t *value_of(const Field *f, const void *of, const void *record)
{
    json_t *value = f->rows ? object_of(f->rows, of, record) : member(f, of);
    if (!value || !f->unless_empty || json_object_size(value) > 0) return value;
    json_decref(value);
    return NULL;
}

static json_t *list_of(const Field *f, const void *of, const void *record)
{
    FieldItem   item = {.key = ""};
    json_t     *array = json_array();
    const void *one;
    for (int i = 0; (one = f->item(&item, of, i, record)); i++) json_array_append_new(array, value_of(f, one, record));
    return array;
}

static void set(json_t *object, const char *key, json_t *value)
{
    if (value) json_object_set_new(object, key, value);
}

static void put(json_t *object, const Field *f, const void *of, const void *record)
{
    FieldItem   item = {.key = ""};
    const void *one;
    if (f->elsewhere || (f->at && !(of = f->at(of)))) return;
    if (f->get) {
        set(object, f->name, f->get(of, record));
    } else if (f->item && field_is_list(f)) {
        set(object, f->name, list_of(f, of, record));
    } else if (f->item && field_is_word(f)) {
        for (int i = 0; (one = f->item(&item, of, i, record)); i++)
            if (*item.key) set(object, item.key, value_of(f, one, record));
    } else {
        one = f->item ? f->item(&item, of, 0, record) : of;
        if (one) set(object, f->name, value_of(f, one, record));
    }
}

static json_t *object_of(const FieldTable *table, const void *of, const void *record)
{
    json_t *object = json_object();
    for (int i = 0; i < table->count; i++) put(object, &table->row[i], of, record);
    return object;
}

json_t *field_object(const FieldTable *table, const void *record) { return object_of(table, record, record); }

/* ---- paths --------------------------------------------------------------------------------------- */

static const Field *row_of(const FieldTable *table, const char *key, size_t length)
{
    for (int i = 0; i < table->count; i++)
        if (strlen(table->row[i].name) == length && memcmp(table->row[i].name, key, length) == 0) return &table->row[i];
    for (int i = 0; i < table->count; i++)
        if (field_is_word(&table->row[i])) return &table->row[i];
    return NULL;
}

const Field *field_find(FieldChannel *channel, const FieldTable *table, const char *path)
{
    for (;;) {
        const size_t length = strcspn(path, ".[");
        const Field *row = table ? row_of(table, path, length) : NULL;
        if (!row) return NULL;
        if (row->channel != FIELD_AS_ABOVE) *channel = row->channel;
        path += length;
        if (*path == '[') path += strcspn(path, "]"); /* an item's id may hold dots */
        if (*path == ']') path++;
        if (*path != '.') return row;
        path++;
        table = row->rows;
    }
}
