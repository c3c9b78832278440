/* Culture of files: the same content as GeoJSON, GeoPackage and Shapefile and in two coordinate systems, made by
 * ogr2ogr, is the same records; places and base heights against geodesy worked out otherwise; what is left out is
 * counted; a table of trees; hostile files. labels: small */
#include "tests/terrain/raster_lab.h"

#include "terrain/earth/geodesy.h"
#include "terrain/from_files/culture_import.h"
#include "terrain/elevation/vector.h"
#include "terrain/surface.h"
#include "terrain/woods/plant.h"

#include <sys/stat.h>

static char       folder[64];
static LocalFrame frame;

static const double lat0 = 47.05, lon0 = 13.02;

/* A hill that leans to the north-east; nothing north of 12 km. */
static double hill(void *user, double x_m, double y_m)
{
    (void)user;
    if (y_m > 12000) return (double)NAN;
    return 640 + 0.03 * x_m - 0.02 * y_m - (x_m * x_m + y_m * y_m) / 12.74e6;
}

static int open_lab(void **state)
{
    (void)state;
    strcpy(folder, "/tmp/pitviper-culture-XXXXXX");
    if (!mkdtemp(folder)) return 1;
    return local_frame_at(&frame, &(Geodetic){lat0 * rad_per_deg, lon0 * rad_per_deg, 600}) != STATUS_OK;
}

static int close_lab(void **state)
{
    char line[128];
    (void)state;
    snprintf(line, sizeof line, "rm -rf %s", folder);
    return system(line) != 0;
}

static void path_of(char out[128], const char *name) { snprintf(out, 128, "%s/%s", folder, name); }

static void save(const char *name, const char *text)
{
    char path[128];
    path_of(path, name);
    FILE *file = fopen(path, "w");
    CHECK(file && fputs(text, file) >= 0 && fclose(file) == 0);
}

/* Runs a program on files of the folder. */
static void convert(const char *arguments)
{
    char line[512];
    snprintf(line, sizeof line, "cd %s && ogr2ogr %s >log 2>&1", folder, arguments);
    if (system(line) != 0) fail_msg("ogr2ogr %s", arguments);
}

/* Without ogr2ogr a test is skipped; where all judges are wanted that is a failure. */
static void need_judge(void)
{
    if (system("command -v ogr2ogr >/dev/null") == 0) return;
    if (getenv("CI")) fail_msg("no ogr2ogr: etc/setup --tests installs it");
    skip();
}

static Status open_names(Culture *c, CultureReport *r, const char *names, const char *trees)
{
    char all[1024] = "", table[128] = "", *at = all;
    for (const char *name = names; *name;) {
        const size_t length = strcspn(name, ",");
        const bool   own = *name != '/' && !strstr(name, ":/");
        at += snprintf(at, (size_t)(all + sizeof all - at), "%s%s%s%.*s", at > all ? "," : "", own ? folder : "",
                       own ? "/" : "", (int)length, name);
        name += length + (name[length] != 0);
    }
    if (trees) path_of(table, trees);
    return culture_open(
        c, r, &(CultureFiles){.buildings = all, .trees = table, .frame = &frame, .ground = hill, .half_m = 16000});
}

/* ---- places ------------------------------------------------------------------------------------------ */

/* Longitude and latitude of a place on the hill, in degrees, by ECEF. */
static void degrees_of(double out[2], double x_m, double y_m)
{
    double       p_ecef[3];
    Geodetic     g;
    const double z_m = hill(NULL, x_m, y_m);
    ecef_from_enu(p_ecef, &frame, (const double[3]){x_m, y_m, isnan(z_m) ? 300 : z_m});
    CHECK(geodetic_from_ecef(&g, p_ecef) == STATUS_OK);
    out[0] = g.lon_rad / rad_per_deg, out[1] = g.lat_rad / rad_per_deg;
}

static char text[1 << 16];
static int  used;

static void add(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    used += vsnprintf(text + used, sizeof text - (size_t)used, format, arguments);
    va_end(arguments);
    CHECK(used < (int)sizeof text);
}

static void begin_file(void)
{
    used = 0;
    add("{\"type\":\"FeatureCollection\",\"features\":[\n");
}

static void add_feature(const char *type, const char *opens, const char *closes, const char *properties,
                        const double (*p)[2], int count)
{
    add("%s{\"type\":\"Feature\",\"properties\":{%s},\"geometry\":{\"type\":\"%s\",\"coordinates\":%s",
        used > 50 ? ",\n" : "", properties, type, opens);
    for (int k = 0; k < count; k++) {
        double deg[2];
        degrees_of(deg, p[k][0], p[k][1]);
        add("%s[%.12f,%.12f]", k ? "," : "", deg[0], deg[1]);
    }
    add("%s}}", closes);
}

static void end_file(const char *name)
{
    add("\n]}\n");
    save(name, text);
}

static const double house[][2] = {{100, 200}, {112, 200}, {112, 210}, {100, 210}, {100, 200}};
static const double far_house[][2] = {{9000, -8000}, {9030, -8010}, {9040, -7980}, {9010, -7970}, {9000, -8000}};
static const double way[][2] = {{-500, -300}, {0, -280}, {700, 150}};
static const double tree[][2] = {{40, 50}};

static void places_are_on_the_ground(void **state)
{
    (void)state;
    Culture       c;
    CultureReport r;
    begin_file();
    add_feature("Polygon", "[[", "]]", "\"building\":\"house\"", house, 5);
    add_feature("Polygon", "[[", "]]", "\"building\":\"house\",\"height\":14", far_house, 5);
    add_feature("LineString", "[", "]", "\"highway\":\"primary\",\"lanes\":\"3\"", way, 3);
    add_feature("Point", "", "", "\"natural\":\"tree\",\"height\":\"12 m\"", tree, 1);
    end_file("places.geojson");
    assert_int_equal(open_names(&c, &r, "places.geojson", NULL), STATUS_OK);
    CHECK(c.buildings == 2 && c.lines == 1 && c.trees == 1 && r.features == 4 && c.left_out == 0);
    for (int k = 0; k < 4; k++) {
        const double *p = c.corner_m[c.building[0].first_corner + k], *q = c.corner_m[c.building[1].first_corner + k];
        for (int a = 0; a < 2; a++) {
            CHECK_NEAR(p[a], house[k][a], 1e-5); /* 1e-12 degrees are 0.1 um */
            CHECK_NEAR(q[a], far_house[k][a], 1e-5);
        }
    }
    /* the lowest ground along the outline: of a plane it is at a corner */
    double low_m[2] = {INFINITY, INFINITY};
    for (int k = 0; k < 4; k++) {
        low_m[0] = fmin(low_m[0], hill(NULL, house[k][0], house[k][1]));
        low_m[1] = fmin(low_m[1], hill(NULL, far_house[k][0], far_house[k][1]));
    }
    CHECK_NEAR((double)c.building[0].base_m, low_m[0], 1e-4);
    CHECK_NEAR((double)c.building[1].base_m, low_m[1], 1e-4);
    CHECK(c.building[1].ridge_m == 14 && r.height_from[HEIGHT_FROM_FILE] == 1 && r.height_from[HEIGHT_FROM_USE] == 1);
    CHECK(c.line[0].width_m == 9.75f && c.line[0].surface == SURFACE_ROAD);
    CHECK_NEAR(c.tree[0].x_m, 40, 1e-5);
    CHECK(c.tree[0].height_m == 12 && culture_surface_at(&c, 0, -281) == SURFACE_ROAD);
    culture_free(&c);
}

/* ---- formats ----------------------------------------------------------------------------------------- */

static void same_records(const Culture *a, const Culture *b, const char *what)
{
    if (a->buildings != b->buildings || a->lines != b->lines || a->points != b->points || a->trees != b->trees ||
        a->corners != b->corners)
        fail_msg("%s: %d %d %d %d", what, b->buildings, b->lines, b->points, b->trees);
    for (int k = 0; k < a->corners; k++)
        for (int axis = 0; axis < 2; axis++) CHECK_NEAR(b->corner_m[k][axis], a->corner_m[k][axis], 1e-3);
    for (int k = 0; k < a->buildings; k++) {
        Building p = a->building[k], q = b->building[k];
        CHECK_NEAR((double)q.base_m, (double)p.base_m, 1e-3);
        CHECK_NEAR((double)q.eaves_m, (double)p.eaves_m, 1e-3);
        CHECK_NEAR(sin((double)q.ridge_rad - (double)p.ridge_rad), 0, 1e-5); /* a line has no sense */
        q.base_m = p.base_m, q.eaves_m = p.eaves_m, q.ridge_m = p.ridge_m, q.ridge_rad = p.ridge_rad;
        assert_memory_equal(&p, &q, sizeof p); /* ids too */
    }
    for (int k = 0; k < a->lines; k++)
        CHECK(a->line[k].id == b->line[k].id && a->line[k].kind == b->line[k].kind &&
              a->line[k].width_m == b->line[k].width_m && a->line[k].surface == b->line[k].surface);
    for (int k = 0; k < a->trees; k++) {
        CHECK(a->tree[k].id == b->tree[k].id && a->tree[k].kind == b->tree[k].kind &&
              a->tree[k].height_m == b->tree[k].height_m);
        CHECK_NEAR(a->tree[k].x_m, b->tree[k].x_m, 1e-3);
    }
}

/* Two hundred houses with everything that a tag says, in three formats and three coordinate systems. */
static void three_formats_and_systems_are_one(void **state)
{
    (void)state;
    static const char *const tags[] = {
        "\"building\":\"house\",\"building:levels\":\"2\",\"roof:shape\":\"hipped\"",
        "\"building\":\"yes\",\"height\":\"39'6\\\"\",\"osm_id\":\"4711\"",
        "\"building\":\"apartments\",\"building:levels\":\"5\",\"roof:material\":\"tar_paper\"",
        "\"building\":\"barn\",\"height\":\"7,5\",\"roof:height\":\"3\",\"building:material\":\"wood\"",
        "\"building\":\"yes\",\"roof:direction\":\"SW\",\"roof:shape\":\"skillion\"",
    };
    Culture       one, other;
    CultureReport r;
    need_judge();
    begin_file();
    for (int n = 0; n < 200; n++) {
        const double a = 0.31 * n, x = 4000 * cos(n), y = 4000 * sin(1.7 * n), l = 8.3 + n % 13, w = 6.1 + n % 7;
        double       p[5][2] = {{x, y},
                                {x + l * cos(a), y + l * sin(a)},
                                {x + l * cos(a) - w * sin(a), y + l * sin(a) + w * cos(a)},
                                {x - w * sin(a), y + w * cos(a)},
                                {x, y}};
        add_feature("Polygon", "[[", "]]", tags[n % 5], (const double(*)[2])p, 5);
    }
    end_file("a.geojson");
    convert("a.gpkg a.geojson");
    convert("utm.gpkg -t_srs EPSG:32633 a.geojson");
    convert("a.shp a.geojson");
    convert("gk.shp -t_srs EPSG:31258 a.geojson");
    convert("gk.geojson -lco RFC7946=NO -lco COORDINATE_PRECISION=6 -t_srs EPSG:3857 a.geojson");
    convert("a.fgb -lco SPATIAL_INDEX=NO a.geojson");
    assert_int_equal(open_names(&one, &r, "a.geojson", NULL), STATUS_OK);
    CHECK(one.buildings == 200 && r.height_from[HEIGHT_FROM_FILE] == 80 && r.height_from[HEIGHT_FROM_LEVELS] == 80);
    static const char *const others[] = {"a.gpkg", "utm.gpkg", "a.shp", "gk.shp", "gk.geojson", "a.fgb"};
    for (size_t k = 0; k < sizeof others / sizeof *others; k++) {
        if (open_names(&other, &r, others[k], NULL) != STATUS_OK) fail_msg("%s", others[k]);
        same_records(&one, &other, others[k]);
        culture_free(&other);
    }
    /* without its .prj a Shapefile does not say its coordinate system: the user does */
    char path[128];
    path_of(path, "gk.prj");
    CHECK(remove(path) == 0);
    log_set_sink(check_listen, NULL);
    CHECK(open_names(&other, &r, "gk.shp", NULL) == STATUS_BAD_VALUE && strstr(check_said, "@srs="));
    log_set_sink(NULL, NULL);
    assert_int_equal(open_names(&other, &r, "gk.shp@srs=EPSG:31258", NULL), STATUS_OK);
    same_records(&one, &other, "@srs");
    culture_free(&other), culture_free(&one);
}

/* Lines and points keep their order in formats that mix them. */
static void mixed_features(void **state)
{
    (void)state;
    static const double hedge[][2] = {{0, -100}, {12.1, -100}}, poles[][2] = {{-500, -300}, {0, -280}, {900, 900}};
    Culture             one, other;
    CultureReport       r;
    need_judge();
    begin_file();
    add_feature("LineString", "[", "]", "\"power\":\"line\"", way, 3);
    for (int k = 0; k < 3; k++) add_feature("Point", "", "", "\"power\":\"tower\"", poles + k, 1);
    add_feature("LineString", "[", "]", "\"barrier\":\"hedge\"", hedge, 2);
    add_feature("MultiPoint", "[", "]", "\"natural\":\"tree\",\"genus\":\"Betula\"", poles, 3);
    add_feature("Polygon", "[[", "]]", "\"man_made\":\"silo\",\"height\":\"20\"", house, 5);
    add_feature("LineString", "[", "]", "\"highway\":\"primary\",\"bridge\":\"yes\"", way, 3);
    add_feature("LineString", "[", "]", "\"waterway\":\"stream\",\"tunnel\":\"culvert\"", way, 3);
    add_feature("Polygon", "[[", "]]", "\"landuse\":\"forest\"", house, 5);
    add_feature("Polygon", "[[", "]]", "\"barrier\":\"wall\"", house, 5);
    end_file("m.geojson");
    convert("m.gpkg m.geojson");
    assert_int_equal(open_names(&one, &r, "m.geojson", NULL), STATUS_OK);
    CHECK(one.lines == 3 && one.line[0].kind == CULTURE_POWER_LINE && one.line[1].kind == CULTURE_BRIDGE &&
          one.line[2].kind == CULTURE_WALL && one.line[2].corners == 5);
    CHECK(one.line[1].surface == SURFACE_NONE && one.line[1].height_m > 0);
    CHECK(one.points == 2 && one.point[0].kind == CULTURE_MAST && one.point[1].kind == CULTURE_SILO);
    CHECK_NEAR(one.point[0].x_m, 900, 1e-3); /* that at the ends of the line are its own */
    CHECK_NEAR(one.point[1].x_m, 106, 1e-3);
    CHECK_NEAR((double)one.point[1].size_m[0], 2 * sqrt(120 / pi_rad), 1e-3);
    CHECK(one.trees == 10 + 3 && one.tree[0].kind == PLANT_HEDGE && one.tree[12].kind == PLANT_BIRCH);
    CHECK_NEAR(one.tree[1].x_m - one.tree[0].x_m, 1.2, 1e-6);
    CHECK(r.left[CULTURE_LEFT_TWICE] == 2 && r.left[CULTURE_LEFT_HIDDEN] == 1 && r.left[CULTURE_LEFT_OTHER] == 1);
    assert_int_equal(open_names(&other, &r, "m.gpkg", NULL), STATUS_OK);
    same_records(&one, &other, "mixed");
    culture_free(&other), culture_free(&one);
}

/* ---- what is left out ---------------------------------------------------------------------------------- */

static void what_cannot_be_is_counted(void **state)
{
    (void)state;
    static const double bow[][2] = {{0, 0}, {20, 20}, {20, 0}, {0, 20}, {0, 0}};
    static const double large[][2] = {{-900, -900}, {900, -900}, {900, 900}, {-900, 900}, {-900, -900}};
    static const double none[][2] = {{0, 12500}, {9, 12500}, {9, 12509}, {0, 12509}, {0, 12500}};
    static const double out[][2] = {{15990, 0}, {16010, 0}, {16010, 9}, {15990, 9}, {15990, 0}};
    static const double leaves[][2] = {{15000, 0},    {15900, 0},   {25000, 0},  {60000, 0},
                                       {60000, 3000}, {15000, 100}, {14000, 100}};
    Culture             c;
    CultureReport       r;
    begin_file();
    add_feature("Polygon", "[[", "]]", "\"building\":\"yes\"", bow, 5);
    add_feature("Polygon", "[[", "]]", "\"building\":\"yes\"", large, 5);
    add_feature("Polygon", "[[", "]]", "\"building\":\"yes\"", none, 5);
    add_feature("Polygon", "[[", "]]", "\"building\":\"yes\"", out, 5);
    add_feature("Polygon", "[[", "]]", "\"building\":\"yes\",\"height\":\"9999\",\"building:levels\":\"few\"", house,
                5);
    add_feature("LineString", "[", "]", "\"highway\":\"primary\"", leaves, 7);
    add(",\n{\"type\":\"Feature\",\"properties\":{\"building\":\"yes\"},\"geometry\":{\"type\":\"Polygon\",\"coordinates\":"
        "[[[13,147],[13.1,147],[13.1,147.1],[13,147]]]}}");
    add(",\n{\"type\":\"Feature\",\"properties\":{\"building\":\"yes\"},\"geometry\":{\"type\":\"Polygon\",\"coordinates\":"
        "[[[13.02,47.05],[13.03,47.05],[1e999,47.06],[13.02,47.05]]]}}");
    add(",\n{\"type\":\"Feature\",\"properties\":{\"building\":\"yes\"},\"geometry\":null}");
    end_file("odd.geojson");
    log_set_sink(check_listen, NULL);
    *check_said = 0;
    assert_int_equal(open_names(&c, &r, "odd.geojson", NULL), STATUS_OK);
    log_set_sink(NULL, NULL);
    CHECK(c.buildings == 1 && r.mended == 1 && r.unread == 1 && c.repaired == 1);
    CHECK(c.building[0].ridge_m < 12);
    CHECK(r.left[CULTURE_LEFT_LARGE] == 1 && r.left[CULTURE_LEFT_CROSSED] >= 1 && r.left[CULTURE_LEFT_OUTSIDE] >= 1);
    int all = 0;
    for (int k = 0; k < CULTURE_LEFTS; k++) all += r.left[k];
    if (all != 7) fail_msg("%d left out: %s", all, check_said); /* all but the house and the way */
    CHECK(c.left_out == all && strstr(check_said, "cross themselves") && strstr(check_said, "could not be true") &&
          strstr(check_said, "terrain culture"));
    /* of the way what may be seen: there and back, in two lines */
    CHECK(c.lines == 2 && c.line[0].corners == 3 && c.line[1].corners == 3);
    culture_free(&c);
}

/* A hedge that leaves the square and comes back: a plant each 1.2 m within it, counted from the corners between which
 * it may be seen. */
static void rows_are_clipped(void **state)
{
    (void)state;
    static const double hedge[][2] = {{15990, 3000}, {16500, 3000}, {16500, 3100}, {15980, 3100}};
    Culture             c;
    CultureReport       r;
    int                 want = 0;
    begin_file();
    add_feature("LineString", "[", "]", "\"barrier\":\"hedge\"", hedge, 4);
    end_file("row.geojson");
    for (double at_m = 0.6; at_m < 520; at_m += 1.2) want += (at_m < 10) + (at_m > 500);
    assert_int_equal(open_names(&c, &r, "row.geojson", NULL), STATUS_OK);
    if (c.trees != want) fail_msg("%d plants, want %d", c.trees, want);
    CHECK_NEAR(c.tree[0].x_m, 15990.6, 1e-4);
    for (int k = 0; k < c.trees; k++) CHECK(c.tree[k].x_m <= 16000);
    culture_free(&c);
}

static void courtyards_are_counted(void **state)
{
    (void)state;
    Culture       c;
    CultureReport r;
    save(
        "yard.geojson",
        "{\"type\":\"FeatureCollection\",\"features\":[{\"type\":\"Feature\",\"properties\":{\"building\":\"yes\"},\"geometry\":"
        "{\"type\":\"MultiPolygon\",\"coordinates\":[[[[13.02,47.05],[13.021,47.05],[13.021,47.051],[13.02,47.051],[13.02,47.05]],"
        "[[13.0203,47.0503],[13.0206,47.0503],[13.0206,47.0506],[13.0203,47.0503]]],"
        "[[[13.03,47.05],[13.031,47.05],[13.031,47.051],[13.03,47.05]]]]}}]}");
    assert_int_equal(open_names(&c, &r, "yard.geojson", NULL), STATUS_OK);
    CHECK(c.buildings == 2 && c.building[0].corners == 4 && c.building[1].corners == 3 && r.courtyards == 1);
    CHECK(c.building[0].id != c.building[1].id);
    culture_free(&c);
}

/* ---- trees ------------------------------------------------------------------------------------------- */

static void a_table_of_trees(void **state)
{
    (void)state;
    Culture       c;
    CultureReport r;
    double        deg[2];
    degrees_of(deg, 300, -400);
    used = 0;
    add("# trees\nlat,lon,kind,height_m,marked\n%.12f,%.12f,birch,14.5,yes\n%.12f,%.12f,pine,,\n", deg[1], deg[0],
        deg[1], deg[0]);
    save("t.csv", text);
    save("xy.csv", "x_m,y_m,marked\n10,20,no\n-30.5,40,yes\n99999,0,no\n");
    assert_int_equal(open_names(&c, &r, "", "t.csv"), STATUS_OK);
    CHECK(c.trees == 2 && r.trees_marked == 1 && c.tree[0].marked && !c.tree[1].marked);
    CHECK_NEAR(c.tree[0].x_m, 300, 1e-5);
    CHECK_NEAR(c.tree[0].y_m, -400, 1e-5);
    CHECK(c.tree[0].kind == PLANT_BIRCH && c.tree[0].height_m == 14.5f && c.tree[1].kind == PLANT_PINE &&
          c.tree[1].height_m == 0);
    culture_free(&c);
    assert_int_equal(open_names(&c, &r, "", "xy.csv"), STATUS_OK);
    CHECK(c.trees == 2 && c.tree[1].x_m == -30.5 && c.tree[1].marked && r.left[CULTURE_LEFT_OUTSIDE] == 1);
    culture_free(&c);
    static const char *const bad[] = {"x_m,kind\n1,pine\n",          "x_m,y_m,kind\n1,2,palm\n",      "lat,lon\n91,0\n",
                                      "x_m,y_m,height_m\n1,2,500\n", "x_m,y_m,marked\n1,2,perhaps\n", "height_m\n3\n"};
    log_set_sink(check_listen, NULL);
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        save("bad.csv", bad[k]);
        *check_said = 0;
        CHECK(open_names(&c, &r, "", "bad.csv") == STATUS_BAD_VALUE && strstr(check_said, "bad.csv"));
    }
    log_set_sink(NULL, NULL);
}

/* ---- hostile files ------------------------------------------------------------------------------------- */

static Status quiet_open(const char *names)
{
    Culture       c = {0};
    CultureReport r;
    log_set_sink(check_listen, NULL);
    *check_said = 0;
    const Status status = open_names(&c, &r, names, NULL);
    log_set_sink(NULL, NULL);
    culture_free(&c);
    return status;
}

static void names_that_are_no_files(void **state)
{
    (void)state;
    static const char *const names[] = {"/nowhere.geojson",
                                        "http://127.0.0.1:9/a.geojson",
                                        "/vsicurl/http://127.0.0.1:9/a.geojson",
                                        "nothing.gpkg",
                                        "PG:dbname=x",
                                        "/vsizip//vsicurl/http://127.0.0.1:9/a.zip/b.geojson",
                                        "/vsistdin/",
                                        "/vsicurl_streaming/http://127.0.0.1:9/a.zip"};
    for (size_t k = 0; k < sizeof names / sizeof *names; k++)
        if (quiet_open(names[k]) == STATUS_OK || !strstr(check_said, "terrain.buildings"))
            fail_msg("%s: %s", names[k], check_said);
    save("a.vrt", "<OGRVRTDataSource><OGRVRTLayer name=\"a\"><SrcDataSource>/vsicurl/http://127.0.0.1:9/a.geojson"
                  "</SrcDataSource></OGRVRTLayer></OGRVRTDataSource>");
    CHECK(quiet_open("a.vrt") != STATUS_OK && strstr(check_said, "GeoPackage"));
    save("tileset.json", "{\"asset\": {\"version\": \"1.0\"}}");
    CHECK(quiet_open("tileset.json") != STATUS_OK && strstr(check_said, "3D Tiles"));
    save("a.flt", "x");
    CHECK(quiet_open("a.flt") != STATUS_OK && strstr(check_said, "OpenFlight"));
    save("a.b3dm", "b3dm");
    CHECK(quiet_open("a.b3dm") != STATUS_OK && strstr(check_said, "3D Tiles"));
    char path[128];
    path_of(path, "cdb");
    CHECK(mkdir(path, 0700) == 0);
    path_of(path, "cdb/Tiles");
    CHECK(mkdir(path, 0700) == 0);
    path_of(path, "cdb/Metadata");
    CHECK(mkdir(path, 0700) == 0);
    CHECK(quiet_open("cdb") != STATUS_OK && strstr(check_said, "CDB"));
    path_of(path, "pipe.geojson");
    CHECK(mkfifo(path, 0600) == 0);
    CHECK(quiet_open("pipe.geojson") != STATUS_OK);
}

static void same_for_elevation(void **state)
{
    (void)state;
    static const struct {
        const char *name, *word;
    } some[] = {{"tileset.json", "3D Tiles"}, {"a.flt", "OpenFlight"}, {"cdb", "CDB"}};
    for (size_t k = 0; k < sizeof some / sizeof *some; k++) {
        char      path[128];
        RasterSet set = {0};
        path_of(path, some[k].name);
        log_set_sink(check_listen, NULL);
        *check_said = 0;
        CHECK(raster_set_open(&set, path, "terrain.elevation") != STATUS_OK);
        log_set_sink(NULL, NULL);
        if (!strstr(check_said, some[k].word)) fail_msg("%s", check_said);
    }
}

/* A Shapefile of one polygon that declares a milliard of points. */
static void a_milliard_of_corners(void **state)
{
    (void)state;
    LabFile file = {.count = 0};
    char    path[128];
    for (int k = 0; k < 7; k++) lab_number(&file, k == 0 ? 9994 : k == 6 ? 50 + 4 + 26 + 16 : 0, 4, true);
    lab_number(&file, 1000, 4, false), lab_number(&file, 5, 4, false);
    for (int k = 0; k < 8; k++) lab_double(&file, k < 4 ? (k % 2 ? 47 : 13) + k / 2 : 0, false);
    lab_number(&file, 1, 4, true), lab_number(&file, 24 + 16, 4, true);
    lab_number(&file, 5, 4, false);
    for (int k = 0; k < 4; k++) lab_double(&file, (k % 2 ? 47 : 13) + k / 2, false);
    lab_number(&file, 1, 4, false), lab_number(&file, 1000000000, 4, false), lab_number(&file, 0, 4, false);
    for (int k = 0; k < 4; k++) lab_double(&file, 13, false);
    path_of(path, "many.shp");
    lab_save(&file, path);
    save("many.prj",
         "GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563]],PRIMEM[\"Greenwich\",0],"
         "UNIT[\"degree\",0.0174532925199433]]");
    Culture       c = {0};
    CultureReport r;
    log_set_sink(check_listen, NULL);
    const Status status = open_names(&c, &r, "many.shp", NULL);
    log_set_sink(NULL, NULL);
    CHECK(status != STATUS_OK || c.buildings == 0);
    culture_free(&c);
}

/* Sound files with octets turned over or their ends cut off: whatever comes of it, the program stays, and what it takes
 * is as any record. */
static void spoilt_files(void **state)
{
    (void)state;
    static const char *const names[] = {"a.gpkg", "a.shp", "a.dbf", "a.shx", "a.geojson", "a.fgb"};
    static uint8_t           sound[1 << 20], spoilt[1 << 20];
    int                      opened = 0, refused = 0;
    need_judge();
    for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
        char path[128];
        path_of(path, names[k]);
        FILE *file = fopen(path, "rb");
        CHECK(file);
        const size_t count = fread(sound, 1, sizeof sound, file);
        fclose(file);
        for (uint32_t n = 0; n < 12; n++) {
            memcpy(spoilt, sound, count);
            const size_t left = n < 3 ? count * (n + 1) / 4 : count;
            for (uint32_t m = 0; m < 20 && n >= 3; m++) {
                const uint64_t at = m * 1000 + n;
                const size_t   reach = n % 2 ? count : count < 400 ? count : 400;
                spoilt[(size_t)(random_uniform(5, (uint32_t)k, 0, at) * (double)reach)] =
                    (uint8_t)(256 * random_uniform(5, (uint32_t)k, 1, at));
            }
            file = fopen(path, "wb");
            CHECK(file && fwrite(spoilt, 1, left, file) == left && fclose(file) == 0);
            Culture       c = {0};
            CultureReport r;
            log_set_sink(check_listen, NULL);
            const Status status =
                open_names(&c, &r, strstr(names[k], "a.dbf") || strstr(names[k], "a.shx") ? "a.shp" : names[k], NULL);
            log_set_sink(NULL, NULL);
            opened += status == STATUS_OK, refused += status != STATUS_OK;
            for (int b = 0; b < c.buildings; b++)
                CHECK(c.building[b].corners >= 3 && c.building[b].ridge_m <= 850 && c.building[b].eaves_m > 0);
            for (int p = 0; p < c.corners; p++)
                CHECK(fabs(c.corner_m[p][0]) <= 16000 && fabs(c.corner_m[p][1]) <= 16000);
            culture_free(&c);
        }
        file = fopen(path, "wb");
        CHECK(file && fwrite(sound, 1, count, file) == count && fclose(file) == 0);
    }
    CHECK(opened > 5 && refused > 5);
}

/* An archive of 12 kB that holds 12 MB of one feature's blanks, and one that is all blanks. */
static void archives(void **state)
{
    (void)state;
    char line[512];
    need_judge();
    snprintf(
        line, sizeof line,
        "cd %s && (printf '{\"type\":\"FeatureCollection\",\"features\":['; head -c 50000000 /dev/zero | tr '\\0' ' ') "
        ">blanks.geojson && gzip -k blanks.geojson && gzip -k places.geojson",
        folder);
    CHECK(system(line) == 0);
    snprintf(line, sizeof line, "/vsigzip/%s/places.geojson.gz", folder);
    CHECK(quiet_open(line) == STATUS_OK);
    snprintf(line, sizeof line, "/vsigzip/%s/blanks.geojson.gz", folder);
    CHECK(quiet_open(line) != STATUS_OK);
}

/* A reader that a file has taken over sends sound and spoilt replies: what is taken is as any record. */
static void whatever_it_sends(void **state)
{
    (void)state;
    enum { rounds = 200 };
    static char   path[4200];
    char          self[4096];
    const ssize_t length = readlink("/proc/self/exe", self, sizeof self - 1);
    int           opened = 0, refused = 0, taken = 0;
    CHECK(length > 0);
    self[length] = 0;
    *strrchr(self, '/') = 0;
    snprintf(path, sizeof path, "%s/rasters_hostile", self);
    raster_child_program(path);
    raster_child_patience(0.5);
    log_set_sink(check_listen, NULL);
    for (int n = 0; n < rounds; n++) {
        Culture       c = {0};
        CultureReport r;
        const Status  status = open_names(&c, &r, "a.geojson", NULL);
        opened += status == STATUS_OK, refused += status != STATUS_OK, taken += c.buildings;
        for (int b = 0; b < c.buildings; b++) CHECK(c.building[b].corners >= 3 && c.building[b].ridge_m <= 850);
        for (int p = 0; p < c.corners; p++) CHECK(fabs(c.corner_m[p][0]) <= 16000 && fabs(c.corner_m[p][1]) <= 16000);
        culture_free(&c);
    }
    log_set_sink(NULL, NULL);
    raster_child_patience(0);
    raster_child_program(NULL);
    if (opened < 2 || refused < 2 || taken < 2) fail_msg("%d opened, %d refused, %d taken", opened, refused, taken);
}

/* The same octet by octet, without a process: never more than a refusal. */
static void replies_are_checked(void **state)
{
    (void)state;
    static double room[64];
    uint8_t      *data = (uint8_t *)room;
    VectorPart    part;
    size_t        at = 0;
    const double  place[2] = {0.1, 0.8};
    WireFeature   w = {.octets = sizeof w + 16 + 16, .shape = WIRE_POINT, .corners = 1, .tags = 1, .texts = 13};
    memcpy(data + sizeof w, place, sizeof place);
    memcpy(data + sizeof w + 16, "building\0yes", 13);
    memcpy(data, &w, sizeof w);
    CHECK(vector_part_read(&part, &at, data, sizeof room) && at == w.octets && part.tags == 1 &&
          strcmp(part.value[0], "yes") == 0 && part.lon_lat_rad[0][1] == 0.8);
    static const int32_t odd[] = {-1, 3, 100, 65537, INT32_MAX, INT32_MIN};
    for (size_t field = 0; field < 8; field++)
        for (size_t k = 0; k < sizeof odd / sizeof *odd; k++) {
            WireFeature bad = w;
            memcpy((uint8_t *)&bad + 4 * field, &odd[k], 4);
            memcpy(data, &bad, sizeof bad);
            at = 0;
            const bool taken = vector_part_read(&part, &at, data, sizeof room);
            CHECK(!taken || (field == 3 || field == 6 || field == 7)); /* holes, file, part: any number will do */
        }
    memcpy(data, &w, sizeof w);
    memset(data + sizeof w + 16, 'x', 16); /* no end */
    at = 0;
    CHECK(!vector_part_read(&part, &at, data, sizeof room));
    at = 4;
    CHECK(!vector_part_read(&part, &at, data, sizeof room));
    at = sizeof room;
    CHECK(!vector_part_read(&part, &at, data, sizeof room));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(places_are_on_the_ground),
        cmocka_unit_test(three_formats_and_systems_are_one),
        cmocka_unit_test(mixed_features),
        cmocka_unit_test(what_cannot_be_is_counted),
        cmocka_unit_test(rows_are_clipped),
        cmocka_unit_test(courtyards_are_counted),
        cmocka_unit_test(a_table_of_trees),
        cmocka_unit_test(names_that_are_no_files),
        cmocka_unit_test(same_for_elevation),
        cmocka_unit_test(a_milliard_of_corners),
        cmocka_unit_test(spoilt_files),
        cmocka_unit_test(archives),
        cmocka_unit_test(whatever_it_sends),
        cmocka_unit_test(replies_are_checked),
    };
    return cmocka_run_group_tests(tests, open_lab, close_lab);
}
