#include "sensor/node/config.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <yaml.h>

typedef enum KeyType { KEY_DOUBLE, KEY_INT, KEY_LONG, KEY_BOOL, KEY_TEXT } KeyType;

typedef struct Key {
    const char *name;
    KeyType     type;
    size_t      offset, size;
    double      low, high;  /* numbers; NaN allowed where `low` is NaN: no bound */
    const char *choices;    /* text: one of these, separated by `|`; NULL: any */
    const char *unit, *help;
} Key;

#define AT(member) offsetof(Config, member), sizeof(((Config *)0)->member)

static const Key keys[] = {
    {"sensor.width_px", KEY_INT, AT(sensor.width_px), 8, 8192, NULL, "px", "columns of the picture"},
    {"sensor.height_px", KEY_INT, AT(sensor.height_px), 8, 8192, NULL, "px", "rows of the picture"},
    {"sensor.hfov_deg", KEY_DOUBLE, AT(sensor.hfov_deg), 0.01, 120, NULL, "deg", "horizontal field of view"},
    {"sensor.rate_hz", KEY_DOUBLE, AT(sensor.rate_hz), 0, 1000, NULL, "Hz", "frames a second; 0: 5 for a munition, 1 for an observer"},
    {"sensor.samples", KEY_INT, AT(sensor.samples), 1, 16, NULL, "", "rays a side of a pixel"},
    {"sensor.antialias", KEY_TEXT, AT(sensor.antialias), 0, 0, "adaptive|off", "", "more rays at edges and over small targets, or not"},
    {"sensor.edge_samples", KEY_INT, AT(sensor.edge_samples), 2, 16, NULL, "", "rays a side of a pixel where neighbours disagree; adaptive"},
    {"sensor.target_samples", KEY_INT, AT(sensor.target_samples), 8, 256, NULL, "", "rays a side over a target of less than 16 px; adaptive"},
    {"sensor.bands", KEY_TEXT, AT(sensor.bands), 0, 0, NULL, "", "any of optical,mwir,lwir,radar"},
    {"sensor.optical", KEY_TEXT, AT(sensor.optical), 0, 0, "rgb|pan|nir", "", "three channels or one: visible, or 0.7-1.1 um"},
    {"sensor.sky_samples", KEY_INT, AT(sensor.sky_samples), 0, 4096, NULL, "", "directions a ray's hit asks for light; 0: by its slope"},
    {"sensor.gimbal_limit_deg", KEY_DOUBLE, AT(sensor.gimbal_limit_deg), 0, 180, NULL, "deg", "largest angle off the body axis"},
    {"sensor.gimbal_rate_dps", KEY_DOUBLE, AT(sensor.gimbal_rate_dps), 0.01, 10000, NULL, "deg/s", "largest rate"},
    {"sensor.gimbal_lag_s", KEY_DOUBLE, AT(sensor.gimbal_lag_s), 0, 10, NULL, "s", "time constant of the tracking loop"},
    {"sensor.preset", KEY_TEXT, AT(sensor.preset), 0, 0, NULL, "", "none, or sensors of etc/sensors.csv, one a band: staring_lwir,staring_mwir,tv"},
    {"detector.bits", KEY_INT, AT(detector.bits), 8, 16, NULL, "", "8 or 16, of the PNG pictures"},
    {"detector.level", KEY_TEXT, AT(detector.level), 0, 0, "auto|manual", "", "gain and level from the picture, or as set"},
    {"detector.gain", KEY_DOUBLE, AT(detector.gain), 0.01, 100, NULL, "", "about the middle of the level"},
    {"detector.offset", KEY_DOUBLE, AT(detector.offset), -1, 1, NULL, "", "in full scales"},
    {"detector.noise_optical", KEY_DOUBLE, AT(detector.noise_optical), 0, 1, NULL, "", "sigma as a share of the mean"},
    {"detector.netd_mwir_k", KEY_DOUBLE, AT(detector.netd_mwir_k), 0, 10, NULL, "K", "noise equivalent temperature difference at 300 K"},
    {"detector.netd_lwir_k", KEY_DOUBLE, AT(detector.netd_lwir_k), 0, 10, NULL, "K", "the same in 8-12 um"},
    {"detector.mwir_low_k", KEY_DOUBLE, AT(detector.mwir_low_k), 150, 2000, NULL, "K", "black, manual level"},
    {"detector.mwir_high_k", KEY_DOUBLE, AT(detector.mwir_high_k), 150, 2000, NULL, "K", "white, manual level"},
    {"detector.lwir_low_k", KEY_DOUBLE, AT(detector.lwir_low_k), 150, 2000, NULL, "K", "black, manual level"},
    {"detector.lwir_high_k", KEY_DOUBLE, AT(detector.lwir_high_k), 150, 2000, NULL, "K", "white, manual level"},
    {"detector.optical_high_w_m2_sr", KEY_DOUBLE, AT(detector.optical_high_w_m2_sr), 1e-3, 1e4, NULL, "W/(m2 sr)", "white, manual level"},
    {"detector.agc_s", KEY_DOUBLE, AT(detector.agc_s), 0, 1000, NULL, "s", "time constant of the automatic level, from the first frame made on; 0: each frame by itself"},
    {"detector.noise", KEY_DOUBLE, AT(detector.noise), 0, 100, NULL, "", "factor of all noise; 0: none"},
    {"detector.f_number", KEY_DOUBLE, AT(detector.f_number), 0.5, 100, NULL, "", "in place of the preset's"},
    {"detector.obscuration", KEY_DOUBLE, AT(detector.obscuration), 0, 0.95, NULL, "", "central, share of the aperture's diameter; in place of the preset's"},
    {"detector.integration_ms", KEY_DOUBLE, AT(detector.integration_ms), 1e-6, 1e4, NULL, "ms", "in place of the preset's"},
    {"detector.jitter_px", KEY_DOUBLE, AT(detector.jitter_px), 0, 10, NULL, "px", "rms a direction, within the integration time; in place of the preset's"},
    {"detector.bad_share", KEY_DOUBLE, AT(detector.bad_share), 0, 0.2, NULL, "", "faulty pixels; in place of the preset's"},
    {"detector.ac_per_line", KEY_DOUBLE, AT(detector.ac_per_line), 0, 100, NULL, "", "cut-off of the AC coupling x line time; in place of the preset's"},
    {"detector.line_noise", KEY_DOUBLE, AT(detector.line_noise), 0, 100, NULL, "", "rms of noise along lines over that of a pixel; in place of the preset's"},
    {"detector.smear", KEY_BOOL, AT(detector.smear), 0, 1, NULL, "", "motion within the integration time and between lines, with a preset"},
    {"detector.raw", KEY_BOOL, AT(detector.raw), 0, 1, NULL, "", "files of raw counts, with a preset"},
    {"radar.bin_m", KEY_DOUBLE, AT(radar.bin_m), 0.01, 100, NULL, "m", "range bin of the profile"},
    {"radar.bins", KEY_INT, AT(radar.bins), 16, 65536, NULL, "", "range bins, about the aim"},
    {"radar.lobe_deg", KEY_DOUBLE, AT(radar.lobe_deg), 0.2, 30, NULL, "deg", "rms half width of the exit lobe"},
    {"exercise.port", KEY_INT, AT(exercise.port), -1, 65535, NULL, "", "UDP port of the exercise; 0: any; -1: 3000, or any when nothing went there"},
    {"exercise.exercise", KEY_INT, AT(exercise.exercise), -2, 255, NULL, "", "exercise identifier; -1: the one heard most; -2: all as one"},
    {"exercise.utc", KEY_TEXT, AT(exercise.utc), 0, 0, NULL, "", "date and time of the first PDU, 2026-06-21T10:00:00Z"},
    {"exercise.host", KEY_TEXT, AT(exercise.host), 0, 0, NULL, "", "site:application:entity that carries the sensor"},
    {"exercise.aim", KEY_TEXT, AT(exercise.aim), 0, 0, NULL, "", "site:application:entity it looks at"},
    {"exercise.from_s", KEY_DOUBLE, AT(exercise.from_s), NAN, NAN, NULL, "s", "first exercise time of interest"},
    {"exercise.to_s", KEY_DOUBLE, AT(exercise.to_s), NAN, NAN, NULL, "s", "last exercise time of interest"},
    {"exercise.causal", KEY_BOOL, AT(causal), 0, 1, NULL, "", "use only what had been received by each frame"},
    {"weather.atmosphere", KEY_TEXT, AT(weather.atmosphere), 0, 0, NULL, "", "us1976, midlat_summer, or another of etc/atmosphere"},
    {"weather.visibility_m", KEY_DOUBLE, AT(weather.visibility_m), 100, 300000, NULL, "m", "meteorological range"},
    {"weather.air_temp_k", KEY_DOUBLE, AT(weather.air_temp_k), 220, 330, NULL, "K", "at the ground; unset: the atmosphere's own"},
    {"weather.pressure_mbar", KEY_DOUBLE, AT(weather.pressure_mbar), 300, 1100, NULL, "mbar", ""},
    {"weather.wind_mps", KEY_DOUBLE, AT(weather.wind_mps), 0, 60, NULL, "m/s", ""},
    {"weather.wind_from_deg", KEY_DOUBLE, AT(weather.wind_from_deg), 0, 360, NULL, "deg", "where the wind comes from, clockwise from north"},
    {"terrain.relief_m", KEY_DOUBLE, AT(terrain.relief_m), 0, 200, NULL, "m", "rms height of the invented hills"},
    {"terrain.spacing_m", KEY_DOUBLE, AT(terrain.spacing_m), 0, 1000, NULL, "m", "between elevation posts; 0: 4 invented, else the files' own"},
    {"terrain.elevation", KEY_TEXT, AT(terrain.elevation), 0, 0, NULL, "", "elevation files or folders, separated by commas; empty: invented ground"},
    {"terrain.vertical", KEY_TEXT, AT(terrain.vertical), 0, 0, "auto|geoid|ellipsoid", "", "what their heights are above; auto: as their CRS says, else the geoid"},
    {"terrain.geoid", KEY_TEXT, AT(terrain.geoid), 0, 0, NULL, "", "a .gtx grid; empty: EGM96 of proj-data"},
    {"terrain.cover", KEY_TEXT, AT(terrain.cover), 0, 0, NULL, "", "ground cover files or folders; empty: by slope and height"},
    {"terrain.cover_table", KEY_TEXT, AT(terrain.cover_table), 0, 0, NULL, "", "worldcover, nlcd, fbfm40 or a CSV of code, surface; empty: by the codes met"},
    {"terrain.cover_band", KEY_INT, AT(terrain.cover_band), 0, 1000, NULL, "", "band of the cover files; 0: 4 of landscape files (8 bands), else 1"},
    {"terrain.orthophoto", KEY_TEXT, AT(terrain.orthophoto), 0, 0, NULL, "", "photographs of the ground from above, files or folders"},
    {"terrain.ground", KEY_TEXT, AT(terrain.ground), 0, 0, "auto|clamp|trust|fit", "", "set land vehicles on the ground, leave them, or lead the ground through them; auto: fit invented ground, clamp to real"},
    {"observer.range_m", KEY_DOUBLE, AT(observer.range_m), 10, 100000, NULL, "m", "of the stand-off observer, along the ground"},
    {"observer.height_m", KEY_DOUBLE, AT(observer.height_m), 1, 20000, NULL, "m", "above what it looks at"},
    {"observer.rate_dps", KEY_DOUBLE, AT(observer.rate_dps), -60, 60, NULL, "deg/s", "of its circle, clockwise from above"},
    {"models.sag_m", KEY_DOUBLE, AT(models.sag_m), 1e-5, 0.1, NULL, "m", "largest distance of a facet from its surface"},
    {"entities.timeout_s", KEY_DOUBLE, AT(entities.timeout_s), 0.1, 1e5, NULL, "s", "silence after which an entity is gone"},
    {"entities.timeout_land_v7_s", KEY_DOUBLE, AT(entities.timeout_land_v7_s), 0.1, 1e5, NULL, "s", "the same for land entities of version 7"},
    {"entities.extrapolation_limit_s", KEY_DOUBLE, AT(entities.extrapolation_limit_s), 0.01, 1e4, NULL, "s", "longest dead reckoning"},
    {"entities.capacity", KEY_INT, AT(entities.capacity), 1, 1000000, NULL, "", "most entities at once"},
    {"seed", KEY_LONG, AT(seed), 0, 2147483647, NULL, "", "of everything random"},
};
enum { key_count = sizeof keys / sizeof keys[0] };
_Static_assert((int)key_count <= (int)config_keys_max, "Config.given is too small");

Config config_default(void)
{
    Config c = {0};
    c.sensor.width_px         = 720;
    c.sensor.height_px        = 486;
    c.sensor.hfov_deg         = 6;
    c.sensor.samples          = 1;
    c.sensor.edge_samples     = 4;
    c.sensor.target_samples   = 48; /* a sunlit crescent within 1 %: tests/render/test_small_targets.c */
    c.sensor.gimbal_limit_deg = 45;
    c.sensor.gimbal_rate_dps  = 60;
    c.sensor.gimbal_lag_s     = 0.03;
    strcpy(c.sensor.bands, "optical,mwir,lwir,radar");
    strcpy(c.sensor.optical, "rgb");
    strcpy(c.sensor.antialias, "adaptive");
    strcpy(c.detector.level, "auto");
    c.detector.bits                 = 8;
    c.detector.gain                 = 1;
    c.detector.noise_optical        = 0.005;
    c.detector.netd_mwir_k          = 0.03; /* staring arrays of public data sheets: 20 .. 50 mK */
    c.detector.netd_lwir_k          = 0.05;
    c.detector.mwir_low_k           = 270;
    c.detector.mwir_high_k          = 340;
    c.detector.lwir_low_k           = 270;
    c.detector.lwir_high_k          = 330;
    c.detector.optical_high_w_m2_sr = 40;
    strcpy(c.sensor.preset, "none");
    c.detector.noise                = 1;
    c.detector.f_number = c.detector.obscuration = c.detector.integration_ms = c.detector.jitter_px = NAN;
    c.detector.bad_share = c.detector.ac_per_line = c.detector.line_noise = NAN;
    c.detector.smear                = true;
    c.detector.raw                  = true;
    c.radar.bin_m                   = 0.3; /* 500 MHz of bandwidth */
    c.radar.bins                    = 512;
    c.radar.lobe_deg                = 3;
    c.exercise.port                 = -1;
    c.exercise.exercise             = -1;
    c.exercise.from_s               = NAN;
    c.exercise.to_s                 = NAN;
    strcpy(c.weather.atmosphere, "us1976");
    c.weather.visibility_m          = 23000;
    c.weather.air_temp_k            = NAN;
    c.weather.pressure_mbar         = 1013.25;
    c.weather.wind_mps              = 3;
    c.weather.wind_from_deg         = 270;
    c.terrain.relief_m              = 15;
    strcpy(c.terrain.vertical, "auto");
    strcpy(c.terrain.ground, "auto");
    c.observer.range_m              = 600;
    c.observer.height_m             = 250;
    c.observer.rate_dps             = 2;
    c.models.sag_m                  = 0.002;
    c.entities.timeout_s            = 12;
    c.entities.timeout_land_v7_s    = 132;
    c.entities.extrapolation_limit_s = 12;
    c.entities.capacity             = 100000;
    c.seed                          = 1;
    return c;
}

static const Key *find_key(const char *name)
{
    for (int i = 0; i < key_count; i++)
        if (strcmp(keys[i].name, name) == 0) return &keys[i];
    return NULL;
}

static bool is_choice(const char *choices, const char *value)
{
    const size_t length = strlen(value);
    for (const char *at = choices; at; at = strchr(at, '|'), at = at ? at + 1 : NULL)
        if (strncmp(at, value, length) == 0 && (at[length] == '|' || !at[length])) return true;
    return false;
}

static void say_bad(const char *source, const Key *key, const char *value)
{
    if (key->choices)
        log_error("config: %s: %s: '%s' is not one of %s", source, key->name, value, key->choices);
    else if (key->type == KEY_TEXT)
        log_error("config: %s: %s: '%s' is longer than %zu characters", source, key->name, value, key->size - 1);
    else if (key->type == KEY_BOOL)
        log_error("config: %s: %s: '%s' is not true or false", source, key->name, value);
    else if (isnan(key->low))
        log_error("config: %s: %s: '%s' is not a number", source, key->name, value);
    else
        log_error("config: %s: %s: '%s' is not %s in %g .. %g%s%s", source, key->name, value,
                  key->type == KEY_DOUBLE ? "a number" : "a whole number", key->low, key->high, *key->unit ? " " : "",
                  key->unit);
}

static Status store_key(Config *config, const Key *key, const char *value, const char *source)
{
    char     *at = (char *)config + key->offset;
    double    number;
    long long whole;
    switch (key->type) {
    case KEY_DOUBLE:
        if (!text_to_double(&number, value)) break;
        if (!isnan(key->low) && !(number >= key->low && number <= key->high)) break;
        memcpy(at, &number, sizeof number);
        return STATUS_OK;
    case KEY_INT:
    case KEY_LONG:
        if (!text_to_long(&whole, value)) break;
        if (!((double)whole >= key->low && (double)whole <= key->high)) break;
        if (key->type == KEY_LONG) {
            memcpy(at, &whole, sizeof whole);
        } else {
            const int number_int = (int)whole;
            memcpy(at, &number_int, sizeof number_int);
        }
        return STATUS_OK;
    case KEY_BOOL:
        if (strcmp(value, "true") != 0 && strcmp(value, "false") != 0) break;
        *(bool *)at = value[0] == 't';
        return STATUS_OK;
    case KEY_TEXT:
        if (strlen(value) >= key->size || (key->choices && !is_choice(key->choices, value))) break;
        memset(at, 0, key->size);
        strcpy(at, value);
        return STATUS_OK;
    }
    say_bad(source, key, value);
    return STATUS_BAD_VALUE;
}

static Status set_key(Config *config, const Key *key, const char *value, const char *source)
{
    const Status status = store_key(config, key, value, source);
    if (status == STATUS_OK) config->given[key - keys] = true;
    return status;
}

OpticalChannels config_optical(const Config *config)
{
    return strcmp(config->sensor.optical, "rgb") == 0   ? OPTICAL_RGB
           : strcmp(config->sensor.optical, "nir") == 0 ? OPTICAL_NIR
                                                        : OPTICAL_PAN;
}

bool config_given(const Config *config, const char *name) { return config->given[find_key(name) - keys]; }

Status config_set(Config *config, const char *name, const char *value, const char *source)
{
    const Key *key = find_key(name);
    if (!key) {
        log_error("config: %s: no such key: %s", source, name);
        return STATUS_BAD_VALUE;
    }
    return set_key(config, key, value, source);
}

/* ---- YAML ----------------------------------------------------------------------------------- */

/* `section.key` or a key at the top; the node's line is what a user sees first. */
static Status set_from_node(Config *config, bool seen[key_count], const char *path, const char *section,
                            const yaml_node_t *name, const yaml_node_t *value)
{
    char      full[160], source[512];
    const int line = (int)name->start_mark.line + 1;
    snprintf(full, sizeof full, "%s%s%s", section, *section ? "." : "", (const char *)name->data.scalar.value);
    snprintf(source, sizeof source, "%s:%d", path, line);
    const Key *key = find_key(full);
    if (!key) {
        log_error("config: %s: no such key: %s", source, full);
        return STATUS_BAD_VALUE;
    }
    if (seen[key - keys]) {
        log_error("config: %s: %s is given twice", source, full);
        return STATUS_BAD_VALUE;
    }
    seen[key - keys] = true;
    if (value->type != YAML_SCALAR_NODE) {
        log_error("config: %s: %s needs one value", source, full);
        return STATUS_BAD_VALUE;
    }
    return set_key(config, key, (const char *)value->data.scalar.value, source);
}

static Status set_from_mapping(Config *config, bool seen[key_count], const char *path, const char *section,
                               yaml_document_t *document, const yaml_node_t *mapping)
{
    for (const yaml_node_pair_t *pair = mapping->data.mapping.pairs.start; pair < mapping->data.mapping.pairs.top;
         pair++) {
        const yaml_node_t *name = yaml_document_get_node(document, pair->key);
        const yaml_node_t *value = yaml_document_get_node(document, pair->value);
        Status             status;
        if (name->type != YAML_SCALAR_NODE) {
            log_error("config: %s:%d: a key must be a word", path, (int)name->start_mark.line + 1);
            return STATUS_BAD_VALUE;
        }
        if (value->type == YAML_MAPPING_NODE && !*section)
            status = set_from_mapping(config, seen, path, (const char *)name->data.scalar.value, document, value);
        else
            status = set_from_node(config, seen, path, section, name, value);
        if (status != STATUS_OK) return status;
    }
    return STATUS_OK;
}

Status config_read(Config *config, const char *path)
{
    Config          filled = *config;
    bool            seen[key_count] = {false};
    yaml_parser_t   parser;
    yaml_document_t document;
    Status          status = STATUS_OK;

    FILE *file = fopen(path, "rb");
    if (!file) {
        log_error("config: cannot open %s: %s", path, strerror(errno));
        return STATUS_IO;
    }
    if (!yaml_parser_initialize(&parser)) {
        fclose(file);
        return STATUS_NO_MEMORY;
    }
    yaml_parser_set_input_file(&parser, file);
    if (!yaml_parser_load(&parser, &document)) {
        log_error("config: %s:%d: %s", path, (int)parser.problem_mark.line + 1,
                  parser.problem ? parser.problem : "not YAML");
        status = STATUS_BAD_VALUE;
    } else {
        const yaml_node_t *root = yaml_document_get_root_node(&document);
        if (root && root->type == YAML_MAPPING_NODE) {
            status = set_from_mapping(&filled, seen, path, "", &document, root);
        } else if (root) {
            log_error("config: %s:%d: expected `section:` and keys below it", path, (int)root->start_mark.line + 1);
            status = STATUS_BAD_VALUE;
        }
        yaml_document_delete(&document);
    }
    yaml_parser_delete(&parser);
    fclose(file);
    if (status == STATUS_OK) *config = filled;
    return status;
}

Status config_check(const Config *config)
{
    if (config->detector.bits != 8 && config->detector.bits != 16) {
        log_error("config: detector.bits: %d is not 8 or 16", config->detector.bits);
        return STATUS_BAD_VALUE;
    }
    if (!(config->detector.lwir_low_k < config->detector.lwir_high_k) ||
        !(config->detector.mwir_low_k < config->detector.mwir_high_k)) {
        log_error("config: detector: the low level must be below the high one");
        return STATUS_BAD_VALUE;
    }
    static const char *const of_preset[] = {"detector.f_number", "detector.obscuration", "detector.integration_ms",
                                            "detector.jitter_px", "detector.bad_share", "detector.ac_per_line",
                                            "detector.line_noise", "detector.smear", "detector.raw"};
    for (size_t i = 0; i < sizeof of_preset / sizeof *of_preset; i++)
        if (strcmp(config->sensor.preset, "none") == 0 && config_given(config, of_preset[i])) {
            log_error("config: %s: needs a sensor to change; choose one with sensor.preset", of_preset[i]);
            return STATUS_BAD_VALUE;
        }
    if (!*config->terrain.elevation && config->terrain.spacing_m > 0 &&
        !(config->terrain.spacing_m >= 1 && config->terrain.spacing_m <= 30)) {
        log_error("config: terrain.spacing_m: %g is not 0 or 1 .. 30 m for invented ground", config->terrain.spacing_m);
        return STATUS_BAD_VALUE;
    }
    if (!*config->terrain.elevation && (*config->terrain.cover || *config->terrain.orthophoto)) {
        log_error("config: terrain.%s needs terrain.elevation: on invented ground it would lie on other country's hills",
                  *config->terrain.cover ? "cover" : "orthophoto");
        return STATUS_BAD_VALUE;
    }
    if (config->exercise.from_s > config->exercise.to_s) {
        log_error("config: exercise.from_s: %g is after exercise.to_s: %g", config->exercise.from_s,
                  config->exercise.to_s);
        return STATUS_BAD_VALUE;
    }
    return STATUS_OK;
}

void config_text(char *out, size_t out_size, const Config *config)
{
    size_t n = 0;
    for (int i = 0; i < key_count && n < out_size; i++) {
        const char *at = (const char *)config + keys[i].offset;
        double      number;
        long long   whole;
        int         small, written = 0;
        switch (keys[i].type) {
        case KEY_DOUBLE:
            memcpy(&number, at, sizeof number);
            written = snprintf(out + n, out_size - n, "%s=%.17g\n", keys[i].name, number);
            break;
        case KEY_INT:
            memcpy(&small, at, sizeof small);
            written = snprintf(out + n, out_size - n, "%s=%d\n", keys[i].name, small);
            break;
        case KEY_LONG:
            memcpy(&whole, at, sizeof whole);
            written = snprintf(out + n, out_size - n, "%s=%lld\n", keys[i].name, whole);
            break;
        case KEY_BOOL:
            written = snprintf(out + n, out_size - n, "%s=%d\n", keys[i].name, *(const bool *)at);
            break;
        case KEY_TEXT: written = snprintf(out + n, out_size - n, "%s=%s\n", keys[i].name, at); break;
        }
        n += written > 0 ? (size_t)written : 0;
    }
}
