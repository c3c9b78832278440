/* sensor/commands/sweep/sweep_private.h: the values that a sweep draws, a sweep while it runs, and what is written
 * about its variants. */
#ifndef SENSOR_COMMANDS_SWEEP_SWEEP_PRIVATE_H
#define SENSOR_COMMANDS_SWEEP_SWEEP_PRIVATE_H

#include "sensor/commands/sweep/sweep.h"
#include "sensor/publish/coco/coco_file.h"
#include "sensor/publish/files/variant_record.h"

/* ---- drawn values ----------------------------------------------------------------------------------- */

/* Random: finds `count` draws that differ. Logs path and line when there are fewer. */
Status sweep_draw(Sweep *sweep, const char *path);
void   sweep_drawn_value(char out[sweep_value_size], const Sweep *sweep, int draw, int axis);

/* ---- a sweep while it runs -------------------------------------------------------------------------- */

enum { sweep_name_size = 16, sweep_words_size = 4096 };

/* manifest.html: a thumbnail of each variant, its bands side by side, and its settings. Written as variants end;
 * renamed into place when complete. */
typedef struct SweepPage {
    FILE *page;
    char  path[4300];
    int   shown;
} SweepPage;

typedef struct Variant {
    int  number; /* in the file, 0 is the first */
    char name[sweep_name_size];
    char config_sha256[sha256_text_size];
    char settings_sha256[sha256_text_size]; /* of its settings.yaml: equal ones are the same run */
} Variant;

typedef struct SweepRun {
    const Options *options;
    Sweep          sweep;
    Variant       *variant;
    int            count, repeated;
    char           log_sha256[sha256_text_size];
    FILE          *manifest;
    SweepPage      sheet;
    CocoMerge     *coco;
    int            made, kept, failed;
    bool           stopped; /* by a signal, before the last */
} SweepRun;

/* Result of one variant. */
typedef struct Outcome {
    const char *status;
    bool        has_run;
    VariantRun  run;      /* run.json */
    char        why[400]; /* of a failure */
    double      seconds;
} Outcome;

/* ---- what is written about its variants ------------------------------------------------------------- */

/* key=value of each axis, separated; truncated to the size of out. */
void sweep_settings_words(char out[sweep_words_size], const Sweep *sweep, int number, const char *between);
/* Opens manifest.html and manifest.jsonl in the folder of the sweep. */
Status sweep_manifest_begin(SweepRun *s);
/* Adds the variant to the page, with a thumbnail of the middle frame of its run, and tells of it. place: of it among
 * all. */
void sweep_report_variant(SweepRun *s, const Variant *v, const Outcome *outcome, int place);
/* The variant's line of manifest.jsonl, malloc'd. NULL: out of memory. */
char *sweep_manifest_line(const SweepRun *s, const Variant *v, const Outcome *outcome);
/* Ends what was opened. STATUS_IO, logged, also for the page. */
Status sweep_manifest_end(SweepRun *s);

#endif
