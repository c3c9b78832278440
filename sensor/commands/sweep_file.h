/* sensor/commands/sweep_file.h: which settings a sweep turns, from a YAML file:
 *
 *     mode: grid            # every combination, the last axis fastest (default); zip: one of each, side by side;
 *     count: 100            # random: so many different draws, no more than there are combinations,
 *     draw: 1               # of this seed (default 1): the n-th is the same for any count
 *     axes:
 *       weather.visibility_m: [5000, 23000]
 *       sensor:
 *         hfov_deg: {from: 2, to: 6}      # random: evenly between; whole numbers where the key wants them
 *       exercise.utc: [2026-06-21T10:00:00Z, 2026-12-21T17:00:00Z]
 *       seed: 7                           # one value: the same for all
 *
 * Any key of `pitviper check --default`. Names of files are relative to the sweep's. Every value is tried before the
 * first run; what is wrong is one logged line with file, line, key, value and range. */
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

/* base: what values are tried on. On failure *out holds nothing. */
Status sweep_read(Sweep *out, const char *path, const Config *base);
void   sweep_close(Sweep *sweep);
/* Random: which draws the variants are, count of them that differ. Logs with path and line when there are fewer. */
Status sweep_draw(Sweep *sweep, const char *path);
void   sweep_drawn_value(char out[sweep_value_size], const Sweep *sweep, int draw, int axis);
/* As a command line would give it. */
void   sweep_value(char out[sweep_value_size], const Sweep *sweep, int variant, int axis);
/* All axes over base; checked but for what involves several keys. */
Status sweep_config(Config *out, const Sweep *sweep, const Config *base, int variant);

#endif
