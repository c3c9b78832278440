/* sensor/settings/config.h: everything a user may set, one table: key, unit, range, default, help.
 *
 * A configuration file is YAML, sections of keys. Names of files in it are relative to its own folder. What is absent
 * keeps its default; what is unknown, given twice, or out of range stops the program with file, line, key, value and the
 * accepted range. */
#ifndef SENSOR_SETTINGS_CONFIG_H
#define SENSOR_SETTINGS_CONFIG_H

#include "render/scene/view.h"

enum { config_keys_max = 256, config_paths_size = 4096, config_text_size = 65536 };

typedef struct Config {
    struct {
        int    width_px, height_px;
        double hfov_deg;
        double rate_hz;            /* 0: chosen by what the host is */
        int    samples;            /* a side of a pixel */
        char   antialias[12];      /* adaptive or off */
        int    edge_samples, target_samples; /* a side: of a pixel with an edge; over a small target */
        char   bands[64];          /* comma separated */
        char   optical[8];         /* rgb, pan or nir */
        int    sky_samples;        /* directions a hit; 0: the quick form */
        char   sky_visibility[8];  /* with the quick form: on or off */
        double gimbal_limit_deg, gimbal_rate_dps, gimbal_lag_s;
        char   mount[48];          /* auto, or a part that the sensor goes with */
        double mount_x_m, mount_y_m, mount_z_m; /* NaN: the mount's own */
        double mount_yaw_deg, mount_pitch_deg, mount_roll_deg;
        char   preset[96];         /* none, or names of etc/sensors.csv, comma separated */
        char   table[1024];        /* a sensor's sheet (sensor/detector/sheet.h), or a .csv of sensors; empty: none */
        double lens_k1, lens_k2, lens_k3, lens_p1,
            lens_p2; /* of the picture (render/scene/lens.h); NaN: as the preset says */
        double lateral_r, lateral_b;
    } sensor;
    struct {
        int    bits;
        char   level[8];           /* auto or manual */
        double gain, offset;
        double noise_optical;      /* share of the mean */
        double netd_mwir_k, netd_lwir_k;
        double lwir_low_k, lwir_high_k, mwir_low_k, mwir_high_k; /* manual levels, apparent temperature */
        double optical_high_w_m2_sr;
        double agc_s;              /* automatic level: time constant; 0: each frame by itself */
        double noise;              /* factor of all noise */
        /* over the preset's; NaN: as it says */
        double f_number, obscuration, integration_ms, jitter_px, bad_share, ac_per_line, line_noise;
        bool   smear, raw;         /* of a preset: motion; files of raw counts */
    } detector;
    struct {
        double bin_m;
        int    bins;
        double lobe_deg;
    } radar;
    struct {
        int    port, exercise;     /* exercise -1: the one heard most, -2: all */
        char   utc[32];            /* of the first PDU; empty: chosen */
        char   host[24];           /* an id; munition: those that appear, causal only; observer; empty: chosen */
        char   aim[24];            /* empty: chosen */
        char   from[32], to[32];   /* a moment of sensor/settings/span.h; empty: whole */
        double listen_s;           /* causal: before the choices */
    } exercise;
    struct {
        char   address[64], interface[32];
        int    ttl, queue_mb;
    } network;
    struct {
        int    site, application;  /* who this node is; PDUs of that sender are its own */
    } node;
    struct {
        char   dis[8];             /* off, sensor or truth */
        bool   files, png;
        char   planes[64];         /* of truth: all, none or a list */
        char   pairs[8];           /* off, target or all */
        bool   coco;
        int    coco_min_pixels;    /* smaller and more hidden targets are there to be ignored */
        double coco_min_visible;
    } publish;
    struct {
        char   path[1024];         /* empty: nothing is recorded */
    } record;
    struct {
        char   atmosphere[1024];   /* a folder of etc/atmosphere; with a dot or a slash, any folder */
        double visibility_m, air_temp_k, pressure_mbar, wind_mps, wind_from_deg; /* air_temp_k NaN: the atmosphere's */
    } weather;
    struct {
        double relief_m, spacing_m;
        char   elevation[config_paths_size], vertical[16], geoid[1024];
        char   cover[config_paths_size], cover_table[1024];
        int    cover_band;
        char   orthophoto[config_paths_size];
        char   ground[8];
    } terrain;
    struct {
        double range_m, height_m, rate_dps; /* the stand-off observer */
    } observer;
    struct {
        char   catalog[1024], materials[1024]; /* rows before those of etc/; empty: none */
        double sag_m;
    } models;
    struct {
        double timeout_s, timeout_land_v7_s, extrapolation_limit_s;
        int    capacity, shown, new_per_s;
    } entities;
    struct {
        char   budget[8];          /* off or on */
        double radiance_rmse_percent, temperature_rms_k, frame_ms; /* asked for; NaN: not */
        double machine_factor;
        char   table[1024];        /* empty: etc/quality.csv */
    } quality;
    long long seed;
    bool      causal;
    bool      given[config_keys_max]; /* by a file or the command line: what a preset leaves alone */
} Config;

Config config_default(void);
/* Fills over what is there. On failure logs and leaves the configuration as it was. */
Status config_read(Config *config, const char *path);
/* The same; paths in it are relative to the folder of `file`. */
Status config_read_as(Config *config, const char *path, const char *file);
/* One key, as the command line gives it: `sensor.width_px`, `720`. source names where it came from. */
Status config_set(Config *config, const char *key, const char *value, const char *source);
/* The same as if it stood in that file (YAML of ours): paths are relative to its folder. NULL: to the current one. */
Status config_set_from(Config *config, const char *key, const char *value, const char *source, const char *file);
/* The line on which a file that config_read has read gives a key; 0: it does not. */
int    config_line(const char *key, const char *path);
/* The sheet that sensor.table names; empty: none, or it is a table. */
const char *config_sheet(const Config *config);
/* The user's tables of this configuration from now on (etc_own), for the whole process. */
Status config_own_tables(const Config *config);
/* Whether a file or the command line has set it; the key must exist. */
bool   config_given(const Config *config, const char *key);
/* What a key takes. */
typedef enum ConfigKind { CONFIG_NONE /* there is no such key */, CONFIG_WORD, CONFIG_NUMBER, CONFIG_WHOLE } ConfigKind;
ConfigKind config_kind(const char *key);
/* What sensor.optical says. */
OpticalChannels config_optical(const Config *config);
/* What sensor.antialias says. */
bool   config_adaptive(const Config *config);
/* Ranges that involve several keys. */
Status config_check(const Config *config);
/* A file to begin with: every key with its value, commented out, and what it means. */
void   config_write(FILE *to, const Config *config);
/* A file that reads back as *config: what was given stands there, all else commented out. */
void   config_write_settings(FILE *to, const Config *config);
/* The first key that the two do not have alike, or that only one has been given; NULL: none. */
const char *config_difference(const Config *a, const Config *b);
/* `key = value` of those that were given, a line each, indented. */
void   config_write_given(FILE *to, const Config *config);
/* The canonical text: every key and value, in table order; those that change no picture (network, publish, record, the
 * port, the span of time) as they are by default. What config_sha256 hashes. */
void   config_text(char *out, size_t out_size, const Config *config);

#endif
