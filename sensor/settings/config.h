/* sensor/settings/config.h: all settings, in one table: key, unit, range, default, help.
 *
 * A configuration file is YAML, sections of keys. Names of files in it are relative to its own folder. A missing key
 * keeps its default; an unknown or repeated key or a value out of range is an error with file, line, key, value and the
 * accepted range; all of them are reported. */
#ifndef SENSOR_SETTINGS_CONFIG_H
#define SENSOR_SETTINGS_CONFIG_H

#include "render/scene/view.h"
#include "pitviper.h"

enum { config_keys_max = 256, config_paths_size = 4096, config_text_size = 65536 };

typedef struct Config {
    struct {
        int    width_px, height_px;
        double hfov_deg;
        double rate_hz;                      /* 0: chosen by the kind of host */
        int    samples;                      /* N: N x N rays per pixel */
        char   antialias[12];                /* adaptive or off */
        int    edge_samples, target_samples; /* rays per side: of an edge pixel; over a small target */
        char   bands[64];                    /* comma separated */
        char   optical[8];                   /* rgb, pan or nir */
        int    sky_samples;                  /* directions per hit; 0: closed form */
        char   sky_visibility[8];            /* with the closed form: on or off */
        double gimbal_limit_deg, gimbal_rate_dps, gimbal_lag_s;
        char   mount[48];                       /* auto, or a part of the host */
        double mount_x_m, mount_y_m, mount_z_m; /* NaN: the mount's own */
        double mount_yaw_deg, mount_pitch_deg, mount_roll_deg;
        char   preset[96];  /* none, or names of etc/sensors.csv, comma separated */
        char   table[1024]; /* a sensor's sheet (sensor/detector/preset.h), or a .csv of sensors; empty: none */
        double lens_k1, lens_k2, lens_k3, lens_p1, lens_p2; /* of the image (render/scene/view.h); NaN: of the preset */
        double lateral_r, lateral_b;
    } sensor;
    struct {
        int    bits;
        char   level[16]; /* auto, plateau or manual */
        double plateau;   /* share of the pixels that counts in a bin */
        double gain, offset;
        double noise_optical; /* share of the mean */
        double netd_mwir_k, netd_lwir_k;
        double lwir_low_k, lwir_high_k, mwir_low_k, mwir_high_k; /* manual levels, apparent temperature */
        double optical_high_w_m2_sr;
        double agc_s; /* automatic level: time constant; 0: each frame by itself */
        double noise; /* factor of all noise */
        /* overrides of the preset; NaN: none */
        double f_number, obscuration, integration_ms, jitter_px, bad_share, ac_per_line, line_noise;
        bool   smear, raw; /* of a preset: motion; files of raw counts */
    } detector;
    struct {
        double bin_m;
        int    bins;
        double lobe_deg;
        char   preset[32];    /* a row of etc/radars.csv, or of `table`; none */
        char   table[1024];   /* radars in place of etc/radars.csv; empty: none */
        bool   ground;        /* of the preset: the ground scatters */
        bool   ground_bounce; /* with a preset: the ground mirrors entities */
        double warp_mm;       /* with a preset: unevenness of surfaces */
        char   given[256];    /* with a preset: list of signatures that are given; empty: none */
        char   library[1024]; /* with a preset: a folder of targets' signatures; empty: none */
        double chaff_dipoles; /* with a preset: resonant dipoles in a cloud of chaff */
        double scan_deg,
            scan_step; /* with a preset: sector that the beam sweeps, 0: it stares; step over the beamwidth */
    } radar;
    struct {
        int    port, exercise;   /* exercise -1: the one with the most PDUs, -2: all */
        char   utc[32];          /* of the first PDU; empty: chosen */
        char   local_solar[32];  /* likewise, in mean solar time; not with utc */
        char   host[24];         /* an id; munition: munitions as they appear, causal only; observer; empty: chosen */
        char   aim[24];          /* empty: chosen */
        char   from[32], to[32]; /* a time as in sensor/settings/config.h; empty: no limit */
        double listen_s;         /* causal: time until the choices are made */
    } exercise;
    struct {
        char address[64], interface[32];
        int  ttl, queue_mb;
    } network;
    struct {
        int site, application; /* of this node; PDUs of that sender are ignored */
    } node;
    struct {
        char   dis[8]; /* off, sensor or truth */
        bool   files, png;
        char   planes[64]; /* of truth: all, none or a list */
        char   pairs[8];   /* off, target or all */
        bool   coco;
        int    coco_min_pixels; /* targets below any of these are ignore regions */
        double coco_min_visible, coco_min_snr;
        bool   truth;                    /* truth.jsonl, and the hash of each frame */
        bool   latest;                   /* OUT/latest: the newest display of each band */
        char   video[config_paths_size]; /* a file (.mp4, .mkv, .ts) or a folder; empty: none */
        char   video_codec[16];          /* h264, h264-10, hevc-12 or ffv1 */
        char   video_labels[8];          /* off, bands or targets: drawn into videos and streams */
        char   stream[128];              /* udp://HOST:PORT; empty: none */
        char   klv[8];                   /* async, sync or off */
        char   vmti[8];                  /* atr, truth or off */
        bool   klv_files;                /* OUT/BAND.klv */
        char   memory[64];               /* name of the shared memory; empty: none */
        char   memory_planes[8];         /* float or counts */
        char   memory_record[8];         /* sensor or truth */
        int    memory_slots;
        int    detections_port; /* UDP, loopback; 0: none */
    } publish;
    struct {
        char path[1024]; /* empty: nothing is recorded */
    } record;
    struct {
        char   atmosphere[1024]; /* a folder of etc/atmosphere; with a dot or a slash, any folder */
        char   day[1024];        /* clear, constant or a file */
        double visibility_m, air_temp_k, pressure_mbar, wind_mps, wind_from_deg; /* air_temp_k NaN: the atmosphere's */
        double air_range_k, humidity_pct, cloud, rain_mmh;
    } weather;
    struct {
        double step_s;         /* of the ground's state */
        double vehicle_step_s; /* longest step of the vehicles' heat */
        int    facets;         /* normals of the ground, a side */
        double shadow_m;       /* cells of the shadow map; 0: none */
        char   given[1024];    /* file of temperatures of parts; empty: none */
        char   vehicles[1024]; /* file of their temperatures over a restart; empty: none */
        char   marks[1024];    /* file of ground marks over a restart; empty: none */
    } heat;
    struct {
        double relief_m, spacing_m;
        char   store[1024]; /* a terrain store; empty: none */
        char   elevation[config_paths_size], vertical[16], geoid[1024];
        char   cover[config_paths_size], cover_table[1024];
        int    cover_band;
        char   orthophoto[config_paths_size];
        char   sources_from[config_paths_size];
        char   ground[8];
        char   detail[8];                 /* on or off: noise of the ground */
        char   woods[8], woods_leaves[8]; /* on or off: trees and other plants; their leaves in winter */
        int    woods_trees;               /* at most */
        double woods_half_m;              /* half width of the square in which they stand; 0: chosen */
        double woods_low_m;               /* reach of low plants about the eye; 0: none */
        double woods_sway, woods_level1_px;
    } terrain;
    struct {
        double range_m, height_m, rate_dps; /* the stand-off observer */
    } observer;
    struct {
        char   catalog[1024], materials[1024]; /* rows that take precedence over those of etc/; empty: none */
        double sag_m;
    } models;
    struct {
        double timeout_s, timeout_land_v7_s, extrapolation_limit_s;
        int    capacity, shown, new_per_s;
    } entities;
    struct {
        char   budget[8];                                          /* off or on */
        double radiance_rmse_percent, temperature_rms_k, frame_ms; /* targets; NaN: none */
        double machine_factor;
        char   table[1024]; /* empty: etc/quality.csv */
    } quality;
    long long seed;
    bool      causal;
    bool      given[config_keys_max]; /* set by a file or the command line: not changed by a preset */
    /* For messages: the last file read, empty where its name is longer, and which keys were set after it. */
    char file[512];
    bool later[config_keys_max];
} Config;

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
 * plane (network, publish, record, port, time span) have their defaults in it. */
void config_text(char *out, size_t out_size, const Config *config);

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
