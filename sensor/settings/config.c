#include "sensor/settings/config.h"

#include "pitviper_channels.h"

#include "dis/pdu.h"
#include "sensor/settings/plane_choice.h"
#include "sensor/settings/span.h"

#include <errno.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#define AT(member) SETTING_AT(Config, member)

static const Setting keys[] = {
    {"sensor.width_px", SETTING_INT, AT(sensor.width_px), 8, 8192, NULL, "px", "columns of the picture"},
    {"sensor.height_px", SETTING_INT, AT(sensor.height_px), 8, 8192, NULL, "px", "rows of the picture"},
    {"sensor.hfov_deg", SETTING_DOUBLE, AT(sensor.hfov_deg), 0.01, 120, NULL, "deg", "horizontal field of view"},
    {"sensor.rate_hz", SETTING_DOUBLE, AT(sensor.rate_hz), 0, 1000, NULL, "Hz",
     "frames a second; 0: 5 for a munition, 1 for an observer"},
    {"sensor.samples", SETTING_INT, AT(sensor.samples), 1, 16, NULL, "", "rays a side of a pixel"},
    {"sensor.antialias", SETTING_TEXT, AT(sensor.antialias), 0, 0, "adaptive|off", "",
     "more rays at edges and over small targets, or not"},
    {"sensor.edge_samples", SETTING_INT, AT(sensor.edge_samples), 2, 16, NULL, "",
     "rays a side of a pixel where neighbours disagree; adaptive"},
    {"sensor.target_samples", SETTING_INT, AT(sensor.target_samples), 8, 256, NULL, "",
     "rays a side over a target of less than 16 px; adaptive"},
    {"sensor.bands", SETTING_TEXT, AT(sensor.bands), 0, 0, NULL, "", "any of optical,mwir,lwir,radar, and further channels of etc/channels.csv in the place of one of these: swir"},
    {"sensor.optical", SETTING_TEXT, AT(sensor.optical), 0, 0, "rgb|pan|nir", "",
     "three channels or one: visible, or 0.7-1.1 um"},
    {"sensor.sky_samples", SETTING_INT, AT(sensor.sky_samples), 0, 4096, NULL, "",
     "directions a ray's hit asks for light; 0: by its slope, and sky_visibility"},
    {"sensor.sky_visibility", SETTING_TEXT, AT(sensor.sky_visibility), 0, 0, "on|off", "",
     "contact shadows: vehicles and buildings hide sky and ground from what is near them"},
    {"sensor.gimbal_limit_deg", SETTING_DOUBLE, AT(sensor.gimbal_limit_deg), 0, 180, NULL, "deg",
     "largest angle off the body axis"},
    {"sensor.gimbal_rate_dps", SETTING_DOUBLE, AT(sensor.gimbal_rate_dps), 0.01, 10000, NULL, "deg/s", "largest rate"},
    {"sensor.gimbal_lag_s", SETTING_DOUBLE, AT(sensor.gimbal_lag_s), 0, 10, NULL, "s",
     "time constant of the tracking loop"},
    {"sensor.mount", SETTING_TEXT, AT(sensor.mount), 0, 0, NULL, "",
     "what the sensor goes with: auto (nose or roof), or a part of the host: primary turret, primary gun 2, a node's "
     "name"},
    {"sensor.mount_x_m", SETTING_DOUBLE, AT(sensor.mount_x_m), -500, 500, NULL, "m",
     "forward, from the body's origin or the part's pivot; unset: in the nose, on the roof, of a part 0"},
    {"sensor.mount_y_m", SETTING_DOUBLE, AT(sensor.mount_y_m), -500, 500, NULL, "m", "right"},
    {"sensor.mount_z_m", SETTING_DOUBLE, AT(sensor.mount_z_m), -500, 500, NULL, "m", "down"},
    {"sensor.mount_yaw_deg", SETTING_DOUBLE, AT(sensor.mount_yaw_deg), -180, 180, NULL, "deg",
     "the gimbal's axis, right of forward"},
    {"sensor.mount_pitch_deg", SETTING_DOUBLE, AT(sensor.mount_pitch_deg), -90, 90, NULL, "deg", "then up"},
    {"sensor.mount_roll_deg", SETTING_DOUBLE, AT(sensor.mount_roll_deg), -180, 180, NULL, "deg",
     "of the stabilised picture against upright, its right side down"},
    {"sensor.preset", SETTING_TEXT, AT(sensor.preset), 0, 0, NULL, "",
     "none, or sensors of etc/sensors.csv, one a band: staring_lwir,staring_mwir,tv"},
    {"sensor.table", SETTING_PATH, AT(sensor.table), 0, 0, NULL, "",
     "a sensor's data sheet with FLIR92's entries (etc/sensors/example_flir2.sheet), before those of sensor.preset; or "
     "a .csv of your own sensors, as etc/sensors.csv, that sensor.preset names"},
    {"sensor.lens_k1", SETTING_DOUBLE, AT(sensor.lens_k1), -1e6, 1e6, NULL, "",
     "distortion of all bands, as OpenCV has it, tangents off the axis; in place of the first preset's"},
    {"sensor.lens_k2", SETTING_DOUBLE, AT(sensor.lens_k2), -1e9, 1e9, NULL, "", "its fourth order"},
    {"sensor.lens_k3", SETTING_DOUBLE, AT(sensor.lens_k3), -1e12, 1e12, NULL, "", "its sixth order"},
    {"sensor.lens_p1", SETTING_DOUBLE, AT(sensor.lens_p1), -1e3, 1e3, NULL, "", "of a lens off centre"},
    {"sensor.lens_p2", SETTING_DOUBLE, AT(sensor.lens_p2), -1e3, 1e3, NULL, "", "of a lens off centre, columns"},
    {"sensor.lateral_r", SETTING_DOUBLE, AT(sensor.lateral_r), -0.02, 0.02, NULL, "",
     "lateral colour of rgb: magnification of R over G, less 1; three pictures are traced"},
    {"sensor.lateral_b", SETTING_DOUBLE, AT(sensor.lateral_b), -0.02, 0.02, NULL, "", "the same of B"},
    {"detector.bits", SETTING_INT, AT(detector.bits), 8, 16, NULL, "", "8 or 16, of the PNG pictures"},
    {"detector.level", SETTING_TEXT, AT(detector.level), 0, 0, "auto|manual", "",
     "gain and level from the picture, or as set"},
    {"detector.gain", SETTING_DOUBLE, AT(detector.gain), 0.01, 100, NULL, "", "about the middle of the level"},
    {"detector.offset", SETTING_DOUBLE, AT(detector.offset), -1, 1, NULL, "", "in full scales"},
    {"detector.noise_optical", SETTING_DOUBLE, AT(detector.noise_optical), 0, 1, NULL, "",
     "sigma as a share of the mean"},
    {"detector.netd_mwir_k", SETTING_DOUBLE, AT(detector.netd_mwir_k), 0, 10, NULL, "K",
     "noise equivalent temperature difference at 300 K"},
    {"detector.netd_lwir_k", SETTING_DOUBLE, AT(detector.netd_lwir_k), 0, 10, NULL, "K", "the same in 8-12 um"},
    {"detector.mwir_low_k", SETTING_DOUBLE, AT(detector.mwir_low_k), 150, 2000, NULL, "K", "black, manual level"},
    {"detector.mwir_high_k", SETTING_DOUBLE, AT(detector.mwir_high_k), 150, 2000, NULL, "K", "white, manual level"},
    {"detector.lwir_low_k", SETTING_DOUBLE, AT(detector.lwir_low_k), 150, 2000, NULL, "K", "black, manual level"},
    {"detector.lwir_high_k", SETTING_DOUBLE, AT(detector.lwir_high_k), 150, 2000, NULL, "K", "white, manual level"},
    {"detector.optical_high_w_m2_sr", SETTING_DOUBLE, AT(detector.optical_high_w_m2_sr), 1e-3, 1e4, NULL, "W/(m2 sr)",
     "white, manual level"},
    {"detector.agc_s", SETTING_DOUBLE, AT(detector.agc_s), 0, 1000, NULL, "s",
     "time constant of a display's automatic level, from the first frame made on; 0: each frame by itself"},
    {"detector.noise", SETTING_DOUBLE, AT(detector.noise), 0, 100, NULL, "", "factor of all noise; 0: none"},
    {"detector.f_number", SETTING_DOUBLE, AT(detector.f_number), 0.5, 100, NULL, "", "in place of the preset's"},
    {"detector.obscuration", SETTING_DOUBLE, AT(detector.obscuration), 0, 0.95, NULL, "",
     "central, share of the aperture's diameter; in place of the preset's"},
    {"detector.integration_ms", SETTING_DOUBLE, AT(detector.integration_ms), 1e-6, 1e4, NULL, "ms",
     "in place of the preset's"},
    {"detector.jitter_px", SETTING_DOUBLE, AT(detector.jitter_px), 0, 10, NULL, "px",
     "rms a direction, within the integration time; in place of the preset's"},
    {"detector.bad_share", SETTING_DOUBLE, AT(detector.bad_share), 0, 0.2, NULL, "",
     "faulty pixels; in place of the preset's"},
    {"detector.ac_per_line", SETTING_DOUBLE, AT(detector.ac_per_line), 0, 100, NULL, "",
     "cut-off of the AC coupling x line time; in place of the preset's"},
    {"detector.line_noise", SETTING_DOUBLE, AT(detector.line_noise), 0, 100, NULL, "",
     "rms of noise along lines over that of a pixel; in place of the preset's"},
    {"detector.smear", SETTING_BOOL, AT(detector.smear), 0, 1, NULL, "",
     "motion within the integration time and between lines, with a preset"},
    {"detector.raw", SETTING_BOOL, AT(detector.raw), 0, 1, NULL, "", "files of raw counts, with a preset"},
    {"radar.bin_m", SETTING_DOUBLE, AT(radar.bin_m), 0.01, 100, NULL, "m", "range bin of the profile"},
    {"radar.bins", SETTING_INT, AT(radar.bins), 16, 65536, NULL, "", "range bins, about the aim"},
    {"radar.lobe_deg", SETTING_DOUBLE, AT(radar.lobe_deg), 0.2, 30, NULL, "deg", "rms half width of the exit lobe"},
    {"exercise.port", SETTING_INT, AT(exercise.port), -1, 65535, NULL, "",
     "UDP port of the exercise; 0: any; -1: 3000, or any when nothing went there"},
    {"exercise.exercise", SETTING_INT, AT(exercise.exercise), -2, 255, NULL, "",
     "exercise identifier; -1: the one heard most; -2: all as one"},
    {"exercise.utc", SETTING_TEXT, AT(exercise.utc), 0, 0, NULL, "",
     "date and time of the first PDU, 2026-06-21T10:00:00Z"},
    {"exercise.host", SETTING_TEXT, AT(exercise.host), 0, 0, NULL, "",
     "site:application:entity that carries the sensor; observer: a stand-off one; munition: those that appear, guided "
     "ones first, one after the other"},
    {"exercise.aim", SETTING_TEXT, AT(exercise.aim), 0, 0, NULL, "", "site:application:entity it looks at"},
    {"exercise.from_s", SETTING_TEXT, AT(exercise.from), 0, 0, NULL, "s",
     "first exercise time of interest; +12: 12 s after the recording's beginning, -5: 5 s before its end"},
    {"exercise.to_s", SETTING_TEXT, AT(exercise.to), 0, 0, NULL, "s", "last exercise time of interest, in the same ways"},
    {"exercise.listen_s", SETTING_DOUBLE, AT(exercise.listen_s), 0.05, 600, NULL, "s",
     "heard before host, ground and time of day are chosen, from the first entity on; run, replay --causal"},
    {"exercise.causal", SETTING_BOOL, AT(causal), 0, 1, NULL, "", "use only what had been received by each frame"},
    {"network.address", SETTING_TEXT, AT(network.address), 0, 0, NULL, "",
     "of the exercise, in numbers: a multicast group, a broadcast, a host; empty: hear all, send to 255.255.255.255"},
    {"network.interface", SETTING_TEXT, AT(network.interface), 0, 0, NULL, "",
     "name, eth0; empty: the system's choice"},
    {"network.ttl", SETTING_INT, AT(network.ttl), 0, 255, NULL, "", "hops of multicast; 0: this machine alone"},
    {"network.queue_mb", SETTING_INT, AT(network.queue_mb), 1, 1024, NULL, "MiB",
     "of PDUs that wait while a frame is made; more are lost, and counted"},
    {"node.site", SETTING_INT, AT(node.site), 1, 65533, NULL, "",
     "who this node is on the network; what that sender says is its own, and ignored"},
    {"node.application", SETTING_INT, AT(node.application), 1, 65533, NULL, "", "the same"},
    {"publish.dis", SETTING_TEXT, AT(publish.dis), 0, 0, "off|sensor|truth", "",
     "a Data PDU a frame and band: nothing; what a seeker could measure; with ids and ranges"},
    {"publish.files", SETTING_BOOL, AT(publish.files), 0, 1, NULL, "",
     "pictures into files; truth.jsonl and run.json are written in any case"},
    {"publish.png", SETTING_BOOL, AT(publish.png), 0, 1, NULL, "", "display pictures beside the EXR ones"},
    {"publish.planes", SETTING_TEXT, AT(publish.planes), 0, 0, NULL, "",
     "of truth per pixel into files: all, none, or any of range,entity,part,material,temperature,normal"},
    {"publish.pairs", SETTING_TEXT, AT(publish.pairs), 0, 0, "off|target|all", "",
     "in a replay: each frame also without what it looks at, or without any entity, and both without noise"},
    {"publish.coco", SETTING_BOOL, AT(publish.coco), 0, 1, NULL, "", "in a replay: coco.json, boxes and masks of what is seen"},
    {"publish.coco_min_pixels", SETTING_INT, AT(publish.coco_min_pixels), 1, 1000000, NULL, "px",
     "targets with fewer pixels in their masks are marked in coco.json to be ignored (iscrowd)"},
    {"publish.coco_min_visible", SETTING_DOUBLE, AT(publish.coco_min_visible), 0, 1, NULL, "",
     "the same for those of which less than this share is seen"},
    {"record.path", SETTING_PATH, AT(record.path), 0, 0, NULL, "", "pcapng file for all that `run` hears; empty: none"},
    {"weather.atmosphere", SETTING_NAME_OR_PATH, AT(weather.atmosphere), 0, 0, NULL, "",
     "us1976, midlat_summer, or another of etc/atmosphere; or a folder as those, ./NAME"},
    {"weather.visibility_m", SETTING_DOUBLE, AT(weather.visibility_m), 100, 300000, NULL, "m", "meteorological range"},
    {"weather.air_temp_k", SETTING_DOUBLE, AT(weather.air_temp_k), 220, 330, NULL, "K",
     "at the ground of the terrain's origin; with height as the atmosphere's; unset: its own"},
    {"weather.pressure_mbar", SETTING_DOUBLE, AT(weather.pressure_mbar), 300, 1100, NULL, "mbar", ""},
    {"weather.wind_mps", SETTING_DOUBLE, AT(weather.wind_mps), 0, 60, NULL, "m/s",
     "cools ground and vehicles, at once; drives smoke"},
    {"weather.wind_from_deg", SETTING_DOUBLE, AT(weather.wind_from_deg), 0, 360, NULL, "deg",
     "where the wind comes from, clockwise from north"},
    {"terrain.relief_m", SETTING_DOUBLE, AT(terrain.relief_m), 0, 200, NULL, "m", "rms height of the invented hills"},
    {"terrain.spacing_m", SETTING_DOUBLE, AT(terrain.spacing_m), 0, 1000, NULL, "m",
     "between elevation posts; 0: 4 invented, else the files' own"},
    {"terrain.elevation", SETTING_PATHS, AT(terrain.elevation), 0, 0, NULL, "",
     "elevation files or folders, separated by commas; empty: invented ground"},
    {"terrain.vertical", SETTING_TEXT, AT(terrain.vertical), 0, 0, "auto|geoid|ellipsoid", "",
     "what their heights are above; auto: as their CRS says, else the geoid"},
    {"terrain.geoid", SETTING_PATH, AT(terrain.geoid), 0, 0, NULL, "", "a .gtx grid; empty: EGM96 of proj-data"},
    {"terrain.cover", SETTING_PATHS, AT(terrain.cover), 0, 0, NULL, "",
     "ground cover files or folders; empty: by slope and height"},
    {"terrain.cover_table", SETTING_NAME_OR_PATH, AT(terrain.cover_table), 0, 0, NULL, "",
     "worldcover, nlcd, fbfm40 or a CSV of code, surface; empty: by the codes met"},
    {"terrain.cover_band", SETTING_INT, AT(terrain.cover_band), 0, 1000, NULL, "",
     "band of the cover files; 0: 4 of landscape files (8 bands), else 1"},
    {"terrain.orthophoto", SETTING_PATHS, AT(terrain.orthophoto), 0, 0, NULL, "",
     "photographs of the ground from above, files or folders"},
    {"terrain.ground", SETTING_TEXT, AT(terrain.ground), 0, 0, "auto|clamp|trust|fit", "",
     "set who stands on the ground onto it, leave them, or lead the ground through them; auto: fit invented ground and "
     "set onto it whom it does not fit, clamp to real"},
    {"observer.range_m", SETTING_DOUBLE, AT(observer.range_m), 10, 100000, NULL, "m",
     "of the stand-off observer, along the ground"},
    {"observer.height_m", SETTING_DOUBLE, AT(observer.height_m), 1, 20000, NULL, "m", "above what it looks at"},
    {"observer.rate_dps", SETTING_DOUBLE, AT(observer.rate_dps), -60, 60, NULL, "deg/s",
     "of its circle, clockwise from above"},
    {"models.catalog", SETTING_PATH, AT(models.catalog), 0, 0, NULL, "",
     "your own rows before those of etc/catalog.csv: which model an entity type gets"},
    {"models.materials", SETTING_PATH, AT(models.materials), 0, 0, NULL, "",
     "your own rows before those of etc/materials.csv"},
    {"models.sag_m", SETTING_DOUBLE, AT(models.sag_m), 1e-5, 0.1, NULL, "m",
     "largest distance of a facet from its surface"},
    {"entities.timeout_s", SETTING_DOUBLE, AT(entities.timeout_s), 0.1, 1e5, NULL, "s",
     "silence after which an entity is gone"},
    {"entities.timeout_land_v7_s", SETTING_DOUBLE, AT(entities.timeout_land_v7_s), 0.1, 1e5, NULL, "s",
     "the same for land entities of version 7"},
    {"entities.extrapolation_limit_s", SETTING_DOUBLE, AT(entities.extrapolation_limit_s), 0.01, 1e4, NULL, "s",
     "longest dead reckoning"},
    {"entities.capacity", SETTING_INT, AT(entities.capacity), 1, 1000000, NULL, "",
     "most entities at once; beyond, the sender with the most gives up its farthest and stalest"},
    {"entities.shown", SETTING_INT, AT(entities.shown), 1, 1000000, NULL, "",
     "most entities in a frame: those whose reports lie nearest the host's"},
    {"quality.budget", SETTING_TEXT, AT(quality.budget), 0, 0, "off|on", "",
     "each frame's estimate of its own error, in truth.jsonl; changes no picture"},
    {"quality.radiance_rmse_percent", SETTING_DOUBLE, AT(quality.radiance_rmse_percent), 0.01, 1000, NULL, "%",
     "largest error of sampling, rms over the band's mean: picks sensor.samples, edge_samples, target_samples, antialias"},
    {"quality.temperature_rms_k", SETTING_DOUBLE, AT(quality.temperature_rms_k), 1e-3, 1000, NULL, "K",
     "the same in apparent temperature, of the thermal bands"},
    {"quality.frame_ms", SETTING_DOUBLE, AT(quality.frame_ms), 0.01, 1e6, NULL, "ms",
     "time that a frame's rays may take, by the table's times quality.machine_factor"},
    {"quality.machine_factor", SETTING_DOUBLE, AT(quality.machine_factor), 0.001, 1000, NULL, "",
     "time on this machine over that in the table; run measures it when it is not given"},
    {"quality.table", SETTING_PATH, AT(quality.table), 0, 0, NULL, "",
     "settings with their errors and times, by `pitviper bench quality --table FILE`; empty: etc/quality.csv"},
    {"seed", SETTING_LONG, AT(seed), 0, 2147483647, NULL, "", "of everything random"},
};
enum { key_count = sizeof keys / sizeof keys[0] };
_Static_assert((int)key_count <= (int)config_keys_max, "Config.given is too small");
static const SettingTable table = {.module = "config", .row = keys, .count = key_count,
                                   .all_keys = "`pitviper check --default`"};

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
    strcpy(c.sensor.sky_visibility, "on");
    strcpy(c.sensor.antialias, "adaptive");
    strcpy(c.sensor.mount, "auto");
    c.sensor.mount_x_m = c.sensor.mount_y_m = c.sensor.mount_z_m = NAN;
    strcpy(c.detector.level, "auto");
    c.detector.agc_s                = 2; /* a level that follows at once flickers: tests/system/test_level.sh */
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
    c.sensor.lens_k1 = c.sensor.lens_k2 = c.sensor.lens_k3 = c.sensor.lens_p1 = c.sensor.lens_p2 = NAN;
    c.sensor.lateral_r = c.sensor.lateral_b = NAN;
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
    c.exercise.listen_s             = 2;
    c.network.ttl                   = 1;
    c.network.queue_mb              = 256; /* a million Entity States; touched as far as it is ever needed */
    c.node.site                     = 4711;
    c.node.application              = 1;
    strcpy(c.publish.dis, "off");
    strcpy(c.publish.pairs, "off");
    strcpy(c.publish.planes, "all");
    c.publish.files                 = true;
    c.publish.png                   = true;
    c.publish.coco_min_pixels       = 1;
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
    c.entities.shown                = 2000;
    strcpy(c.quality.budget, "on");
    c.quality.radiance_rmse_percent = c.quality.temperature_rms_k = c.quality.frame_ms = NAN;
    c.quality.machine_factor        = 1;
    c.seed                          = 1;
    return c;
}

OpticalChannels config_optical(const Config *config)
{
    /* a channel that stands in nir's place is what there is of the band */
    return strcmp(config->sensor.optical, "nir") == 0 || !channel_in(SPECTRAL_NIR)->standard ? OPTICAL_NIR
           : strcmp(config->sensor.optical, "rgb") == 0                                     ? OPTICAL_RGB
                                                                                            : OPTICAL_PAN;
}

bool config_adaptive(const Config *config) { return strcmp(config->sensor.antialias, "adaptive") == 0; }

bool config_given(const Config *config, const char *name) { return config->given[settings_find(&table, name)]; }

ConfigKind config_kind(const char *name)
{
    const int row = settings_find(&table, name);
    if (row < 0) return CONFIG_NONE;
    return keys[row].type == SETTING_DOUBLE                                          ? CONFIG_NUMBER
           : keys[row].type == SETTING_INT || keys[row].type == SETTING_LONG ? CONFIG_WHOLE
                                                                                     : CONFIG_WORD;
}

Status config_set(Config *config, const char *name, const char *value, const char *source)
{
    return settings_set(config, config->given, &table, name, value, source);
}

Status config_set_from(Config *config, const char *name, const char *value, const char *source, const char *file)
{
    return settings_set_from(config, config->given, &table, name, value, source, file);
}

int config_line(const char *name, const char *path) { return settings_line(&table, name, path); }

/* Of a .csv: sensors for sensor.preset; of anything else: one sensor. */
static bool table_has_rows(const Config *config)
{
    const size_t length = strlen(config->sensor.table);
    return length > 4 && strcasecmp(config->sensor.table + length - 4, ".csv") == 0;
}

const char *config_sheet(const Config *config) { return table_has_rows(config) ? "" : config->sensor.table; }

static bool is_readable(const char *key, const char *path)
{
    struct stat about;
    const int   failed = !*path || access(path, R_OK) == 0 ? 0 : errno;
    const bool  file = !*path || stat(path, &about) != 0 || S_ISREG(about.st_mode);
    if (failed == 0 && file) return true;
    log_error("config: %s: cannot read %s: %s; in a file of settings paths are relative to that file, on the command line "
              "to the folder you are in", key, path, file ? strerror(failed) : "it is no file");
    return false;
}

Status config_own_tables(const Config *config)
{
    if (!is_readable("models.catalog", config->models.catalog) ||
        !is_readable("models.materials", config->models.materials) || !is_readable("sensor.table", config->sensor.table))
        return STATUS_BAD_VALUE;
    const bool fits = etc_own_set("catalog.csv", config->models.catalog) &&
                      etc_own_set("materials.csv", config->models.materials) &&
                      etc_own_set("sensors.csv", table_has_rows(config) ? config->sensor.table : NULL);
    return fits ? STATUS_OK : STATUS_BAD_VALUE;
}

Status config_read(Config *config, const char *path) { return config_read_as(config, path, path); }

Status config_read_as(Config *config, const char *path, const char *file)
{
    Config       filled = *config;
    const Status status = settings_read_as(&filled, filled.given, &table, path, file);
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
        if (strcmp(config->sensor.preset, "none") == 0 && !*config_sheet(config) &&
            config_given(config, of_preset[i])) {
            log_error("config: %s: needs a sensor to change; choose one with sensor.preset or sensor.table",
                      of_preset[i]);
            return STATUS_BAD_VALUE;
        }
    if (table_has_rows(config) && strcmp(config->sensor.preset, "none") == 0) {
        log_error("config: sensor.table: %s is a table of sensors; sensor.preset says which of its rows to take",
                  config->sensor.table);
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
    const bool pairs = strcmp(config->publish.pairs, "off") != 0;
    if ((pairs || config->publish.coco) && !config->publish.files) {
        log_error("config: publish.%s: needs pictures in files; set publish.files: true", pairs ? "pairs" : "coco");
        return STATUS_BAD_VALUE;
    }
    DisEntityId id;
    double      unix_s;
    unsigned    planes;
    if (!plane_choice_parse(&planes, config->publish.planes)) {
        log_error("config: publish.planes: '%s' is not all, none, or a list of range, entity, part, material, temperature, "
                  "normal, for example range,entity", config->publish.planes);
        return STATUS_BAD_VALUE;
    }
    if (!*config->sensor.mount) {
        log_error("config: sensor.mount: has no name; auto, or a part of the host such as `primary turret`");
        return STATUS_BAD_VALUE;
    }
    if (*config->exercise.host && strcmp(config->exercise.host, "munition") != 0 &&
        strcmp(config->exercise.host, "observer") != 0 && !dis_entity_id_parse(&id, config->exercise.host)) {
        log_error("config: exercise.host: '%s' is neither site:application:entity, for example 1:3001:82, nor munition "
                  "nor observer", config->exercise.host);
        return STATUS_BAD_VALUE;
    }
    if (*config->exercise.aim && !dis_entity_id_parse(&id, config->exercise.aim)) {
        log_error("config: exercise.aim: '%s' is not site:application:entity, for example 1:3001:82",
                  config->exercise.aim);
        return STATUS_BAD_VALUE;
    }
    if (*config->exercise.utc && !text_to_unix_s(&unix_s, config->exercise.utc)) {
        log_error("config: exercise.utc: '%s' is not a time such as 2026-06-21T10:00:00Z, 1900 .. 2100",
                  config->exercise.utc);
        return STATUS_BAD_VALUE;
    }
    const char *const moment[2] = {config->exercise.from, config->exercise.to};
    for (int i = 0; i < 2; i++)
        if (!span_good(moment[i])) {
            log_error("config: exercise.%s: '%s' is not a number of seconds: 3471.5 is exercise time, +12 is from the "
                      "recording's beginning, -5 from its end", i ? "to_s" : "from_s", moment[i]);
            return STATUS_BAD_VALUE;
        }
    if (span_backward(config->exercise.from, config->exercise.to)) {
        log_error("config: exercise.from_s: %s is after exercise.to_s: %s", config->exercise.from, config->exercise.to);
        return STATUS_BAD_VALUE;
    }
    return STATUS_OK;
}

void config_text(char *out, size_t out_size, const Config *config)
{
    const Config plain  = config_default();
    Config       hashed = *config;
    hashed.network         = plain.network;
    hashed.publish         = plain.publish;
    hashed.record          = plain.record;
    hashed.exercise.port   = plain.exercise.port;
    memcpy(hashed.exercise.from, plain.exercise.from, sizeof hashed.exercise.from);
    memcpy(hashed.exercise.to, plain.exercise.to, sizeof hashed.exercise.to);
    hashed.quality         = plain.quality; /* of the settings that it picks each is hashed */
    settings_absolute(&hashed, &table);
    settings_text(out, out_size, &table, &hashed);
}

void config_write(FILE *to, const Config *config)
{
    static const bool none[key_count] = {false};
    fputs("# Settings of pitviper " PITVIPER_VERSION ". Every key stands here with its default, behind a #: take that away to\n"
          "# change it. A key without a value is chosen by the program, which prints its choice. `pitviper check FILE`\n"
          "# says whether a file is good.\n", to);
    settings_write(to, &table, config, none);
}

const char *config_difference(const Config *a, const Config *b)
{
    char in_a[8192], in_b[8192];
    for (int i = 0; i < key_count; i++) {
        const SettingTable one = {.module = table.module, .row = &keys[i], .count = 1};
        settings_text(in_a, sizeof in_a, &one, a);
        settings_text(in_b, sizeof in_b, &one, b);
        if (strcmp(in_a, in_b) != 0 || a->given[i] != b->given[i]) return keys[i].name;
    }
    return NULL;
}

void config_write_settings(FILE *to, const Config *config)
{
    Config absolute = *config;
    settings_absolute(&absolute, &table);
    settings_write(to, &table, &absolute, config->given);
}

void config_write_given(FILE *to, const Config *config)
{
    char  text[config_text_size];
    char *at = text;
    settings_text(text, sizeof text, &table, config);
    for (int i = 0; i < key_count && *at; i++) {
        char *end = strchr(at, '\n'), *equals = strchr(at, '=');
        if (!end || !equals) return;
        if (config->given[i])
            fprintf(to, "  %.*s = %.*s%s%s\n", (int)(equals - at), at, (int)(end - equals - 1), equals + 1,
                    *keys[i].unit ? " " : "", keys[i].unit);
        at = end + 1;
    }
}
