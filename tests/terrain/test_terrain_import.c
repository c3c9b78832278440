/* tests/terrain/test_terrain_import.c: files to a terrain store: the posts of the path in memory, in strips of any
 * height and on any number of threads; holes, overlapping sheets and datums; options as a text; stopped and made again.
 */
#include "tests/check.h"

#include "terrain/earth/geoid.h"
#include "terrain/import/terrain_import.h"
#include "terrain/from_files/elevation_import.h"

#include <limits.h>
#include <sys/stat.h>
#include <unistd.h>

static char folder[temp_path_size];

/* An ESRI grid of floats in degrees, with its coordinate system. */
typedef struct Grid {
    const char *name;
    int         nx, ny;
    double      west_deg, south_deg, step_deg;
    float (*z)(int i, int j);
} Grid;

static void path_of(char out[temp_name_size], const char *name)
{
    snprintf(out, temp_name_size, "%s/%s", folder, name);
}

static void write_grid(char out[temp_name_size], const Grid *g)
{
    char path[temp_name_size], name[64];
    for (int part = 0; part < 3; part++) {
        snprintf(name, sizeof name, "%s.%s", g->name, part == 0 ? "hdr" : part == 1 ? "prj" : "flt");
        path_of(path, name);
        FILE *file = fopen(path, "wb");
        CHECK(file != NULL);
        if (part == 0)
            fprintf(file,
                    "ncols %d\nnrows %d\nxllcorner %.10f\nyllcorner %.10f\ncellsize %.10f\nNODATA_value -9999\n"
                    "byteorder lsbfirst\n",
                    g->nx, g->ny, g->west_deg, g->south_deg, g->step_deg);
        else if (part == 1)
            fputs("GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563]],"
                  "PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]]\n",
                  file);
        else
            for (int n = 0; n < g->nx * g->ny; n++) {
                const float z = g->z(n % g->nx, n / g->nx);
                CHECK(fwrite(&z, sizeof z, 1, file) == 1);
            }
        CHECK(fclose(file) == 0);
    }
    snprintf(name, sizeof name, "%s.flt", g->name);
    path_of(out, name);
}

static float hills(int i, int j)
{
    return (float)(300 + 20 * sin(0.03 * i) * cos(0.02 * j) + 2 * sin(0.7 * i + 0.4 * j));
}
static float with_holes(int i, int j) { return (i / 40 + j / 30) % 4 == 0 ? -9999 : hills(i, j); }
static float higher(int i, int j) { return hills(i, j) + 25; }
static float higher_coarse(int i, int j)
{
    const double x = 4 * i + 1.5, y = 4 * j + 1.5;
    return (float)(325 + 20 * sin(0.03 * x) * cos(0.02 * y) + 2 * sin(0.7 * x + 0.4 * y));
}
static float flat(int i, int j) { return (float)(100 + 0 * i * j); }
static float corine_classes(int i, int j) { return (float)(j < 125 ? 312 : 511 + 0 * i); }
static float dynamic_codes(int i, int j) { return (float)(j < 125 ? 1 : 0 * i); }
static float codes(int i, int j) { return (float)(j < 125 ? 10 : 60 + 0 * i); }

static const Grid ground = {"hills", 260, 250, 11, 46, 1e-5, hills};

static LocalFrame frame_of(const Grid *g)
{
    LocalFrame     frame;
    const Geodetic middle = {(g->south_deg + 0.5 * g->ny * g->step_deg) * rad_per_deg,
                             (g->west_deg + 0.5 * g->nx * g->step_deg) * rad_per_deg, 0};
    assert_int_equal(local_frame_at(&frame, &middle), STATUS_OK);
    return frame;
}

static TerrainOptions options_of(const char *elevation)
{
    TerrainOptions o;
    const char    *why;
    terrain_options_default(&o);
    CHECK(terrain_options_set(&o, &why, "elevation", elevation) && terrain_options_set(&o, &why, "horizon", "1") &&
          terrain_options_set(&o, &why, "vertical", "ellipsoid"));
    return o;
}

/* Posts 2 m apart: sooner done. */
static TerrainOptions coarse_options_of(const char *elevation)
{
    TerrainOptions o = options_of(elevation);
    const char    *why;
    CHECK(terrain_options_set(&o, &why, "spacing", "2"));
    return o;
}

/* ---- the same posts -------------------------------------------------------------------------- */

static void heights_of(float *h_m, const ElevationFiles *files, const LocalFrame *frame, int rows, Pool *pool,
                       StreamLevel *level)
{
    ElevationStream *stream = NULL;
    assert_int_equal(elevation_stream_open(&stream, files, frame, NULL, pool), STATUS_OK);
    assert_int_equal(elevation_stream_begin(stream, 0), STATUS_OK);
    elevation_stream_level(level, stream, 0);
    for (int row0 = 0; row0 < level->ny; row0 += rows) {
        const int here = level->ny - row0 < rows ? level->ny - row0 : rows;
        float    *to = h_m + (size_t)row0 * (size_t)level->nx;
        assert_int_equal(elevation_stream_heights(stream, row0, here, to, NULL, true), STATUS_OK);
        assert_int_equal(elevation_stream_bend(stream, row0, here, to), STATUS_OK);
    }
    elevation_stream_close(stream);
}

static void strips_and_threads_give_the_same_posts(void **state)
{
    (void)state;
    enum { most = 700 * 700 };
    char             path[2 * temp_name_size], coarse[temp_name_size];
    const LocalFrame frame = frame_of(&ground);
    float           *whole = malloc(most * sizeof *whole), *part = malloc(most * sizeof *part);
    StreamLevel      level, again;
    Pool            *pool;
    assert_int_equal(pool_create(&pool, 3), STATUS_OK);
    /* with holes, which a coarser file fills */
    const Grid g = {"holes", 260, 250, 11, 46, 1e-5, with_holes}, c = {"coarse", 65, 63, 11, 46, 4e-5, higher_coarse};
    write_grid(path, &g);
    write_grid(coarse, &c);
    snprintf(path + strlen(path), sizeof path - strlen(path), ",%s", coarse);
    const ElevationFiles files = {.paths = path, .geoid_path = "", .vertical = ELEVATION_GEOID, .horizon_m = 1000};
    heights_of(whole, &files, &frame, 10000, NULL, &level);
    CHECK(level.nx * level.ny <= most && level.ny > 200);
    const size_t     size = (size_t)level.nx * (size_t)level.ny * sizeof *whole;
    static const int rows[] = {37, 128};
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        heights_of(part, &files, &frame, rows[k], k & 1 ? pool : NULL, &again);
        CHECK(memcmp(whole, part, size) == 0);
    }
    pool_destroy(pool);
    free(whole);
    free(part);
}

/* The store and the terrain in memory: to half a quantum of each. */
static void the_store_has_the_posts_of_the_path_in_memory(void **state)
{
    (void)state;
    char            path[temp_name_size], out[temp_name_size];
    Elevation       memory = {0};
    ElevationReport report;
    TerrainReport   r;
    TerrainStore    store;
    write_grid(path, &ground);
    path_of(out, "ground.store");
    const TerrainOptions o = options_of(path);
    const ElevationFiles files = {.paths = path, .geoid_path = "", .vertical = ELEVATION_ELLIPSOID, .horizon_m = 1000};
    assert_int_equal(terrain_import(&r, &o, out, NULL, NULL), STATUS_OK);
    assert_int_equal(store_open(&store, out), STATUS_OK);
    assert_int_equal(elevation_import(&memory, &report, &files, &store.frame, NULL, 0), STATUS_OK);
    CHECK(memory.level_count == store.elevation.level_count);
    const ElevationLevel *a = &memory.level[0], *b = &store.elevation.level[0];
    CHECK(a->nx == b->nx && a->ny == b->ny && a->spacing_m == b->spacing_m && a->x0_m == b->x0_m && a->y0_m == b->y0_m);
    /* 2^-8 m in memory, what the report says in the store */
    const double most_m = 0.5 * 0x1p-8 + r.store.worst_m[0] + 1e-6;
    double       worst_m = 0;
    for (double y_m = b->y0_m + b->spacing_m; y_m < b->y0_m + (b->ny - 1) * b->spacing_m; y_m += b->spacing_m)
        for (double x_m = b->x0_m + b->spacing_m; x_m < b->x0_m + (b->nx - 1) * b->spacing_m; x_m += b->spacing_m)
            worst_m = fmax(worst_m, fabs(elevation_height(&memory, x_m, y_m, NULL) -
                                         elevation_height(&store.elevation, x_m, y_m, NULL)));
    print_message("largest difference %.5f m, allowed %.5f\n", worst_m, most_m);
    CHECK(worst_m <= most_m);
    CHECK_NEAR(r.elevation.error_rms_m, report.error_rms_m, 1e-3);
    CHECK(r.elevation.places > 20000 && r.elevation.voids == 0);
    elevation_destroy(&memory);
    store_close(&store);
}

/* ---- many files ------------------------------------------------------------------------------ */

static double stored_h_m(const TerrainStore *store, double lat_deg, double lon_deg)
{
    const Geodetic at = {lat_deg * rad_per_deg, lon_deg * rad_per_deg, 0};
    double         p_ecef[3], p_enu[3];
    Geodetic       place;
    assert_int_equal(ecef_from_geodetic(p_ecef, NULL, &at), STATUS_OK);
    enu_from_ecef(p_enu, &store->frame, p_ecef);
    p_enu[2] = elevation_height(&store->elevation, p_enu[0], p_enu[1], NULL);
    ecef_from_enu(p_ecef, &store->frame, p_enu);
    assert_int_equal(geodetic_from_ecef(&place, p_ecef), STATUS_OK);
    return place.h_m;
}

static void first_given_wins_and_each_has_its_datum(void **state)
{
    (void)state;
    char one[temp_name_size], two[temp_name_size], list[3 * temp_name_size], out[temp_name_size];
    /* half a pixel off: another grid of the same posting */
    const Grid    other = {"higher", 260, 250, 11 + 0.5e-5, 46 + 0.5e-5, 1e-5, higher};
    TerrainReport r;
    TerrainStore  store;
    Geoid         geoid = {0};
    write_grid(one, &ground);
    write_grid(two, &other);
    path_of(out, "two.store");
    assert_int_equal(geoid_open(&geoid, ""), STATUS_OK);
    const double n_m = geoid_height_m(&geoid, 46.0012 * rad_per_deg, 11.0012 * rad_per_deg);
    double       h_m[3];
    for (int k = 0; k < 3; k++) {
        if (k == 2) snprintf(list, sizeof list, "%s@geoid,%s@ellipsoid", one, two);
        else snprintf(list, sizeof list, "%s,%s", k ? two : one, k ? one : two);
        const TerrainOptions o = coarse_options_of(list);
        assert_int_equal(terrain_import(&r, &o, out, NULL, NULL), STATUS_OK);
        CHECK(r.elevation.grids == 2 && r.elevation.sheets == 2);
        assert_int_equal(store_open(&store, out), STATUS_OK);
        h_m[k] = stored_h_m(&store, 46.0012, 11.0012);
        store_close(&store);
    }
    CHECK_NEAR(h_m[1] - h_m[0], 25, 2); /* 25 m higher, on pixels half a post off */
    CHECK_NEAR(h_m[2] - h_m[0], n_m, 0.01);
    geoid_close(&geoid);
}

static void holes_are_filled_and_counted(void **state)
{
    (void)state;
    char          path[temp_name_size], out[temp_name_size];
    const Grid    g = {"holes", 260, 250, 11, 46, 1e-5, with_holes};
    TerrainReport r;
    TerrainStore  store;
    write_grid(path, &g);
    path_of(out, "holes.store");
    const TerrainOptions o = options_of(path);
    assert_int_equal(terrain_import(&r, &o, out, NULL, NULL), STATUS_OK);
    /* a quarter of 260 x 250 pixels of a hundred-thousandth of a degree */
    const double pixel_m2 = 1.1117 * 1.1134 * cos(46 * rad_per_deg),
                 post_m2 = r.elevation.spacing_m * r.elevation.spacing_m;
    CHECK_NEAR((double)r.elevation.voids * post_m2 / pixel_m2, 0.25 * 260 * 250, 0.02 * 260 * 250);
    assert_int_equal(store_open(&store, out), STATUS_OK);
    for (int k = 0; k < 200; k++) {
        const double h_m = stored_h_m(&store, 46.0002 + 0.9e-5 * k, 11.0003 + 0.9e-5 * k);
        CHECK(h_m > 270 && h_m < 330); /* within what is around */
    }
    store_close(&store);
}

/* Deep in a hole of 40 x 30 pixels the coarser file's ground, 25 m higher; led over to from the rim, without a step;
 * what the fine file has stays. */
static void holes_are_filled_from_coarser_files_first(void **state)
{
    (void)state;
    char       fine[temp_name_size], coarse[temp_name_size], list[2 * temp_name_size], out[temp_name_size];
    const Grid g = {"holes", 260, 250, 11, 46, 1e-5, with_holes}, c = {"coarse", 65, 63, 11, 46, 4e-5, higher_coarse};
    TerrainReport r;
    TerrainStore  store;
    write_grid(fine, &g);
    write_grid(coarse, &c);
    snprintf(list, sizeof list, "%s,%s", fine, coarse);
    path_of(out, "coarser.store");
    const TerrainOptions o = options_of(list);
    assert_int_equal(terrain_import(&r, &o, out, NULL, NULL), STATUS_OK);
    assert_int_equal(store_open(&store, out), STATUS_OK);
    double last_m = 0, worst_m = 0, deep_m = 0, steep_m = 0;
    for (int i = 5; i < 250; i++) { /* along row 135: holes are pixels 0 .. 39 and 160 .. 199 */
        const double h_m = stored_h_m(&store, 46 + (249.5 - 135) * 1e-5, 11 + (i + 0.5) * 1e-5) - (double)hills(i, 135);
        const bool   hole = with_holes(i, 135) < 0;
        if (!hole && with_holes(i - 2, 135) > 0 && with_holes(i + 2, 135) > 0) worst_m = fmax(worst_m, fabs(h_m));
        if (i >= 175 && i <= 185) deep_m = fmax(deep_m, fabs(h_m - 25));
        if (i > 5) steep_m = fmax(steep_m, fabs(h_m - last_m));
        last_m = h_m;
    }
    store_close(&store);
    print_message("off %.2f m outside, %.2f deep inside, %.2f from pixel to pixel; %ld + %ld posts\n", worst_m, deep_m,
                  steep_m, r.elevation.voids, r.elevation.voids_coarser);
    CHECK(worst_m < 1 && deep_m < 3 && steep_m < 8);
    CHECK(r.elevation.voids > 0 && r.elevation.voids_coarser > r.elevation.voids / 4);
}

static void classes_are_where_the_file_has_them(void **state)
{
    (void)state;
    /* of whole numbers: the same as a VRT of octets; of more than 255; and a table where 0 is a class */
    static const struct {
        const char *type, *table;
        float (*code)(int i, int j);
        SurfaceClass north, south;
    } kinds[] = {{"Byte", "worldcover", codes, SURFACE_FOREST_BROADLEAF, SURFACE_BARE_SOIL},
                 {"Int16", "corine", corine_classes, SURFACE_FOREST_CONIFER, SURFACE_WATER},
                 {"Byte", "dynamicworld", dynamic_codes, SURFACE_FOREST_BROADLEAF, SURFACE_WATER}};
    char          path[temp_name_size], cover[temp_name_size], out[temp_name_size], code[2 * temp_name_size];
    const char   *why;
    TerrainReport r;
    TerrainStore  store;
    write_grid(path, &ground);
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
        const Grid g = {"cover", 260, 250, 11, 46, 1e-5, kinds[k].code};
        write_grid(cover, &g);
        path_of(code, "cover.vrt");
        FILE *vrt = fopen(code, "w");
        CHECK(vrt != NULL);
        fprintf(
            vrt,
            "<VRTDataset rasterXSize=\"260\" rasterYSize=\"250\"><SRS>EPSG:4326</SRS><GeoTransform>11, 1e-5, 0, %.10f, "
            "0, -1e-5</GeoTransform><VRTRasterBand dataType=\"%s\" band=\"1\"><SimpleSource><SourceFilename>%s"
            "</SourceFilename><SourceBand>1</SourceBand></SimpleSource></VRTRasterBand></VRTDataset>",
            46 + 250e-5, kinds[k].type, cover);
        CHECK(fclose(vrt) == 0);
        path_of(out, "cover.store");
        TerrainOptions o = options_of(path);
        CHECK(terrain_options_set(&o, &why, "cover", code));
        assert_int_equal(terrain_import(&r, &o, out, NULL, NULL), STATUS_OK);
        assert_string_equal(r.cover.table, kinds[k].table);
        assert_int_equal(store_open(&store, out), STATUS_OK);
        assert_int_equal(cover_grid_at(store.surface, 5, 20), kinds[k].north);
        assert_int_equal(cover_grid_at(store.surface, 5, -20), kinds[k].south);
        CHECK(cover_grid_at(store.surface, 5, 1e5) == SURFACE_NONE);
        CHECK_NEAR(r.cover.share[kinds[k].north], 0.5, 0.02);
        CHECK(r.cover.unknown == 0);
        store_close(&store);
    }
}

/* ---- surface models -------------------------------------------------------------------------- */

static const int tree[3][2] = {{150, 50}, {50, 150}, {160, 165}};

static bool  in_house(int i, int j) { return i >= 40 && i < 65 && j >= 40 && j < 60; }
static bool  in_court(int i, int j) { return i >= 113 && i < 128 && j >= 113 && j < 128; }
static bool  in_yard_house(int i, int j) { return i >= 100 && i < 141 && j >= 100 && j < 141 && !in_court(i, j); }
static float slope(int i, int j) { return (float)(200 + 0.02 * i + 0.01 * j); }

/* Two houses, one about a courtyard, and three trees; row 0 northernmost. */
static float town(int i, int j)
{
    double above_m = in_house(i, j) ? 8 : in_yard_house(i, j) ? 11 : 0;
    for (int k = 0; k < 3; k++) {
        const double away_m = hypot(i - tree[k][0], j - tree[k][1]);
        const double rough_m = 0.8 * random_uniform(7, 1, (uint32_t)i, (uint64_t)j);
        if (away_m < 5) above_m = 12 - 0.4 * away_m * away_m - rough_m;
    }
    return (float)((double)slope(i, j) + above_m);
}

static void houses_and_trees_are_taken_off_a_surface_model(void **state)
{
    (void)state;
    char          path[temp_name_size], out[temp_name_size];
    const char   *why;
    TerrainReport r;
    TerrainStore  store;
    const double  pixel_deg = 0.9e-5, west_deg = 11, south_deg = 0.001; /* of a metre at the equator */
    const Grid    g = {"town", 200, 200, west_deg, south_deg, pixel_deg, town};
    write_grid(path, &g);
    path_of(out, "town.store");
    TerrainOptions o;
    terrain_options_default(&o);
    CHECK(terrain_options_set(&o, &why, "surface", path) && terrain_options_set(&o, &why, "horizon", "1") &&
          terrain_options_set(&o, &why, "vertical", "ellipsoid") && terrain_options_set(&o, &why, "spacing", "1"));
    assert_int_equal(terrain_import(&r, &o, out, NULL, NULL), STATUS_OK);
    assert_int_equal(store_open(&store, out), STATUS_OK);
    CHECK(r.apart && !r.beside);
    print_message("%d buildings, %d crowns\n", (int)store.building_count, (int)store.crown_count);
    CHECK(store.building_count == 2);
    int crowns = 0; /* a house's corner may leave a crown of one cell */
    for (int n = 0; n < (int)store.crown_count; n++) crowns += store.crown[n].radius_m > 1;
    CHECK(crowns == 3);
    static const int    place[][2] = {{52, 50}, {105, 120}, {120, 120}, {80, 80}, {150, 50}, {160, 165}};
    static const double above_m[] = {8, 11, 0, 0, 0, 0};
    for (int k = 0; k < 6; k++) {
        const int    i = place[k][0], j = place[k][1];
        const double h_m = stored_h_m(&store, south_deg + (199.5 - j) * pixel_deg, west_deg + (i + 0.5) * pixel_deg);
        CHECK_NEAR(h_m, (double)slope(i, j) + above_m[k], 0.3);
        /* the frame's origin is the middle of the file */
        const uint8_t surface = (uint8_t)cover_grid_at(store.surface, i - 99.5, 99.5 - j);
        CHECK((surface == SURFACE_BUILT) == (k < 2));
    }
    for (int k = 0; k < 3; k++) {
        double nearest_m = INFINITY;
        for (int n = 0; n < (int)store.crown_count; n++) {
            const Crown *c = &store.crown[n];
            nearest_m =
                fmin(nearest_m, hypot((double)c->x_m - (tree[k][0] - 99.5), (double)c->y_m - (99.5 - tree[k][1])));
            CHECK(c->radius_m < 1 || (c->height_m > 10 && c->height_m < 13 && c->radius_m > 3 && c->radius_m < 6));
        }
        CHECK(nearest_m < 2);
    }
    store_close(&store);
}

static void buildings_are_counted_over_rows(void **state)
{
    (void)state;
    /* a ring about a cell, two arms that meet in the last row but one, cells that touch at a corner */
    static const char *const rows[] = {"###..#.#.#", "#.#..#.#..", "###..#.#..", ".....###..", "#.......##"};
    TerrainBuildings         b = {0};
    for (int j = 0; j < 5; j++) {
        uint8_t kind[10];
        for (int i = 0; i < 10; i++) kind[i] = rows[j][i] == '#' ? CELL_BUILDING : i & 1 ? CELL_TREE : CELL_BARE;
        assert_int_equal(terrain_buildings_count(&b, 10, kind), STATUS_OK);
    }
    assert_int_equal(b.count, 5);
    terrain_buildings_free(&b);
}

/* ---- options, stopping, making again --------------------------------------------------------- */

static void options_are_a_text_and_back(void **state)
{
    (void)state;
    static char              text[8 * terrain_paths_size], second[8 * terrain_paths_size];
    TerrainOptions           o, back;
    const char              *why;
    int                      line;
    static const char *const given[][2] = {{"surface", "/a/b c.tif@ellipsoid"},
                                           {"buildings", "/a/b c.geojson"},
                                           {"elevation", "/x.tif"},
                                           {"elevation", "/y.tif:3"},
                                           {"cover-table", "nlcd"},
                                           {"vertical", "geoid"},
                                           {"origin", "0,0"},
                                           {"size", "12x16"},
                                           {"spacing", "0.1"},
                                           {"horizon", "30"}};
    terrain_options_default(&o);
    for (size_t k = 0; k < sizeof given / sizeof *given; k++)
        CHECK(terrain_options_set(&o, &why, given[k][0], given[k][1]));
    assert_string_equal(o.elevation, "/x.tif,/y.tif:3");
    CHECK(terrain_options_text(text, sizeof text, &o) && terrain_options_parse(&back, &why, &line, text));
    CHECK(terrain_options_text(second, sizeof second, &back));
    assert_string_equal(text, second);
    CHECK(back.origin_deg[0] == 0 && back.size_km[1] == 16 && back.spacing_m == 0.1);
    static const char *const wrong[][2] = {{"size", "12"},     {"size", "0x4"},     {"size", "nanx4"},
                                           {"origin", "91,0"}, {"origin", "1"},     {"spacing", "0"},
                                           {"spacing", "1e9"}, {"vertical", "sea"}, {"horizon", "inf"},
                                           {"colour", "red"},  {"cover", ""},       {"cover", "a\nb"}};
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++)
        CHECK(!terrain_options_set(&o, &why, wrong[k][0], wrong[k][1]));
    CHECK(!terrain_options_parse(&back, &why, &line, "elevation /x.tif\nsize 1\n") && line == 2);
    CHECK(!terrain_options_parse(&back, &why, &line, "size 1x1\n"));
    CHECK(!terrain_options_parse(&back, &why, &line, "elevation /x.tif\nbuildings /a.geojson\n") &&
          strstr(why, "give --surface"));
}

static bool stop_soon(void *user, const char *stage, double share)
{
    (void)stage;
    (void)share;
    return ++*(int *)user < 3;
}

static void stopped_or_refused_it_leaves_nothing(void **state)
{
    (void)state;
    char          path[temp_name_size], out[temp_name_size], part[temp_name_size + 8];
    TerrainReport r;
    struct stat   about;
    int           calls = 0;
    write_grid(path, &ground);
    path_of(out, "stopped.store");
    snprintf(part, sizeof part, "%s.tmp", out);
    TerrainOptions o = options_of(path);
    CHECK(terrain_import(&r, &o, out, NULL, &(TerrainWatch){.progress = stop_soon, .user = &calls}) != STATUS_OK &&
          r.stopped);
    CHECK(stat(out, &about) != 0 && stat(part, &about) != 0);
    log_set_sink(check_listen, NULL);
    o = options_of("/nowhere.tif");
    CHECK(terrain_import(&r, &o, out, NULL, NULL) != STATUS_OK && strstr(check_said, "/nowhere.tif"));
    CHECK(stat(out, &about) != 0 && stat(part, &about) != 0);
    const char *why;
    o = options_of(path);
    CHECK(terrain_options_set(&o, &why, "cover", path)); /* heights are no classes */
    CHECK(terrain_import(&r, &o, out, NULL, NULL) != STATUS_OK && strstr(check_said, "is it elevation"));
    o = options_of(path);
    CHECK(terrain_options_set(&o, &why, "origin", "10,10"));
    CHECK(terrain_import(&r, &o, out, NULL, NULL) != STATUS_OK && strstr(check_said, "nearest"));
    log_set_sink(NULL, NULL);
    CHECK(stat(out, &about) != 0 && stat(part, &about) != 0);
}

static void a_store_is_made_again_from_its_header(void **state)
{
    (void)state;
    char          path[temp_name_size], out[temp_name_size], which[512];
    TerrainReport r;
    TerrainStore  store;
    const Grid    other = {"again", 260, 250, 11, 46, 1e-5, flat};
    Grid          first = ground;
    first.name = "again";
    write_grid(path, &first);
    path_of(out, "again.store");
    const TerrainOptions o = coarse_options_of(path);
    assert_int_equal(terrain_import(&r, &o, out, NULL, NULL), STATUS_OK);
    assert_int_equal(store_open(&store, out), STATUS_OK);
    const uint64_t was = store.content;
    CHECK(store_sources(&store, which, sizeof which) == STORE_FRESH);
    assert_int_equal(terrain_store_rebuild(out, store.options, false), STATUS_OK);
    store_close(&store);
    assert_int_equal(store_open(&store, out), STATUS_OK);
    CHECK(store.content == was); /* the same, on other threads */
    write_grid(path, &other);
    CHECK(store_sources(&store, which, sizeof which) == STORE_CHANGED && strstr(which, "again"));
    assert_int_equal(terrain_store_rebuild(out, store.options, false), STATUS_OK);
    store_close(&store);
    assert_int_equal(store_open(&store, out), STATUS_OK);
    CHECK(store_sources(&store, which, sizeof which) == STORE_FRESH);
    CHECK_NEAR(stored_h_m(&store, 46.0012, 11.0012), 100, 0.01);
    store_close(&store);
}

static int set_up(void **state)
{
    (void)state;
    return temp_folder(folder) ? 0 : -1;
}

static int tear_down(void **state)
{
    char command[temp_name_size + 16];
    (void)state;
    snprintf(command, sizeof command, "rm -r '%s'", folder);
    return system(command);
}

/* The grid `own` by another name. */
static void write_vrt(const char *path, const char *source)
{
    FILE *file = fopen(path, "w");
    CHECK(file != NULL);
    fprintf(file,
            "<VRTDataset rasterXSize=\"260\" rasterYSize=\"250\"><SRS>EPSG:4326</SRS>"
            "<GeoTransform>11,1e-5,0,46.0025,0,-1e-5</GeoTransform><VRTRasterBand dataType=\"Float32\" band=\"1\">"
            "<SimpleSource><SourceFilename relativeToVRT=\"0\">%s</SourceFilename><SourceBand>1</SourceBand>"
            "</SimpleSource></VRTRasterBand></VRTDataset>",
            source);
    CHECK(fclose(file) == 0);
}

/* A store may be a stranger's: what lies outside its own folder is not read for it, whichever way it is named. */
static void a_store_is_made_again_of_its_own_folder_alone(void **state)
{
    (void)state;
    char path[temp_name_size], out[temp_name_size], outside[512], text[4 * temp_name_size], whole[PATH_MAX],
        own[temp_path_size], other[temp_path_size], secret[temp_name_size], vrt[temp_name_size], nested[temp_name_size],
        linked[temp_name_size], links[temp_name_size];
    TerrainReport r;
    Grid          first = ground;
    first.name = "own";
    write_grid(path, &first);
    path_of(out, "own.store");
    const TerrainOptions o = coarse_options_of(path);
    assert_int_equal(terrain_import(&r, &o, out, NULL, NULL), STATUS_OK);

    assert_true(temp_folder(other));
    memcpy(own, folder, sizeof own);
    memcpy(folder, other, sizeof folder);
    write_grid(secret, &first);
    memcpy(folder, own, sizeof folder);
    path_of(linked, "linked.flt");
    path_of(links, "links");
    path_of(vrt, "named.vrt");
    path_of(nested, "nested.vrt");
    assert_int_equal(symlink(secret, linked), 0);
    assert_int_equal(mkdir(links, 0700), 0);
    snprintf(text, sizeof text, "%s/linked.flt", links);
    assert_int_equal(symlink(secret, text), 0);
    write_vrt(vrt, secret);
    write_vrt(nested, vrt);
    const char *file_name = strrchr(path, '/') + 1, *store_folder = realpath(out, whole);
    assert_non_null(store_folder);
    const struct {
        const char *options[4];
        const char *said;
    } bad[] = {
        {{"elevation ", secret}, "outside its own folder"},
        {{"elevation ", path, ",", secret}, "outside its own folder"},
        {{"elevation ", path, "\nsurface ", secret}, "outside its own folder"},
        {{"elevation ", path, "\ncover ", secret}, "outside its own folder"},
        {{"elevation ", path, "\nphoto ", secret}, "outside its own folder"},
        {{"elevation ", path, "\ncanopy-height ", secret}, "outside its own folder"},
        {{"elevation ", path, "\ncanopy-cover ", secret}, "outside its own folder"},
        {{"elevation ", path, "\ngeoid ", secret}, "outside its own folder"},
        {{"elevation ", path, "\ncover-table ", secret}, "outside its own folder"},
        {{"elevation ", secret, "@geoid"}, "outside its own folder"},
        {{"elevation ", secret, ":1"}, "outside its own folder"},
        {{"elevation ", path, "/../../", secret}, "outside its own folder"},
        {{"elevation ", "/vsicurl/http://127.0.0.1:9/a.tif"}, "outside its own folder"},
        {{"elevation ", "http://127.0.0.1:9/a.tif"}, "outside its own folder"},
        {{"elevation ", "/vsizip/", path}, "outside its own folder"},
        {{"elevation ", "GTIFF_DIR:1:", path}, "outside its own folder"},
        {{"elevation ", file_name}, "outside its own folder"}, /* of the current folder */
        {{"elevation ", linked}, "outside its own folder"},
        {{"elevation ", links}, "lies outside the folder"},
        {{"elevation ", vrt}, "lies outside the folder"},
        {{"elevation ", nested}, "lies outside the folder"},
    };
    log_set_sink(check_listen, NULL);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        const char *const *part = bad[i].options;
        snprintf(text, sizeof text, "%s%s%s%s\nhorizon 1\n", part[0], part[1], part[2] ? part[2] : "",
                 part[3] ? part[3] : "");
        if (terrain_store_rebuild(out, text, false) == STATUS_OK) fail_msg("made again: %s", text);
        if (!strstr(check_said, bad[i].said)) fail_msg("%s: said '%s'", text, check_said);
        CHECK(terrain_store_foreign(outside, sizeof outside, out, text) == (strstr(bad[i].said, "its own") != NULL));
    }
    log_set_sink(NULL, NULL);
    snprintf(text, sizeof text, "elevation %s\nspacing 10\nhorizon 1\n", path);
    CHECK(!terrain_store_foreign(outside, sizeof outside, out, text));
    assert_int_equal(terrain_store_rebuild(out, text, false), STATUS_OK);
    /* anywhere: what is named is read, and what that names where the options say so */
    log_set_sink(check_listen, NULL);
    snprintf(text, sizeof text, "elevation %s\nspacing 10\nhorizon 1\n", nested);
    CHECK(terrain_store_rebuild(out, text, true) != STATUS_OK && strstr(check_said, "lies outside its folder"));
    log_set_sink(NULL, NULL);
    snprintf(text, sizeof text, "elevation %s\nspacing 10\nhorizon 1\nsources-from %s\n", nested, other);
    assert_int_equal(terrain_store_rebuild(out, text, true), STATUS_OK);
    log_set_sink(check_listen, NULL);
    CHECK(terrain_store_rebuild(out, text, false) != STATUS_OK); /* a store's own word does not widen that */
    log_set_sink(NULL, NULL);
    memcpy(folder, other, sizeof folder);
    tear_down(state);
    memcpy(folder, own, sizeof folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(strips_and_threads_give_the_same_posts),
        cmocka_unit_test(the_store_has_the_posts_of_the_path_in_memory),
        cmocka_unit_test(first_given_wins_and_each_has_its_datum),
        cmocka_unit_test(holes_are_filled_and_counted),
        cmocka_unit_test(holes_are_filled_from_coarser_files_first),
        cmocka_unit_test(classes_are_where_the_file_has_them),
        cmocka_unit_test(houses_and_trees_are_taken_off_a_surface_model),
        cmocka_unit_test(buildings_are_counted_over_rows),
        cmocka_unit_test(options_are_a_text_and_back),
        cmocka_unit_test(stopped_or_refused_it_leaves_nothing),
        cmocka_unit_test(a_store_is_made_again_from_its_header),
        cmocka_unit_test(a_store_is_made_again_of_its_own_folder_alone),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
