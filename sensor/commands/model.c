/* sensor/commands/model.c: `pitviper model`: list, info, show. */
#include "sensor/commands/model.h"
#include "pitviper_output.h"

#include "entities/catalog/model_info.h"
#include "entities/import/sidecar.h"
#include "sensor/settings/config.h"

#include <strings.h>

static const char help[] =
    "usage: pitviper model list [-c FILE]\n"
    "       pitviper model info NAME|FILE [--sag M] [--length M] [--width M] [--height M]\n"
    "       pitviper model show NAME|FILE [--out PNG] [--sag M] [-c FILE]\n"
    "       pitviper model --keys\n"
    "\n"
    "list: every built-in shape and every row of the catalog: name, kind, size, source, articulated parts.\n"
    "info: contents of a model: nodes and joints, parts, materials, heat, size, and what an import lost.\n"
    "show: an optical image of it from eight sides, with a scale: PNG.\n"
    "\n"
    "NAME: a built-in model (tank, truck, helicopter ...). FILE: OBJ, glTF, AC3D, 3DS, ASE, PLY, STL and others, also\n"
    "as .gz; OpenFlight (.flt, by osgconv); or a sidecar (.yaml) that names one. A sidecar beside the file is read:\n"
    "tank.glb, tank.yaml. etc/ADDING.md describes how to add vehicles, materials, sensors and shapes.\n"
    "\n"
    "  --sag M            chord error of a built-in model: largest distance of facets from surfaces, 1e-05 .. 0.1 m "
    "(0.005)\n"
    "  --length M         scale a built-in model to that length, width or height, as a row of etc/catalog.csv does:\n"
    "  --width M          0.001 .. 2000 m; sizes not given follow in proportion. Length and width: bounding box at\n"
    "  --height M         rest; height: above the ground, or above the lowest point below it. For a file: checks that\n"
    "                     it has that size, and prints which axes or scale would give it\n"
    "  --out PNG          output of show (default: NAME.png in the current folder)\n"
    "  --config FILE      or -c: settings, whose models.catalog and models.materials are read\n"
    "  --keys             every key of a sidecar: type, unit, range, meaning\n";

static int refuse(const char *option, const char *what)
{
    text_print(stderr, "pitviper model: %s: %s; see `pitviper model --help`\n", option, what);
    return 2;
}

typedef struct ModelOptions {
    const char *name, *out, *config;
    double      sag_m;
} ModelOptions;

/* Options of list and show. 0: valid; else the exit code. */
static int parse(ModelOptions *o, int argc, char **argv)
{
    *o = (ModelOptions){.sag_m = 0.005};
    for (int i = 2; i < argc; i++) {
        const char  *option = argv[i], *value = i + 1 < argc ? argv[i + 1] : NULL;
        const char **text = strcmp(option, "--out") == 0                                          ? &o->out
                            : strcmp(option, "--config") == 0 || strcmp(option, "-c") == 0 ? &o->config
                                                                                           : NULL;
        if (text) {
            if (!value) return refuse(option, "needs an argument");
            *text = value;
            i++;
        } else if (strcmp(option, "--sag") == 0) {
            if (!value || !text_to_double(&o->sag_m, value) || o->sag_m < 1e-5 || o->sag_m > 0.1)
                return refuse(option, "needs a number in 1e-05 .. 0.1 m");
            i++;
        } else if (option[0] == '-' || o->name) {
            return refuse(option, option[0] == '-' ? "no such option" : "one model at a time");
        } else {
            o->name = option;
        }
    }
    return 0;
}

static Status take_config(const char *path)
{
    Config config = config_default();
    Status status = path ? config_read(&config, path) : STATUS_OK;
    return status == STATUS_OK ? config_own_tables(&config) : status;
}

static int list_command(int argc, char **argv)
{
    ModelOptions o;
    char         catalog[4096];
    const int    wrong = parse(&o, argc, argv);
    if (wrong) return wrong;
    if (o.name || o.out) return refuse(o.name ? o.name : "--out", "does not apply to list");
    if (take_config(o.config) != STATUS_OK || !etc_path(catalog, sizeof catalog, "catalog.csv")) return 1;
    return model_list(stdout, catalog) == STATUS_OK ? 0 : 1;
}

static int show_command(int argc, char **argv)
{
    ModelOptions o;
    char         out[256];
    const int    wrong = parse(&o, argc, argv);
    if (wrong) return wrong;
    if (!o.name) return refuse("show", "needs a model: a built-in name, or a file");
    if (o.out && strcasecmp(output_ending(o.out), ".png") != 0) return refuse(o.out, "the picture's name ends with .png");
    if (take_config(o.config) != STATUS_OK) return 1;
    etc_own_set("catalog.csv", NULL); /* the model is shown whatever its entity types */
    const char *slash = strrchr(o.name, '/'), *last = slash ? slash + 1 : o.name;
    snprintf(out, sizeof out, "%.*s.png", (int)strcspn(last, "."), last);
    return model_show(o.name, o.sag_m, o.out ? o.out : out) == STATUS_OK ? 0 : 1;
}

int model_command(int argc, char **argv)
{
    thread_flush_denormals();
    for (int i = 1; i < argc; i++)
        if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0) {
            fputs(help, stdout);
            return 0;
        }
    if (argc < 2) {
        fputs(help, stderr);
        return 2;
    }
    if (strcmp(argv[1], "info") == 0) return model_info_command(argc, argv);
    if (strcmp(argv[1], "list") == 0) return list_command(argc, argv);
    if (strcmp(argv[1], "show") == 0) return show_command(argc, argv);
    if (strcmp(argv[1], "--keys") == 0) {
        sidecar_write_keys(stdout);
        return 0;
    }
    text_print(stderr, "pitviper model: no such action: %s; there are `model list`, `model info NAME|FILE`, `model "
                       "show "
            "NAME|FILE` and `model --keys`\n", argv[1]);
    return 2;
}
