/* sensor/settings/config_private.h: the table of settings, and what the checks ask of their texts. */
#ifndef SENSOR_SETTINGS_CONFIG_PRIVATE_H
#define SENSOR_SETTINGS_CONFIG_PRIVATE_H

#include "sensor/settings/config.h"

extern const SettingTable config_table;

/* Whether sensor.table is a .csv, which holds rows for sensor.preset; any other file is of one sensor. */
bool config_table_has_rows(const Config *config);
/* Whether the file that a key names can be read, or none is named; else logged. */
bool config_is_readable(const char *key, const char *path);
/* Whether sensor.bands is a list of bands, without choosing them. where: `node.yaml:3: ` before the message, or "". */
bool config_bands_check(const char *text, const char *where);

#endif
