/* sensor/commands/sweep/sweep.h: `replay --sweep FILE`: many runs of one log.
 *
 *     OUT/vXXXXXXXXXX/       a run, named by its settings: unchanged when axes are added
 *         settings.yaml      all settings; `replay LOG -c settings.yaml` with the options in its second line
 *                            reproduces the run
 *         log.txt            messages of the run
 *         variant.json       its line of the manifest; exists when the run is complete
 *         coco.json          with publish.coco
 *     OUT/manifest.jsonl     a line per variant: status made, kept or failed, settings, folder, hashes of its frames
 *     OUT/manifest.html      thumbnails and settings
 *     OUT/exercises/         recordings, where a scenario is replayed
 *     OUT/coco.json          of all variants that have one (sensor/publish/coco/coco_file.h)
 *
 * A variant is a run with the given options and the values of the axes over them: settings are passed in
 * settings.yaml, which must read back equal, every other option on the command line of the variant (options_variant).
 * Several --host are refused.
 *
 * Every variant is validated (combinations of settings, sensors) before the first run. They are made one after another,
 * with all threads, in a process beside the sweep's, which keeps log, models, ground, woods and warmth from one variant
 * to the next, as far as their axes do not change what these follow from (sensor/node/run/made_world.h). A variant that
 * fails or crashes ends that process and affects no other. A variant is kept when its folder holds a complete
 * run of these settings (time span and products included), this log and this version; deleted images, and changes of
 * etc/ or of terrain files, are not detected. */
#ifndef SENSOR_COMMANDS_SWEEP_SWEEP_H
#define SENSOR_COMMANDS_SWEEP_SWEEP_H

#include "sensor/frame/field.h"
#include "sensor/node/run/host_run.h"
#include "sensor/settings/config.h"

/* What replay knows of a run before its world is set up: log, hosts, span. Logged; the caller calls run_close. */
typedef Status SweepLook(Run *run);

/* Exit code: 0; 1: a variant failed, or the sweep could not be written, or look refuses what no axis changes; 2: the
 * file or settings of a variant are invalid. */
int sweep_replay(const Options *options, SweepLook *look);

/* `pitviper replay --variants`, which sweep_replay starts, and no user: makes variants until its standard input, a
 * socket, ends. Exit code of a variant: as of a replay; made is what variants share. */
typedef int       SweepVariant(int argc, char **argv, MadeWorld *made);
extern const char sweep_worker_option[];
int               sweep_worker(SweepVariant *make);

extern const FieldTable variant_fields; /* a line of manifest.jsonl */

/* ---- the settings that a sweep varies --------------------------------------------------------------- */

/* From a YAML file:
 *
 *     mode: grid            # every combination, the last axis fastest (default); zip: the lists in parallel;
 *     count: 100            # random: number of different draws, at most the number of combinations,
 *     draw: 1               # seed of the draws (default 1): the n-th is the same for any count
 *     axes:
 *       weather.visibility_m: [5000, 23000]
 *       sensor:
 *         hfov_deg: {from: 2, to: 6}      # random: uniform; whole numbers for integer keys
 *       exercise.utc: [2026-06-21T10:00:00Z, 2026-12-21T17:00:00Z]
 *       seed: 7                           # one value for all
 *
 * Any key of `pitviper check --default`. Where a scenario is replayed in place of a recording, `replay SCENARIO.yaml
 * --sweep FILE`, also any key of `pitviper exercise --keys`, and of vehicles by their name:
 *
 *       scenario.seed: [1, 2, 3]
 *       scenario.vehicles.Tank.type: [tank, carrier]
 *       scenario.vehicles.Tank.route_m: ["-400,-300", "200,100"]
 *
 * Each of the exercises that they make is recorded once, OUT/exercises/eXXXXXXXXXX.pcapng, with the table of what hides
 * in it. Where the scenario has ground.planted, its seed, relief and spacing are those of the variant, and the
 * variant's terrain.place is that of the scenario. Names of files are relative to the sweep's. Every value is validated
 * before the first run; an error is one logged line with file, line, key, value and range. */
enum { sweep_variants_max = 10000, sweep_axes_max = 64, sweep_value_size = 1024 };

typedef enum SweepMode { SWEEP_GRID, SWEEP_ZIP, SWEEP_RANDOM } SweepMode;

typedef struct SweepAxis {
    char   key[96];
    int    line, count; /* count: of values; 0: between low and high */
    char **value;
    double low, high;
    bool   whole;
    int    kinds;    /* random: values that differ; 0: a range of real numbers */
    int   *kind_of;  /* [count] of each value, 0 .. kinds - 1 */
    int   *first_of; /* [kinds] the first value of each */
} SweepAxis;

typedef struct Sweep {
    const char *scenario; /* borrowed: what is replayed, where that is no recording; NULL: a recording */
    const char *path;     /* borrowed: paths of its values are relative to its folder */
    SweepMode   mode;
    int         count, axis_count; /* count: of variants */
    int         count_line;
    long long   draw;
    int        *draw_of; /* [count] random: which draw a variant is */
    SweepAxis   axis[sweep_axes_max];
} Sweep;

/* base: settings on which the values are validated. On failure *out is empty. */
Status sweep_read(Sweep *out, const char *path, const Config *base);
/* The same of a scenario; scenario NULL: of a recording. */
Status sweep_read_of(Sweep *out, const char *path, const Config *base, const char *scenario);
void   sweep_close(Sweep *sweep);
/* As on a command line. */
void sweep_value(char out[sweep_value_size], const Sweep *sweep, int variant, int axis);
/* base with the values of all axes; checks that involve several keys are not made. */
Status sweep_config(Config *out, const Sweep *sweep, const Config *base, int variant);

#endif
