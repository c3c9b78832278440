/* sensor/commands/rcs/rcs_library.c: makes the signatures of a model for a range of aspects, which a run finds. */
#include "sensor/commands/rcs/rcs_private.h"

#include "entities/exercise/scenario.h"
#include "sensor/radar/seeker_radar.h"
#include "sensor/radar/signature_library.h"
#include "sensor/settings/config.h"
#include "sensor/settings/command_line.h"

#include <stdlib.h>

const char rcs_library_help[] =
    "usage: pitviper rcs MODEL --library FOLDER --preset NAME [--azimuth FROM:TO] [--elevation FROM:TO]\n"
    "                    [--range FROM:TO] [--joint NAME=VALUE]... [--damage N] [--warp MM] [-c FILE]\n"
    "\n"
    "Computes the signatures of a target for a radar, one file for each bin of aspect (0.3 deg) and range (a factor of 1.19),\n"
    "for radar.library of a run. Existing files are kept: after an interruption the same command continues.\n"
    "\n"
    "MODEL: an entity type as in the catalog (1.1.222.1.1.1.0), or a built-in name in the shape's own size.\n"
    "  --preset NAME        a row of etc/radars.csv: seeker_94\n"
    "  --azimuth FROM:TO    clockwise from the nose, deg (0:360)\n"
    "  --elevation FROM:TO  of the antenna as the target sees it, deg (5:10)\n"
    "  --range FROM:TO      m (1000:3000)\n"
    "  --joint NAME=VALUE   of a node of the model, deg or m, as `model show` names it; at rest without\n"
    "  --damage N           0 .. 3 (0)\n"
    "  --warp MM            as radar.warp_mm (1)\n"
    "  --config FILE        or -c: settings, whose models.catalog and models.materials are read\n";

enum { most_joints = 32 };

typedef struct LibraryOptions {
    const char *name, *folder, *preset, *settings;
    double      azimuth_deg[2], elevation_deg[2], range_m[2], warp_mm, damage;
    int         joints;
    const char *joint[most_joints];
} LibraryOptions;

typedef struct Work {
    LibraryOptions    o;
    RadarPreset       preset;
    RadarMaterials    materials;
    Catalog          *catalog;
    const Model      *of;
    int               model;
    double           *joint; /* [node_count] */
    SignaturesConfig  config;
    SignatureLibrary *library;
    Signatures       *signatures;
    Pool             *pool;
    long              bins, done, made;
    double            begun_s;
} Work;

static int refuse(const char *option, const char *what)
{
    return 1 + command_line_wrong("rcs", "%s: %s", option, what);
}

static bool number_in(double *out, const char *text, double low, double high)
{
    return text && text_to_double(out, text) && *out >= low && *out <= high;
}

static bool span_in(double out[2], const char *text, double low, double high)
{
    char        first[64];
    const char *colon = text ? strchr(text, ':') : NULL;
    if (!colon) return number_in(&out[0], text, low, high) && number_in(&out[1], text, low, high);
    if (colon - text >= (int)sizeof first) return false;
    memcpy(first, text, (size_t)(colon - text));
    first[colon - text] = 0;
    return number_in(&out[0], first, low, high) && number_in(&out[1], colon + 1, low, high) && out[0] <= out[1];
}

/* Returns 0 if the arguments are valid; else the program exits with this code - 1. */
static int parse(LibraryOptions *o, int argc, char **argv)
{
    enum { CONFIG = 'c', LIBRARY = 256, PRESET, AZIMUTH, ELEVATION, RANGE, WARP, DAMAGE, JOINT, HELP };
    static const struct option options[] = {
        {"library", 1, NULL, LIBRARY},     {"preset", 1, NULL, PRESET}, {"azimuth", 1, NULL, AZIMUTH},
        {"elevation", 1, NULL, ELEVATION}, {"range", 1, NULL, RANGE},   {"warp", 1, NULL, WARP},
        {"damage", 1, NULL, DAMAGE},       {"joint", 1, NULL, JOINT},   {"config", 1, NULL, CONFIG},
        {"help", 0, NULL, HELP},           {NULL, 0, NULL, 0}};
    *o = (LibraryOptions){.azimuth_deg = {0, 360}, .elevation_deg = {5, 10}, .range_m = {1000, 3000}, .warp_mm = 1};
    optind = 0; /* restart getopt */
    for (int option; (option = command_line_option(argc, argv, "c:", options)) != -1;) switch (option) {
        case LIBRARY:
            if (!*optarg) return refuse("--library", "needs a folder");
            o->folder = optarg;
            break;
        case PRESET:
            o->preset = optarg;
            break;
        case CONFIG:
            o->settings = optarg;
            break;
        case AZIMUTH:
            if (!span_in(o->azimuth_deg, optarg, -720, 720))
                return refuse("--azimuth", "needs FROM:TO in deg, rising, within 720");
            break;
        case ELEVATION:
            if (!span_in(o->elevation_deg, optarg, -90, 90))
                return refuse("--elevation", "needs FROM:TO in -90 .. 90 deg, rising");
            break;
        case RANGE:
            if (!span_in(o->range_m, optarg, 10, 1e6)) return refuse("--range", "needs FROM:TO in 10 .. 1e6 m, rising");
            break;
        case WARP:
            if (!number_in(&o->warp_mm, optarg, 0, 20)) return refuse("--warp", "needs a height in 0 .. 20 mm");
            break;
        case DAMAGE:
            if (!number_in(&o->damage, optarg, 0, 3) || o->damage != floor(o->damage))
                return refuse("--damage", "needs 0, 1, 2 or 3");
            break;
        case JOINT:
            if (!strchr(optarg, '=') || o->joints == most_joints)
                return refuse("--joint", "needs NAME=VALUE, at most 32 of them");
            o->joint[o->joints++] = optarg;
            break;
        case HELP:
            fputs(rcs_library_help, stdout);
            return 1 + 0;
        default:
            return 1 + 2; /* reported by command_line_option */
        }
    if (optind == argc) return refuse("no target is named", "an entity type or a built-in name");
    o->name = argv[optind];
    if (optind + 1 < argc) return refuse(argv[optind + 1], "one target at a time");
    if (!o->preset) return refuse("--preset", "--library needs a row of etc/radars.csv, seeker_94 for one");
    return 0;
}

static Status set_joints(Work *w)
{
    w->joint = calloc((size_t)w->of->node_count + 1, sizeof *w->joint);
    if (!w->joint) return STATUS_NO_MEMORY;
    for (int j = 0; j < w->o.joints; j++) {
        const char  *text = w->o.joint[j], *equals = strchr(text, '=');
        const size_t length = (size_t)(equals - text);
        double       value;
        int          node = 0;
        while (node < w->of->node_count &&
               (strlen(w->of->node[node].name) != length || strncmp(w->of->node[node].name, text, length) != 0))
            node++;
        if (node == w->of->node_count || w->of->node[node].joint == JOINT_FIXED ||
            !text_to_double(&value, equals + 1)) {
            log_error(
                "rcs: --joint %s: the model has no such joint, or the value is not a number; `pitviper model show` names them",
                text);
            return STATUS_BAD_VALUE;
        }
        w->joint[node] = w->of->node[node].joint == JOINT_ROTATION ? value * rad_per_deg : value;
    }
    return STATUS_OK;
}

static Status open_model(Work *w)
{
    DisEntityType type;
    Origin        origin;
    char          path[4096];
    const double  sag_m = radar_sag_m(w->preset.wave.centre_hz);
    Status        status;
    if (scenario_type_parse(&type, w->o.name)) {
        status = etc_path(path, sizeof path, "catalog.csv") ? catalog_open(&w->catalog, path, sag_m) : STATUS_BAD_VALUE;
        if (status == STATUS_OK) w->model = catalog_find(w->catalog, type, &origin, NULL);
    } else {
        status = catalog_open_one(&w->catalog, &w->model, w->o.name, sag_m);
    }
    if (status != STATUS_OK) return status;
    w->of = catalog_model(w->catalog, w->model);
    return set_joints(w);
}

static Status open_work(Work *w)
{
    char   path[4096];
    Status status =
        etc_path(path, sizeof path, "radars.csv") ? radar_preset_read(&w->preset, path, w->o.preset) : STATUS_BAD_VALUE;
    if (status == STATUS_OK) status = radar_materials_load(&w->materials);
    if (status == STATUS_OK) status = open_model(w);
    if (status != STATUS_OK) return status;
    w->config = seeker_radar_signatures(&w->preset, 1e-3 * w->o.warp_mm, NULL);
    w->config.most_octets = 1; /* nothing is asked for twice */
    status = signature_library_open(&w->library, w->o.folder, &w->config, &w->materials);
    if (status != STATUS_OK) return status;
    w->config.store = signature_library_store(w->library);
    w->config.store.fetch = NULL;
    status = signatures_create(&w->signatures, &w->config, w->catalog, &w->materials);
    return status == STATUS_OK ? pool_create(&w->pool, thread_processors()) : status;
}

static void close_work(Work *w)
{
    pool_destroy(w->pool);
    signatures_destroy(w->signatures);
    signature_library_close(w->library);
    if (w->catalog) catalog_close(w->catalog);
    radar_materials_close(&w->materials);
    free(w->joint);
}

static Status one_bin(Work *w, const ScatterAntenna *antenna)
{
    const SignatureLook look = signature_look(antenna);
    SignatureKey        key = {.model = w->of, .joint = w->joint, .damage = (int)w->o.damage};
    const Signature    *made;
    char                line[160];
    Status              status = STATUS_OK;
    signature_look_bin(&key.look, &look, w->config.aspect_rad);
    if (!signature_library_has(w->library, &key)) {
        status = signatures_find(&made, w->signatures, w->model, w->joint, key.damage, &look, w->pool);
        w->made++;
    }
    w->done++;
    const double spent_s = wall_clock_s() - w->begun_s;
    snprintf(line, sizeof line, "%ld of %ld bins, %ld made; %.0f s, %.0f s to go", w->done, w->bins, w->made, spent_s,
             w->made ? spent_s / (double)w->made * (double)(w->bins - w->done) : 0);
    log_status(line);
    return status;
}

/* Goes through every bin that has a part of the spans: counts it, or makes it. */
static Status all_bins(Work *w, bool count)
{
    const double  side = w->config.aspect_rad;
    const double *az = w->o.azimuth_deg, *el = w->o.elevation_deg;
    const int     near = (int)nearbyint(4 * log2(w->o.range_m[0])), far = (int)nearbyint(4 * log2(w->o.range_m[1]));
    const int     low = (int)floor(el[0] * rad_per_deg / side), high = (int)floor(el[1] * rad_per_deg / side);
    Status        status = STATUS_OK;
    for (int e = low; e <= high && status == STATUS_OK; e++) {
        const double middle = clamp(side * (e + 0.5), -0.5 * pi_rad, 0.5 * pi_rad);
        const long   round = (long)fmax(1, nearbyint(2 * pi_rad * cos(middle) / side));
        const double width = 2 * pi_rad / (double)round;
        const long   first = (long)floor((az[0] * rad_per_deg + pi_rad) / width),
                   last = (long)floor((az[1] * rad_per_deg + pi_rad) / width);
        const long bins = last - first + 1 < round ? last - first + 1 : round;
        if (count) w->bins += bins * (far - near + 1);
        for (int r = near; r <= far && !count && status == STATUS_OK; r++)
            for (long a = first; a < first + bins && status == STATUS_OK; a++) {
                ScatterAntenna antenna;
                radar_look(&antenna, width * ((double)a + 0.5) - pi_rad, middle, exp2(r / 4.0));
                status = one_bin(w, &antenna);
            }
    }
    return status;
}

int rcs_library_command(int argc, char **argv)
{
    static Work w;
    const int   stop = parse(&w.o, argc, argv);
    if (stop) return stop - 1;
    w.begun_s = wall_clock_s();
    Status status = config_tables_of(w.o.settings);
    if (status == STATUS_OK) status = open_work(&w);
    if (status == STATUS_OK) status = all_bins(&w, true);
    if (status == STATUS_OK) status = all_bins(&w, false);
    log_status(NULL);
    if (status == STATUS_OK) {
        const SignatureLibraryCounters c = signature_library_counters(w.library);
        log_print("%s for %s: %ld bins, %ld made, %.2f MB written, %.1f s\n", w.of->name, w.preset.name, w.bins, w.made,
                  1e-6 * (double)c.octets, wall_clock_s() - w.begun_s);
        if (c.failed > 0) status = STATUS_IO;
    }
    if (status == STATUS_NO_MEMORY) log_error("rcs: out of memory: %s", w.o.name);
    close_work(&w);
    return status == STATUS_OK ? 0 : 1;
}
