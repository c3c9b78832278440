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

json_t *field_octets(const char *octets, size_t count)
{
    char text[256];
    text_escape(text, sizeof text, octets, count);
    return json_string(text);
}

const void *field_keyed(FieldAt *at, const char *key, const void *item)
{
    snprintf(at->key, sizeof at->key, "%s", key);
    return item;
}

static double turned(const Field *f, double value) { return f->as ? f->as(value) : value; }

static json_t *whole(const Field *f, json_int_t value)
{
    return f->unless_0 && value == 0 ? NULL : json_integer(value);
}

/* All plurals: of 8 octets, or int. */
static json_t *list_of_member(const Field *f, const void *at)
{
    json_t   *array = json_array();
    const int count = (int)(f->size / (f->kind == FIELD_OF_INTS ? sizeof(int) : sizeof(double)));
    for (int i = 0; i < count; i++)
        json_array_append_new(array, f->kind == FIELD_OF_DOUBLES ? json_real(turned(f, ((const double *)at)[i]))
                                     : f->kind == FIELD_OF_INTS  ? json_integer(((const int *)at)[i])
                                                                 : json_integer((json_int_t)((const uint64_t *)at)[i]));
    return array;
}

static json_t *member(const Field *f, const void *of)
{
    const void *at = (const char *)of + f->offset;
    switch (f->kind) {
    case FIELD_OF_NONE:
        return NULL;
    case FIELD_OF_DOUBLE:
        return field_number(turned(f, *(const double *)at));
    case FIELD_OF_INT:
        return whole(f, *(const int *)at);
    case FIELD_OF_LONG:
        return whole(f, *(const long *)at);
    case FIELD_OF_LONG_LONG:
        return whole(f, *(const long long *)at);
    case FIELD_OF_COUNT:
        return whole(f, (json_int_t) * (const uint64_t *)at);
    case FIELD_OF_DOUBLES:
    case FIELD_OF_INTS:
    case FIELD_OF_COUNTS:
        return list_of_member(f, at);
    case FIELD_OF_BOOL:
        return json_boolean(*(const bool *)at);
    case FIELD_OF_TEXT:
        return *(const char *const *)at ? json_string(*(const char *const *)at) : NULL;
    case FIELD_OF_OCTETS:
        return field_octets(at, strnlen(at, f->size - 1));
    case FIELD_OF_ID:
        return field_id(*(const DisEntityId *)at);
    }
    return NULL;
}

/* ---- types --------------------------------------------------------------------------------------- */

bool field_is_list(const Field *f) { return f->type && strncmp(f->type, "list", 4) == 0; }

const char *field_type(char out[field_type_size], const Field *f)
{
    const int doubles = (int)(f->size / sizeof(double)), ints = (int)(f->size / sizeof(int));
    switch (f->type ? FIELD_OF_NONE : f->kind) {
    case FIELD_OF_NONE:
        return f->type ? f->type : "";
    case FIELD_OF_DOUBLE:
        return "number";
    case FIELD_OF_INT:
    case FIELD_OF_LONG:
    case FIELD_OF_LONG_LONG:
    case FIELD_OF_COUNT:
        return "integer";
    case FIELD_OF_BOOL:
        return "boolean";
    case FIELD_OF_TEXT:
    case FIELD_OF_OCTETS:
    case FIELD_OF_ID:
        return "string";
    case FIELD_OF_DOUBLES:
        snprintf(out, field_type_size, "list of %d numbers", doubles);
        break;
    case FIELD_OF_INTS:
        snprintf(out, field_type_size, "list of %d integers", ints);
        break;
    case FIELD_OF_COUNTS:
        snprintf(out, field_type_size, "list of %d integers", doubles);
        break;
    }
    return out;
}

static bool is_word(const Field *f) { return *f->name >= 'A' && *f->name <= 'Z'; }

/* ---- objects ------------------------------------------------------------------------------------- */

static json_t *object_of(const FieldTable *table, const void *of, const void *record);

static json_t *value_of(const Field *f, const void *of, const void *record)
{
    json_t *value = f->rows ? object_of(f->rows, of, record) : member(f, of);
    if (!value || !f->unless_empty || json_object_size(value) > 0 || json_string_length(value) > 0) return value;
    json_decref(value);
    return NULL;
}

static void set(json_t *object, const char *key, json_t *value)
{
    if (value) json_object_set_new(object, key, value);
}

static void put(json_t *object, const Field *f, const void *of, const void *record)
{
    FieldAt     at = {.of = f->in ? f->in(of) : of, .record = record};
    const void *one;
    if (!at.of) return;
    if (f->get) {
        set(object, f->name, f->get(&at));
    } else if (f->item && field_is_list(f)) {
        json_t *list = json_array();
        for (int i = 0; (one = f->item(&at, i)); i++) json_array_append_new(list, value_of(f, one, record));
        set(object, f->name, list);
    } else if (f->item && is_word(f)) {
        for (int i = 0; (one = f->item(&at, i)); i++)
            if (*at.key) set(object, at.key, value_of(f, one, record));
    } else {
        one = f->item ? f->item(&at, 0) : at.of;
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

char *field_line(const FieldTable *table, const void *record, int digits)
{
    json_t *object = field_object(table, record);
    char   *text = json_dumps(object, JSON_COMPACT | JSON_REAL_PRECISION((size_t)digits));
    json_decref(object);
    return text;
}

void field_carry(json_t *object, const FieldTable *table, const char *name, const void *record)
{
    for (int i = 0; i < table->count; i++)
        if (strcmp(table->row[i].name, name) == 0) put(object, &table->row[i], record, record);
}

/* ---- paths --------------------------------------------------------------------------------------- */

static const Field *row_of(const FieldTable *table, const char *key, size_t length)
{
    const Field *word = NULL;
    for (int i = 0; table && i < table->count; i++) {
        const Field *f = &table->row[i];
        if (strlen(f->name) == length && memcmp(f->name, key, length) == 0) return f;
        if (is_word(f)) word = f;
    }
    return word;
}

const Field *field_find(FieldChannel *channel, const FieldTable *table, const char *path)
{
    for (;;) {
        const size_t length = strcspn(path, ".[");
        const Field *row = row_of(table, path, length);
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
