/* sensor/commands/sweep_file.h: the settings that a sweep varies, from a YAML file:
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
 * Any key of `pitviper check --default`. Names of files are relative to the sweep's. Every value is validated before
 * the first run; an error is one logged line with file, line, key, value and range. */
#ifndef SENSOR_COMMANDS_SWEEP_FILE_H
#define SENSOR_COMMANDS_SWEEP_FILE_H

#include "sensor/settings/config.h"

enum { sweep_variants_max = 10000, sweep_axes_max = 64, sweep_value_size = 1024 };

typedef enum SweepMode { SWEEP_GRID, SWEEP_ZIP, SWEEP_RANDOM } SweepMode;

typedef struct SweepAxis {
    char   key[96];
    int    line, count;     /* count: of values; 0: between low and high */
    char **value;
    double low, high;
    bool   whole;
    int    kinds;           /* random: values that differ; 0: a range of real numbers */
    int   *kind_of;         /* [count] of each value, 0 .. kinds - 1 */
    int   *first_of;        /* [kinds] the first value of each */
} SweepAxis;

typedef struct Sweep {
    const char *path;            /* borrowed: paths of its values are relative to its folder */
    SweepMode mode;
    int       count, axis_count; /* count: of variants */
    int       count_line;
    long long draw;
    int      *draw_of;           /* [count] random: which draw a variant is */
    SweepAxis axis[sweep_axes_max];
} Sweep;

/* base: settings on which the values are validated. On failure *out is empty. */
Status sweep_read(Sweep *out, const char *path, const Config *base);
void   sweep_close(Sweep *sweep);
/* Random: finds `count` draws that differ. Logs path and line when there are fewer. */
Status sweep_draw(Sweep *sweep, const char *path);
void   sweep_drawn_value(char out[sweep_value_size], const Sweep *sweep, int draw, int axis);
/* As on a command line. */
void   sweep_value(char out[sweep_value_size], const Sweep *sweep, int variant, int axis);
/* base with the values of all axes; checks that involve several keys are not made. */
Status sweep_config(Config *out, const Sweep *sweep, const Config *base, int variant);

#endif
