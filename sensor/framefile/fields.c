/* sensor/framefile/fields.c: fields of a chunk, written, or read and checked. */
#include "sensor/framefile/fields.h"

static void expect(Fields *f, const char *name, bool good)
{
    if (!good && fields_good(f)) f->fault = name;
}

void field_bytes(Fields *f, void *bytes, size_t count)
{
    if (f->to) {
        sink_bytes(f->to, bytes, count);
        return;
    }
    const uint8_t *from = source_bytes(f->from, count);
    if (from && count) memcpy(bytes, from, count);
    else if (count) memset(bytes, 0, count);
}

void field_int(Fields *f, const char *name, int *value, int low, int high)
{
    if (f->to) {
        sink_i32(f->to, *value);
        return;
    }
    *value = source_i32(f->from);
    if (*value >= low && *value <= high) return;
    expect(f, name, false);
    *value = low; /* an index is never out of its array, even when writing */
}

void field_u32(Fields *f, uint32_t *value) { field_bytes(f, value, sizeof *value); }
void field_u64(Fields *f, uint64_t *value) { field_bytes(f, value, sizeof *value); }

void field_bool(Fields *f, const char *name, bool *value)
{
    int number = *value;
    field_int(f, name, &number, 0, 1);
    *value = number != 0;
}

void field_real(Fields *f, const char *name, double *value, double low, double high)
{
    field_bytes(f, value, sizeof *value);
    if (f->from) expect(f, name, *value >= low && *value <= high);
}

void field_reals(Fields *f, const char *name, double *value, int count, double most)
{
    for (int i = 0; i < count; i++) field_real(f, name, &value[i], -most, most);
}

void field_floats(Fields *f, const char *name, float *value, int count, float low, float high)
{
    field_bytes(f, value, (size_t)count * sizeof *value);
    for (int i = 0; f->from && i < count; i++) expect(f, name, value[i] >= low && value[i] <= high);
}

void field_unit(Fields *f, const char *name, double v[3])
{
    field_reals(f, name, v, 3, 2);
    if (f->from) expect(f, name, fabs(v3_dot(v, v) - 1) <= 1e-6);
}

void field_rotation(Fields *f, const char *name, double r[9])
{
    double across[3];
    field_reals(f, name, r, 9, 2);
    if (!f->from) return;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j <= i; j++)
            expect(f, name, fabs(v3_dot(r + 3 * i, r + 3 * j) - (i == j)) <= 1e-6);
    v3_cross(across, r, r + 3);
    expect(f, name, v3_dot(across, r + 6) > 0);
}

void field_text(Fields *f, const char *name, const char **text, size_t most)
{
    if (f->to) {
        sink_text(f->to, *text);
        return;
    }
    *text = source_text(f->from, most, f->arena);
    if (*text) return;
    expect(f, name, false);
    *text = "";
}

void field_chars(Fields *f, const char *name, char *text, size_t size)
{
    field_bytes(f, text, size);
    if (!f->from) return;
    expect(f, name, memchr(text, 0, size) != NULL);
    text[size - 1] = 0;
}

bool field_array(Fields *f, const char *name, int *count, void **array, size_t record, size_t octets, int most)
{
    if (f->to) {
        sink_i32(f->to, *count);
        return true;
    }
    *count = 0;
    *array = NULL;
    if (!fields_good(f)) return false;
    const int found = source_count(f->from, octets, most);
    expect(f, name, !f->from->truncated);
    *array = fields_good(f) ? arena_alloc(f->arena, (size_t)found + 1, record) : NULL;
    if (fields_good(f) && !*array) f->no_memory = true;
    if (!fields_good(f)) return false;
    *count = found;
    return true;
}
