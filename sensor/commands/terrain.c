/* sensor/commands/terrain.c: `pitviper terrain import`, and the table of the command's actions. */
#include "sensor/commands/terrain.h"
#include "pitviper_output.h"

#include "sensor/commands/terrain_again.h"
#include "sensor/commands/terrain_info.h"
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
    "small one from its surroundings. FILE@geoid and FILE@ellipsoid state what one file's heights are above; FILE:BAND\n"
    "names a band.\n"
    "\n"
    "sources\n"
    "  --surface FILES        surface models, roofs and crowns included: taken apart into bare ground, buildings and\n"
    "                         trees, with the help of SOURCE where that is given; posts up to 4 m apart\n"
    "  --cover FILES          land cover classes\n"
    "  --cover-table TABLE    what its codes mean: worldcover, nlcd, fbfm40 or a CSV (the one with most of the codes)\n"
    "  --photo FILES          an orthophoto, 8 bits, one band or three\n"
    "  --canopy-height FILE   height of the trees, m; of whole numbers above 80 tenths of a metre, as LANDFIRE's\n"
    "  --canopy-cover FILE    share of the ground under trees, percent\n"
    "  --vertical WHAT        heights are above: auto (by each file's coordinate system), geoid, ellipsoid (auto)\n"
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
    "  --threads N            1 .. 256 (all processors)\n";

static int refuse(const char *option, const char *what)
{
    return wrong_line("terrain", "%s: %s", option, what);
}

typedef struct Wanted {
    TerrainOptions terrain;
    const char    *out;
    bool           overwrite;
    long long      threads;
} Wanted;

/* 0: go on; else the exit code. */
static int parse(Wanted *w, int argc, char **argv)
{
    enum { OUT = 'o', HELP = 'h', OVERWRITE = 256, THREADS, VALUE };
    static const struct option options[] = {
        {"out", 1, NULL, OUT},
        {"overwrite", 0, NULL, OVERWRITE},
        {"threads", 1, NULL, THREADS},
        {"help", 0, NULL, HELP},
        /* those of terrain/import/options.h */
        {"surface", 1, NULL, VALUE},
        {"cover", 1, NULL, VALUE + 1},
        {"cover-table", 1, NULL, VALUE + 2},
        {"photo", 1, NULL, VALUE + 3},
        {"canopy-height", 1, NULL, VALUE + 4},
        {"canopy-cover", 1, NULL, VALUE + 5},
        {"vertical", 1, NULL, VALUE + 6},
        {"geoid", 1, NULL, VALUE + 7},
        {"origin", 1, NULL, VALUE + 8},
        {"size", 1, NULL, VALUE + 9},
        {"spacing", 1, NULL, VALUE + 10},
        {"horizon", 1, NULL, VALUE + 11},
        {"sources-from", 1, NULL, VALUE + 12},
        {"most-gb", 1, NULL, VALUE + 13},
        {NULL, 0, NULL, 0}};
    enum { own_options = 4 };
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

/* ---- progress and summary -------------------------------------------------------------------- */

static bool show(void *user, const char *stage, double share)
{
    const double begun_s = *(const double *)user;
    char         text[120];
    if (stop_asked()) return false;
    if (share < 0) {
        log_print("%s\n", stage);
        fflush(stdout); /* before a work of hours */
        return true;
    }
    if (wall_clock_s() - begun_s < 1) return true;
    snprintf(text, sizeof text, "terrain import: %s, %.0f %%", stage, 100 * share);
    log_status(text);
    return true;
}

static void print_classes(const CoverReport *cover)
{
    bool shown[SURFACE_COUNT] = {false};
    for (int n = 0; n < 5; n++) { /* the five that cover most */
        int best = 0;
        for (int s = 1; s < SURFACE_COUNT; s++)
            if (!shown[s] && cover->share[s] > (best ? cover->share[best] : 0)) best = s;
        if (!best) break;
        shown[best] = true;
        log_print("%s%s %.0f %%", n ? ", " : "classes: ", surface_name((SurfaceClass)best), 100 * cover->share[best]);
    }
    if (cover->posting_m > 0)
        log_print(" (pixels %.3g m apart, table %s, %ld cells with codes it lacks)", cover->posting_m, cover->table,
                  cover->unknown);
    log_print("\n");
}

static void print_summary(const Wanted *w, const TerrainReport *r, double seconds)
{
    const ElevationReport *e = &r->elevation;
    log_print("%s: %.1f M posts, %.3g m apart over %.2f x %.2f km, from %d file%s of posts %.3g m apart\n", w->out,
              1e-6 * r->nx * r->ny, e->spacing_m, 1e-3 * e->width_m[0], 1e-3 * e->width_m[1], e->sheets,
              e->sheets == 1 ? "" : "s", e->posting_m);
    if (e->ellipsoidal) log_print("heights: above the ellipsoid\n");
    else log_print("heights: above the geoid, which lies %+.2f m from the ellipsoid here; converted at each post\n",
                   e->geoid_m);
    if (r->apart)
        log_print("surface model taken apart%s: bare ground %.1f %%, buildings %.1f %% (%llu), trees %.1f %% (%llu "
                  "crowns)\n",
                  r->beside ? " with the terrain model beside it" : " by its own shape", 100 * r->kind_share[0],
                  100 * r->kind_share[1], (unsigned long long)r->store.buildings, 100 * r->kind_share[2],
                  (unsigned long long)r->store.crowns);
    if (e->places > 0)
        log_print("resampling: %.3f m rms, p99 %.3f, at most %.3f against the files\n", e->error_rms_m, e->error_p99_m,
                  e->error_max_m);
    if (e->voids > 0) log_print("voids: %ld posts filled from their surroundings\n", e->voids);
    if (e->voids_coarser > 0) log_print("voids: %ld posts filled from coarser files\n", e->voids_coarser);
    log_print("quantisation: steps of %.3g mm, at most %.3g mm off\n", 1e3 * r->store.step_m[0],
              1e3 * r->store.worst_m[0]);
    if (r->apart || r->cover.posting_m > 0) print_classes(&r->cover);
    if (r->photo_posting_m > 0) log_print("photograph: pixels %.3g m apart\n", r->photo_posting_m);
    if (r->canopy_scale_m > 0) log_print("canopy height: numbers of %.2g m\n", r->canopy_scale_m);
    log_print("%.1f MB in %.1f s (levels around %.1f, posts %.1f, cover and photograph %.1f, writing %.1f)\n",
              1e-6 * (double)r->store.octets, seconds, r->seconds[0], r->seconds[1], r->seconds[2], r->seconds[3]);
}

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
    double begun_s = wall_clock_s();
    stop_by_signals();
    if (status == STATUS_OK) status = terrain_import(&r, &w->terrain, w->out, pool, show, &begun_s);
    log_status(NULL);
    if (status == STATUS_OK) print_summary(w, &r, wall_clock_s() - begun_s);
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
