/* sensor/settings/config_keys.c: settings one key at a time: their values as text, and taken from another
 * configuration. */
#include "sensor/settings/config_private.h"

#include <stdlib.h>

int config_keys(void) { return config_table.count; }

const char *config_key(int index) { return config_table.row[index].name; }

void config_value(char out[config_value_size], const Config *config, int index)
{
    const Setting     *row = &config_table.row[index];
    const SettingTable one = {.module = config_table.module, .row = row, .count = 1};
    Config             absolute = *config;
    char               line[config_value_size] = "", shortest[32];
    double             value;
    settings_absolute(&absolute, &one);
    settings_text(line, sizeof line, &one, &absolute);
    line[strcspn(line, "\n")] = 0;
    const char *equals = strchr(line, '=');
    snprintf(out, config_value_size, "%s", equals ? equals + 1 : line);
    if (row->type != SETTING_DOUBLE || !text_to_double(&value, out)) return;
    int digits = 6;
    do snprintf(shortest, sizeof shortest, "%.*g", digits, value);
    while (strtod(shortest, NULL) != value && digits++ < 17);
    snprintf(out, config_value_size, "%s", shortest);
}

void config_take(Config *config, const Config *from, int index)
{
    const Setting *row = &config_table.row[index];
    memcpy((char *)config + row->offset, (const char *)from + row->offset, row->size);
    config->given[index] = from->given[index];
    config->later[index] = from->later[index];
}
