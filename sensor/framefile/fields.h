/* sensor/framefile/fields.h: one list of fields serves writing and reading: with a sink each field is written to it,
 * with a source it is read from it and must be in its range. The first error is kept, and ends the reading. */
#ifndef SENSOR_FRAMEFILE_FIELDS_H
#define SENSOR_FRAMEFILE_FIELDS_H

#include "sensor/framefile/chunks.h"

typedef struct Fields {
    ByteSink   *to;    /* one of the two */
    ByteSource *from;
    Arena      *arena; /* reading: of arrays and texts */
    int         version; /* of the format (sensor/framefile/chunks.h) */
    const char *fault; /* the name of the field; static storage */
    bool        no_memory;
} Fields;

static inline bool fields_good(const Fields *f)
{
    return !f->fault && !f->no_memory && !(f->from && f->from->truncated);
}

void field_int(Fields *f, const char *name, int *value, int low, int high);
void field_u32(Fields *f, uint32_t *value);
void field_u64(Fields *f, uint64_t *value);
void field_bool(Fields *f, const char *name, bool *value);
void field_real(Fields *f, const char *name, double *value, double low, double high); /* NaN is always out of range */
void field_reals(Fields *f, const char *name, double *value, int count, double most); /* |value| <= most */
void field_floats(Fields *f, const char *name, float *value, int count, float low, float high);
void field_unit(Fields *f, const char *name, double v[3]);        /* length 1 within 1e-6 */
void field_rotation(Fields *f, const char *name, double r[9]);    /* orthonormal within 1e-6, right-handed */
void field_bytes(Fields *f, void *bytes, size_t count);
void field_text(Fields *f, const char *name, const char **text, size_t most);
/* In place, terminated. */
void field_chars(Fields *f, const char *name, char *text, size_t size);
/* A count and, reading, an allocation for that many records; octets: the least size of one in the file. False:
 * nothing more is to be read. */
bool field_array(Fields *f, const char *name, int *count, void **array, size_t record, size_t octets, int most);

#endif
