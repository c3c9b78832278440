/* sensor/publish/files/variant_record.h: manifest.jsonl and variant.json of a sweep (sensor/commands/sweep/sweep.h),
 * and the fields that they and run.json share for a completed run. */
#ifndef SENSOR_PUBLISH_FILES_VARIANT_RECORD_H
#define SENSOR_PUBLISH_FILES_VARIANT_RECORD_H

#include "sensor/frame/plane.h"

#include <stdio.h>

/* The result of a run. Empty texts, no frames: not in the file. */
typedef struct VariantRun {
    char version[32], config_sha256[sha256_text_size], log_sha256[sha256_text_size], settings_sha256[sha256_text_size];
    bool complete;             /* rendered to its last frame */
    int  frames, middle_frame; /* middle_frame: the number of the one in the middle of the list */
    int  hash_count;
    char (*hash)[sha256_text_size]; /* [hash_count] of each frame's planes */
} VariantRun;

/* run.json or variant.json. False: it is absent or not such a record, and *out is empty. */
bool variant_run_read(VariantRun *out, const char *path);
void variant_run_free(VariantRun *run);

typedef struct VariantRecord {
    const char        *name, *status, *error; /* error: "": none */
    int                number;                /* 1 is the first */
    int                setting_count;
    const char *const *key, *const *value; /* [setting_count] */
    const char       *config_sha256, *settings_sha256, *log_sha256;
    double            seconds; /* 0: not given */
    const VariantRun *run;     /* NULL: there is none */
} VariantRecord;

/* One line without its newline, freed by the caller. NULL: out of memory. */
char *variant_line(const VariantRecord *record);

#endif
