/* tests/bench/sensor/town_import.c: `bench town`: a town of files, 10,000 and 200,000 buildings with OpenStreetMap's
 * tags and their roads and fences as GeoJSON, GeoPackage and Shapefile (where ogr2ogr is there to write them): from
 * files to records; and of the smaller one to meshes, with clutter, and to the end of its first frame. */
#include "tests/bench/sensor/speed_private.h"

#include "pitviper_output.h"
#include "sensor/frame/frame_scenery.h"
#include "sensor/settings/config.h"
#include "terrain/from_files/culture_import.h"

#include <stdlib.h>
#include <time.h>
#include <unistd.h>

enum { small_town = 10000, large_town = 200000, forms = 3, vehicles = 10 };
static const double      lat_deg = 47.05, lon_deg = 13.02, lot_m = 25, clutter_density = 0.85;
static const char *const form_name[forms] = {"GeoJSON", "GeoPackage", "Shapefile"};

typedef struct ImportBench {
    Bench     *bench;
    char       folder[64];
    LocalFrame frame;
    Landscape  landscape;
    Pool      *pool;
    int        houses;
} ImportBench;

static void say(const ImportBench *t, const char *what, double value, const char *unit)
{
    BenchRow row = bench_row(what);
    row.median = value;
    row.unit = unit;
    bench_add(t->bench, &row);
}

/* ---- the files ----------------------------------------------------------------------------------- */

static void put_place(FILE *file, bool first, double x_m, double y_m)
{
    const double a_degree_m = 111320;
    fprintf(file, "%s[%.7f,%.7f]", first ? "" : ",", lon_deg + x_m / (a_degree_m * cos(lat_deg * rad_per_deg)),
            lat_deg + y_m / a_degree_m);
}

static void put_house(FILE *file, int k, double x_m, double y_m)
{
    static const char *const use[] = {"house", "house", "residential", "yes", "garage", "apartments"};
    static const double      corner[5][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}, {-1, -1}};
    const double             turn = 0.7 * k, half[2] = {4 + k % 5, 3 + k % 4};
    fprintf(file, ",\n{\"type\":\"Feature\",\"properties\":{\"osm_id\":\"%d\",\"building\":\"%s\"", 1000 + k,
            use[k % 6]);
    if (k % 4 == 0) fprintf(file, ",\"height\":\"%.1f\"", 4 + 0.1 * (k % 90));
    if (k % 4 == 1) fprintf(file, ",\"building:levels\":\"%d\"", 1 + k % 4);
    if (k % 5 == 0) fputs(k % 2 ? ",\"roof:shape\":\"hipped\"" : ",\"roof:shape\":\"gabled\"", file);
    fputs("},\"geometry\":{\"type\":\"Polygon\",\"coordinates\":[[", file);
    for (int c = 0; c < 5; c++) {
        const double u = corner[c][0] * half[0], v = corner[c][1] * half[1];
        put_place(file, c == 0, x_m + u * cos(turn) - v * sin(turn), y_m + u * sin(turn) + v * cos(turn));
    }
    fputs("]]}}", file);
}

static void put_line(FILE *file, bool first, const char *tag, double y_m, double half_m)
{
    fprintf(file, "%s{\"type\":\"Feature\",\"properties\":{%s},\"geometry\":{\"type\":\"LineString\",\"coordinates\":[",
            first ? "" : ",\n", tag);
    for (double x_m = -half_m; x_m <= half_m; x_m += 50) put_place(file, x_m == -half_m, x_m, y_m + 2 * sin(x_m / 90));
    fputs("]}}", file);
}

static int side_of(int houses) { return (int)ceil(sqrt(houses)); }

static bool write_town(const ImportBench *t, int houses)
{
    const int    side = side_of(houses);
    const double half_m = 0.5 * side * lot_m;
    char         path[128];
    snprintf(path, sizeof path, "%s/town.geojson", t->folder);
    FILE *file = output_file(path, 0);
    if (!file) return false;
    fputs("{\"type\":\"FeatureCollection\",\"features\":[\n", file);
    for (int k = 0; k < side; k += 2) {
        put_line(file, k == 0, "\"highway\":\"residential\",\"lanes\":\"2\"", (k + 0.5) * lot_m - half_m, half_m);
        put_line(file, false, "\"barrier\":\"fence\"", (k + 1.5) * lot_m - half_m, half_m);
    }
    for (int k = 0; k < houses; k++) put_house(file, k, k % side * lot_m - half_m, k / side * lot_m - half_m);
    fputs("]}\n", file);
    return fclose(file) == 0;
}

/* False: ogr2ogr is not there, or cannot. */
static bool convert(char names[256], const ImportBench *t, int form)
{
    char line[512];
    if (form == 0) snprintf(names, 256, "%s/town.geojson", t->folder);
    if (form == 1) snprintf(names, 256, "%s/town.gpkg", t->folder);
    if (form == 2) snprintf(names, 256, "%s/b.shp,%s/l.shp", t->folder, t->folder);
    if (form == 1) snprintf(line, sizeof line, "cd %s && ogr2ogr town.gpkg town.geojson 2>/dev/null", t->folder);
    if (form == 2)
        snprintf(line, sizeof line,
                 "cd %s && ogr2ogr b.shp town.gpkg -where 'building is not null' 2>/dev/null && "
                 "ogr2ogr l.shp town.gpkg -where 'building is null' 2>/dev/null",
                 t->folder);
    return form == 0 || system(line) == 0;
}

/* ---- from files to records, meshes, a frame ------------------------------------------------------ */

static Status read_town(Culture *out, const ImportBench *t, const char *names, int houses)
{
    CultureReport      report;
    const CultureFiles from = {.buildings = names,
                               .frame = &t->frame,
                               .ground = frame_scenery_ground,
                               .user = (void *)&t->landscape,
                               .half_m = side_of(houses) * lot_m};
    return culture_open(out, &report, &from);
}

static Status time_import(const ImportBench *t, int houses)
{
    Status status = write_town(t, houses) ? STATUS_OK : STATUS_IO;
    for (int form = 0; form < forms && status == STATUS_OK; form++) {
        char    names[256], what[what_size];
        Culture culture = {0};
        if (!convert(names, t, form)) continue;
        bench_progress(t->bench, form_name[form]);
        const double  start_s = wall_clock_s(), before_mb = bench_memory_mb("VmRSS:");
        const clock_t start = clock();
        status = read_town(&culture, t, names, houses);
        const double own_s = (double)(clock() - start) / CLOCKS_PER_SEC, took_s = wall_clock_s() - start_s;
        if (status == STATUS_OK && culture.buildings != houses) status = STATUS_BAD_VALUE;
        snprintf(what, sizeof what, "%s of %d buildings to records: wall, reader and all", form_name[form], houses);
        say(t, what, took_s, "s");
        snprintf(what, sizeof what, "%s of %d buildings to records: processor, beside the reader", form_name[form],
                 houses);
        say(t, what, own_s, "s");
        snprintf(what, sizeof what, "%s of %d buildings to records: memory", form_name[form], houses);
        say(t, what, bench_memory_mb("VmRSS:") - before_mb, "MB");
        culture_free(&culture);
    }
    return status;
}

static Status first_frame(ImportBench *t, TrialScene *scene, FrameScenery *town, Arena *arena)
{
    const Config  config = config_default();
    const double  half_m = 0.5 * side_of(t->houses) * lot_m;
    char          names[256];
    SceneryCounts n;
    TrialFrame    frame = {.scene = scene, .pool = t->pool, .arena = arena};
    *town = (FrameScenery){0};
    snprintf(names, sizeof names, "%s/town.geojson", t->folder);
    const SceneryPlan plan = {.from = CULTURE_FROM_RECORDS,
                              .clutter = clutter_density,
                              .clutter_seed = 1,
                              .south_west_m = {-half_m, -half_m},
                              .north_east_m = {half_m, half_m}};
    bench_progress(t->bench, "first frame");
    const double  start_s = wall_clock_s();
    const clock_t start = clock();
    Status        status = read_town(&town->culture, t, names, t->houses);
    if (status == STATUS_OK) status = frame_scenery_make(town, &plan, &t->landscape);
    say(t, "file to meshes, with clutter", wall_clock_s() - start_s, "s");
    if (status == STATUS_OK) status = world_scenery(&scene->world, &town->scenery, NULL, t->pool);
    say(t, "file to trees", wall_clock_s() - start_s, "s");
    if (status != STATUS_OK) return status;
    frame.request = (RenderRequest){.view = trial_view(scene, 600, 100, 40 * rad_per_deg, 720, 486),
                                    .bands = three_bands,
                                    .truth = true,
                                    .optical = OPTICAL_RGB,
                                    .samples = 1,
                                    .edge_samples = config.sensor.edge_samples,
                                    .target_samples = config.sensor.target_samples,
                                    .sky_visibility = config.sensor.sky_visibility,
                                    .t_s = 30,
                                    .hidden_entity = -1};
    trial_frame(&frame);
    frame_scenery_count(&n, town);
    say(t, "things of clutter", n.clutter, "");
    say(t, "file to the end of the first frame", wall_clock_s() - start_s, "s");
    say(t, "file to the end of the first frame: processor", (double)(clock() - start) / CLOCKS_PER_SEC, "s");
    say(t, "most memory", bench_memory_mb("VmHWM:"), "MB");
    return frame.status;
}

static Status run_all(ImportBench *t)
{
    static const DisEntityType types[] = {{1, 1, 222, 1, 1, 1, 0}, {1, 1, 222, 7, 1, 0, 0}};
    const Geodetic             origin = {lat_deg * rad_per_deg, lon_deg * rad_per_deg, 500};
    const bool                 quick = bench_quick(t->bench);
    TrialScene                 scene = {0};
    FrameScenery               town = {0};
    Arena                     *arena = arena_create();
    double                     times_s[2];
    char                       catalog[512];
    t->houses = quick ? 100 : small_town;
    Status status = arena && etc_path(catalog, sizeof catalog, "catalog.csv") ? STATUS_OK : STATUS_BAD_VALUE;
    if (status == STATUS_OK) status = pool_create(&t->pool, bench_threads(t->bench));
    if (status == STATUS_OK) status = local_frame_at(&t->frame, &origin);
    const double wide_m = (side_of(quick ? t->houses : large_town) + 1) * lot_m + 2000;
    if (status == STATUS_OK) status = landscape_quick(&t->landscape, times_s, &t->frame, wide_m, wide_m, t->pool);
    if (status == STATUS_OK && !quick) status = time_import(t, large_town);
    if (status == STATUS_OK) status = time_import(t, t->houses);
    if (status == STATUS_OK) status = trial_scene_open(&scene, &t->landscape, catalog, types, 2, vehicles);
    if (status == STATUS_OK) status = first_frame(t, &scene, &town, arena);
    trial_scene_close(&scene);
    frame_scenery_free(&town);
    arena_destroy(arena);
    return status;
}

Status bench_town_import(Bench *bench)
{
    ImportBench t = {.bench = bench, .folder = "/tmp/pitviper-town-XXXXXX"};
    char        line[128];
    if (!mkdtemp(t.folder)) return STATUS_IO;
    const Status status = run_all(&t);
    if (status != STATUS_OK) log_error("bench: town of files: %s", status_name(status));
    landscape_destroy(&t.landscape);
    pool_destroy(t.pool);
    snprintf(line, sizeof line, "rm -rf %s", t.folder);
    return system(line) == 0 ? status : STATUS_IO;
}
