/* sensor/quality/quality.h: settings picked off a measured front, where error or time is configured and not settings.
 *
 * etc/quality.csv: rows of rays a pixel, at edges and over small targets, each with the largest error it was found to
 * have over several scenes and its time; `pitviper bench quality --table FILE` writes it. A pick is a function of table
 * and configuration alone: times are the table's times quality.machine_factor, never a clock's. */
#ifndef SENSOR_QUALITY_QUALITY_H
#define SENSOR_QUALITY_QUALITY_H

#include "sensor/node/choices.h"

/* The bands of which errors are kept; no radar: its picture has few rays' worth of meaning. */
enum { quality_bands = BAND_LWIR + 1, quality_rows_max = 256 };

typedef struct QualityRow {
    int    samples, edge_samples, target_samples; /* as RenderRequest: 0 of both of the latter: antialias off */
    double percent[quality_bands];                /* rms of radiance over the band's mean */
    double kelvin[quality_bands];                 /* the same as apparent temperature; of the thermal bands */
    double ms_megapixel;                          /* three bands and truth, one thread */
} QualityRow;

typedef struct QualityTable {
    int        count;
    QualityRow row[quality_rows_max];
} QualityTable;

/* STATUS_BAD_VALUE, logged with file, line, column and range. */
Status quality_open(QualityTable *out, const char *path);
/* `# ` and comment, then the rows. STATUS_IO, logged. */
Status quality_write(const char *path, const QualityTable *table, const char *comment);

/* What is asked for: NaN where nothing is. */
typedef struct QualityTarget {
    double   percent, kelvin, frame_ms;
    double   megapixels, machine_factor;
    unsigned bands;             /* 1 << Band: those that must keep it */
} QualityTarget;

/* The row that keeps every target in the least time, or, of those that no row keeps, comes nearest: first within
 * frame_ms, where any row is, then with the smallest excess of error over target. Equal ones: the first. With frame_ms
 * alone: the smallest error within it. reached: whether all are kept. */
int  quality_pick(bool *reached, const QualityTable *table, const QualityTarget *target);

/* Whether there is any target, of any bands, that this row is picked for; else a quicker one is as good in all. */
bool quality_wanted(const QualityTable *table, int row);

/* Sets what quality.* asks for, and says so; keys that were given stay. Nothing asked for: nothing is done. */
Status quality_choose(Config *config, Choices *choices, unsigned bands);
/* Whether the machine's own time would change the pick: frame_ms is asked for, and no factor given. */
bool   quality_wants_factor(const Config *config);

#endif
