/* sensor/commands/heat/heat_command.c: `pitviper heat`: the command line, the files, the plot and the summary of a
 * vehicle's day. */
#include "sensor/commands/commands.h"

#include "sensor/commands/heat/heat_day_private.h"
#include "sensor/commands/overwrite.h"
#include "sensor/publish/files/svg_plot.h"
#include "sensor/settings/command_line.h"
#include "sensor/settings/config.h"

#include <sys/stat.h>
#include <unistd.h>

/* ---- the plot: SVG, temperatures of its parts, air and ground by the hour --------------------------- */

enum { width_px = 900, height_px = 470, legend_x = 668, most_parts = 10 };

static const SvgBox  box = {.left = 58, .right = 650, .top = 74, .bottom = 416};
static const SvgAxis hours = {SVG_HOURS, 0, 24, 58, 650, 9, {0, 3, 6, 9, 12, 15, 18, 21, 24}};

typedef struct Curve {
    const char *name;
    SvgPen      pen;
    double      area_m2, low_k, high_k, k[heat_day_rows];
} Curve;

static double row_y(int row) { return box.top + 22 * row + 20; }

static void find_range(Curve *c)
{
    c->low_k = INFINITY, c->high_k = -INFINITY;
    for (int r = 0; r < heat_day_rows; r++) c->low_k = fmin(c->low_k, c->k[r]), c->high_k = fmax(c->high_k, c->k[r]);
}

/* The curve of a part: the mean by area of all patches of parts of this name. */
static void part_curve(Curve *out, const HeatDay *day, const char *part)
{
    *out = (Curve){.name = part};
    for (int i = 0; i < day->patches; i++) {
        if (strcmp(day->part[i], part) != 0) continue;
        out->area_m2 += day->area_m2[i];
        for (int r = 0; r < heat_day_rows; r++)
            out->k[r] += day->area_m2[i] * (double)day->patch_k[(size_t)r * (size_t)day->patches + (size_t)i];
    }
    for (int r = 0; r < heat_day_rows; r++) out->k[r] /= out->area_m2;
    find_range(out);
}

/* The curves of the parts of the largest area, largest first. */
static int part_curves(Curve out[most_parts], const HeatDay *day)
{
    int count = 0;
    for (int i = 0; i < day->patches; i++) {
        bool known = false;
        for (int k = 0; k < i; k++) known |= strcmp(day->part[k], day->part[i]) == 0;
        if (known) continue;
        Curve curve;
        part_curve(&curve, day, day->part[i]);
        int at = count;
        while (at > 0 && out[at - 1].area_m2 < curve.area_m2) at--;
        if (at == most_parts) continue;
        count += count < most_parts;
        for (int k = count - 1; k > at; k--) out[k] = out[k - 1];
        out[at] = curve;
    }
    return count;
}

/* Draws a curve, and its row of the legend. */
static void draw_curve(FILE *to, const Curve *c, const SvgAxis *kelvin, int row)
{
    char name[21];
    svg_curve_begin(to, &c->pen);
    for (int r = 0; r < heat_day_rows; r++)
        svg_curve_point(to, svg_at(&hours, r * heat_day_row_s / 3600.0), svg_at(kelvin, c->k[r]));
    svg_curve_end(to);
    snprintf(name, sizeof name, "%s", c->name);
    svg_legend(to, &c->pen, legend_x, row_y(row), name);
    svg_text(to, SVG_DIM, SVG_RIGHT, width_px - 12, row_y(row) + 4, "%.1f \u2013 %.1f", c->low_k, c->high_k);
}

/* Marks when the vehicle is as warm as the ground. */
static void draw_crossings(FILE *to, const HeatDay *day, int row)
{
    const SvgPen pen = {SVG_RED, 1, "2 3"};
    bool         raised = false;
    for (int i = 0; i < day->crossings; i++) {
        const double x = svg_at(&hours, day->crossing_h[i]);
        const int    minutes = (int)(60 * day->crossing_h[i] + 0.5);
        const bool   close = i > 0 && x - svg_at(&hours, day->crossing_h[i - 1]) < 36;
        raised = close && !raised; /* so that its label stands clear of the one before */
        svg_line(to, &pen, x, box.top, x, box.bottom);
        svg_text(to, SVG_RED, SVG_MIDDLE, x, box.top - (raised ? 17 : 5), "%02d:%02d", minutes / 60, minutes % 60);
    }
    if (day->crossings > 0) svg_legend(to, &pen, legend_x, row_y(row), "contrast crossover");
}

/* Draws all of it. about: the line below the title. */
static void plot_day(FILE *to, const HeatDay *day, const char *about)
{
    static const char *const colours[most_parts] = {"#1f77b4", "#e0a100", "#2ca02c", "#d1495b", "#6a4c93",
                                                    "#17a2a2", "#a0522d", "#e377c2", "#7f7f7f", "#8bc34a"};
    static Curve             curve[most_parts + 2];
    double                   low_k = INFINITY, high_k = -INFINITY;
    int                      count = part_curves(curve, day);
    for (int i = 0; i < count; i++) curve[i].pen = (SvgPen){colours[i], 2, NULL};
    Curve *air = &curve[count++], *ground = &curve[count++];
    *air = (Curve){.name = "air", .pen = {"#5b8db8", 2, "6 4"}};
    *ground = (Curve){.name = "ground", .pen = {"#5a7d3a", 2, "6 4"}};
    for (int r = 0; r < heat_day_rows; r++) air->k[r] = day->row[r].air_k, ground->k[r] = day->row[r].ground_k;
    find_range(air);
    find_range(ground);
    for (int i = 0; i < count; i++) low_k = fmin(low_k, curve[i].low_k), high_k = fmax(high_k, curve[i].high_k);
    const SvgAxis kelvin = svg_linear_axis(low_k, high_k, box.bottom, box.top);

    svg_begin(to, width_px, height_px, day->model, ": temperatures of its parts, means by area", about);
    svg_axes(to, &box, &hours, "local mean solar time, h", &kelvin, "temperature, K");
    for (int i = 0; i < count; i++) draw_curve(to, &curve[i], &kelvin, i);
    draw_crossings(to, day, count);
    svg_text(to, SVG_DIM, SVG_RIGHT, width_px - 12, box.top + 2, "coldest \u2013 warmest, K");
    svg_end(to);
}

/* ---- the command line ------------------------------------------------------------------------------- */

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
    return 1 + command_line_wrong("heat", "%s: %s", option, what);
}

static bool in_range(double *out, const char *text, double low, double high)
{
    return text && text_to_double(out, text) && *out >= low && *out <= high;
}

/* Reads a day as the Unix time of its midnight in local mean solar time. */
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
    o->course.drive_to_s = 3600 * h1 + 60 * m1;
    snprintf(o->drive, sizeof o->drive, "%02d:%02d-%02d:%02d", h0, m0, h1, m1);
    return o->course.drive_from_s < o->course.drive_to_s && o->course.drive_to_s <= 86400;
}

/* Returns 0 if the arguments are valid; else the program exits with this code - 1. */
static int parse(HeatOptions *o, int argc, char **argv)
{
    enum { OUT = 'o', CONFIG = 'c', AT = 256, DAY, DRIVE, HEADING, STEP, OVERWRITE, HELP };
    static const struct option options[] = {{"out", 1, NULL, OUT},
                                            {"at", 1, NULL, AT},
                                            {"day", 1, NULL, DAY},
                                            {"drive", 1, NULL, DRIVE},
                                            {"heading", 1, NULL, HEADING},
                                            {"step", 1, NULL, STEP},
                                            {"overwrite", 0, NULL, OVERWRITE},
                                            {"config", 1, NULL, CONFIG},
                                            {"help", 0, NULL, HELP},
                                            {NULL, 0, NULL, 0}};
    double                     heading_deg = 270;
    *o = (HeatOptions){.day = "2026-06-21", .lat_deg = 48, .lon_deg = 11, .course = {.step_s = 60}};
    optind = 0; /* restart getopt */
    for (int option; (option = command_line_option(argc, argv, "c:o:", options)) != -1;) {
        const char *second = NULL;
        switch (option) {
        case OUT:
            if (!*optarg) return refuse("--out", "needs a folder");
            o->out = optarg;
            break;
        case CONFIG:
            o->config = optarg;
            break;
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
    return overwrite_files(path, &(OutputFiles){.command = "heat",
                                                .count = file_count,
                                                .name = names,
                                                .given = o->out,
                                                .model = o->name,
                                                .endings = ".",
                                                .overwrite = o->overwrite});
}

/* What is drawn of a day, and its caption. */
typedef struct HeatText {
    const HeatDay *day;
    const char    *about;
} HeatText;

static void put_csv(FILE *to, const void *text) { heat_day_write_csv(to, ((const HeatText *)text)->day); }
static void put_plot(FILE *to, const void *text)
{
    plot_day(to, ((const HeatText *)text)->day, ((const HeatText *)text)->about);
}

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
    const struct {
        const char *what;
        int         row;
    } extremes[] = {{"warmest over the ground", most}, {"coldest", least}};
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
    HeatOptions       o;
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
