/* sensor/settings/config_file.c: the table of settings and their defaults; sets them from files and command lines, says
 * what they are, and writes them. */
#include "sensor/settings/config_private.h"

#include "pitviper_channels.h"
#include "pitviper_file.h"
#include "terrain/woods/woods.h"

#include <stdarg.h>
#include <strings.h>

#define CONFIG_ROW(...) SETTING_ROW(Config, __VA_ARGS__)
static const Setting keys[] = {CONFIG_ROWS(CONFIG_ROW)};
enum { key_count = sizeof keys / sizeof keys[0] };
_Static_assert((int)key_count <= (int)config_keys_max, "Config.given is too small");
const SettingTable config_table = {
    .module = "config", .row = keys, .count = key_count, .all_keys = "`pitviper check --default`"};

Config config_default(void) { return (Config){CONFIG_ROWS(SETTING_DEFAULT)}; }

/* ---- what they say ---------------------------------------------------------------------------------- */

OpticalChannels config_optical(const Config *config)
{
    /* a channel selected in place of nir is all there is of the band */
    return config->sensor.optical == SENSOR_OPTICAL_NIR || !channel_in(SPECTRAL_NIR)->standard ? OPTICAL_NIR
           : config->sensor.optical == SENSOR_OPTICAL_RGB                                      ? OPTICAL_RGB
                                                                                               : OPTICAL_PAN;
}

bool config_adaptive(const Config *config) { return config->sensor.antialias == ANTIALIAS_ADAPTIVE; }

bool config_given(const Config *config, const char *name) { return config->given[settings_find(&config_table, name)]; }

ConfigKind config_kind(const char *name)
{
    const int row = settings_find(&config_table, name);
    if (row < 0) return CONFIG_NONE;
    const Setting *setting = &config_table.row[row];
    if (setting->type == SETTING_DOUBLE) return CONFIG_NUMBER;
    return setting->type == SETTING_INT || setting->type == SETTING_LONG ? CONFIG_WHOLE : CONFIG_WORD;
}

bool config_takes_list(const char *name)
{
    const int row = settings_find(&config_table, name);
    return row >= 0 && config_table.row[row].type == SETTING_WORDS;
}

bool config_local_solar(double *clock_s, const Config *config)
{
    char zoned[sizeof config->exercise.local_solar + 1];
    snprintf(zoned, sizeof zoned, "%sZ", config->exercise.local_solar);
    return text_to_unix_s(clock_s, zoned);
}

/* ---- set and read ----------------------------------------------------------------------------------- */

Status config_set(Config *config, const char *name, const char *value, const char *source)
{
    return config_set_from(config, name, value, source, NULL);
}

Status config_set_from(Config *config, const char *name, const char *value, const char *source, const char *file)
{
    const Status status = settings_set_from(config, config->given, &config_table, name, value, source, file);
    if (status == STATUS_OK) config->later[settings_find(&config_table, name)] = true;
    return status;
}

int config_line(const char *name, const char *path) { return settings_line(&config_table, name, path); }

bool config_table_has_rows(const Config *config)
{
    const size_t length = strlen(config->sensor.table);
    return length > 4 && strcasecmp(config->sensor.table + length - 4, ".csv") == 0;
}

const char *config_sheet(const Config *config) { return config_table_has_rows(config) ? "" : config->sensor.table; }

bool config_is_readable(const char *key, const char *path)
{
    char why[file_why_size];
    if (!*path || file_is_regular(why, path)) return true;
    log_error("config: %s: cannot read %s: %s; in a file of settings paths are relative to that file, on the command "
              "line "
              "to the current folder",
              key, path, why);
    return false;
}

Status config_own_tables(const Config *config)
{
    if (!config_is_readable("models.catalog", config->models.catalog) ||
        !config_is_readable("models.materials", config->models.materials) ||
        !config_is_readable("sensor.table", config->sensor.table) ||
        !config_is_readable("radar.table", config->radar.table) ||
        !config_is_readable("exercise.cigi_types", config->exercise.cigi_types))
        return STATUS_BAD_VALUE;
    const bool fits = etc_own_set("catalog.csv", config->models.catalog) &&
                      etc_own_set("materials.csv", config->models.materials) &&
                      etc_own_set("sensors.csv", config_table_has_rows(config) ? config->sensor.table : NULL);
    return fits ? STATUS_OK : STATUS_BAD_VALUE;
}

Status config_tables_of(const char *path)
{
    Config       config = config_default();
    const Status status = path ? config_read(&config, path) : STATUS_OK;
    return status == STATUS_OK ? config_own_tables(&config) : status;
}

Status config_read(Config *config, const char *path) { return config_read_as(config, path, path); }

Status config_read_as(Config *config, const char *path, const char *file)
{
    Config       filled = *config;
    const Status status = settings_read_as(&filled, filled.given, &config_table, path, file);
    if (status != STATUS_OK) return status;
    *config = filled;
    memset(config->later, 0, sizeof config->later);
    snprintf(config->file, sizeof config->file, "%s", strlen(path) < sizeof config->file ? path : "");
    return STATUS_OK;
}

Status config_parse(Config *config, const char *text, const char *file)
{
    Config       filled = *config;
    const Status status = settings_parse(&filled, filled.given, &config_table, file, text, strlen(text));
    if (status == STATUS_OK) *config = filled;
    return status;
}

Status config_read_checked(Config *config, const char *path)
{
    Status status = settings_read_as(config, config->given, &config_table, path, path);
    snprintf(config->file, sizeof config->file, "%s", strlen(path) < sizeof config->file ? path : "");
    if ((status == STATUS_OK || status == STATUS_BAD_VALUE) && config_check(config) != STATUS_OK)
        status = STATUS_BAD_VALUE;
    log_suppress(true);
    if (!config_bands_check(config->sensor.bands, "")) /* reported: what follows is checked with all bands */
        strcpy(config->sensor.bands, config_default().sensor.bands);
    log_suppress(false);
    return status;
}

const char *config_where(const Config *config, const char *key)
{
    static _Thread_local char text[sizeof config->file + 16];
    const int                 row = settings_find(&config_table, key);
    const int line = *config->file && config->given[row] && !config->later[row] ? config_line(key, config->file) : 0;
    snprintf(text, sizeof text, "%s:%d: ", config->file, line);
    return line > 0 ? text : "";
}

/* ---- written ---------------------------------------------------------------------------------------- */

void config_text(char *out, size_t out_size, const Config *config)
{
    const Config plain = config_default();
    Config       hashed = *config;
    hashed.network = plain.network;
    hashed.publish = plain.publish;
    hashed.projector = plain.projector;
    hashed.record = plain.record;
    hashed.cache = plain.cache;
    hashed.exercise.port = plain.exercise.port;
    memcpy(hashed.exercise.from_s, plain.exercise.from_s, sizeof hashed.exercise.from_s);
    memcpy(hashed.exercise.to_s, plain.exercise.to_s, sizeof hashed.exercise.to_s);
    hashed.quality = plain.quality; /* the settings that it selects are hashed themselves */
    settings_absolute(&hashed, &config_table);
    settings_text(out, out_size, &config_table, &hashed);
}

/* Whether words (config_part) name the key: the last of them that it begins with decides. */
static bool names_key(const char *words, const char *key)
{
    bool named = false;
    while (*words) {
        const size_t length = strcspn(words, " ");
        const bool   out = *words == '-';
        if (length > out && strncmp(key, words + out, length - out) == 0) named = !out;
        words += length + (words[length] == ' ');
    }
    return named;
}

void config_part(Config *out, const Config *from, const char *words)
{
    *out = config_default();
    for (int i = 0; i < config_table.count; i++) {
        const Setting *row = &config_table.row[i];
        if (names_key(words, row->name)) memcpy((char *)out + row->offset, (const char *)from + row->offset, row->size);
    }
}

void config_write(FILE *to, const Config *config)
{
    static const bool none[config_keys_max] = {false};
    fputs("# Settings of pitviper " PITVIPER_VERSION ": every key with its default. Remove the # to change it.\n"
          "# A key without a value is chosen automatically; the choice is printed.\n"
          "# `pitviper check FILE` validates a file.\n",
          to);
    settings_write(to, &config_table, config, none);
}

const char *config_difference(const Config *a, const Config *b)
{
    char in_a[8192], in_b[8192];
    for (int i = 0; i < config_table.count; i++) {
        const SettingTable one = {.module = config_table.module, .row = &config_table.row[i], .count = 1};
        settings_text(in_a, sizeof in_a, &one, a);
        settings_text(in_b, sizeof in_b, &one, b);
        if (strcmp(in_a, in_b) != 0 || a->given[i] != b->given[i]) return config_table.row[i].name;
    }
    return NULL;
}

void config_write_settings(FILE *to, const Config *config)
{
    Config absolute = *config;
    settings_absolute(&absolute, &config_table);
    settings_write(to, &config_table, &absolute, config->given);
}

void config_write_given(FILE *to, const Config *config)
{
    char  text[config_text_size];
    char *at = text;
    settings_text(text, sizeof text, &config_table, config);
    for (int i = 0; i < config_table.count && *at; i++) {
        char *end = strchr(at, '\n'), *equals = strchr(at, '=');
        if (!end || !equals) return;
        if (config->given[i])
            fprintf(to, "  %.*s = %.*s%s%s\n", (int)(equals - at), at, (int)(end - equals - 1), equals + 1,
                    *config_table.row[i].unit ? " " : "", config_table.row[i].unit);
        at = end + 1;
    }
}

/* ---- automatic choices ------------------------------------------------------------------------------ */

void choice_add(Choices *choices, const char *format, ...)
{
    if (choices->count >= choices_capacity) return;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(choices->line[choices->count++], choice_text_size, format, arguments);
    va_end(arguments);
}
