/* sensor/commands/check_command.c: `pitviper check`: validates configuration files and every table and model that
 * they lead to. */
#include "sensor/commands/commands.h"
#include "sensor/node/cigi/cigi_types.h"

#include "entities/scenery/scenery_clutter.h"
#include "entities/traces/effect_history.h"
#include "render/heat/given_heat.h"
#include "render/scattering/signatures/given_signature.h"
#include "render/heat/part_table.h"
#include "sensor/detector/preset.h"
#include "sensor/frame/frame_world.h"
#include "sensor/node/run/host_run.h"
#include "sensor/radar/radar_preset.h"
#include "terrain/weather/weather.h"
#include "terrain/earth/geoid.h"
#include "terrain/ground/ground_image.h"
#include "terrain/from_files/culture_import.h"
#include "terrain/from_files/elevation_import.h"
#include "terrain/store/store.h"
#include "sensor/settings/command_line.h"

#include <errno.h>
#include <stdio.h>

static const char help[] =
    "usage: pitviper check FILE ...\n"
    "       pitviper check --default > node.yaml\n"
    "\n"
    "Reads configuration files as `replay` and `run` do, and lists the keys that they set, or what is wrong: file, "
    "line,\n"
    "key, value and what is accepted. Then validates the tables: the catalog with its models and sidecars, materials,\n"
    "sensors, atmosphere, and files of elevation and land cover, which must exist and be readable.\n"
    "\n"
    "  --default          print every key with its default, unit, range and meaning: a file to start from\n";

/* ---- tables and models ------------------------------------------------------------------ */

typedef struct Check {
    const char   *path;
    const Config *config;
    Catalog      *catalog;
} Check;

/* Tables already validated for an earlier file are not read again. */
static struct {
    bool   bundled, models;
    char   air[frame_model_size];
    double visibility_m;
} known;

/* Logs the setting that led to a table or model, after the error itself. Returns false. */
static bool report(const Check *c, const char *key, const char *next)
{
    const int line = config_line(key, c->path);
    if (line > 0) log_error("check: %s:%d: %s: see the error above; %s", c->path, line, key, next);
    else log_error("check: %s: %s (default): see the error above; %s", c->path, key, next);
    return false;
}

static bool is_bundled(const Check *c, const char *name, Status (*read)(const char *path))
{
    char path[4096];
    if (etc_path(path, sizeof path, name) && read(path) == STATUS_OK) return true;
    log_error("check: %s: the bundled table etc/%s cannot be used, see the error above; reinstall it, or correct the "
              "folder that PITVIPER_ETC names",
              c->path, name);
    return false;
}

static Status read_heat(const char *path)
{
    PartTable table;
    return part_table_roles(&table, path);
}

static Status read_machines(const char *path)
{
    PartTable table;
    return part_table_machines(&table, path);
}

static Status read_effects(const char *path)
{
    EffectHistory *history = NULL;
    const Status   status = effect_history_create(&history, path);
    effect_history_destroy(history);
    return status;
}

/* Opens every sheet with GDAL and reads a small window of each; of heights as much as before they are used. */
static bool sheets_are_valid(const Check *c, const char *paths, const char *key, bool heights)
{
    enum { side = 16 };
    static float piece[side * side];
    RasterSet    set = {0};
    if (!*paths) return true;
    raster_sources_from(c->config->terrain.sources_from);
    Status status = raster_set_open(&set, paths, key);
    for (int i = 0; heights && i < set.count && status == STATUS_OK; i++) {
        ElevationSurvey survey;
        status = elevation_survey(&survey, &set.raster[i], key, NULL);
    }
    for (int i = 0; i < set.count && status == STATUS_OK; i++)
        for (int k = 0; k < set.raster[i].sheet_count && status == STATUS_OK; k++) {
            const RasterSheet *sheet = &set.raster[i].sheet[k];
            status = raster_read(piece, &set.raster[i], 1,
                                 (RasterWindow){sheet->x0 + sheet->width / 2 - side / 2,
                                                sheet->y0 + sheet->height / 2 - side / 2, side, side},
                                 key);
        }
    raster_set_close(&set);
    return status == STATUS_OK || report(c, key,
                                         "paths in a configuration file are relative to that file; `gdalinfo "
                                         "FILE` "
                                         "shows whether GDAL can read one");
}

static bool store_is_valid(const Check *c)
{
    TerrainStore store;
    if (!*c->config->terrain.store) return true;
    if (store_open(&store, c->config->terrain.store) != STATUS_OK)
        return report(c, "terrain.store", "`pitviper terrain info FILE` looks into a terrain store");
    store_close(&store);
    return true;
}

static bool terrain_is_valid(const Check *c)
{
    const Config *config = c->config;
    const char   *table = config->terrain.cover_table;
    bool          good = sheets_are_valid(c, config->terrain.elevation, "terrain.elevation", true);
    good &= store_is_valid(c);
    good &= sheets_are_valid(c, config->terrain.cover, "terrain.cover", false);
    good &= sheets_are_valid(c, config->terrain.orthophoto, "terrain.orthophoto", false);
    if (strpbrk(table, "/.")) {
        if (surface_table_check(table) != STATUS_OK)
            good = report(c, "terrain.cover_table", "etc/cover_worldcover.csv is an example");
    }
    if (*config->terrain.geoid) {
        Geoid geoid = {0};
        if (geoid_open(&geoid, config->terrain.geoid) != STATUS_OK)
            good = report(c, "terrain.geoid", "omit it to use EGM96 of proj-data");
        else geoid_close(&geoid);
    }
    return good;
}

static bool culture_is_valid(const Check *c)
{
    const char *files = strpbrk(c->config->terrain.buildings, "/.") ? c->config->terrain.buildings : "";
    const char *trees = c->config->terrain.trees;
    raster_sources_from(c->config->terrain.sources_from);
    return (!*files && !*trees) || culture_files_good(files, trees) ||
           report(c, *files ? "terrain.buildings" : "terrain.trees",
                  "`pitviper terrain culture FILE` lists what it holds");
}

static bool clutter_is_valid(const Check *c)
{
    char path[1024];
    return (clutter_table_path(path, sizeof path, c->config->terrain.clutter_table) &&
            scenery_clutter_check(path) == STATUS_OK) ||
           report(c, "terrain.clutter_table", "rear_area, countryside, or a CSV as etc/clutter.csv");
}

static bool atmosphere_is_valid(const Check *c)
{
    Atmosphere   *atmosphere = NULL;
    const Config *config = c->config;
    const double  visibility_m = droplets_haze_m(config->weather.visibility_m, frame_world_fog(config));
    char          model[frame_model_size];
    const bool    named = frame_world_model(model, config) == STATUS_OK;
    if (named && strcmp(known.air, model) == 0 && known.visibility_m == visibility_m) return true;
    const bool there = named && atmosphere_open_at(&atmosphere, model, visibility_m) == STATUS_OK;
    atmosphere_close(atmosphere);
    if (there) {
        snprintf(known.air, sizeof known.air, "%s", model);
        known.visibility_m = visibility_m;
    }
    return there || report(c, "weather.atmosphere", "us1976 is always available");
}

static bool weather_is_valid(const Check *c)
{
    WeatherCourse            *course;
    const WeatherCourseConfig about = {weather_default(), c->config->weather.air_range_k, 0, 0};
    if (!strpbrk(c->config->weather.day, "/.")) return true;
    if (weather_course_open(&course, c->config->weather.day, &about) != STATUS_OK)
        return report(c, "weather.day", "clear is always available; etc/reference/weather.md has the formats");
    weather_course_close(course);
    return true;
}

static bool given_heat_is_valid(const Check *c)
{
    GivenHeat *given;
    if (!*c->config->heat.given) return true;
    if (given_heat_open(&given, c->config->heat.given) != STATUS_OK)
        return report(c, "heat.given", "empty is always right; etc/reference/vehicle_heat.md has an example");
    given_heat_close(given);
    return true;
}

static bool given_signatures_are_valid(const Check *c)
{
    GivenList *given;
    if (!*c->config->radar.given) return true;
    if (given_list_open(&given, c->config->radar.given) != STATUS_OK)
        return report(c, "radar.given", "empty is always right; etc/reference/radar_seeker.md has an example");
    given_list_close(given);
    return true;
}

/* Checks the catalog, its models and sidecars, and the materials of their parts. */
static bool models_are_valid(Check *c)
{
    /* built-in shapes are valid at any chord error; model files are read in full */
    static const double coarse_chord_error_m = 0.1;
    char                catalog[4096], materials[4096], surfaces[4096];
    Materials           read = {0};
    const bool          own = etc_own("catalog.csv") || etc_own("materials.csv");
    if (known.models && !own) return true;
    if (!etc_path(catalog, sizeof catalog, "catalog.csv") || !etc_path(materials, sizeof materials, "materials.csv") ||
        !etc_path(surfaces, sizeof surfaces, "surfaces.csv"))
        return report(c, "models.catalog", "its path is too long");
    /* materials alone first, so that a material missing for a model is reported as such */
    Status status = materials_open(&read, materials, surfaces, NULL);
    materials_close(&read);
    if (status != STATUS_OK) return report(c, "models.materials", "etc/ADDING.md describes a row of materials");
    if (catalog_open(&c->catalog, catalog, coarse_chord_error_m) != STATUS_OK)
        return report(c, "models.catalog",
                      "etc/ADDING.md describes how to add a vehicle; `pitviper model info FILE` "
                      "checks "
                      "one model");
    status = materials_open(&read, materials, surfaces, c->catalog);
    materials_close(&read);
    known.models = known.models || (status == STATUS_OK && !own);
    return status == STATUS_OK || report(c, "models.materials",
                                         "the material of each part needs a row there, or in "
                                         "etc/materials.csv");
}

static bool sensors_are_valid(const Check *c)
{
    const char *own = etc_own("sensors.csv");
    if (own && preset_check(own) != STATUS_OK)
        return report(c, "sensor.table", "etc/ADDING.md describes a row of sensors");
    return true;
}

static bool radar_is_valid(const Check *c)
{
    const char *preset = c->config->radar.preset;
    char        path[4096];
    RadarPreset radar;
    const char *own = c->config->radar.table;
    if (*own && radar_preset_check(own) != STATUS_OK)
        return report(c, "radar.table", "a .csv with the columns of etc/radars.csv; that file describes them");
    if (strcmp(preset, "none") == 0) return true;
    if ((!*own && !etc_path(path, sizeof path, "radars.csv")) ||
        radar_preset_read(&radar, *own ? own : path, preset) != STATUS_OK)
        return report(c, "radar.preset", "`none`, or a row of etc/radars.csv or of radar.table");
    return true;
}

static bool cigi_is_valid(const Check *c)
{
    static CigiTypes types;
    const char      *own = c->config->exercise.cigi_types;
    return !*own || cigi_types_read(&types, own) == STATUS_OK ||
           report(c, "exercise.cigi_types", "a .csv with the columns of etc/cigi_types.csv; that file describes them");
}

static bool tables_are_valid(Check *c)
{
    bool good = models_are_valid(c);
    good &= sensors_are_valid(c);
    good &= radar_is_valid(c);
    good &= cigi_is_valid(c);
    good &= atmosphere_is_valid(c);
    good &= weather_is_valid(c);
    good &= given_heat_is_valid(c);
    good &= given_signatures_are_valid(c);
    good &= terrain_is_valid(c);
    good &= culture_is_valid(c);
    good &= clutter_is_valid(c);
    if (!known.bundled)
        known.bundled = is_bundled(c, "sensors.csv", preset_check) && is_bundled(c, "radars.csv", radar_preset_check) &&
                        is_bundled(c, "heat.csv", read_heat) && is_bundled(c, "heat_machines.csv", read_machines) &&
                        is_bundled(c, "effects.csv", read_effects);
    good &= known.bundled;
    catalog_close(c->catalog);
    c->catalog = NULL;
    return good;
}

static bool check_file(const char *path)
{
    static Run run; /* too large for a stack */
    Config    *config = &run.options.config;
    run = (Run){0};
    *config = config_default();
    const Status read = config_read_checked(config, path);
    if (read != STATUS_OK && read != STATUS_BAD_VALUE) return false;
    const Config given = *config; /* a preset changes keys that were not given */
    Check        c = {.path = path, .config = config};
    /* `&=`, not `&&`: all is read, so that one run reports everything */
    bool good = read == STATUS_OK;
    good &= run_prepare(&run) == STATUS_OK;
    good &= tables_are_valid(&c);
    if (!good) {
        log_error("check: %s: not valid", path);
        return false;
    }
    log_print("%s: valid\n", path);
    if (!log_is_quiet()) config_write_given(stdout, &given);
    return true;
}

int check_command(int argc, char **argv)
{
    enum { DEFAULT = 1, HELP };
    static const struct option options[] = {{"default", 0, NULL, DEFAULT}, {"help", 0, NULL, HELP}, {NULL, 0, NULL, 0}};
    bool                       defaults = false, good = true;
    optind = 0;
    for (int option; (option = command_line_option(argc, argv, "", options)) != -1;) {
        if (option == HELP) {
            fputs(help, stdout);
            return 0;
        }
        if (option == '?') return 2; /* reported by command_line_option */
        defaults = true;
    }
    if (defaults && optind != argc)
        return command_line_wrong("check", "--default takes no file, not '%s'", argv[optind]);
    if (!defaults && optind == argc)
        return command_line_wrong("check", "no FILE is named: usage: pitviper check FILE ... | --default");
    if (defaults) {
        const Config config = config_default();
        config_write(stdout, &config);
    }
    for (int i = optind; i < argc; i++) good &= check_file(argv[i]);
    if (fflush(stdout) != 0) {
        log_error("check: cannot write: %s", strerror(errno));
        return 1;
    }
    return good ? 0 : 1;
}
