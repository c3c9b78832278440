/* sensor/settings/tables_used.h: SHA-256 of the tables and models that a run reads, for run.json; `pitviper regress`
 * compares them before any channel. */
#ifndef SENSOR_SETTINGS_TABLES_USED_H
#define SENSOR_SETTINGS_TABLES_USED_H

#include "sensor/settings/config.h"
#include "pitviper_sha256.h"

enum { tables_used_max = 256, table_used_name_size = 160 };

typedef struct TableUsed {
    char name[table_used_name_size]; /* `materials.csv`, `atmosphere/midlat_summer` (all its files together), a model's
                                      * file as the catalog names it */
    char sha256[sha256_text_size];
} TableUsed;

typedef struct TablesUsed {
    int       count;
    TableUsed table[tables_used_max];
} TablesUsed;

/* Every *.csv of etc/, the configured atmosphere's folder, the data sheet of sensor.table, and each model file of the
 * catalog with its sidecar. 4 MB and some 10 ms. A file that cannot be read is left out: its reader reports it.
 * STATUS_NO_MEMORY, or the status of table_open for the catalog. */
Status tables_used(TablesUsed *out, const Config *config, const char *catalog);
/* And heat.given, which a frame file does not need again: its temperatures are in it. */
Status tables_given(TablesUsed *out, const Config *config);

#endif
