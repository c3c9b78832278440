/* sensor/reference/reference.h: every field of every product: meaning, type, unit, frame or index base, and
 * when it is absent; and Python to read it.
 *
 * One table, out of which come `pitviper help TOPIC`, the PRODUCTS section of the manual page and products.md. A new
 * field of a product is one row here, of what has a FieldTable the row that also writes it:
 * tests/system/test_reference.sh replays exercises with all products and fails for a field without a row, a row without
 * a field, a different type, and a missing field whose row has no `absent`. */
#ifndef SENSOR_REFERENCE_REFERENCE_H
#define SENSOR_REFERENCE_REFERENCE_H

#include "sensor/frame/field.h"

/* path: of JSON, keys joined by dots, `[]` for each item of a list; else what `notation` of the topic says. A word in
 * capitals is a placeholder (ReferenceWord).
 * type: integer, number, string, boolean, object, or `list of N` of these; of binary files what `notation` says.
 * frame: coordinate frame, order of a list, or from where an index counts.
 * absent: when there is no such field though there is what holds it; empty: never. */
typedef struct ReferenceField {
    const char *path, *type, *unit, *frame, *absent, *about;
} ReferenceField;

/* Values of a placeholder: text, or a list of names with meanings. */
typedef struct ReferenceWord {
    const char *word, *about;
    const char *(*name)(int i); /* returns NULL at the end; NULL: described by about */
    const char *(*what)(int i); /* may be NULL */
} ReferenceWord;

typedef struct Reference {
    const char *topic;    /* of `pitviper help TOPIC` */
    const char *file;     /* in the folder of the products */
    const char *title;    /* in one line */
    const char *about;    /* paragraphs, lines of at most 110 columns */
    const char *notation; /* of path and type, where it is not JSON; may be NULL */
    /* The i-th field that another list has; they stand before `field`. Its texts hold until the next call. False: there
     * is no more. NULL: none. */
    bool (*listed)(ReferenceField *out, int i);
    const ReferenceField *field;
    int                   field_count;
    const FieldTable     *table; /* of products written by rows, from where they are written; else NULL */
    const ReferenceWord  *word;
    int                   word_count;
    const char           *python; /* run in the folder given by --out; may be NULL */
} Reference;

#define REFERENCE_FIELDS(list) (list), (int)(sizeof(list) / sizeof *(list))

/* In the order of the data path. */
extern const Reference reference_products, reference_truth, reference_run, reference_exr, reference_png, reference_raw,
    reference_profile, reference_radar, reference_radar_map, reference_radar_scan, reference_radar_azimuths,
    reference_pairs, reference_coco, reference_answers, reference_score, reference_manifest, reference_sheet,
    reference_data_pdu, reference_stream_pdu, reference_radar_pdu, reference_pdus, reference_regress;

/* Names of the topics, separated by blanks. */
void reference_list(FILE *to);
/* `pitviper help TOPIC`, for a terminal; a product's file name is accepted too. False: no such topic. */
bool reference_write(FILE *to, const char *topic);
/* The same of a topic that is in no list. */
void reference_write_topic(FILE *to, const Reference *topic);
/* Writes all topics as Markdown: products.md. */
void reference_write_markdown(FILE *to);

/* ---- placeholders used in several topics --------------------------------------------------------- */

const char *reference_band(int i); /* optical ...; NULL at the end */

#define REFERENCE_WORD_BAND                                                                                            \
    {                                                                                                                  \
        "BAND", "one of", reference_band, NULL                                                                         \
    }

#define REFERENCE_WORD_CONSUMER                                                                                        \
    {                                                                                                                  \
        "CONSUMER", "what the frame went to: image_files, truth_lines, dis, memory, video and so on", NULL, NULL       \
    }

#endif
