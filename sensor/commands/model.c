#include "sensor/commands/model.h"

#include "entities/catalog/model_info.h"
#include "entities/import/sidecar.h"
#include "sensor/settings/config.h"

static const char help[] =
    "usage: pitviper model list [-c FILE]\n"
    "       pitviper model info NAME|FILE [--sag M] [--length M] [--width M] [--height M]\n"
    "       pitviper model show NAME|FILE [--out PNG] [--sag M] [-c FILE]\n"
    "       pitviper model --keys\n"
    "\n"
    "list: every built-in shape and every row of the catalog: name, kind, size, source, articulated parts.\n"
    "info: what a model is made of: nodes and joints, parts, materials, heat, size, and what was lost on the way.\n"
    "show: a picture of it from eight sides, optical, with a scale: PNG.\n"
    "\n"
    "NAME: a built-in model (tank, truck, helicopter ...). FILE: OBJ, glTF, AC3D, 3DS, ASE, PLY, STL and others, also\n"
    "as .gz; OpenFlight (.flt, by osgconv); or a sidecar (.yaml) that names one. A sidecar beside the file is read:\n"
    "tank.glb, tank.yaml. etc/ADDING.md says how vehicles, materials, sensors and shapes are added.\n"
    "\n"
    "  --sag M            largest distance of a built-in model's facets from its surfaces, 1e-05 .. 0.1 m (0.005)\n"
    "  --length M         a built-in model of that length, width or height, as a row of etc/catalog.csv gives it:\n"
    "  --width M          0.001 .. 2000 m; what is left out is in proportion. Length and width: of the bounding box at\n"
    "  --height M         rest; height: from the ground, or the lowest point below it. Of a file: whether it has that\n"
    "                     size, and which axes or scale would give it\n"
    "  --out PNG          of show (default: NAME.png here)\n"
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

/* Of list and show. 0: good. */
static int parse(ModelOptions *o, int argc, char **argv)
{
    *o = (ModelOptions){.sag_m = 0.005};
    for (int i = 2; i < argc; i++) {
        const char  *option = argv[i], *value = i + 1 < argc ? argv[i + 1] : NULL;
        const char **text = strcmp(option, "--out") == 0                                          ? &o->out
                            : strcmp(option, "--config") == 0 || strcmp(option, "-c") == 0 ? &o->config
                                                                                           : NULL;
        if (text) {
            if (!value) return refuse(option, "what is missing behind it");
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
    if (o.name || o.out) return refuse(o.name ? o.name : "--out", "is not for list");
    if (take_config(o.config) != STATUS_OK || !etc_path(catalog, sizeof catalog, "catalog.csv")) return 1;
    return model_list(stdout, catalog) == STATUS_OK ? 0 : 1;
}

static int show_command(int argc, char **argv)
{
    ModelOptions o;
    char         out[256];
    const int    wrong = parse(&o, argc, argv);
    if (wrong) return wrong;
    if (!o.name) return refuse("show", "which model: a built-in name, or a file");
    if (take_config(o.config) != STATUS_OK) return 1;
    etc_own_set("catalog.csv", NULL); /* one model is shown, whatever its types are */
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
    text_print(stderr, "pitviper model: no such action: %s; there are `model list`, `model info NAME|FILE`, `model show "
            "NAME|FILE` and `model --keys`\n", argv[1]);
    return 2;
}
