/* sensor/commands/range/range_command.c: `pitviper range`: the command line, the files and the summary of how far a
 * sensor's observer detects, recognises and identifies a target. */
#include "sensor/commands/commands.h"

#include "sensor/commands/overwrite.h"
#include "sensor/commands/range/range_private.h"
#include "sensor/settings/command_line.h"
#include "sensor/settings/config.h"
#include "sensor/settings/sensors.h"

#include <stdlib.h>

static const char help[] =
    "usage: pitviper range SENSOR|FILE [-o FOLDER] [--class CLASS] [--size M] [--contrast C] [--visibility KM]\n"
    "                      [--air MODEL] [--height M] [--sun DEG] [--far KM] [--criteria NAME] [--n50 D,R,I]\n"
    "                      [--v50 D,R,I] [--probability P] [-c FILE] [--overwrite]\n"
    "\n"
    "How far an observer of a sensor detects, recognises and identifies a target, by Johnson's cycles and by the TTP\n"
    "metric, from the sensor's MTF and noise, the target's contrast and the air. etc/reference/range.md has the model.\n"
    "\n"
    "SENSOR: a row of etc/sensors.csv (staring_lwir, tv ...). FILE: a data sheet. Writes to FOLDER:\n"
    "  range.csv    a row a range: transmittance, apparent contrast, cycles on the target, TTP value, probabilities\n"
    "  range.svg    a plot of the probabilities\n"
    "\n"
    "  --out FOLDER       or -o (default: NAME_range in the current folder)\n"
    "  --class CLASS      nato (2.3 m: the standard target of STANAG 4347), tank (3.1 m) or person (0.75 m) (nato)\n"
    "  --size M           root of the target's area instead, 0.01 .. 1000 m\n"
    "  --contrast C       at the target: K against its background (2), or of reflective bands its difference over the\n"
    "                     background's radiance (0.3); -1000 .. 1000, not 0\n"
    "  --visibility KM    0.4 .. 300 (23)\n"
    "  --air MODEL        of etc/atmosphere: us1976, midlat_summer (us1976)\n"
    "  --height M         of the sensor over the ground, 0 .. 20000 (2)\n"
    "  --sun DEG          above the horizon, 1 .. 90; for reflective bands (45)\n"
    "  --far KM           of the last row, 0.1 .. 1000 (where detection is rare)\n"
    "  --criteria NAME    of Johnson: acquire (0.75, 3, 6 cycles), johnson (1, 4, 6.4), stanag (1, 3, 6) (acquire)\n"
    "  --n50 D,R,I        cycles instead, and\n"
    "  --v50 D,R,I        TTP values at which half of the observers detect, recognise, identify; 0.01 .. 1000 (2,7.5,13)\n"
    "  --probability P    ranges of the summary are those with P, 0.01 .. 0.99 (0.5)\n"
    "  --config FILE      or -c: settings, whose sensor.table is read\n"
    "  --overwrite        replace these files in FOLDER; without it that is an error\n";

typedef struct RangeOptions {
    const char *name, *out, *config;
    RangeScene  scene;
    double      probability;
    bool        overwrite;
} RangeOptions;

static int refuse(const char *option, const char *what)
{
    return 1 + command_line_wrong("range", "%s: %s", option, what);
}

static bool in_range(double *out, const char *text, double low, double high, double unit)
{
    double value;
    if (!text_to_double(&value, text) || !(value >= low && value <= high)) return false;
    *out = value * unit;
    return true;
}

/* Three numbers, separated by commas; a later task takes at least as much as an earlier one. */
static bool read_three(double out[acquisition_tasks], const char *text)
{
    double value[acquisition_tasks];
    int    used = 0;
    if (strlen(text) > 80 || sscanf(text, "%9lf,%9lf,%9lf%n", &value[0], &value[1], &value[2], &used) != 3 ||
        text[used])
        return false;
    for (int i = 0; i < acquisition_tasks; i++)
        if (!(value[i] >= 0.01 && value[i] <= 1000) || (i && value[i] < value[i - 1])) return false;
    memcpy(out, value, sizeof value);
    return true;
}

static bool read_class(double *size_m, const char *name)
{
    static const struct {
        const char *name;
        double      size_m;
    } classes[] = {{"nato", 2.3}, {"tank", 3.1}, {"person", 0.75}};
    for (size_t i = 0; i < sizeof classes / sizeof *classes; i++)
        if (strcmp(name, classes[i].name) == 0) {
            *size_m = classes[i].size_m;
            return true;
        }
    return false;
}

static bool read_criteria(double out[acquisition_tasks], const char *name)
{
    for (int i = 0; i < johnson_criteria_count; i++)
        if (strcmp(name, johnson_criteria[i].name) == 0) {
            memcpy(out, johnson_criteria[i].at50, sizeof johnson_criteria[i].at50);
            return true;
        }
    return false;
}

/* Returns 0 if the arguments are valid; else the program exits with this code - 1. */
static int parse(RangeOptions *o, int argc, char **argv)
{
    enum {
        OUT = 'o',
        CONFIG = 'c',
        CLASS = 256,
        SIZE,
        CONTRAST,
        VISIBILITY,
        AIR,
        HEIGHT,
        SUN,
        FAR,
        CRITERIA,
        N50,
        V50,
        PROBABILITY,
        OVERWRITE,
        HELP
    };
    static const struct option options[] = {{"out", 1, NULL, OUT},
                                            {"class", 1, NULL, CLASS},
                                            {"size", 1, NULL, SIZE},
                                            {"contrast", 1, NULL, CONTRAST},
                                            {"visibility", 1, NULL, VISIBILITY},
                                            {"air", 1, NULL, AIR},
                                            {"height", 1, NULL, HEIGHT},
                                            {"sun", 1, NULL, SUN},
                                            {"far", 1, NULL, FAR},
                                            {"criteria", 1, NULL, CRITERIA},
                                            {"n50", 1, NULL, N50},
                                            {"v50", 1, NULL, V50},
                                            {"probability", 1, NULL, PROBABILITY},
                                            {"overwrite", 0, NULL, OVERWRITE},
                                            {"config", 1, NULL, CONFIG},
                                            {"help", 0, NULL, HELP},
                                            {NULL, 0, NULL, 0}};
    RangeScene                *s = &o->scene;
    *o = (RangeOptions){.probability = 0.5,
                        .scene = {.size_m = 2.3,
                                  .contrast = NAN,
                                  .observer_m = 2,
                                  .sun_rad = 45 * rad_per_deg,
                                  .visibility_m = 23e3,
                                  .air = "us1976",
                                  .far_m = NAN}};
    memcpy(s->at50[BY_JOHNSON], johnson_criteria[0].at50, sizeof s->at50[BY_JOHNSON]);
    memcpy(s->at50[BY_TTP], ttp_criteria.at50, sizeof s->at50[BY_TTP]);
    optind = 0; /* restart getopt */
    for (int option; (option = command_line_option(argc, argv, "c:o:", options)) != -1;) {
        switch (option) {
        case OUT:
            if (!*optarg) return refuse("--out", "needs a folder");
            o->out = optarg;
            break;
        case CONFIG:
            o->config = optarg;
            break;
        case CLASS:
            if (!read_class(&s->size_m, optarg)) return refuse("--class", "needs nato, tank or person; or use --size");
            break;
        case SIZE:
            if (!in_range(&s->size_m, optarg, 0.01, 1000, 1)) return refuse("--size", "needs 0.01 .. 1000 m");
            break;
        case CONTRAST:
            if (!in_range(&s->contrast, optarg, -1000, 1000, 1) || s->contrast == 0)
                return refuse("--contrast", "needs -1000 .. 1000, not 0");
            break;
        case VISIBILITY:
            if (!in_range(&s->visibility_m, optarg, 0.4, 300, 1e3))
                return refuse("--visibility", "needs 0.4 .. 300 km");
            break;
        case AIR:
            if (!*optarg) return refuse("--air", "needs a model of etc/atmosphere, as us1976");
            s->air = optarg;
            break;
        case HEIGHT:
            if (!in_range(&s->observer_m, optarg, 0, 20000, 1)) return refuse("--height", "needs 0 .. 20000 m");
            break;
        case SUN:
            if (!in_range(&s->sun_rad, optarg, 1, 90, rad_per_deg)) return refuse("--sun", "needs 1 .. 90 deg");
            break;
        case FAR:
            if (!in_range(&s->far_m, optarg, 0.1, 1000, 1e3)) return refuse("--far", "needs 0.1 .. 1000 km");
            break;
        case CRITERIA:
            if (!read_criteria(s->at50[BY_JOHNSON], optarg))
                return refuse("--criteria", "needs acquire, johnson or stanag; or use --n50");
            break;
        case N50:
        case V50:
            if (!read_three(s->at50[option == N50 ? BY_JOHNSON : BY_TTP], optarg))
                return refuse(option == N50 ? "--n50" : "--v50",
                              "needs three numbers in 0.01 .. 1000, none below the one before it, as 0.75,3,6");
            break;
        case PROBABILITY:
            if (!in_range(&o->probability, optarg, 0.01, 0.99, 1)) return refuse("--probability", "needs 0.01 .. 0.99");
            break;
        case OVERWRITE:
            o->overwrite = true;
            break;
        case HELP:
            fputs(help, stdout);
            return 1 + 0;
        default:
            return 1 + 2; /* reported by command_line_option */
        }
    }
    if (optind == argc) return refuse("no sensor is named", "a row of etc/sensors.csv, or a data sheet's file");
    o->name = argv[optind];
    if (optind + 1 < argc) return refuse(argv[optind + 1], "one sensor at a time");
    return 0;
}

/* The sensor, with the channel that it is for in its place. */
static Status find_sensor(SensorPreset *p, const char *name)
{
    Status status = strpbrk(name, "./") ? preset_read_sheet(p, name) : sensors_find(p, name);
    if (status != STATUS_OK) return status;
    sensors_alone(p);
    return STATUS_OK;
}

/* ---- the products ----------------------------------------------------------------------------------- */

static void print_summary(const RangeCourse *c, double probability, const char *about)
{
    static const char *const by[range_methods] = {"Johnson", "TTP"};
    log_print("%s: %s\n", c->preset.name, about);
    log_print("ranges with a probability of %g:\n", probability);
    for (int method = 0; method < range_methods; method++) {
        log_print("%-8s", by[method]);
        for (int task = 0; task < acquisition_tasks; task++) {
            const double range_m = range_of(c, (RangeMethod)method, (AcquisitionTask)task, probability);
            if (range_m == 0) log_print("%s%s nowhere", task ? ", " : " ", range_task_names[task]);
            else
                log_print("%s%s %s%.3g km", task ? ", " : " ", range_task_names[task], isinf(range_m) ? "beyond " : "",
                          1e-3 * (isinf(range_m) ? c->row[range_rows - 1].range_m : range_m));
        }
        log_print("\n");
    }
}

int range_command(int argc, char **argv)
{
    static const char *const names[] = {"range.csv", "range.svg"};
    static OutputPath        path[2];
    static RangeCourse       course;
    RangeOptions             o;
    char                     about[200];
    thread_flush_denormals();
    const int stop = parse(&o, argc, argv);
    if (stop) return stop - 1;
    if (config_tables_of(o.config) != STATUS_OK) return 1;
    course.scene = o.scene;
    Status status = find_sensor(&course.preset, o.name);
    if (status == STATUS_OK && isnan(course.scene.contrast))
        course.scene.contrast = course.preset.band == BAND_OPTICAL ? 0.3 : 2;
    if (status == STATUS_OK) status = range_course_make(&course);
    if (status == STATUS_OK)
        status = overwrite_files(path, &(OutputFiles){.command = "range",
                                                      .count = 2,
                                                      .name = names,
                                                      .given = o.out,
                                                      .model = o.name,
                                                      .endings = ".",
                                                      .overwrite = o.overwrite});
    snprintf(about, sizeof about, "target of %g m, contrast %g%s; visibility %g km, %.60s", course.scene.size_m,
             course.scene.contrast, course.preset.band == BAND_OPTICAL ? "" : " K", 1e-3 * course.scene.visibility_m,
             course.scene.air);
    const RangeText text = {&course, about};
    if (status == STATUS_OK) status = text_write_file("range", path[0], range_csv, &text);
    if (status == STATUS_OK) status = text_write_file("range", path[1], range_plot, &text);
    if (status == STATUS_OK) print_summary(&course, o.probability, about);
    range_course_close(&course);
    return status == STATUS_OK ? 0 : 1;
}
