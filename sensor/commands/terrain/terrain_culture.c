/* sensor/commands/terrain/terrain_culture.c: `pitviper terrain culture`: what files of buildings, roads and trees hold:
 * counts, heights, what is left out and why; and all records as GeoJSON. */
#include "sensor/commands/commands.h"

#include "pitviper_output.h"
#include "sensor/commands/overwrite.h"
#include "sensor/settings/command_line.h"
#include "terrain/from_files/culture_import.h"
#include "terrain/store/store.h"
#include "terrain/woods/plant.h"

#include <errno.h>
#include <stdlib.h>

static const char help[] =
    "usage: pitviper terrain culture FILE... [--trees TABLE] [--store STORE | --at LAT,LON] [--half-width M]\n"
    "                                [-o OUT.geojson [--overwrite]]\n"
    "\n"
    "What a node would have of files of buildings, walls, roads, power lines, poles and trees (terrain.buildings,\n"
    "terrain.trees): counts by kind, heights, what was left out and why. FILE: GeoJSON, Shapefile, GeoPackage or\n"
    "FlatGeobuf, in any coordinate system (FILE@srs=EPSG:32633 where it does not say it), with OpenStreetMap's tags or\n"
    "heights of their own; etc/culture_tags.csv has what each attribute means.\n"
    "\n"
    "  --trees TABLE       a table of trees (CSV): lat and lon, or x_m and y_m; kind, height_m, marked\n"
    "  --store STORE       the terrain store that they stand on; without it level ground at the ellipsoid\n"
    "  --at LAT,LON        middle of the square, degrees (the store's, else that of the files)\n"
    "  --half-width M      half its width, 10 .. 100000 m (20000)\n"
    "  -o, --out FILE      every record as GeoJSON, in longitude and latitude\n"
    "  --overwrite         replace it if it exists\n";

typedef struct Wanted {
    char        files[4096];
    const char *trees, *store, *out;
    Geodetic    at;
    bool        has_at, overwrite;
    double      half_m;
} Wanted;

static bool parse_at(Wanted *w, const char *text)
{
    double lat, lon;
    int    end = 0;
    if (sscanf(text, "%lf,%lf%n", &lat, &lon, &end) != 2 || text[end] || !(fabs(lat) <= 90) || !(fabs(lon) <= 360))
        return false;
    w->at = (Geodetic){.lat_rad = lat * rad_per_deg, .lon_rad = remainder(lon * rad_per_deg, 2 * pi_rad)};
    w->has_at = true;
    return true;
}

/* 0: go on, -1: help was printed, 2: usage. */
static int parse(Wanted *w, int argc, char **argv)
{
    enum { OUT = 'o', HELP = 'h', OVERWRITE = 256, TREES, STORE, AT, HALF };
    static const struct option options[] = {
        {"out", 1, NULL, OUT}, {"overwrite", 0, NULL, OVERWRITE}, {"trees", 1, NULL, TREES}, {"store", 1, NULL, STORE},
        {"at", 1, NULL, AT},   {"half-width", 1, NULL, HALF},     {"help", 0, NULL, HELP},   {NULL, 0, NULL, 0}};
    w->half_m = 20000;
    optind = 0; /* restart getopt */
    for (int option; (option = command_line_option(argc, argv, "o:h", options)) != -1;) switch (option) {
        case OUT:
            w->out = optarg;
            break;
        case OVERWRITE:
            w->overwrite = true;
            break;
        case TREES:
            w->trees = optarg;
            break;
        case STORE:
            w->store = optarg;
            break;
        case AT:
            if (!parse_at(w, optarg)) return command_line_wrong("terrain culture", "--at needs LAT,LON in degrees");
            break;
        case HALF:
            if (!text_to_double(&w->half_m, optarg) || !(w->half_m >= 10 && w->half_m <= 100000))
                return command_line_wrong("terrain culture", "--half-width needs a number in 10 .. 100000, metres");
            break;
        case HELP:
            fputs(help, stdout);
            return -1;
        default:
            return 2;
        }
    size_t used = 0;
    for (; optind < argc; optind++) {
        const int n = snprintf(w->files + used, sizeof w->files - used, "%s%s", used ? "," : "", argv[optind]);
        if (n < 0 || used + (size_t)n >= sizeof w->files)
            return command_line_wrong("terrain culture", "the names of the files are too long");
        used += (size_t)n;
    }
    if (used == 0 && !w->trees) return command_line_wrong("terrain culture", "no FILE is named");
    if (w->store && w->has_at)
        return command_line_wrong("terrain culture", "--store has a middle of its own: leave out --at");
    return 0;
}

static double ground_of(void *user, double x_m, double y_m) { return elevation_height(user, x_m, y_m, NULL); }

/* ---- in words ---------------------------------------------------------------------------------------- */

static void print_kinds(const char *what, int all, const int *count, int kinds, const char *(*name)(int))
{
    printf("%s: %d", what, all);
    for (int k = 0, shown = 0; k < kinds; k++)
        if (count[k] > 0) printf("%s%d %s", shown++ ? ", " : ": ", count[k], name(k));
    putchar('\n');
}

static const char *name_of_plant(int kind) { return plant_name((PlantKind)kind); }

static void print_culture(const Culture *c, const CultureReport *r, const Geodetic *at, const Wanted *w)
{
    int  use[BUILDING_USES] = {0}, line[CULTURE_LINE_KINDS] = {0}, point[CULTURE_POINT_KINDS] = {0};
    int  tree[PLANT_STANDING] = {0};
    char left[512];
    for (int n = 0; n < c->buildings; n++) use[c->building[n].use]++;
    for (int n = 0; n < c->lines; n++) line[c->line[n].kind]++;
    for (int n = 0; n < c->points; n++) point[c->point[n].kind]++;
    for (int n = 0; n < c->trees; n++) tree[c->tree[n].kind]++;
    printf("%lld features, within %.6g m of %.6f N, %.6f E\n", (long long)r->features, w->half_m,
           at->lat_rad / rad_per_deg, at->lon_rad / rad_per_deg);
    print_kinds("buildings", c->buildings, use, BUILDING_USES, culture_use_name);
    if (c->buildings > 0)
        printf("  %.1f .. %.1f m high; height stated of %d, by levels of %d, by use and size of %d\n", r->low_m,
               r->high_m, r->height_from[0], r->height_from[1], r->height_from[2]);
    if (r->courtyards > 0) printf("  %d courtyards\n", r->courtyards);
    if (r->built_over > 0) printf("  %d courtyards are built over: small, or entangled\n", r->built_over);
    print_kinds("lines", c->lines, line, CULTURE_LINE_KINDS, culture_line_name);
    print_kinds("points", c->points, point, CULTURE_POINT_KINDS, culture_point_name);
    print_kinds("trees", c->trees, tree, PLANT_STANDING, name_of_plant);
    if (r->trees_marked > 0) printf("  %d with marked trunks\n", r->trees_marked);
    culture_report_left(left, sizeof left, r);
    printf("left out: %s\n", *left ? left : "none");
    if (r->mended + r->unread > 0)
        printf("numbers left aside: %d that could not be true, %d that are none\n", r->mended, r->unread);
}

/* ---- the command -------------------------------------------------------------------------------------- */

static Status show(const Wanted *w, const Geodetic *at, const LocalFrame *frame, const TerrainStore *store)
{
    Culture            culture = {0};
    CultureReport      report;
    Elevation          elevation = store ? store->elevation : (Elevation){0};
    const CultureFiles from = {.buildings = w->files,
                               .trees = w->trees,
                               .frame = frame,
                               .ground = store ? ground_of : NULL,
                               .user = &elevation,
                               .half_m = w->half_m};
    Status             status = culture_open(&culture, &report, &from);
    if (status != STATUS_OK) return status;
    print_culture(&culture, &report, at, w);
    if (w->out) status = culture_write_geojson(w->out, &culture, &from);
    culture_free(&culture);
    return status;
}

int terrain_culture_command(int argc, char **argv)
{
    Wanted      *w = calloc(1, sizeof *w);
    TerrainStore store;
    LocalFrame   frame;
    if (!w) return 1;
    const int code = parse(w, argc, argv);
    if (code) {
        free(w);
        return code < 0 ? 0 : code;
    }
    Status status = w->out ? overwrite_file("terrain culture", w->out, w->overwrite) : STATUS_OK;
    if (status == STATUS_OK && w->out && output_check(w->out, OUTPUT_STREAM) != 0) {
        log_error("terrain culture: cannot write %s: %s; choose another name with -o", w->out, output_reason(errno));
        status = STATUS_IO;
    }
    bool opened = false;
    if (status == STATUS_OK && w->store) {
        status = store_open(&store, w->store);
        opened = status == STATUS_OK;
    }
    if (status == STATUS_OK && opened) frame = store.frame, w->at = frame.origin;
    else if (status == STATUS_OK) {
        if (!w->has_at && !*w->files) {
            log_error("terrain culture: a table alone has no middle; say it with --at LAT,LON");
            status = STATUS_BAD_VALUE;
        } else if (!w->has_at && !culture_middle(&w->at, w->files)) status = STATUS_BAD_VALUE;
        if (status == STATUS_OK) status = local_frame_at(&frame, &w->at);
    }
    if (status == STATUS_OK) status = show(w, &w->at, &frame, opened ? &store : NULL);
    if (status == STATUS_NO_MEMORY) log_error("terrain culture: out of memory; --half-width takes a part");
    if (opened) store_close(&store);
    free(w);
    return status == STATUS_OK ? 0 : 1;
}
