/* sensor/frame/field.h: the fields of a product that is JSON, one row each: what it is called, means and is measured
 * in, where its value is in the structs of the program, and how far two runs may differ in it.
 *
 * A row is all there is to a field: field_object writes it, `pitviper help` and products.md list it
 * (sensor/reference/reference.h), and `pitviper regress` compares it. Rows stand in the order of the file. An object,
 * or a list of them, is a row with rows of its own; paths are joined as in `targets[].bands.BAND.snr`. A name in
 * capitals stands for any key (ReferenceWord). */
#ifndef SENSOR_FRAME_FIELD_H
#define SENSOR_FRAME_FIELD_H

#include "dis/pdu/pdu.h"

#include <stddef.h>

struct json_t;

typedef enum FieldKind {
    FIELD_OF_NONE, /* given by `get`, or put into the file by another function */
    FIELD_OF_DOUBLE,
    FIELD_OF_DOUBLES, /* an array, as the other plurals */
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

/* What a difference in it is reported as (sensor/verify/regress). */
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

/* Where the writing is: in the struct that the rows are of, in the one of the whole product. An item of several sets
 * its key, where the name is in capitals (empty: it is left out), and has room for a struct that is made for it. */
typedef struct FieldAt {
    const void *of, *record;
    char        key[48];
    max_align_t room[12];
} FieldAt;

/* name .. about: as in ReferenceField. A value is a member (FIELD_MEMBER), on the way to the file turned by `as`, or
 * made by `get`. A number that is not finite is absent. */
typedef struct Field Field;
typedef struct FieldTable {
    const Field *row;
    int          count;
} FieldTable;
struct Field {
    const char *name, *unit, *frame, *absent, *about;
    const char *type; /* NULL: as the member's */
    FieldKind   kind;
    size_t      offset, size;
    double (*as)(double);
    const void *(*in)(const void *of);       /* finds the struct of the member or the rows; NULL: none, absent */
    struct json_t *(*get)(FieldAt *at);      /* the caller owns it; NULL: absent */
    const void *(*item)(FieldAt *at, int i); /* the i-th struct of the rows, or place of the member; NULL: no more */
    const FieldTable *rows;
    bool              unless_0, unless_empty; /* a count of 0 is absent; an object without a field, an empty text */
    /* comparison: equal within absolute + relative |expected|. Not held: within 1e-6 of it, and older records may lack
     * it; newer: held where the older record has it */
    bool         held, newer;
    double       absolute, relative;
    FieldChannel channel;
};

#define FIELD_TABLE(list)                                                                                              \
    (const FieldTable) { (list), (int)(sizeof(list) / sizeof *(list)) }
#define FIELD_KIND(value)                                                                                              \
    _Generic((value),                                                                                                  \
        double: FIELD_OF_DOUBLE,                                                                                       \
        double *: FIELD_OF_DOUBLES,                                                                                    \
        int: FIELD_OF_INT,                                                                                             \
        int *: FIELD_OF_INTS,                                                                                          \
        long: FIELD_OF_LONG,                                                                                           \
        long long: FIELD_OF_LONG_LONG,                                                                                 \
        uint64_t: FIELD_OF_COUNT,                                                                                      \
        uint64_t *: FIELD_OF_COUNTS,                                                                                   \
        bool: FIELD_OF_BOOL,                                                                                           \
        const char *: FIELD_OF_TEXT,                                                                                   \
        char *: FIELD_OF_OCTETS,                                                                                       \
        DisEntityId: FIELD_OF_ID)
/* What a row is of. */
#define FIELD_MEMBER(Struct, member)                                                                                   \
    .kind = FIELD_KIND(((Struct *)0)->member), .offset = offsetof(Struct, member), .size = sizeof(((Struct *)0)->member)
#define FIELD_IN(find, Struct, member) .in = (find), FIELD_MEMBER(Struct, member)
#define FIELD_GET(what, made_by)       .type = (what), .get = (made_by)
#define FIELD_OBJECT(list)             .type = "object", .rows = &FIELD_TABLE(list)
#define FIELD_OBJECTS(list)            .type = "list of objects", .rows = &FIELD_TABLE(list)
#define FIELD_ELSEWHERE(what)          .type = (what) /* put into the file with the object that it is in */
/* How far two runs may differ. */
#define FIELD_WITHIN(most, share) .held = true, .absolute = (most), .relative = (share)
#define FIELD_EXACT               .held = true

/* Makes the object of a struct, owned by the caller. */
struct json_t *field_object(const FieldTable *table, const void *record);
/* The same as text in one line, without its newline; digits: of a number. NULL: out of memory. */
char *field_line(const FieldTable *table, const void *record, int digits);
/* Puts one field of it, by its name in the table, into another product's object, where it is absent as there. */
void field_carry(struct json_t *object, const FieldTable *table, const char *name, const void *record);
/* The row of a path as in a file, `targets[1:2:3].bands.lwir.snr`, and its channel, that of its objects if it has none
 * of its own, else the given one. NULL: there is no such row; the channel is that of the objects which there are. */
const Field *field_find(FieldChannel *channel, const FieldTable *table, const char *path);

/* ---- for rows ------------------------------------------------------------------------------------ */

enum { field_type_size = 32 };
/* Its type in words, as in ReferenceField: `list of 2 numbers`. */
const char *field_type(char out[field_type_size], const Field *field);
bool        field_is_list(const Field *field);

/* `as`: radians in degrees; a ratio in dB; in thousandths and millionths; ms to the microsecond. */
double field_deg(double rad);
double field_db(double ratio);
double field_milli(double value);
double field_micro(double value);
double field_ms(double ms);
/* Values made by `get`. NULL: the number is not finite. */
struct json_t *field_number(double value);
struct json_t *field_id(DisEntityId id);
struct json_t *field_octets(const char *octets, size_t count); /* what cannot be printed is escaped */
/* Returns an item, whose key it sets. */
const void *field_keyed(FieldAt *at, const char *key, const void *item);

#endif
