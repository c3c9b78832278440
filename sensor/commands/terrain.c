/* sensor/commands/terrain.c: `pitviper terrain import`, and the table of the command's actions. */
#include "sensor/commands/terrain.h"
#include "pitviper_output.h"

#include "sensor/commands/terrain_again.h"
#include "sensor/commands/terrain_info.h"
#include "sensor/commands/terrain_report.h"
#include "sensor/node/overwrite.h"
#include "sensor/node/stop.h"
#include "sensor/settings/next_option.h"
#include "terrain/import/terrain_import.h"

#include <errno.h>
#include <stdlib.h>

static const char help[] =
    "usage: pitviper terrain import SOURCE... -o STORE [options]\n"
    "       pitviper terrain import --surface FILES -o STORE [options]\n"
    "       pitviper terrain info STORE [--out DIR] [--verify]\n"
    "       pitviper terrain again STORE\n"
    "\n"
    "import: a terrain store, one file that is mapped (terrain.store), from any files that GDAL reads. SOURCE: terrain\n"
    "models, that is bare ground; files, or folders of them. Sheets may overlap, have different postings and coordinate\n"
    "systems, and holes: the finest wins, of equals the one given first; a large hole is filled from coarser files, a\n"
    "small one from its surroundings. What was read of each file is said before it is used; where a guess is wrong, say what\n"
    "is right: for all files by the options below, for one after its name: FILE:BAND, FILE@geoid, FILE@ellipsoid,\n"
    "FILE@us-ft (a unit), FILE@down (depths), FILE@nodata=-9999, FILE@nodata=none, FILE@srs=EPSG:32633, FILE@part=NAME (of a\n"
    "file of several grids).\n"
    "\n"
    "sources\n"
    "  --surface FILES        surface models, roofs and crowns included: taken apart into bare ground, buildings and\n"
    "                         trees, with the help of SOURCE where that is given; posts up to 4 m apart\n"
    "  --cover FILES          land cover classes\n"
    "  --cover-table TABLE    what its codes mean: worldcover, nlcd, fbfm40, dynamicworld, corine or a CSV (the one with\n"
    "                         most of the codes)\n"
    "  --photo FILES          an orthophoto, 8 bits, one band or three\n"
    "  --canopy-height FILE   height of the trees, m; of whole numbers above 80 tenths of a metre, as LANDFIRE's\n"
    "  --canopy-cover FILE    share of the ground under trees, percent\n"
    "  --vertical WHAT        heights are above: auto (by each file's coordinate system), geoid, ellipsoid (auto)\n"
    "  --unit UNIT            of the heights: m, dm, cm, ft, us-ft (as each file says)\n"
    "  --srs EPSG:N           coordinate system (as each file says)\n"
    "  --nodata N             a number that is no height; none: voids are those that a file declares, no others\n"
    "  --geoid FILE           geoid grid in PROJ's .gtx form (EGM96 of proj-data)\n"
    "  --sources-from FOLDERS where files may lie that others name (VRT), beside those in the folder of the one that names them\n"
    "terrain\n"
    "  --origin LAT,LON       middle of the terrain, degrees (middle of the finest file)\n"
    "  --size KMxKM           east by north, of the finest posts, each 0.01 .. 1000 (all data)\n"
    "  --spacing M            of the finest posts, 0.06 .. 1000 m (the finest file's)\n"
    "  --horizon KM           half width of the coarse posts around, 1 .. 400 (100)\n"
    "output\n"
    "  -o, --out STORE        the store; made again from the same sources when one of them changes and\n"
    "                         all lie in its folder; `terrain again STORE` makes it from any\n"
    "  --most-gb GB           refuse what would write more, or read 64 times as much, 0.001 .. 1000000 (16)\n"
    "  --overwrite            replace an existing STORE; without it that is an error\n"
    "  --threads N            1 .. 256 (all processors)\n"
    "  --json                 what was read and made as one JSON object on standard output\n";

static int refuse(const char *option, const char *what)
{
    return wrong_line("terrain", "%s: %s", option, what);
}

typedef struct Wanted {
    TerrainOptions terrain;
    const char    *out;
    bool           overwrite, json;
    long long      threads;
} Wanted;

/* 0: go on; else the exit code. */
static int parse(Wanted *w, int argc, char **argv)
{
    enum { OUT = 'o', HELP = 'h', OVERWRITE = 256, THREADS, JSON, VALUE };
    static const struct option options[] = {
        {"out", 1, NULL, OUT},
        {"overwrite", 0, NULL, OVERWRITE},
        {"threads", 1, NULL, THREADS},
        {"json", 0, NULL, JSON},
        {"help", 0, NULL, HELP},
        /* those of terrain/import/options.h */
        {"surface", 1, NULL, VALUE},
        {"cover", 1, NULL, VALUE + 1},
        {"cover-table", 1, NULL, VALUE + 2},
        {"photo", 1, NULL, VALUE + 3},
        {"canopy-height", 1, NULL, VALUE + 4},
        {"canopy-cover", 1, NULL, VALUE + 5},
        {"vertical", 1, NULL, VALUE + 6},
        {"unit", 1, NULL, VALUE + 7},
        {"srs", 1, NULL, VALUE + 8},
        {"nodata", 1, NULL, VALUE + 9},
        {"geoid", 1, NULL, VALUE + 10},
        {"origin", 1, NULL, VALUE + 11},
        {"size", 1, NULL, VALUE + 12},
        {"spacing", 1, NULL, VALUE + 13},
        {"horizon", 1, NULL, VALUE + 14},
        {"sources-from", 1, NULL, VALUE + 15},
        {"most-gb", 1, NULL, VALUE + 16},
        {NULL, 0, NULL, 0}};
    enum { own_options = 5 };
    const char *why = NULL;
    char        text[256], name[64];
    terrain_options_default(&w->terrain);
    w->threads = thread_processors();
    optind     = 0; /* restart getopt */
    for (int option; (option = next_option(argc, argv, "o:h", options)) != -1;) {
        const char *named = option >= VALUE ? options[own_options + option - VALUE].name : NULL;
        switch (option) {
        case OUT: w->out = optarg; break;
        case OVERWRITE: w->overwrite = true; break;
        case JSON: w->json = true; break;
        case THREADS:
            if (!text_to_long(&w->threads, optarg) || w->threads < 1 || w->threads > 256)
                return refuse("--threads", "needs a whole number in 1 .. 256");
            break;
        default:
            if (!named) return 2;
            if (terrain_options_set(&w->terrain, &why, named, optarg)) break;
            snprintf(name, sizeof name, "--%s", named);
            snprintf(text, sizeof text, "'%.80s' is not %s", optarg, why);
            return refuse(name, text);
        }
    }
    for (; optind < argc; optind++)
        if (!terrain_options_set(&w->terrain, &why, "elevation", argv[optind])) return refuse("SOURCE", why);
    why = terrain_options_fault(&w->terrain);
    if (why) return refuse("import", why);
    if (!w->out) return refuse("import", "needs -o STORE");
    return 0;
}

/* ---- progress -------------------------------------------------------------------- */

typedef struct Watching {
    double      begun_s;
    SourceLines sources;
} Watching;

static bool show(void *user, const char *stage, double share)
{
    const double begun_s = ((const Watching *)user)->begun_s;
    char         text[120];
    if (stop_asked()) return false;
    if (share < 0) {
        if (!((const Watching *)user)->sources.json) log_print("%s\n", stage);
        fflush(stdout); /* before a work of hours */
        return true;
    }
    if (wall_clock_s() - begun_s < 1) return true;
    snprintf(text, sizeof text, "terrain import: %s, %.0f %%", stage, 100 * share);
    log_status(text);
    return true;
}

static void heard(void *user, const ElevationSurvey *survey) { source_lines_add(&((Watching *)user)->sources, survey); }

static int import_command(int argc, char **argv)
{
    Wanted       *w = calloc(1, sizeof *w);
    TerrainReport r = {0};
    Pool         *pool = NULL;
    if (!w) return 1;
    int code = parse(w, argc, argv);
    if (code) {
        free(w);
        return code;
    }
    Status status = overwrite_file("terrain import", w->out, w->overwrite);
    if (status == STATUS_OK && output_check(w->out, 0) != 0) {
        log_error("terrain import: cannot write %s: %s; choose another name with -o", w->out, output_reason(errno));
        status = STATUS_IO;
    }
    if (status == STATUS_OK) status = pool_create(&pool, (int)w->threads);
    Watching           watching = {.begun_s = wall_clock_s(), .sources = {.json = w->json}};
    const TerrainWatch watch = {show, heard, &watching};
    stop_by_signals();
    if (status == STATUS_OK) status = terrain_import(&r, &w->terrain, w->out, pool, &watch);
    log_status(NULL);
    if (status == STATUS_OK) status = terrain_report(w->out, &r, wall_clock_s() - watching.begun_s, &watching.sources);
    source_lines_free(&watching.sources);
    if (status == STATUS_NO_MEMORY) log_error("terrain import: out of memory; --size takes a part");
    if (r.stopped) log_warn("terrain import: stopped: %s is as it was", w->out);
    code = r.stopped ? stop_exit_code() : status == STATUS_OK ? 0 : 1;
    pool_destroy(pool);
    free(w);
    return code;
}

int terrain_command(int argc, char **argv)
{
    static char called[] = "pitviper terrain", called_info[] = "pitviper terrain info",
                called_again[] = "pitviper terrain again";
    const bool  again = argc > 1 && strcmp(argv[1], "again") == 0;
    const bool  info = argc > 1 && strcmp(argv[1], "info") == 0; /* these have a help of their own */
    for (int i = 1; !info && !again && i < argc && strcmp(argv[i], "--") != 0; i++)
        if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0) {
            fputs(help, stdout);
            return 0;
        }
    if (argc < 2) return wrong_line("terrain", "no action: import or info");
    if (strcmp(argv[1], "import") == 0) {
        argv[1] = called; /* program name in getopt's messages */
        return import_command(argc - 1, argv + 1);
    }
    if (strcmp(argv[1], "info") == 0) {
        argv[1] = called_info;
        return terrain_info_command(argc - 1, argv + 1);
    }
    if (again) {
        argv[1] = called_again;
        return terrain_again_command(argc - 1, argv + 1);
    }
    WordMeant meant = word_meant(argv[1]);
    word_consider_list(&meant, "import|info|again", '|');
    return wrong_line("terrain", "no such action: %s%s", argv[1],
                      *word_hint(&meant) ? meant.hint : "; there are import, info and again");
}
