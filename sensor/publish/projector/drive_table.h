/* sensor/publish/projector/drive_table.h: drive levels of a scene projector for values of a band: a table of its
 * measurement, linear between rows (etc/reference/projector.md).
 *
 * A CSV file with the columns `radiance` (as in the EXR files: W/(m2 sr), radar relative) or `counts` (raw, of a band
 * with a sensor), and `level`. Values ascend strictly; levels may go either way. Below the first row and above the last
 * one the level is that row's. */
#ifndef SENSOR_PUBLISH_PROJECTOR_DRIVE_TABLE_H
#define SENSOR_PUBLISH_PROJECTOR_DRIVE_TABLE_H

#include "pitviper.h"

enum { drive_rows_most = 65536, drive_bins = 1024 };

typedef struct DriveTable {
    bool      counts; /* of raw counts; else of radiance */
    int       rows;
    double   *value, *level;          /* [rows] */
    double   *slope;                  /* [rows] of the level, to the next row */
    int       of_bin[drive_bins + 1]; /* of values in a bin: the last row before all of them */
    uint16_t *of_count;               /* [65536] level of each count; NULL: of radiance */
} DriveTable;

/* most: of a level, 255 or 65535. STATUS_BAD_VALUE, STATUS_IO, logged with file, line and what is accepted. */
Status drive_table_read(DriveTable *out, const char *path, int most);
void   drive_table_free(DriveTable *table); /* accepts zeros */

/* The level of a value, rounded to the nearest, halves up; of NaN that of the first row. */
uint16_t drive_level(const DriveTable *table, double value);
/* Levels of a plane's values. */
void drive_levels_of_radiance(uint16_t *out, const DriveTable *table, const float *radiance, size_t count);
void drive_levels_of_counts(uint16_t *out, const DriveTable *table, const uint16_t *counts, size_t count);

#endif
