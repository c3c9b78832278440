/* Culture of files: the same content as GeoJSON, GeoPackage and Shapefile and in two coordinate systems, made by
 * ogr2ogr, is the same records; places and base heights against geodesy worked out otherwise; what is left out is
 * counted; a table of trees; hostile files. labels: small */
#include "tests/terrain/vector_lab.h"

/* ---- places ------------------------------------------------------------------------------------------ */

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

static void courtyards_are_open(void **state)
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
    CHECK(c.buildings == 2 && c.building[0].corners == 4 + 3 + 4 && c.building[1].corners == 3);
    CHECK(r.courtyards == 1 && r.built_over == 0);
    /* the triangle of the courtyard is 0.0003 by 0.0003 of the 0.001 by 0.001 degrees: 4.5 % of the square */
    double twice = 0;
    for (int k = 0; k < c.building[0].corners; k++) {
        const double *a = c.corner_m[k], *b = c.corner_m[(k + 1) % c.building[0].corners];
        twice += a[0] * b[1] - a[1] * b[0];
    }
    const double across_m = 0.001 * 111320 * cos(47.0505 * pi_rad / 180), square_m2 = across_m * 0.001 * 111170;
    CHECK_NEAR(0.5 * twice / square_m2, 0.955, 0.004);
    CHECK(c.building[0].id != c.building[1].id);
    culture_free(&c);
    /* 44 x 36 m about a courtyard of 22 x 14 m: 1276 m2 between 232 m of walls, wings of 10.6 m, whose roofs rise by
     * 0.84 of half of that, less the two sides of the slit; without the courtyard by 0.84 of 18 m, 12 at most */
    const double square[8][2] = {{-22, -18}, {22, -18}, {22, 18}, {-22, 18}, {-11, -7}, {11, -7}, {11, 7}, {-11, 7}};
    char         block[2048];
    int          n = snprintf(block, sizeof block,
                              "{\"type\":\"FeatureCollection\",\"features\":[{\"type\":\"Feature\",\"properties\":{"
                                       "\"building\":\"apartments\",\"roof:shape\":\"gabled\",\"building:levels\":\"3\"},\"geometry\":{"
                                       "\"type\":\"Polygon\",\"coordinates\":[[");
    for (int k = 0; k < 10; k++) {
        const double *p = square[k < 5 ? k % 4 : 4 + (k - 5) % 4];
        n += snprintf(block + n, sizeof block - (size_t)n, "%s[%.9f,%.9f]",
                      k == 5 ? "],["
                      : k    ? ","
                             : "",
                      13.02 + p[0] / (111320 * cos(47.05 * pi_rad / 180)), 47.05 + p[1] / 111170);
    }
    snprintf(block + n, sizeof block - (size_t)n, "]]}}]}");
    save("block.geojson", block);
    assert_int_equal(open_names(&c, &r, "block.geojson", NULL), STATUS_OK);
    CHECK(c.buildings == 1 && r.courtyards == 1 && c.building[0].roof == ROOF_GABLED);
    CHECK_NEAR((double)(c.building[0].ridge_m - c.building[0].eaves_m), 0.42 * 2 * 1276 / (232 + 2 * 11), 0.1);
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
    CHECK(c.trees == 2 && r.trees_marked == 1 && c.tree[0].mark == MARK_WHITE && !c.tree[1].mark);
    CHECK_NEAR(c.tree[0].x_m, 300, 1e-5);
    CHECK_NEAR(c.tree[0].y_m, -400, 1e-5);
    CHECK(c.tree[0].kind == PLANT_BIRCH && c.tree[0].height_m == 14.5f && c.tree[1].kind == PLANT_PINE &&
          c.tree[1].height_m == 0);
    culture_free(&c);
    assert_int_equal(open_names(&c, &r, "", "xy.csv"), STATUS_OK);
    CHECK(c.trees == 2 && c.tree[1].x_m == -30.5 && c.tree[1].mark == MARK_WHITE && r.left[CULTURE_LEFT_OUTSIDE] == 1);
    culture_free(&c);
    static const char *const bad[] = {"x_m,kind\n1,pine\n",          "x_m,y_m,kind\n1,2,palm\n",      "lat,lon\n91,0\n",
                                      "x_m,y_m,height_m\n1,2,500\n", "x_m,y_m,marked\n1,2,perhaps\n", "height_m\n3\n",
                                      "lat,lon,x_m,y_m\n47,13,1,2\n"};
    log_set_sink(check_listen, NULL);
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        save("bad.csv", bad[k]);
        *check_said = 0;
        CHECK(open_names(&c, &r, "", "bad.csv") == STATUS_BAD_VALUE && strstr(check_said, "bad.csv"));
    }
    log_set_sink(NULL, NULL);
}

/* Two files of neighbouring areas have what lies on the border in common; one that is named twice, all. */
static void what_two_files_have_is_there_once(void **state)
{
    (void)state;
    static const double one[5][2] = {{0, 0}, {12, 0}, {12, 9}, {0, 9}, {0, 0}};
    static const double other[5][2] = {{50, 0}, {62, 0}, {62, 9}, {50, 9}, {50, 0}};
    static const double wall[3][2] = {{0, 40}, {30, 40}, {30, 60}}, tank[1][2] = {{80, 80}}, birch[1][2] = {{90, 80}};
    Culture             c, all;
    CultureReport       r;
    for (int k = 0; k < 2; k++) {
        begin_file();
        add_feature("Polygon", "[[", "]]", "\"building\":\"house\",\"height\":7", one, 5);
        if (k) add_feature("Polygon", "[[", "]]", "\"building\":\"house\"", other, 5);
        add_feature("LineString", "[", "]", "\"barrier\":\"wall\"", wall, 3);
        add_feature("Point", "", "", "\"man_made\":\"silo\"", tank, 1);
        add_feature("Point", "", "", "\"natural\":\"tree\"", birch, 1);
        end_file(k ? "east.geojson" : "west.geojson");
    }
    assert_int_equal(open_names(&c, &r, "west.geojson,east.geojson,west.geojson", NULL), STATUS_OK);
    CHECK(c.buildings == 2 && c.lines == 1 && c.points == 1 && c.trees == 1 && r.left[CULTURE_LEFT_TWICE] == 8);
    CHECK(r.height_from[HEIGHT_FROM_FILE] == 1 && r.height_from[HEIGHT_FROM_USE] == 1 && c.corners == 4 + 3 + 4);
    assert_int_equal(open_names(&all, &r, "east.geojson", NULL), STATUS_OK);
    CHECK(all.buildings == 2 && all.lines == 1 && r.left[CULTURE_LEFT_TWICE] == 0);
    culture_free(&c), culture_free(&all);
}

/* The first place of the first feature of a type in GeoJSON, off where it is on the hill, in degrees. */
static double first_off_deg(const char *json, const char *type, const double p_m[2])
{
    double      deg[2], want[2];
    const char *at = strstr(json, type);
    CHECK(at && (at = strstr(at, "coordinates\": ")));
    at += strcspn(at, "[");
    CHECK(sscanf(at + strspn(at, "["), "%lf, %lf", &deg[0], &deg[1]) == 2);
    degrees_of(want, p_m[0], p_m[1]);
    return fmax(fabs(deg[0] - want[0]), fabs(deg[1] - want[1]));
}

/* Records are written where they are on ground that is high above the frame's plane, 12 km off. */
static void records_are_written_where_they_are(void **state)
{
    (void)state;
    static const double one[5][2] = {{8000, 9000}, {8012, 9000}, {8012, 9009}, {8000, 9009}, {8000, 9000}};
    static const double wall[3][2] = {{-9000, 8000}, {-9030, 8000}, {-9030, 8060}}, birch[1][2] = {{8000, -9000}};
    static char         json[1 << 14];
    char                path[128];
    Culture             c;
    CultureReport       r;
    begin_file();
    add_feature("Polygon", "[[", "]]", "\"building\":\"house\"", one, 5);
    add_feature("LineString", "[", "]", "\"barrier\":\"wall\"", wall, 3);
    add_feature("Point", "", "", "\"natural\":\"tree\"", birch, 1);
    end_file("in.geojson");
    assert_int_equal(open_names(&c, &r, "in.geojson", NULL), STATUS_OK);
    path_of(path, "out.geojson");
    assert_int_equal(culture_write_geojson(path, &c, &(CultureFiles){.frame = &frame, .ground = hill}), STATUS_OK);
    FILE *file = fopen(path, "r");
    CHECK(file && fread(json, 1, sizeof json - 1, file) > 0);
    fclose(file);
    const double polygon = first_off_deg(json, "Polygon", c.corner_m[c.building[0].first_corner]),
                 line = first_off_deg(json, "LineString", wall[0]), point = first_off_deg(json, "Point", birch[0]);
    print_message("%.1e, %.1e and %.1e degrees off\n", polygon, line, point);
    CHECK(polygon < 2e-9 && line < 2e-9 && point < 2e-9); /* of nine decimals; a metre is 1e-5 */
    culture_free(&c);
}

/* Fifteen hedges of 200 km are 2.5 million plants: more than one culture holds, but no file has a limit of its own. */
static void a_file_of_more_records_than_a_square_holds_is_good(void **state)
{
    (void)state;
    char path[128];
    begin_file();
    for (int n = 0; n < 15; n++) {
        const double p[2][2] = {{-1e5, 10 * n}, {1e5, 10 * n}};
        add_feature("LineString", "[", "]", "\"barrier\":\"hedge\"", p, 2);
    }
    end_file("hedges.geojson");
    path_of(path, "hedges.geojson");
    CHECK(culture_files_good(path, ""));
    save("hedges.geojson", "{\"type\":");
    log_set_sink(check_listen, NULL);
    CHECK(!culture_files_good(path, ""));
    log_set_sink(NULL, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(places_are_on_the_ground),
        cmocka_unit_test(three_formats_and_systems_are_one),
        cmocka_unit_test(mixed_features),
        cmocka_unit_test(what_cannot_be_is_counted),
        cmocka_unit_test(rows_are_clipped),
        cmocka_unit_test(courtyards_are_open),
        cmocka_unit_test(a_table_of_trees),
        cmocka_unit_test(a_file_of_more_records_than_a_square_holds_is_good),
        cmocka_unit_test(what_two_files_have_is_there_once),
        cmocka_unit_test(records_are_written_where_they_are),
    };
    return cmocka_run_group_tests(tests, open_lab, close_lab);
}
