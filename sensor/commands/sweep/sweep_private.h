/* sensor/commands/sweep/sweep_private.h: the values that a sweep draws, a sweep while it runs, and what is written
 * about its variants. */
#ifndef SENSOR_COMMANDS_SWEEP_SWEEP_PRIVATE_H
#define SENSOR_COMMANDS_SWEEP_SWEEP_PRIVATE_H

#include "sensor/frame/plane.h"
#include "sensor/commands/sweep/sweep.h"
#include "sensor/publish/coco/coco_file.h"

#include <stdio.h>
#include <sys/types.h>

/* ---- records of variants (variant_record.c) -------------------------------------------------- */

/* manifest.jsonl and variant.json of a sweep (sensor/commands/sweep/sweep.h), and the fields that they share with the
 * run.json of a completed run. */

/* The result of a run. Texts that are empty and lists of no frames are left out of the file. */
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

/* ---- drawn values ----------------------------------------------------------------------------------- */

/* Random: finds `count` draws that differ. Logs path and line when there are fewer. */
Status sweep_draw(Sweep *sweep, const char *path);
void   sweep_drawn_value(char out[sweep_value_size], const Sweep *sweep, int draw, int axis);

/* ---- axes of a scenario (sweep_scenario.c) ----------------------------------------------------------- */

enum { sweep_name_size = 16 /* of variants and exercises */ };

/* Whether a key is of a scenario: `scenario.seed`. */
bool sweep_scenario_key(const char *key);
/* As config_kind, of keys of a scenario too. */
ConfigKind sweep_key_kind(const char *key);
/* Whether a scenario takes this value; logged. scenario NULL: there is none. */
Status sweep_scenario_try(const char *scenario, const char *key, const char *value, const char *source);
/* Whether what is to be replayed is the file of a scenario, by its name. */
bool sweep_is_scenario(const char *path);
/* The exercise of a variant: a name of it, by the scenario's octets, its axes and the variant's ground. The ground's
 * place goes into the variant's settings. Without a scenario: an empty name. */
Status sweep_exercise(char name[sweep_name_size], Config *config, const Sweep *sweep, int variant);
/* Its recording: OUT/exercises/NAME.pcapng, which is made where it is not there, with the table of places beside it. */
Status sweep_exercise_need(char *path, size_t size, const char *out, const char *name, const Config *config,
                           const Sweep *sweep, int variant);

/* ---- a sweep while it runs -------------------------------------------------------------------------- */

enum { sweep_words_size = 4096, sweep_path_size = 4300 };

/* manifest.html: the thumbnail of each variant (vXXXXXXXXXX/thumbnail.png), its bands side by side, and its settings.
 * Written as variants end; renamed into place when complete. */
typedef struct SweepPage {
    FILE *page;
    char  path[4300];
} SweepPage;

typedef struct Variant {
    int  number; /* in the file, 0 is the first */
    char name[sweep_name_size];
    char config_sha256[sha256_text_size];
    char exercise[sweep_name_size];         /* of a scenario; "": a recording is replayed */
    char log[sweep_path_size];              /* what it replays */
    char log_sha256[sha256_text_size];      /* "": not made yet */
    char settings_sha256[sha256_text_size]; /* of its settings.yaml: equal ones are the same run */
} Variant;

/* The process that makes variants; zeroes: none is there. It keeps what they share (sensor/node/run/made_world.h), and
 * ends with a variant that fails: the next one is made by a fresh one. */
typedef struct SweepWorker {
    bool  there;
    pid_t process;
    int   socket;
} SweepWorker;

/* Makes a variant by this command line (options_variant), its messages going into the file `said`. Its exit code; -1:
 * ended by a signal, or not started. */
int sweep_worker_make(SweepWorker *worker, const char *said, const char *const argv[]);
/* Lets it end. Its exit code; -1: ended by a signal, or there was none. */
int sweep_worker_end(SweepWorker *worker);

typedef struct SweepRun {
    const Options *options;
    Sweep          sweep;
    Variant       *variant;
    int            count, repeated;
    char           log_sha256[sha256_text_size];
    FILE          *manifest;
    SweepPage      sheet;
    CocoMerge     *coco;
    SweepWorker    worker;
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

/* Writes key=value of each axis, separated; truncated to the size of out. */
void sweep_settings_words(char out[sweep_words_size], const Sweep *sweep, int number, const char *between);
/* Opens manifest.html and manifest.jsonl in the folder of the sweep. */
Status sweep_manifest_begin(SweepRun *s);
/* Adds the variant to the page, with a thumbnail of the middle frame of its run, and prints a line about it. place: its
 * number among all variants. */
void sweep_report_variant(SweepRun *s, const Variant *v, const Outcome *outcome, int place);
/* Makes the variant's line of manifest.jsonl, which the caller frees. NULL: out of memory. */
char *sweep_manifest_line(const SweepRun *s, const Variant *v, const Outcome *outcome);
/* Ends what was opened. STATUS_IO, logged, also for the page. */
Status sweep_manifest_end(SweepRun *s);

#endif
