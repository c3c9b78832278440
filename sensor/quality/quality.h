/* sensor/quality/quality.h: selects settings from a measured Pareto front, where error or time is configured instead
 * of settings.
 *
 * etc/quality.csv: rows of rays per pixel, at edges and over small targets, for each kind of scene, with the largest
 * error over several views and the time; `pitviper bench quality --table FILE` writes it. The selection is a function
 * of table and configuration alone: times are the table's times quality.machine_factor, never a clock's, and the
 * scene is one of woods where terrain.woods lets plants grow, so that a frame rendered alone has the settings it has
 * in a run. */
#ifndef SENSOR_QUALITY_QUALITY_H
#define SENSOR_QUALITY_QUALITY_H

#include "sensor/settings/config.h"

/* The bands whose error is in the table: all but the radar. */
enum { quality_bands = BAND_LWIR + 1, quality_rows_max = 256 };

/* Rays among leaves take several times as long as over bare ground, and err more. */
typedef enum QualityScene {
    QUALITY_BARE,
    QUALITY_WOODS,
    quality_scenes,
    quality_any_scene = quality_scenes
} QualityScene;
const char *quality_scene_name(QualityScene scene); /* bare, woods */

typedef struct QualityRow {
    QualityScene scene;                                 /* that it was measured in; any: a table without that column */
    int          samples, edge_samples, target_samples; /* as RenderRequest: 0 of both of the latter: antialias off */
    double       percent[quality_bands];                /* rms of radiance over the band's mean */
    double       kelvin[quality_bands];                 /* the same as apparent temperature; of the thermal bands */
    double       ms_megapixel;                          /* three bands and truth, one thread */
} QualityRow;

typedef struct QualityTable {
    int        count;
    QualityRow row[quality_rows_max];
} QualityTable;

/* STATUS_BAD_VALUE, logged with file, line, column and range. With a column `scene` there are rows of every scene. */
Status quality_open(QualityTable *out, const char *path);
/* Writes `# ` and the comment, then the rows. STATUS_IO, logged. */
Status quality_write(const char *path, const QualityTable *table, const char *comment);

/* Targets; NaN: none. */
typedef struct QualityTarget {
    double       percent, kelvin, frame_ms;
    double       megapixels, machine_factor;
    unsigned     bands; /* 1 << Band: bands to which the targets apply */
    QualityScene scene;
} QualityTarget;

/* Picks a row of the scene: the fastest that meets every target. If there is none, the closest: within frame_ms if any
 * row is, and with the smallest ratio of error to target. Of equals the first. With frame_ms alone: the smallest error
 * within it. reached: all targets are met. */
int quality_pick(bool *reached, const QualityTable *table, const QualityTarget *target);

/* Whether any targets select this row; else a faster row of its scene is at least as good in all. */
bool quality_wanted(const QualityTable *table, int row);

/* Applies quality.* to the settings and reports it; keys that were given stay. No target: no change. */
Status quality_choose(Config *config, Choices *choices, unsigned bands);
/* Whether the selection depends on the speed of this machine: frame_ms is set, and no factor given. */
bool quality_wants_factor(const Config *config);

#endif
