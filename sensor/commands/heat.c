/* sensor/commands/heat.c: `pitviper heat`: the command line, the files and the summary of a vehicle's day. */
#include "sensor/commands/heat.h"

#include "sensor/commands/heat_day.h"
#include "sensor/commands/output_files.h"
#include "sensor/settings/config.h"
#include "sensor/settings/next_option.h"

#include <sys/stat.h>
#include <unistd.h>

static const char help[] =
    "usage: pitviper heat NAME|FILE [-o FOLDER] [--at LAT LON] [--day DAY] [--drive FROM-TO] [--heading DEG]\n"
    "                     [--step S] [-c FILE] [--overwrite]\n"
    "\n"
    "A vehicle's temperatures over a clear day. It stands on level grass, its engine stopped unless --drive is given;\n"
    "the air is 288 K on average with a range of 10 K. Hours are of local mean solar time.\n"
    "\n"
    "NAME: a built-in model (tank, truck, helicopter ...). FILE: as `pitviper model show` takes it. Writes to FOLDER:\n"
    "  nodes.csv          a row each ten minutes, K: air, ground, mean of the vehicle over the ground (dt_k), engine,\n"
    "                     cabin, and each patch of its skin: its part and the side it faces\n"
    "  nodes.svg          a plot of the means of its parts, with the times at which dt_k changes sign\n"
    "  mwir.png lwir.png  the vehicle at 00, 03 ... 21 h from the south-east, in apparent temperature\n"
    "\n"
    "  --out FOLDER       or -o (default: NAME_heat in the current folder)\n"
    "  --at LAT LON       degrees, -90 .. 90 and -180 .. 180 (48 11)\n"
    "  --day DAY          in 1900 .. 2100 (2026-06-21)\n"
    "  --drive FROM-TO    hours between which it drives, e.g. 06:00-07:30: 10 m/s, without leaving its place\n"
    "  --heading DEG      of its nose, clockwise from north, -360 .. 360 (270)\n"
    "  --step S           time step, a divisor of 600 s from 1 s (60)\n"
    "  --config FILE      or -c: settings, whose models.materials are read\n"
    "  --overwrite        replace these files in FOLDER; without it that is an error\n";

typedef struct HeatOptions {
    const char   *name, *out, *day, *config;
    double        lat_deg, lon_deg, begin_s;
    char          drive[48];
    HeatDayConfig course;
    bool          overwrite;
} HeatOptions;

static int refuse(const char *option, const char *what)
{
    return 1 + wrong_line("heat", "%s: %s", option, what);
}

static bool in_range(double *out, const char *text, double low, double high)
{
    return text && text_to_double(out, text) && *out >= low && *out <= high;
}

/* Midnight of local mean solar time. */
static bool read_day(double *begin_s, const char *day, double lon_deg)
{
    char text[40];
    if (!day || strlen(day) != 10) return false;
    snprintf(text, sizeof text, "%sT00:00:00Z", day);
    if (!text_to_unix_s(begin_s, text)) return false;
    *begin_s -= 240 * lon_deg;
    return true;
}

static bool read_drive(HeatOptions *o, const char *text)
{
    int h0, m0, h1, m1, used = 0;
    if (!text || sscanf(text, "%2d:%2d-%2d:%2d%n", &h0, &m0, &h1, &m1, &used) != 4 || text[used] || used > 11 ||
        h0 < 0 || m0 < 0 || m0 > 59 || h1 < 0 || m1 < 0 || m1 > 59)
        return false;
    o->course.drive_from_s = 3600 * h0 + 60 * m0;
    o->course.drive_to_s   = 3600 * h1 + 60 * m1;
    snprintf(o->drive, sizeof o->drive, "%02d:%02d-%02d:%02d", h0, m0, h1, m1);
    return o->course.drive_from_s < o->course.drive_to_s && o->course.drive_to_s <= 86400;
}

/* 0: valid; else exit with this code - 1. */
static int parse(HeatOptions *o, int argc, char **argv)
{
    enum { OUT = 'o', CONFIG = 'c', AT = 256, DAY, DRIVE, HEADING, STEP, OVERWRITE, HELP };
    static const struct option options[] = {
        {"out", 1, NULL, OUT},         {"at", 1, NULL, AT},     {"day", 1, NULL, DAY},
        {"drive", 1, NULL, DRIVE},     {"heading", 1, NULL, HEADING}, {"step", 1, NULL, STEP},
        {"overwrite", 0, NULL, OVERWRITE}, {"config", 1, NULL, CONFIG}, {"help", 0, NULL, HELP}, {NULL, 0, NULL, 0}};
    double heading_deg = 270;
    *o = (HeatOptions){.day = "2026-06-21", .lat_deg = 48, .lon_deg = 11, .course = {.step_s = 60}};
    optind = 0; /* restart getopt */
    for (int option; (option = next_option(argc, argv, "c:o:", options)) != -1;) {
        const char *second = NULL;
        switch (option) {
        case OUT:
            if (!*optarg) return refuse("--out", "needs a folder");
            o->out = optarg;
            break;
        case CONFIG: o->config = optarg; break;
        case AT: /* takes two words */
            second = optind < argc ? argv[optind++] : NULL;
            if (!in_range(&o->lat_deg, optarg, -90, 90) || !in_range(&o->lon_deg, second, -180, 180))
                return refuse("--at", "needs a latitude in -90 .. 90 and a longitude in -180 .. 180 deg");
            break;
        case DAY:
            if (!read_day(&o->begin_s, optarg, 0)) return refuse("--day", "needs a day in 1900 .. 2100, as 2026-06-21");
            o->day = optarg;
            break;
        case DRIVE:
            if (!read_drive(o, optarg))
                return refuse("--drive", "needs hours of the day, the earlier first, as 06:00-07:30");
            break;
        case HEADING:
            if (!in_range(&heading_deg, optarg, -360, 360))
                return refuse("--heading", "needs an angle in -360 .. 360 deg");
            break;
        case STEP:
            if (!in_range(&o->course.step_s, optarg, 1, heat_day_row_s) || fmod(heat_day_row_s, o->course.step_s) != 0)
                return refuse("--step", "needs a divisor of 600 s, from 1 s");
            break;
        case OVERWRITE: o->overwrite = true; break;
        case HELP: fputs(help, stdout); return 1 + 0;
        default: return 1 + 2; /* reported by next_option */
        }
    }
    if (optind == argc) return refuse("no model is named", "a built-in name, or a file");
    o->name = argv[optind];
    if (optind + 1 < argc) return refuse(argv[optind + 1], "one model at a time");
    if (!read_day(&o->begin_s, o->day, o->lon_deg))
        return refuse("--day", "needs a day in 1900 .. 2100, as 2026-06-21");
    o->course.heading_rad = heading_deg * rad_per_deg;
    return 0;
}

/* ---- files ------------------------------------------------------------------------------------------ */

enum { file_csv, file_svg, file_mwir, file_lwir, file_count };

static Status make_paths(OutputPath path[file_count], const HeatOptions *o)
{
    static const char *const names[file_count] = {"nodes.csv", "nodes.svg", "mwir.png", "lwir.png"};
    return output_files(path, names, file_count, "heat", o->out, o->name, ".", o->overwrite);
}

/* What is drawn of a day, and its caption. */
typedef struct HeatText {
    const HeatDay *day;
    const char    *about;
} HeatText;

static void put_csv(FILE *to, const void *text) { heat_day_write_csv(to, ((const HeatText *)text)->day); }
static void put_plot(FILE *to, const void *text) { heat_day_plot(to, ((const HeatText *)text)->day, ((const HeatText *)text)->about); }

static Status write_files(const HeatDay *day, const HeatImages *images, const ModelStage *stage, const HeatOptions *o,
                          OutputPath path[])
{
    char about[256], drive[64] = "engine stopped";
    if (*o->drive) snprintf(drive, sizeof drive, "drives %s", o->drive);
    snprintf(about, sizeof about, "clear day %s at %g %c %g %c, nose to %g deg, %s; level grass", o->day,
             fabs(o->lat_deg), o->lat_deg < 0 ? 'S' : 'N', fabs(o->lon_deg), o->lon_deg < 0 ? 'W' : 'E',
             o->course.heading_rad / rad_per_deg, drive);
    const HeatText text = {day, about};
    Status         status = text_write_file("heat", path[file_csv], put_csv, &text);
    if (status == STATUS_OK) status = text_write_file("heat", path[file_svg], put_plot, &text);
    const char *const sheets[2] = {path[file_mwir], path[file_lwir]};
    return status == STATUS_OK ? heat_images_write(images, stage, sheets) : status;
}

/* ---- the summary ---------------------------------------------------------------------------------- */

static void print_hour(double hour)
{
    const int minutes = (int)(60 * hour + 0.5);
    log_print("%02d:%02d", minutes / 60, minutes % 60);
}

static void print_summary(const HeatDay *day)
{
    int least = 0, most = 0, hot_row = 0, hot = 0;
    for (int r = 0; r < heat_day_rows; r++) {
        if (day->row[r].dt_k < day->row[least].dt_k) least = r;
        if (day->row[r].dt_k > day->row[most].dt_k) most = r;
        for (int i = 0; i < day->patches; i++)
            if (day->patch_k[(size_t)r * (size_t)day->patches + (size_t)i] >
                day->patch_k[(size_t)hot_row * (size_t)day->patches + (size_t)hot])
                hot_row = r, hot = i;
    }
    log_print("%s: %d patches; local mean solar time\n", day->model, day->patches);
    log_print("crossover of vehicle and ground:");
    for (int i = 0; i < day->crossings; i++) {
        log_print(i ? ", " : " ");
        print_hour(day->crossing_h[i]);
    }
    log_print(day->crossings ? "\n" : " none\n");
    const struct { const char *what; int row; } extremes[] = {{"warmest over the ground", most}, {"coldest", least}};
    for (int k = 0; k < 2; k++) {
        log_print("%s: %+.1f K at ", extremes[k].what, day->row[extremes[k].row].dt_k);
        print_hour(extremes[k].row * heat_day_row_s / 3600.0);
        log_print("\n");
    }
    log_print("hottest patch: %s, %.1f K at ", day->name[hot],
              (double)day->patch_k[(size_t)hot_row * (size_t)day->patches + (size_t)hot]);
    print_hour(hot_row * heat_day_row_s / 3600.0);
    log_print("\n");
}

int heat_command(int argc, char **argv)
{
    static OutputPath path[file_count];
    HeatOptions o;
    thread_flush_denormals();
    const int stop = parse(&o, argc, argv);
    if (stop) return stop - 1;
    if (config_tables_of(o.config) != STATUS_OK) return 1;
    ModelStage             stage = {0};
    HeatDay                day = {0};
    HeatImages             images = {0};
    const Geodetic         origin = {.lat_rad = o.lat_deg * rad_per_deg, .lon_rad = o.lon_deg * rad_per_deg};
    const ModelStageConfig about = {o.name, 0.005, origin, o.begin_s, SURFACE_GRASS};
    etc_own_set("catalog.csv", NULL); /* that model, whatever its entity types */
    Status status = model_stage_open(&stage, &about);
    if (status == STATUS_OK) status = make_paths(path, &o);
    if (status == STATUS_OK) status = heat_images_open(&images);
    if (status == STATUS_OK) status = heat_day_run(&day, &images, &stage, &o.course);
    if (status == STATUS_OK) status = write_files(&day, &images, &stage, &o, path);
    if (status == STATUS_OK) print_summary(&day);
    if (status == STATUS_NO_MEMORY) log_error("heat: out of memory: %s", o.name);
    heat_images_close(&images);
    heat_day_free(&day);
    model_stage_close(&stage);
    return status == STATUS_OK ? 0 : 1;
}
