/* sensor/settings/config.h: the settings of a run: read, set, checked, written, hashed.
 *
 * A configuration file is YAML, sections of keys. Names of files in it are relative to its own folder. A missing key
 * keeps its default; an unknown or repeated key or a value out of range is an error with file, line, key, value and the
 * accepted range; all of them are reported. */
#ifndef SENSOR_SETTINGS_CONFIG_H
#define SENSOR_SETTINGS_CONFIG_H

#include "render/scene/view.h"
#include "sensor/settings/config_rows.h"

enum { config_keys_max = 256, config_text_size = 65536 };

/* clang-format off */
typedef struct Config {
    struct { CONFIG_SENSOR(SETTING_MEMBER) } sensor;
    struct { CONFIG_DETECTOR(SETTING_MEMBER) } detector;
    struct { CONFIG_RADAR(SETTING_MEMBER) } radar;
    struct { CONFIG_EXERCISE(SETTING_MEMBER) } exercise;
    struct { CONFIG_FLIGHT(SETTING_MEMBER) } flight;
    struct { CONFIG_NETWORK(SETTING_MEMBER) } network;
    struct { CONFIG_NODE(SETTING_MEMBER) } node;
    struct { CONFIG_PUBLISH(SETTING_MEMBER) } publish;
    struct { CONFIG_PROJECTOR(SETTING_MEMBER) } projector;
    struct { CONFIG_RECORD(SETTING_MEMBER) } record;
    struct { CONFIG_CACHE(SETTING_MEMBER) } cache;
    struct { CONFIG_WEATHER(SETTING_MEMBER) } weather;
    struct { CONFIG_HEAT(SETTING_MEMBER) } heat;
    struct { CONFIG_TERRAIN(SETTING_MEMBER) } terrain;
    struct { CONFIG_OBSERVER(SETTING_MEMBER) } observer;
    struct { CONFIG_MODELS(SETTING_MEMBER) } models;
    struct { CONFIG_ENTITIES(SETTING_MEMBER) } entities;
    struct { CONFIG_QUALITY(SETTING_MEMBER) } quality;
    CONFIG_TOP(SETTING_MEMBER)
    bool given[config_keys_max]; /* set by a file or the command line: not changed by a preset */
    /* For messages: the last file read, empty where its name is longer, and which keys were set after it. */
    char file[512];
    bool later[config_keys_max];
} Config;
/* clang-format on */

/* Whether it is a list of words, such as sensor.bands. */
bool config_takes_list(const char *name);
/* exercise.local_solar as Unix time at longitude 0. False: it is no time. */
bool   config_local_solar(double *clock_s, const Config *config);
Config config_default(void);
/* Sets the keys of the file, keeps the others. On failure logs and leaves the configuration as it was. */
Status config_read(Config *config, const char *path);
/* Does the same with config_check, for `pitviper check`: it goes on where keys of the file are wrong, so that one run
 * reports all; those keep their values. STATUS_BAD_VALUE: *config holds what is right. */
Status config_read_checked(Config *config, const char *path);
/* The same as config_read; paths in it are relative to the folder of `file`. */
Status config_read_as(Config *config, const char *path, const char *file);
/* The same of a text; file: where it is from, for messages, and for paths in it. */
Status config_parse(Config *config, const char *text, const char *file);
/* Sets one key as the command line does: `sensor.width_px`, `720`. source: where it comes from, for messages. */
Status config_set(Config *config, const char *key, const char *value, const char *source);
/* The same for a value from that file: paths are relative to its folder. NULL: to the current one. */
Status config_set_from(Config *config, const char *key, const char *value, const char *source, const char *file);
/* The line of a key in a file read by config_read; 0: not set there. */
int config_line(const char *key, const char *path);
/* `node.yaml:3: ` where the key was set in a file, for messages; else "". Valid until the next call of the thread. */
const char *config_where(const Config *config, const char *key);
/* The data sheet of sensor.table; empty: none, or it is a .csv. */
const char *config_sheet(const Config *config);
/* Makes the tables of this configuration take precedence (etc_own), for the whole process. */
Status config_own_tables(const Config *config);
/* Reads the tables' settings from a file, for commands that take nothing else from `--config`; NULL: there is no file.
 */
Status config_tables_of(const char *path);
/* Whether a file or the command line has set it; the key must exist. */
bool config_given(const Config *config, const char *key);
/* Type of a key's value. */
typedef enum ConfigKind { CONFIG_NONE /* there is no such key */, CONFIG_WORD, CONFIG_NUMBER, CONFIG_WHOLE } ConfigKind;
ConfigKind config_kind(const char *key);
/* From sensor.optical. */
OpticalChannels config_optical(const Config *config);
/* From sensor.antialias. */
bool config_adaptive(const Config *config);
/* Checks that involve several keys; logs every contradiction. */
Status config_check(const Config *config);
/* Writes a file to start from: every key with its value, commented out, and its meaning. */
void config_write(FILE *to, const Config *config);
/* A file that reads back as *config: keys that were given; all others commented out. */
void config_write_settings(FILE *to, const Config *config);
/* The first key whose value differs, or that only one of them was given; NULL: there is none. */
const char *config_difference(const Config *a, const Config *b);
/* `key = value` of those that were given, a line each, indented. */
void config_write_given(FILE *to, const Config *config);
/* Writes the canonical text, which is hashed as config_sha256: every key and value, in table order. Keys that change no
 * plane (network, publish, projector, record, cache, port, time span) have their defaults in it. */
void config_text(char *out, size_t out_size, const Config *config);
/* The defaults, and of `from` the keys that words name: with blanks between, each a key or the beginning of some,
 * `weather.`; with - before it: left out again. Nothing is given (config_given) in it: what is made by it follows from
 * these keys alone. */
void config_part(Config *out, const Config *from, const char *words);

/* ---- key by key (config_keys.c) --------------------------------------------------------------------- */

enum { config_value_size = 8192 };
int         config_keys(void);     /* how many there are */
const char *config_key(int index); /* 0 .. config_keys() - 1, in table order */
/* The value as text, numbers with six digits or as many as they need; paths are absolute. */
void config_value(char out[config_value_size], const Config *config, int index);
/* The value of one key, and whether it was given, from another configuration. */
void config_take(Config *config, const Config *from, int index);

/* ---- settings whose text has a grammar --------------------------------------------------------------- */

/* sensor.bands as a set of bands. A further channel of etc/channels.csv takes the place of a band: these channels are
 * chosen for the process, before tables are read (channel_choose). False, logged: the text is no list of bands. */
bool config_bands_choose(unsigned *bands, const char *text);

/* exercise.from_s and to_s: a time in a recording. A plain number, 3471.5, is exercise time, as `pitviper inspect`
 * shows it; +12 is seconds after the start of the recording, -5 seconds before its end. An empty text is valid: no
 * limit. */
bool config_span_good(const char *text);
/* Reads a time. NaN: the text is empty, or not a time. */
double config_span_time_s(const char *text, double first_s, double last_s);
/* Whether `from` is after `to` in every recording: both are of one kind. */
bool config_span_backward(const char *from, const char *to);
/* Whether a recording of that span holds nothing at or after `from`, or nothing up to `to`: logged, with the span. */
bool config_span_outside(const char *from, const char *to, double first_s, double last_s);

/* ---- automatic choices, where settings are open ------------------------------------------------------- */

enum { choices_capacity = 32, choice_text_size = 200 };

/* Lines, one for each choice that was made, with the key that changes it. */
typedef struct Choices {
    int  count;
    char line[choices_capacity][choice_text_size];
} Choices;

/* Dropped when the list is full. */
void choice_add(Choices *choices, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
