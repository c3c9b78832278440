/* sensor/commands/rcs/rcs_command.c: `pitviper rcs`: the command line, the files and the summary of a target's radar
 * cross section. */
#include "sensor/commands/commands.h"

#include "sensor/commands/rcs/rcs_private.h"
#include "sensor/settings/config.h"
#include "sensor/settings/command_line.h"
#include "sensor/commands/overwrite.h"

#include <errno.h>
#include <sys/stat.h>

static const char help[] =
    "usage: pitviper rcs NAME|FILE|SHAPE [-o FOLDER] [--frequency GHZ[,GHZ...]] [--azimuth FROM:TO:STEP]\n"
    "                    [--elevation DEG] [--range M] [--rays N] [--splits N] [--warp MM] [--no-edges]\n"
    "                    [--no-polygons] [--joint NAME=VALUE ...] [--image DEG|none] [--cell M] [-c FILE]\n"
    "                    [--overwrite]\n"
    "\n"
    "A target's radar cross section over azimuth, at full polarisation, by ray tubes, physical optics and edges. It\n"
    "stands alone: no ground.\n"
    "\n"
    "NAME: a built-in model (tank, truck, helicopter ...). FILE: as `pitviper model show` takes it. SHAPE, of metal,\n"
    "in m: sphere:R plate:AxB disc:R cylinder:RxL dihedral:AxB trihedral:A corner:A. given:CSV: a signature from\n"
    "elsewhere, as `radar.given` takes them (etc/reference/radar_seeker.md), without a picture. Writes to FOLDER:\n"
    "  rcs.csv    a row each look and frequency: dBsm and complex field, m, as received and transmitted polarisation\n"
    "  rcs.svg    a polar plot of HH and VV at the first frequency\n"
    "  isar.png   a picture by range and cross range at the first frequency, HH and HV: nose up, seen from above\n"
    "\n"
    "  --out FOLDER         or -o (default: NAME_rcs in the current folder)\n"
    "  --frequency LIST     0.1 .. 300 GHz, at most 64 (10)\n"
    "  --azimuth FROM:TO:STEP   clockwise from the nose, deg (0:360:1)\n"
    "  --elevation DEG      upwards, -90 .. 90 (10)\n"
    "  --range M            from the body's origin; without it the far field\n"
    "  --rays N             ray tubes a wavelength, 0.25 .. 16 (1.25); the error of one number falls slowly with it\n"
    "  --splits N           how often a tube at an edge is divided in four, 0 .. 5 (2); each costs twice the time or "
    "more\n"
    "  --warp MM            surfaces uneven by that height, rms, over 0.5 m, 0 .. 20 (0): built-in models are truer "
    "to\n"
    "                       plane and right angle than vehicles are, and far too bright at 35 and 94 GHz without it\n"
    "  --joint NAME=VALUE   where a joint stands, deg, of one that slides m; at most 32. Others are at rest. "
    "`pitviper\n"
    "                       model info` lists them\n"
    "  --no-edges           without the diffraction at edges\n"
    "  --no-polygons        by ray tubes alone; else flat faces are in closed form on targets of at most 64 of them\n"
    "  --image DEG|none     azimuth at which the picture is taken (30)\n"
    "  --cell M             its resolution, 0.01 .. 10 (a sixtieth of the target, at least three wavelengths)\n"
    "  --config FILE        or -c: settings, whose models.materials are read\n"
    "  --overwrite          replace these files in FOLDER; without it that is an error\n";

typedef struct RcsOptions {
    const char *out, *settings;
    RcsConfig   config;
    bool        overwrite;
} RcsOptions;

static int refuse(const char *option, const char *what)
{
    return 1 + command_line_wrong("rcs", "%s: %s", option, what);
}

static bool in_range(double *out, const char *text, double low, double high)
{
    return text && text_to_double(out, text) && *out >= low && *out <= high;
}

/* Reads numbers between a separator, at most `most`; returns how many, -1 where one is not a number. */
static int read_list(double *out, int most, const char *text, char separator)
{
    char copy[1024];
    int  count = 0;
    if (!text || snprintf(copy, sizeof copy, "%s", text) >= (int)sizeof copy) return -1;
    for (char *at = copy; at;) {
        char *end = strchr(at, separator);
        if (end) *end++ = 0;
        if (count == most || !text_to_double(&out[count++], at)) return -1;
        at = end;
    }
    return count;
}

static bool read_frequencies(RcsConfig *config, const char *text)
{
    config->frequencies = read_list(config->frequency_hz, rcs_most_frequencies, text, ',');
    for (int f = 0; f < config->frequencies; f++) {
        if (!(config->frequency_hz[f] >= 0.1 && config->frequency_hz[f] <= 300)) return false;
        config->frequency_hz[f] *= 1e9;
    }
    return config->frequencies > 0;
}

static bool read_azimuth(RcsConfig *config, const char *text)
{
    double number[3];
    if (read_list(number, 3, text, ':') != 3 || !(fabs(number[0]) <= 720 && fabs(number[1]) <= 720) ||
        !(number[2] > 0) || !(number[1] >= number[0]))
        return false;
    const double looks = floor((number[1] - number[0]) / number[2] + 1e-9) + 1;
    if (!(looks <= rcs_most_looks)) return false;
    config->from_deg = number[0], config->step_deg = number[2], config->looks = (int)looks;
    return true;
}

static bool read_joint(RcsConfig *config, const char *text)
{
    RcsJoint   *joint = &config->joint[config->joints];
    const char *equals = text ? strchr(text, '=') : NULL;
    if (!equals || config->joints == rcs_most_joints || equals == text || equals - text >= (int)sizeof joint->name)
        return false;
    snprintf(joint->name, sizeof joint->name, "%.*s", (int)(equals - text), text);
    config->joints++;
    return in_range(&joint->value, equals + 1, -3600, 3600);
}

/* Returns 0 if the arguments are valid; else the program exits with this code - 1. */
static int parse(RcsOptions *o, int argc, char **argv)
{
    enum {
        OUT = 'o',
        CONFIG = 'c',
        FREQUENCY = 256,
        AZIMUTH,
        ELEVATION,
        RANGE,
        RAYS,
        SPLITS,
        WARP,
        JOINT,
        CELL,
        IMAGE,
        NO_EDGES,
        NO_POLYGONS,
        OVERWRITE,
        LIBRARY,
        HELP
    };
    static const struct option options[] = {{"out", 1, NULL, OUT},
                                            {"frequency", 1, NULL, FREQUENCY},
                                            {"azimuth", 1, NULL, AZIMUTH},
                                            {"elevation", 1, NULL, ELEVATION},
                                            {"range", 1, NULL, RANGE},
                                            {"rays", 1, NULL, RAYS},
                                            {"splits", 1, NULL, SPLITS},
                                            {"warp", 1, NULL, WARP},
                                            {"joint", 1, NULL, JOINT},
                                            {"cell", 1, NULL, CELL},
                                            {"image", 1, NULL, IMAGE},
                                            {"no-edges", 0, NULL, NO_EDGES},
                                            {"no-polygons", 0, NULL, NO_POLYGONS},
                                            {"overwrite", 0, NULL, OVERWRITE},
                                            {"library", 1, NULL, LIBRARY},
                                            {"config", 1, NULL, CONFIG},
                                            {"help", 0, NULL, HELP},
                                            {NULL, 0, NULL, 0}};
    RcsConfig                 *c = &o->config;
    double                     number;
    *o = (RcsOptions){.config = {.step_deg = 1,
                                 .looks = 361,
                                 .elevation_deg = 10,
                                 .range_m = INFINITY,
                                 .frequencies = 1,
                                 .frequency_hz = {10e9},
                                 .image_deg = 30,
                                 .splits = -1}};
    optind = 0; /* restart getopt */
    for (int option; (option = command_line_option(argc, argv, "c:o:", options)) != -1;) switch (option) {
        case OUT:
            if (!*optarg) return refuse("--out", "needs a folder");
            o->out = optarg;
            break;
        case CONFIG:
            o->settings = optarg;
            break;
        case FREQUENCY:
            if (!read_frequencies(c, optarg))
                return refuse("--frequency", "needs 1 to 64 numbers in 0.1 .. 300 GHz, separated by commas");
            break;
        case AZIMUTH:
            if (!read_azimuth(c, optarg))
                return refuse("--azimuth", "needs FROM:TO:STEP in deg, rising, at most 36001 looks, as 0:360:1");
            break;
        case ELEVATION:
            if (!in_range(&c->elevation_deg, optarg, -90, 90))
                return refuse("--elevation", "needs an angle in -90 .. 90 deg");
            break;
        case RANGE:
            if (!in_range(&c->range_m, optarg, 1e-3, 1e9))
                return refuse("--range", "needs a distance in 0.001 .. 1e9 m");
            break;
        case RAYS:
            if (!in_range(&c->rays_per_wavelength, optarg, 0.25, 16))
                return refuse("--rays", "needs a number in 0.25 .. 16");
            break;
        case SPLITS:
            if (!in_range(&number, optarg, 0, tubes_splits_most) || number != floor(number))
                return refuse("--splits", "needs a whole number in 0 .. 5");
            c->splits = (int)number;
            break;
        case WARP:
            if (!in_range(&c->warp_mm, optarg, 0, 20)) return refuse("--warp", "needs a height in 0 .. 20 mm");
            break;
        case JOINT:
            if (!read_joint(c, optarg))
                return refuse("--joint", "needs NAME=VALUE, in -3600 .. 3600 deg or m, at most 32 times");
            break;
        case CELL:
            if (!in_range(&c->resolution_m, optarg, 0.01, 10))
                return refuse("--cell", "needs a length in 0.01 .. 10 m");
            break;
        case IMAGE:
            c->image_deg = NAN;
            if (strcmp(optarg, "none") != 0 && !in_range(&c->image_deg, optarg, -720, 720))
                return refuse("--image", "needs an angle within 720 deg, or none");
            break;
        case NO_EDGES:
            c->no_edges = true;
            break;
        case NO_POLYGONS:
            c->no_polygons = true;
            break;
        case OVERWRITE:
            o->overwrite = true;
            break;
        case LIBRARY:
            break; /* taken by rcs_command */
        case HELP:
            printf("%s\n%s", help, rcs_library_help);
            return 1 + 0;
        default:
            return 1 + 2; /* reported by command_line_option */
        }
    if (optind == argc) return refuse("no target is named", "a built-in name, a file or a shape");
    c->name = argv[optind];
    if (optind + 1 < argc) return refuse(argv[optind + 1], "one target at a time");
    if (given_signature_path(c->name)) c->image_deg = NAN;
    if (given_signature_path(c->name) && c->joints > 0) return refuse("--joint", "a given signature has no joints");
    if (fabs(c->elevation_deg) > 85 && !isnan(c->image_deg))
        return refuse("--elevation", "there is no cross range beyond 85 deg: add --image none");
    return 0;
}

/* ---- files ------------------------------------------------------------------------------------------ */

enum { file_csv, file_svg, file_png, file_count };

static Status make_paths(OutputPath path[file_count], const RcsOptions *o)
{
    static const char *const names[file_count] = {"rcs.csv", "rcs.svg", "isar.png"};
    return overwrite_files(path, &(OutputFiles){.command = "rcs",
                                                .count = file_count,
                                                .name = names,
                                                .given = o->out,
                                                .model = o->config.name,
                                                .endings = ".:",
                                                .overwrite = o->overwrite});
}

static void put_csv(FILE *to, const void *user) { rcs_write_csv(to, user); }
static void put_plot(FILE *to, const void *user) { rcs_plot(to, user); }

static void print_summary(const RcsSweep *sweep, double seconds)
{
    const RcsConfig *c = &sweep->config;
    for (int f = 0; f < c->frequencies; f++) {
        double mean_m2[2] = {0, 0}, most_dbsm = -INFINITY, at_deg = 0;
        for (int look = 0; look < c->looks; look++) {
            const ScatterMatrix *s = &sweep->s[(size_t)look * (size_t)c->frequencies + (size_t)f];
            const double complex value[2] = {s->hh, s->vv};
            for (int p = 0; p < 2; p++) {
                const double re = creal(value[p]), im = cimag(value[p]);
                mean_m2[p] += 4 * pi_rad * (re * re + im * im) / c->looks;
                if (value[p] != 0 && rcs_dbsm(value[p]) > most_dbsm)
                    most_dbsm = rcs_dbsm(value[p]), at_deg = rcs_look_deg(c, look);
            }
        }
        log_print("%s at %g GHz: mean HH %.1f, VV %.1f dBsm; most %.1f dBsm at azimuth %g deg\n",
                  rcs_target_name(sweep), c->frequency_hz[f] * 1e-9,
                  mean_m2[0] > 0 ? 10 * log10(mean_m2[0]) : -INFINITY,
                  mean_m2[1] > 0 ? 10 * log10(mean_m2[1]) : -INFINITY, most_dbsm, at_deg);
    }
    const RadarTarget *target = sweep->model.target;
    if (target && target->chord_m > 0) { /* a file's facets are taken as they are */
        const double deg_m = 720 * c->frequency_hz[c->frequencies - 1] / light_mps;
        log_print(
            "facets of curved surfaces are up to %.2g mm off them, %.2g mm rms: %.2g and %.2g deg of phase at %g GHz\n",
            1e3 * target->chord_m, 1e3 * target->chord_rms_m, deg_m * target->chord_m, deg_m * target->chord_rms_m,
            1e-9 * c->frequency_hz[c->frequencies - 1]);
    }
    if (!isnan(sweep->grid_db)) log_print("error of the grid of ray tubes, by another grid: %.0f dB\n", sweep->grid_db);
    log_detail("rcs: %lld ray tubes, %lld hits, %.1f s", sweep->rays, sweep->hit_count, seconds);
}

static Status make_picture(RcsSweep *sweep, const char *path)
{
    RcsImage image;
    Status   status = rcs_image_make(&image, sweep);
    if (status != STATUS_OK) return status;
    status = rcs_image_write(&image, sweep, path);
    rcs_image_free(&image);
    return status;
}

int rcs_command(int argc, char **argv)
{
    static OutputPath path[file_count];
    RcsOptions        o;
    thread_flush_denormals();
    for (int i = 1; i < argc && strcmp(argv[i], "--") != 0; i++) /* the options beside it are others */
        if (strncmp(argv[i], "--library", 9) == 0 && (!argv[i][9] || argv[i][9] == '='))
            return rcs_library_command(argc, argv);
    const int stop = parse(&o, argc, argv);
    if (stop) return stop - 1;
    if (config_tables_of(o.settings) != STATUS_OK) return 1;
    RcsSweep     sweep = {0};
    const double begun_s = wall_clock_s();
    Status       status = rcs_sweep_open(&sweep, &o.config);
    if (status == STATUS_OK) status = make_paths(path, &o);
    if (status == STATUS_OK) status = rcs_sweep_run(&sweep);
    if (status == STATUS_OK) status = text_write_file("rcs", path[file_csv], put_csv, &sweep);
    if (status == STATUS_OK) status = text_write_file("rcs", path[file_svg], put_plot, &sweep);
    if (status == STATUS_OK && !isnan(o.config.image_deg)) status = make_picture(&sweep, path[file_png]);
    if (status == STATUS_OK) print_summary(&sweep, wall_clock_s() - begun_s);
    if (status == STATUS_NO_MEMORY) log_error("rcs: out of memory: %s", o.config.name);
    rcs_sweep_close(&sweep);
    return status == STATUS_OK ? 0 : 1;
}
