#include "sensor/commands/check.h"

#include "entities/effects/effects_history.h"
#include "entities/effects/heat.h"
#include "sensor/detector/preset.h"
#include "sensor/node/host_run.h"
#include "terrain/earth/geoid.h"
#include "terrain/landscape/ground_image.h"
#include "terrain/elevation/raster.h"
#include "sensor/commands/next_option.h"

#include <errno.h>
#include <stdio.h>

static const char help[] =
    "usage: pitviper check FILE ...\n"
    "       pitviper check --default > node.yaml\n"
    "\n"
    "Reads files of settings as `replay` and `run` would, and says which keys they set, or what is wrong: file, line,\n"
    "key, value and what is accepted. Then the tables: the catalog with the models and sidecars that it names, materials,\n"
    "sensors, atmosphere, and files of elevation and cover, which must be there and be readable.\n"
    "\n"
    "  --default          print every key with its default, unit, range and meaning: a file to begin with\n";

/* ---- what the settings name ------------------------------------------------------------------ */

typedef struct Check {
    const char   *path;
    const Config *config;
    Catalog      *catalog;
} Check;

/* What one of the files has shown to be good need not be read for the next. */
static struct {
    bool bundled, models;
    char air[1024];
    double visibility_m;
} known;

/* Behind the error itself: which setting led there. False. */
static bool blame(const Check *c, const char *key, const char *next)
{
    const int line = config_line(key, c->path);
    if (line > 0) log_error("check: %s:%d: %s: see above; %s", c->path, line, key, next);
    else log_error("check: %s: %s (not set here, its default): see above; %s", c->path, key, next);
    return false;
}

static bool is_bundled(const Check *c, const char *name, Status (*read)(const char *path))
{
    char path[4096];
    if (etc_path(path, sizeof path, name) && read(path) == STATUS_OK) return true;
    log_error("check: %s: the program's own table etc/%s cannot be used, see above; install it anew, or mend the folder "
              "that PITVIPER_ETC names", c->path, name);
    return false;
}

static Status read_heat(const char *path)
{
    HeatTable table;
    return heat_table_open(&table, path);
}

static Status read_effects(const char *path)
{
    EffectHistory *history = NULL;
    const Status   status = effect_history_create(&history, path);
    effect_history_destroy(history);
    return status;
}

/* Sheets that GDAL knows, a piece of each read. */
static bool sheets_are_good(const Check *c, const char *paths, const char *key)
{
    enum { side = 16 };
    static float piece[side * side];
    RasterSet    set = {0};
    if (!*paths) return true;
    Status status = raster_set_open(&set, paths, key);
    for (int i = 0; i < set.count && status == STATUS_OK; i++)
        for (int k = 0; k < set.raster[i].sheet_count && status == STATUS_OK; k++) {
            const RasterSheet *sheet = &set.raster[i].sheet[k];
            status = raster_read(piece, &set.raster[i], 1, sheet->x0 + sheet->width / 2 - side / 2,
                                 sheet->y0 + sheet->height / 2 - side / 2, side, side, key);
        }
    raster_set_close(&set);
    return status == STATUS_OK || blame(c, key, "paths in a file of settings are relative to that file; `gdalinfo FILE` "
                                                "says what GDAL makes of one");
}

static bool ground_is_good(const Check *c)
{
    const Config *config = c->config;
    const char   *table = config->terrain.cover_table;
    bool          good = sheets_are_good(c, config->terrain.elevation, "terrain.elevation");
    good &= sheets_are_good(c, config->terrain.cover, "terrain.cover");
    good &= sheets_are_good(c, config->terrain.orthophoto, "terrain.orthophoto");
    if (strpbrk(table, "/.")) {
        if (cover_table_check(table) != STATUS_OK)
            good = blame(c, "terrain.cover_table", "etc/cover_worldcover.csv is an example");
    }
    if (*config->terrain.geoid) {
        Geoid geoid = {0};
        if (geoid_open(&geoid, config->terrain.geoid) != STATUS_OK)
            good = blame(c, "terrain.geoid", "leave it out: EGM96 of proj-data is taken");
        else geoid_close(&geoid);
    }
    return good;
}

static bool air_is_good(const Check *c)
{
    Atmosphere   *atmosphere = NULL;
    const Config *config = c->config;
    if (strcmp(known.air, config->weather.atmosphere) == 0 && known.visibility_m == config->weather.visibility_m)
        return true;
    const bool there =
        atmosphere_open_at(&atmosphere, config->weather.atmosphere, config->weather.visibility_m) == STATUS_OK;
    atmosphere_close(atmosphere);
    if (there) {
        snprintf(known.air, sizeof known.air, "%s", config->weather.atmosphere);
        known.visibility_m = config->weather.visibility_m;
    }
    return there || blame(c, "weather.atmosphere", "us1976 is always there");
}

/* Catalog, the models and sidecars that it names, and the materials of their parts. */
static bool models_are_good(Check *c)
{
    static const double coarse_sag_m = 0.1; /* files are read whole, built-in shapes are known to be good */
    char      catalog[4096], materials[4096], surfaces[4096];
    Materials read = {0};
    const bool own = etc_own("catalog.csv") || etc_own("materials.csv");
    if (known.models && !own) return true;
    if (!etc_path(catalog, sizeof catalog, "catalog.csv") || !etc_path(materials, sizeof materials, "materials.csv") ||
        !etc_path(surfaces, sizeof surfaces, "surfaces.csv"))
        return blame(c, "models.catalog", "its path is too long");
    /* by themselves first: a model's material that is missing is not the catalog's fault */
    Status status = materials_open(&read, materials, surfaces, NULL);
    materials_close(&read);
    if (status != STATUS_OK) return blame(c, "models.materials", "etc/ADDING.md says what a row of materials needs");
    if (catalog_open(&c->catalog, catalog, coarse_sag_m) != STATUS_OK)
        return blame(c, "models.catalog", "etc/ADDING.md says how a vehicle is added; `pitviper model info FILE` reads one "
                                          "model by itself");
    status = materials_open(&read, materials, surfaces, c->catalog);
    materials_close(&read);
    known.models = known.models || (status == STATUS_OK && !own);
    return status == STATUS_OK || blame(c, "models.materials", "a part's material needs a row there, or in etc/materials.csv");
}

static bool sensors_are_good(const Check *c)
{
    const char *own = etc_own("sensors.csv");
    if (own && preset_check(own) != STATUS_OK)
        return blame(c, "sensor.table", "etc/ADDING.md says what a row of sensors needs");
    return true;
}

static bool tables_are_good(Check *c)
{
    bool good = models_are_good(c);
    good &= sensors_are_good(c);
    good &= air_is_good(c);
    good &= ground_is_good(c);
    if (!known.bundled)
        known.bundled = is_bundled(c, "sensors.csv", preset_check) && is_bundled(c, "heat.csv", read_heat) &&
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
    run  = (Run){0};
    *config = config_default();
    if (config_read(config, path) != STATUS_OK) return false;
    const Config given = *config; /* a preset fills in what it says */
    Check        c = {.path = path, .config = config};
    if (config_check(config) != STATUS_OK || run_prepare(&run) != STATUS_OK || !tables_are_good(&c)) {
        log_error("check: %s: not good", path);
        return false;
    }
    log_say("%s: good\n", path);
    if (!log_is_quiet()) config_write_given(stdout, &given);
    return true;
}

int check_command(int argc, char **argv)
{
    enum { DEFAULT = 1, HELP };
    static const struct option options[] = {{"default", 0, NULL, DEFAULT}, {"help", 0, NULL, HELP}, {NULL, 0, NULL, 0}};
    bool defaults = false, good = true;
    optind = 0;
    for (int option; (option = next_option(argc, argv, "", options)) != -1;) {
        if (option == HELP) {
            fputs(help, stdout);
            return 0;
        }
        if (option == '?') {
            fputs("see `pitviper check --help`\n", stderr);
            return 2;
        }
        defaults = true;
    }
    if (defaults ? optind != argc : optind == argc) {
        fputs("usage: pitviper check FILE ... | --default; see `pitviper check --help`\n", stderr);
        return 2;
    }
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
