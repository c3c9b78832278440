/* sensor/publish/variant_record.h: manifest.jsonl and variant.json of a sweep (sensor/commands/sweep.h), and what they
 * and run.json say of a run that has been made. */
#ifndef SENSOR_PUBLISH_VARIANT_RECORD_H
#define SENSOR_PUBLISH_VARIANT_RECORD_H

#include "sensor/publish/plane_hash.h"

#include <stdio.h>

/* What a run says of itself. Empty texts, no frames: the file did not say. */
typedef struct MadeRun {
    char version[32], config_sha256[sha256_text_size], log_sha256[sha256_text_size], settings_sha256[sha256_text_size];
    bool complete;                    /* made to its last frame */
    int  frames, middle_frame; /* middle_frame: the number of the one in the middle of the list */
    int  hash_count;
    char (*hash)[sha256_text_size]; /* [hash_count] of each frame's planes */
} MadeRun;

/* run.json or variant.json. False: it is not there or no such record, and *out is empty. */
bool made_run_read(MadeRun *out, const char *path);
void made_run_free(MadeRun *run);

typedef struct VariantRecord {
    const char *name, *status, *error; /* error: "": none */
    int         number;                /* 1 is the first */
    int         setting_count;
    const char *const *key, *const *value; /* [setting_count] */
    const char *config_sha256, *settings_sha256, *log_sha256;
    double      seconds;               /* 0: not said */
    const MadeRun *run;                /* NULL: there is none */
} VariantRecord;

/* One line without its end, of the caller's to free. NULL: out of memory. */
char *variant_line(const VariantRecord *record);

#endif
