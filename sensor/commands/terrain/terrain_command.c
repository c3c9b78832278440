/* sensor/commands/terrain/terrain_command.c: `pitviper terrain`: makes a store from files (`import`), tells what was
 * read and made, and makes a store again (`again`). */
#include "sensor/commands/commands.h"

#include "pitviper_output.h"
#include "sensor/commands/overwrite.h"
#include "sensor/node/run/stop.h"
#include "sensor/frame/json_object.h"
#include "sensor/settings/command_line.h"
#include "terrain/import/terrain_import.h"

#include <errno.h>
#include <stdlib.h>
#include <sys/stat.h>

/* ---- sources of an import --------------------------------------------------------------------------- */

/* What was read of each source, in words or as JSON. */
typedef struct SourceLines {
    bool    json; /* kept until the end; else printed when they are added, before the files are used */
    json_t *list; /* NULL: none */
} SourceLines;

static double octets_of(const Raster *raster)
{
    double      octets = 0;
    struct stat about;
    for (int k = 0; k < raster->sheet_count; k++)
        if (stat(raster->sheet[k].path, &about) == 0) octets += (double)about.st_size;
    return octets;
}

static void print_source(const ElevationSurvey *s)
{
    const Raster *r = s->raster;
    const char   *unit, *unit_from, *datum, *datum_from;
    elevation_survey_words(&unit, &unit_from, &datum, &datum_from, s);
    log_print("%s", r->sheet[0].path);
    if (r->sheet_count > 1) log_print(" and %d more", r->sheet_count - 1);
    log_print(": %d x %d posts %.3g m apart, %s, ", r->width, r->height, fmin(r->posting_m[0], r->posting_m[1]),
              r->stated.type);
    if (octets_of(r) > 0) log_print("%.1f kB; ", 1e-3 * octets_of(r)); /* none of a file in an archive */
    log_print("%s (--srs)\n", r->stated.crs);
    if (isfinite(s->low_m)) log_print("  heights %.1f .. %.1f m", s->low_m, s->high_m);
    else log_print("  no heights");
    log_print("%s; unit %s, %s (--unit); above %s, %s (--vertical)%s\n", s->whole ? "" : " where it was looked at",
              unit, unit_from, datum, datum_from, r->metres_per_unit < 0 ? "; depths, turned round (FILE@up)" : "");
    if (s->voids + s->outside + s->suspect_posts > 0)
        log_print("  voids %.2g %%%s\n", 100 * (s->voids + s->outside + s->suspect_posts) / s->posts,
                  s->outside + s->suspect_posts > 0 ? ", some of them not declared (--nodata)" : "");
    if (r->bands > 1) log_print("  band %d of %d (FILE:BAND)\n", r->choice.band ? r->choice.band : 1, r->bands);
}

static json_t *pair_of(double a, double b) { return json_pack("[f, f]", a, b); }

static void add_source(json_t *list, const ElevationSurvey *s)
{
    const Raster *r = s->raster;
    const char   *unit, *unit_from, *datum, *datum_from;
    json_t       *source = json_object(), *files = json_array(), *suspects = json_array();
    elevation_survey_words(&unit, &unit_from, &datum, &datum_from, s);
    for (int k = 0; k < r->sheet_count; k++) json_array_append_new(files, json_string(r->sheet[k].path));
    for (int k = 0; k < s->suspects; k++) json_array_append_new(suspects, json_real(s->suspect[k]));
    json_object_set_new(source, "files", files);
    json_object_set_new(source, "octets", json_real(octets_of(r)));
    json_object_set_new(source, "posts", json_pack("[i, i]", r->width, r->height));
    json_object_set_new(source, "posting_m", pair_of(r->posting_m[0], r->posting_m[1]));
    json_object_set_new(source, "type", json_string(r->stated.type));
    json_object_set_new(source, "band", json_integer(r->choice.band ? r->choice.band : 1));
    json_object_set_new(source, "bands", json_integer(r->bands));
    json_object_set_new(source, "crs", json_string(r->stated.crs));
    json_object_set_new(source, "unit", json_string(unit));
    json_object_set_new(source, "unit_from", json_string(unit_from));
    json_object_set_new(source, "turned_round", json_boolean(r->metres_per_unit < 0));
    json_object_set_new(source, "above", json_string(datum));
    json_object_set_new(source, "above_from", json_string(datum_from));
    json_object_set_new(source, "looked_at", json_real(s->posts));
    json_set_number(source, "low_m", s->low_m);
    json_set_number(source, "high_m", s->high_m);
    json_object_set_new(source, "voids_declared", json_real(s->voids));
    json_object_set_new(source, "no_heights_on_earth", json_real(s->outside));
    json_object_set_new(source, "suspected_voids", suspects);
    json_object_set_new(source, "suspected_posts", json_real(s->suspect_posts));
    json_array_append_new(list, source);
}

static void source_lines_add(SourceLines *lines, const ElevationSurvey *survey)
{
    if (!lines->json) print_source(survey);
    else {
        if (!lines->list) lines->list = json_array();
        add_source(lines->list, survey);
    }
}

static void source_lines_free(SourceLines *lines)
{
    json_decref(lines->list);
    lines->list = NULL;
}

/* ---- what an import made ---------------------------------------------------------------------------- */

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

static void print_words(const char *store, const char *buildings, const TerrainReport *r, double seconds)
{
    const ElevationReport *e = &r->elevation;
    log_print("%s: %.1f M posts, %.3g m apart over %.2f x %.2f km, from %d file%s of posts %.3g m apart\n", store,
              1e-6 * r->nx * r->ny, e->spacing_m, 1e-3 * e->width_m[0], 1e-3 * e->width_m[1], e->sheets,
              e->sheets == 1 ? "" : "s", e->posting_m);
    if (e->ellipsoidal) log_print("heights: above the ellipsoid\n");
    else
        log_print("heights: above the geoid, which lies %+.2f m from the ellipsoid here; converted at each post\n",
                  e->geoid_m);
    if (r->apart)
        log_print("surface model taken apart%s: bare ground %.1f %%, buildings %.1f %% (%llu), trees %.1f %% (%llu "
                  "crowns)\n",
                  r->beside ? " with the terrain model beside it" : " by its own shape", 100 * r->kind_share[0],
                  100 * r->kind_share[1], (unsigned long long)r->store.buildings, 100 * r->kind_share[2],
                  (unsigned long long)r->store.crowns);
    if (*buildings) {
        log_print("%s: %d buildings with outlines and roofs, bare ground below them (terrain.buildings)", buildings,
                  r->records);
        if (r->records_left > 0) log_print("; %d patches of roof make none", r->records_left);
        log_print("\n");
    }
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

static Status print_json(const char *store, const char *buildings, const TerrainReport *r, double seconds,
                         const SourceLines *lines)
{
    const ElevationReport *e = &r->elevation;
    json_t                *all = json_object(), *classes = json_object();
    json_object_set_new(all, "store", json_string(store));
    if (lines->list) json_object_set(all, "sources", lines->list);
    json_object_set_new(all, "posts", json_pack("[i, i]", r->nx, r->ny));
    json_object_set_new(all, "spacing_m", json_real(e->spacing_m));
    json_object_set_new(all, "width_m", pair_of(e->width_m[0], e->width_m[1]));
    json_object_set_new(all, "ellipsoidal", json_boolean(e->ellipsoidal));
    if (!e->ellipsoidal) json_set_number(all, "geoid_m", e->geoid_m);
    json_object_set_new(all, "voids_filled", json_integer(e->voids));
    json_object_set_new(all, "voids_filled_from_coarser", json_integer(e->voids_coarser));
    if (e->places > 0) {
        json_set_number(all, "resampling_rms_m", e->error_rms_m);
        json_set_number(all, "resampling_p99_m", e->error_p99_m);
        json_set_number(all, "resampling_max_m", e->error_max_m);
    }
    json_set_number(all, "quantisation_max_m", r->store.worst_m[0]);
    json_object_set_new(all, "buildings", json_integer((json_int_t)r->store.buildings));
    if (*buildings) {
        json_object_set_new(all, "buildings_file", json_string(buildings));
        json_object_set_new(all, "building_records", json_integer(r->records));
        json_object_set_new(all, "building_records_left_out", json_integer(r->records_left));
    }
    json_object_set_new(all, "crowns", json_integer((json_int_t)r->store.crowns));
    for (int s = 1; s < SURFACE_COUNT; s++)
        if (r->cover.share[s] > 0) json_set_number(classes, surface_name((SurfaceClass)s), r->cover.share[s]);
    json_object_set_new(all, "classes", classes);
    if (r->cover.posting_m > 0) json_object_set_new(all, "cover_table", json_string(r->cover.table));
    json_object_set_new(all, "octets", json_integer((json_int_t)r->store.octets));
    json_set_number(all, "seconds", seconds);
    char        *text = json_dumps(all, JSON_INDENT(1) | JSON_REAL_PRECISION(12));
    const Status status = text ? STATUS_OK : STATUS_NO_MEMORY;
    if (text) printf("%s\n", text);
    free(text);
    json_decref(all);
    return status;
}

/* STATUS_NO_MEMORY: nothing was printed. */
static Status report(const char *store, const char *buildings, const TerrainReport *r, double seconds,
                     const SourceLines *lines)
{
    if (lines->json) return print_json(store, buildings, r, seconds, lines);
    print_words(store, buildings, r, seconds);
    return STATUS_OK;
}

/* ---- again ------------------------------------------------------------------------------------------ */

static const char again_help[] =
    "usage: pitviper terrain again STORE\n"
    "\n"
    "Makes a terrain store again with the sources and options that it was made with, which are printed first. A node does\n"
    "that by itself where all of them lie in the store's own folder: a store from elsewhere makes it read no other file.\n";

/* Reads the options that a store was made with, from a whole or a damaged file; the caller frees them. NULL, logged:
 * there are none. */
static char *options_of(const char *path)
{
    TerrainStore store;
    const char  *why;
    char        *options = NULL;
    if (store_open_why(&store, &why, path) == STATUS_OK) {
        options = strdup(store.options);
        store_close(&store);
    } else {
        options = store_recall(path);
        if (!options)
            log_error("terrain again: %s: %s; nothing says what it was made of: run `pitviper terrain import`", path,
                      why);
    }
    return options;
}

/* argv[0] = "pitviper terrain again". 0: done; 1: it has no options, or could not be made; 2: usage; 128 + a signal's
 * number: stopped, and as it was. */
static int again_command(int argc, char **argv)
{
    if (argc == 2 && (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0)) {
        fputs(again_help, stdout);
        return 0;
    }
    if (argc != 2 || argv[1][0] == '-') return command_line_wrong("terrain", "again takes one STORE");
    char *options = options_of(argv[1]);
    if (!options) return 1;
    stop_by_signals();
    text_print(stdout, "%s", options);
    fflush(stdout);
    const Status status = terrain_store_rebuild(argv[1], options, true);
    free(options);
    if (status != STATUS_OK && stop_asked()) {
        log_warn("terrain again: stopped: %s is as it was", argv[1]);
        return stop_exit_code();
    }
    return status == STATUS_OK ? 0 : 1;
}

/* ---- import ----------------------------------------------------------------------------------------- */

static const char help[] =
    "usage: pitviper terrain import SOURCE... -o STORE [options]\n"
    "       pitviper terrain import --surface FILES -o STORE [options]\n"
    "       pitviper terrain info STORE [--out DIR] [--verify]\n"
    "       pitviper terrain again STORE\n"
    "       pitviper terrain culture FILE... [--trees TABLE] [--store STORE | --at LAT,LON] [-o OUT.geojson]\n"
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
    "  --buildings FILE.geojson  the buildings of --surface as records, outlines with heights and roofs, for terrain.buildings;\n"
    "                         the ground is then bare below them; posts up to 2 m apart\n"
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
    return command_line_wrong("terrain", "%s: %s", option, what);
}

typedef struct Wanted {
    TerrainOptions terrain;
    const char    *out;
    bool           overwrite, json;
    long long      threads;
} Wanted;

/* Returns 0 to go on; else the exit code. */
static int parse(Wanted *w, int argc, char **argv)
{
    enum { OUT = 'o', HELP = 'h', OVERWRITE = 256, THREADS, JSON, VALUE };
    static const struct option options[] = {{"out", 1, NULL, OUT},
                                            {"overwrite", 0, NULL, OVERWRITE},
                                            {"threads", 1, NULL, THREADS},
                                            {"json", 0, NULL, JSON},
                                            {"help", 0, NULL, HELP},
                                            /* these options are those of terrain/import/terrain_import.h */
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
                                            {"buildings", 1, NULL, VALUE + 17},
                                            {NULL, 0, NULL, 0}};
    enum { own_options = 5 };
    const char *why = NULL;
    char        text[256], name[64];
    terrain_options_default(&w->terrain);
    w->threads = thread_processors();
    optind = 0; /* restart getopt */
    for (int option; (option = command_line_option(argc, argv, "o:h", options)) != -1;) {
        const char *named = option >= VALUE ? options[own_options + option - VALUE].name : NULL;
        switch (option) {
        case OUT:
            w->out = optarg;
            break;
        case OVERWRITE:
            w->overwrite = true;
            break;
        case JSON:
            w->json = true;
            break;
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

/* ---- progress of an import -------------------------------------------------------------------------- */

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
    if (status == STATUS_OK && *w->terrain.buildings)
        status = overwrite_file("terrain import", w->terrain.buildings, w->overwrite);
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
    if (status == STATUS_OK)
        status = report(w->out, w->terrain.buildings, &r, wall_clock_s() - watching.begun_s, &watching.sources);
    source_lines_free(&watching.sources);
    if (status == STATUS_NO_MEMORY) log_error("terrain import: out of memory; --size takes a part");
    if (r.stopped) log_warn("terrain import: stopped: %s is as it was", w->out);
    code = r.stopped ? stop_exit_code() : status == STATUS_OK ? 0 : 1;
    pool_destroy(pool);
    free(w);
    return code;
}

/* ---- the actions ------------------------------------------------------------------------------------ */

int terrain_command(int argc, char **argv)
{
    static char called[] = "pitviper terrain", called_info[] = "pitviper terrain info",
                called_again[] = "pitviper terrain again", called_culture[] = "pitviper terrain culture";
    const bool culture = argc > 1 && strcmp(argv[1], "culture") == 0;
    const bool again = argc > 1 && strcmp(argv[1], "again") == 0;
    const bool info = argc > 1 && strcmp(argv[1], "info") == 0; /* these have a help of their own */
    for (int i = 1; !info && !again && !culture && i < argc && strcmp(argv[i], "--") != 0; i++)
        if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0) {
            fputs(help, stdout);
            return 0;
        }
    if (argc < 2) return command_line_wrong("terrain", "no action: import or info");
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
        return again_command(argc - 1, argv + 1);
    }
    if (culture) {
        argv[1] = called_culture;
        return terrain_culture_command(argc - 1, argv + 1);
    }
    WordMeant meant = word_meant(argv[1]);
    word_consider_list(&meant, "import|info|again|culture", '|');
    return command_line_wrong("terrain", "no such action: %s%s", argv[1],
                              *word_hint(&meant) ? meant.hint : "; there are import, info, again and culture");
}
