/* sensor/frame/field.h: the fields of a product that is JSON, one row each: what it is called, means and is measured
 * in, where its value is in the structs of the program, and how far two runs may differ in it.
 *
 * A row is all there is to a field: field_object writes it, `pitviper help` and products.md list it
 * (sensor/reference/reference.h), and `pitviper regress` compares it. Rows stand in the order of the file. An object,
 * or a list of them, is a row with a table of its own; paths are joined as in `targets[].bands.BAND.snr`. A name in
 * capitals stands for any key (ReferenceWord). */
#ifndef SENSOR_FRAME_FIELD_H
#define SENSOR_FRAME_FIELD_H

#include "dis/pdu/pdu.h"

#include <stddef.h>

struct json_t;

typedef enum FieldKind {
    FIELD_OF_NONE, /* written by `get`, or elsewhere */
    FIELD_OF_DOUBLE,
    FIELD_OF_DOUBLES, /* an array */
    FIELD_OF_INT,
    FIELD_OF_INTS,
    FIELD_OF_LONG,
    FIELD_OF_LONG_LONG,
    FIELD_OF_COUNT,
    FIELD_OF_COUNTS,
    FIELD_OF_BOOL,
    FIELD_OF_TEXT,   /* a pointer; NULL: absent */
    FIELD_OF_OCTETS, /* an array, terminated; what cannot be printed is escaped */
    FIELD_OF_ID,
} FieldKind;

/* What a difference in it is reported as, and in which order (sensor/verify/regress). */
typedef enum FieldChannel {
    FIELD_AS_ABOVE, /* as the object that it is in */
    FIELD_APART,    /* it is not compared with that of another run */
    FIELD_TIME,
    FIELD_POSE,
    FIELD_SUN,
    FIELD_MOTION,
    FIELD_TARGETS,
    FIELD_TEMP,
    FIELD_SIGNALS,
    FIELD_ERROR,
    FIELD_RADAR,
    FIELD_COUNTERS,
    FIELD_CHANNELS
} FieldChannel;

typedef struct Field Field;
typedef struct FieldTable {
    const Field *row;
    int          count;
} FieldTable;

/* One of several: its key, where the name is in capitals, empty: it is left out; room for a struct that is made for it.
 */
typedef struct FieldItem {
    char        key[48];
    max_align_t room[12];
} FieldItem;

/* name .. about: as in ReferenceField. Then where the value is: at a place in the struct that the row is of, and on the
 * way to the file turned by `as`; or given by a function. In these `record` is the struct of the whole product.
 * A number that is not finite is absent. */
struct Field {
    const char *name, *type, *unit, *frame, *absent, *about;
    FieldKind   kind; /* FIELD_MEMBER */
    size_t      offset, size;
    double (*as)(double);
    const void *(*at)(const void *of);                         /* finds the struct; NULL: `of`. Of NULL: absent */
    struct json_t *(*get)(const void *of, const void *record); /* makes the value, owned by the caller; NULL: absent */
    const void *(*item)(FieldItem *item, const void *of, int i, const void *record); /* of rows; NULL at the end */
    const FieldTable *rows;
    bool              unless_0;     /* a count of 0 is absent */
    bool              unless_empty; /* so is an object without a field */
    bool              elsewhere;    /* it is put into the file by another function */
    /* comparison: equal within absolute + relative |expected|. Not held: within 1e-6 of it, and older records may lack
     * it; newer: held where the older record has it */
    bool         held, newer;
    double       absolute, relative;
    FieldChannel channel;
};

#define FIELD_TABLE(list)                                                                                              \
    {                                                                                                                  \
        (list), (int)(sizeof(list) / sizeof *(list))                                                                   \
    }
#define FIELD_KIND(value)                                                                                              \
    _Generic((value),                                                                                                  \
        double: FIELD_OF_DOUBLE,                                                                                       \
        double *: FIELD_OF_DOUBLES,                                                                                    \
        int: FIELD_OF_INT,                                                                                             \
        int *: FIELD_OF_INTS,                                                                                          \
        long long: FIELD_OF_LONG_LONG, \
        long: FIELD_OF_LONG,                                                                                           \
        uint64_t *: FIELD_OF_COUNTS, \
        uint64_t: FIELD_OF_COUNT,                                                                                      \
        bool: FIELD_OF_BOOL,                                                                                           \
        const char *: FIELD_OF_TEXT,                                                                                   \
        char *: FIELD_OF_OCTETS,                                                                                       \
        DisEntityId: FIELD_OF_ID)
/* Where a value is. */
#define FIELD_MEMBER(Struct, member)                                                                                   \
    .kind = FIELD_KIND(((Struct *)0)->member), .offset = offsetof(Struct, member), .size = sizeof(((Struct *)0)->member)
/* How far two runs may differ. */
#define FIELD_WITHIN(most, share) .held = true, .absolute = (most), .relative = (share)
#define FIELD_EXACT               .held = true

/* Makes the object of a struct, owned by the caller. */
struct json_t *field_object(const FieldTable *table, const void *record);
/* The row of a path as in a file, `targets[1:2:3].bands.lwir.snr`, and its channel, that of its objects if it has none
 * of its own, else the given one. NULL: there is no such row; the channel is that of the objects which there are. */
const Field *field_find(FieldChannel *channel, const FieldTable *table, const char *path);

/* ---- for rows ------------------------------------------------------------------------------------ */

/* Whether its name stands for any key. */
static inline bool field_is_word(const Field *f) { return *f->name >= 'A' && *f->name <= 'Z'; }
static inline bool field_is_list(const Field *f) { return strncmp(f->type, "list", 4) == 0; }

/* `as`: radians in degrees; a ratio in dB; in thousandths and millionths; ms to the microsecond. */
double field_deg(double rad);
double field_db(double ratio);
double field_milli(double value);
double field_micro(double value);
double field_ms(double ms);
/* Values made by `get`. NULL: the number is not finite. */
struct json_t *field_number(double value);
struct json_t *field_id(DisEntityId id);

#endif
