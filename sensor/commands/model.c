/* sensor/commands/model.c: `pitviper model`: list, info, show. */
#include "sensor/commands/model.h"
#include "pitviper_output.h"

#include "entities/catalog/model_info.h"
#include "entities/import/sidecar.h"
#include "sensor/publish/model_record.h"
#include "sensor/settings/config.h"
#include "sensor/settings/next_option.h"

#include <strings.h>

static const char help[] =
    "usage: pitviper model list [-c FILE]\n"
    "       pitviper model info NAME|FILE [--sag M] [--length M] [--width M] [--height M] [-c FILE] [--json]\n"
    "       pitviper model show NAME|FILE [--out PNG] [--sag M] [-c FILE]\n"
    "       pitviper model --keys\n"
    "\n"
    "list: every built-in shape and every row of the catalog: name, kind, size, source, articulated parts.\n"
    "info: contents of a model: nodes and joints, parts, materials, heat, size; of a file its unit and axes, where they\n"
    "come from, and what the import lost.\n"
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
    "  --json             info as one JSON object\n"
    "  --keys             every key of a sidecar: type, unit, range, meaning\n";

typedef struct ModelOptions {
    const char *name, *out, *config;
    double      sag_m;
    ModelSize   size;
    bool        json;
} ModelOptions;

typedef enum Option { OUT = 256, CONFIG, SAG, LENGTH, WIDTH, HEIGHT, JSON, HELP } Option;

/* allowed: bits of the options that apply to the action. 0: valid; else exit with this code - 1. argv[0] is the
 * action. */
static int parse(ModelOptions *o, unsigned allowed, int argc, char **argv)
{
    static const struct option options[] = {
        {"out", 1, NULL, OUT},       {"config", 1, NULL, CONFIG}, {"sag", 1, NULL, SAG}, {"length", 1, NULL, LENGTH},
        {"width", 1, NULL, WIDTH},   {"height", 1, NULL, HEIGHT}, {"json", 0, NULL, JSON}, {"help", 0, NULL, HELP},
        {NULL, 0, NULL, 0}};
    double *const figure[] = {&o->size.length_m, &o->size.width_m, &o->size.height_m};
    *o     = (ModelOptions){.sag_m = 0.005};
    optind = 0; /* restart getopt */
    for (int option; (option = next_option(argc, argv, "c:o:", options)) != -1;) {
        if (option == 'c') option = CONFIG;
        if (option == 'o') option = OUT;
        if (option >= OUT && option < HELP && !(allowed >> (option - OUT) & 1))
            return 1 + wrong_line("model", "--%s does not apply to %s", options[option - OUT].name, "this action");
        switch (option) {
        case OUT: o->out = optarg; break;
        case JSON: o->json = true; break;
        case CONFIG: o->config = optarg; break;
        case SAG:
            if (!text_to_double(&o->sag_m, optarg) || o->sag_m < 1e-5 || o->sag_m > 0.1)
                return 1 + wrong_line("model", "--sag: '%s' is not a number in 1e-05 .. 0.1 m", optarg);
            break;
        case LENGTH:
        case WIDTH:
        case HEIGHT:
            if (!text_to_double(figure[option - LENGTH], optarg) || *figure[option - LENGTH] < 0.001 ||
                *figure[option - LENGTH] > 2000)
                return 1 + wrong_line("model", "--%s: '%s' is not a number in 0.001 .. 2000 m",
                                      options[option - OUT].name, optarg);
            break;
        case HELP: fputs(help, stdout); return 1 + 0;
        default: return 1 + 2; /* reported by next_option */
        }
    }
    if (optind < argc) o->name = argv[optind++];
    if (optind < argc) return 1 + wrong_line("model", "one model at a time, not also '%s'", argv[optind]);
    return 0;
}

static int list_command(int argc, char **argv)
{
    ModelOptions o;
    char         catalog[4096];
    const int    stop = parse(&o, 1u << (CONFIG - OUT), argc, argv);
    if (stop) return stop - 1;
    if (o.name) return wrong_line("model", "list takes no model, not '%s'", o.name);
    if (config_tables_of(o.config) != STATUS_OK || !etc_path(catalog, sizeof catalog, "catalog.csv")) return 1;
    return model_list(stdout, catalog) == STATUS_OK ? 0 : 1;
}

static int show_command(int argc, char **argv)
{
    ModelOptions o;
    char         out[256];
    const int    stop = parse(&o, 1u << (OUT - OUT) | 1u << (CONFIG - OUT) | 1u << (SAG - OUT), argc, argv);
    if (stop) return stop - 1;
    if (!o.name) return wrong_line("model", "show needs a model: a built-in name, or a file");
    if (o.out && strcasecmp(output_ending(o.out), ".png") != 0)
        return wrong_line("model", "%s: the picture's name ends with .png", o.out);
    if (config_tables_of(o.config) != STATUS_OK) return 1;
    etc_own_set("catalog.csv", NULL); /* the model is shown whatever its entity types */
    const char *slash = strrchr(o.name, '/'), *last = slash ? slash + 1 : o.name;
    snprintf(out, sizeof out, "%.*s.png", (int)strcspn(last, "."), last);
    return model_show(o.name, o.sag_m, o.out ? o.out : out) == STATUS_OK ? 0 : 1;
}

static int info_command(int argc, char **argv)
{
    ModelOptions o;
    ModelInfo    info;
    const int    stop = parse(&o, 1u << (SAG - OUT) | 1u << (LENGTH - OUT) | 1u << (WIDTH - OUT) | 1u << (HEIGHT - OUT) |
                              1u << (CONFIG - OUT) | 1u << (JSON - OUT), argc, argv);
    if (stop) return stop - 1;
    if (!o.name) return wrong_line("model", "info needs a model: a built-in name, or a file");
    if (config_tables_of(o.config) != STATUS_OK) return 1;
    etc_own_set("catalog.csv", NULL); /* that model, whatever its entity types */
    if (model_info_open(&info, o.name, &o.size, o.sag_m) != STATUS_OK) return 1;
    const bool put = !o.json || model_record_print(stdout, &info);
    if (!o.json) model_info_print(&info);
    if (!put) log_error("model: no memory: %s", o.name);
    model_info_close(&info);
    return put ? 0 : 1;
}

static int keys_command(int argc, char **argv)
{
    if (argc > 1) return wrong_line("model", "--keys takes no '%s'", argv[1]);
    sidecar_write_keys(stdout);
    return 0;
}

int model_command(int argc, char **argv)
{
    static const struct {
        const char *name;
        int       (*run)(int argc, char **argv);
    } actions[] = {{"info", info_command}, {"list", list_command}, {"show", show_command}, {"--keys", keys_command}};
    thread_flush_denormals();
    if (argc < 2) return wrong_line("model", "no action: list, info NAME|FILE, show NAME|FILE or --keys");
    if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0) {
        fputs(help, stdout);
        return 0;
    }
    WordMeant meant = word_meant(argv[1]);
    for (size_t i = 0; i < sizeof actions / sizeof *actions; i++) {
        if (strcmp(argv[1], actions[i].name) != 0) {
            word_consider(&meant, actions[i].name);
            continue;
        }
        static char called[] = "pitviper model";
        argv[1] = called; /* of messages */
        return actions[i].run(argc - 1, argv + 1);
    }
    return wrong_line("model", "no such action: %s%s", argv[1],
                      *word_hint(&meant) ? meant.hint : "; there are list, info NAME|FILE, show NAME|FILE and --keys");
}
