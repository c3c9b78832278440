/* Buildings of surface models as records: those of a town that the test built, wherever windows and strips meet and far
 * from the origin; read as they were written. */
#include "tests/terrain/buildings_lab.h"

#include "terrain/import/terrain_import_private.h"

/* An ESRI grid of floats in degrees; row 0 northernmost. */
static void write_grid(char out[temp_name_size], const char *name, int nx, int ny, const double south_west_deg[2],
                       double step_deg, float (*z)(int i, int j))
{
    char path[temp_name_size], file_name[64];
    for (int part = 0; part < 3; part++) {
        snprintf(file_name, sizeof file_name, "%s.%s", name, part == 0 ? "hdr" : part == 1 ? "prj" : "flt");
        path_of(path, file_name);
        FILE *file = fopen(path, "wb");
        CHECK(file != NULL);
        if (part == 0)
            fprintf(file,
                    "ncols %d\nnrows %d\nxllcorner %.10f\nyllcorner %.10f\ncellsize %.10f\nNODATA_value -9999\n"
                    "byteorder lsbfirst\n",
                    nx, ny, south_west_deg[1], south_west_deg[0], step_deg);
        else if (part == 1)
            fputs("GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563]],"
                  "PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]]\n",
                  file);
        else
            for (int n = 0; n < nx * ny; n++) {
                const float h_m = z(n % nx, n / nx);
                CHECK(fwrite(&h_m, sizeof h_m, 1, file) == 1);
            }
        CHECK(fclose(file) == 0);
    }
    snprintf(file_name, sizeof file_name, "%s.flt", name);
    path_of(out, file_name);
}

/* ---- windows and strips ------------------------------------------------------------------------------ */

enum { apart = 24, town_nx = 1152, town_ny = 792 };               /* cells of 2 m; houses every 24 of them */
static const int long_j[2] = {268, 276}, long_i[2] = {944, 1104}; /* 320 m, across where windows meet */

static bool in_long(int i, int j) { return i >= long_i[0] && i < long_i[1] && j >= long_j[0] && j < long_j[1]; }

static float town(int i, int j)
{
    const int  a = i / apart, b = j / apart, x = i % apart, y = j % apart;
    const int  wide = 6 + (a * 7 + b * 3) % 7, deep = 5 + (a * 5 + b * 11) % 5, at = 3 + (a + b) % 4;
    const bool near_long = a >= long_i[0] / apart - 1 && a <= long_i[1] / apart + 1 && b >= long_j[0] / apart - 1 &&
                           b <= long_j[1] / apart + 1;
    const bool house = !near_long && x >= at && x < at + wide && y >= at && y < at + deep;
    return (float)(200 + 0.02 * i + 0.01 * j + (house ? 4 + (a + 2 * b) % 4 : in_long(i, j) ? 9 : 0));
}

static int houses_of_town(void)
{
    int count = 0;
    for (int b = 0; b * apart < town_ny; b++)
        for (int a = 0; a * apart < town_nx; a++) {
            const int i = a * apart + 7, j = b * apart + 7; /* of every house */
            count += (double)town(i, j) - (200 + 0.02 * i + 0.01 * j) > 3 && !in_long(i, j);
        }
    return count;
}

static int by_id(const void *a, const void *b)
{
    const uint64_t x = ((const Building *)a)->id, y = ((const Building *)b)->id;
    return (x > y) - (x < y);
}

static Culture buildings_by(const SurfaceSources *from, int ny, int rows)
{
    Culture c = {0};
    for (int row0 = 0; row0 < ny; row0 += rows) {
        SurfaceStrip strip = {0};
        assert_int_equal(surface_strip_make(&strip, from, row0, ny - row0 < rows ? ny - row0 : rows), STATUS_OK);
        assert_int_equal(import_buildings_add(&c, &strip.culture), STATUS_OK);
        surface_strip_free(&strip);
    }
    qsort(c.building, (size_t)c.buildings, sizeof *c.building, by_id);
    return c;
}

static void strips_and_threads_give_the_same_buildings(void **state)
{
    (void)state;
    static const double south_west_deg[2] = {0.001, 11};
    char                path[temp_name_size];
    LocalFrame          frame;
    Pool               *pool;
    ElevationStream    *stream = NULL;
    StreamLevel         level;
    const double        step_deg = 1.8e-5;
    const Geodetic      middle = {(south_west_deg[0] + 0.5 * town_ny * step_deg) * rad_per_deg,
                                  (south_west_deg[1] + 0.5 * town_nx * step_deg) * rad_per_deg, 0};
    assert_int_equal(local_frame_at(&frame, &middle), STATUS_OK);
    assert_int_equal(pool_create(&pool, 3), STATUS_OK);
    write_grid(path, "windows", town_nx, town_ny, south_west_deg, step_deg, town);
    const ElevationFiles files = {
        .paths = path, .geoid_path = "", .vertical = ELEVATION_ELLIPSOID, .horizon_m = 1000, .spacing_m = 2};
    assert_int_equal(elevation_stream_open(&stream, &files, &frame, NULL, pool), STATUS_OK);
    assert_int_equal(elevation_stream_begin(stream, 0), STATUS_OK);
    elevation_stream_level(&level, stream, 0);
    SurfaceSources from = {.surface = stream, .frame = &frame, .buildings = true};
    Culture        whole = buildings_by(&from, level.ny, level.ny);
    from.pool = pool;
    Culture   part = buildings_by(&from, level.ny, 150);
    const int houses = houses_of_town();
    double    long_m2 = 0;
    int       pieces = 0;
    print_message("%d buildings, in strips %d; %d houses and the long one\n", whole.buildings, part.buildings, houses);
    CHECK(level.nx > 1024 && whole.buildings == part.buildings);
    for (int n = 0; n < whole.buildings; n++) {
        Building a = whole.building[n], b = part.building[n];
        const double(*p)[2] = (const double(*)[2])whole.corner_m + a.first_corner;
        CHECK(a.corners == b.corners && memcmp(p, part.corner_m + b.first_corner, (size_t)a.corners * sizeof *p) == 0);
        b.first_corner = a.first_corner;
        CHECK(memcmp(&a, &b, sizeof a) == 0);
        if (a.eaves_m < 8) continue;
        pieces++;
        for (int k = 0; k < a.corners; k++) {
            const double *u = p[k], *v = p[(k + 1) % a.corners];
            long_m2 += 0.5 * (u[0] * v[1] - u[1] * v[0]);
        }
    }
    /* the long building is cut, and none of it is lost or there twice: 320 x 16 m */
    print_message("%d pieces of the long one, %.0f m2\n", pieces, long_m2);
    CHECK(whole.buildings == houses + pieces && pieces >= 2 && pieces <= 6);
    CHECK(long_m2 > 316 * 12 && long_m2 < 324 * 20); /* walls within a cell */
    culture_free(&whole), culture_free(&part);
    elevation_stream_close(stream);
    pool_destroy(pool);
}

/* ---- far from the origin ----------------------------------------------------------------------------- */

static bool same_files(const char *a, const char *b)
{
    FILE *one = fopen(a, "rb"), *two = fopen(b, "rb");
    int   x = 0, y = 0;
    while (one && two && x == y && x != EOF) x = fgetc(one), y = fgetc(two);
    const bool same = one && two && x == y;
    if (one) fclose(one);
    if (two) fclose(two);
    return same;
}

enum { site = 200 };
static float flat_roofs(int i, int j)
{
    const bool low = i >= 50 && i < 64 && j >= 60 && j < 70, high = i >= 100 && i < 120 && j >= 110 && j < 125;
    return (float)(200 + 0.01 * i + (low ? 6 : high ? 12 : 0));
}

/* 10 km from the origin the ellipsoid lies 8 m below its plane. */
static void roofs_stand_where_they_were_far_from_the_origin(void **state)
{
    (void)state;
    static const double south_west_deg[2] = {46.1, 11};
    char                path[temp_name_size], out[temp_name_size], geojson[temp_name_size];
    const char         *why;
    TerrainOptions      o;
    TerrainReport       r;
    TerrainStore        store;
    CultureReport       report;
    path_of(out, "far.store"), path_of(geojson, "far.geojson");
    write_grid(path, "far", site, site, south_west_deg, 1e-5, flat_roofs);
    terrain_options_default(&o);
    CHECK(terrain_options_set(&o, &why, "surface", path) && terrain_options_set(&o, &why, "horizon", "1") &&
          terrain_options_set(&o, &why, "vertical", "ellipsoid") && terrain_options_set(&o, &why, "spacing", "1") &&
          terrain_options_set(&o, &why, "origin", "46.01,11") && terrain_options_set(&o, &why, "buildings", geojson));
    CHECK(!terrain_options_set(&o, &why, "buildings", "/tmp/a.txt") &&
          !terrain_options_set(&o, &why, "buildings", "/tmp/a.geojson,/tmp/b.geojson"));
    assert_int_equal(terrain_import(&r, &o, out, NULL, NULL), STATUS_OK);
    assert_int_equal(store_open(&store, out), STATUS_OK);
    Culture culture = read_back(&report, geojson, &store);
    CHECK(r.records == 2 && culture.buildings == 2);
    for (int n = 0; n < culture.buildings; n++) {
        const Building *b = &culture.building[n];
        const double    want_m = n ? 6 : 12; /* from the south: the high one is further down */
        print_message("eaves %.2f, ridge %.2f over %.2f\n", (double)b->eaves_m, (double)b->ridge_m, (double)b->base_m);
        CHECK_NEAR((double)b->ridge_m, want_m, 0.3);
        CHECK(b->roof == ROOF_FLAT && b->eaves_m == b->ridge_m && b->corners == 4 && b->chimneys == 0);
        /* and the ground is bare below it: 201 m above the ellipsoid, not above the plane */
        const double *p = culture.corner_m[b->first_corner], *q = culture.corner_m[b->first_corner + 2];
        double        p_enu[3] = {0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1]), 0}, p_ecef[3];
        Geodetic      place;
        p_enu[2] = ground_of(&store, p_enu[0], p_enu[1]);
        ecef_from_enu(p_ecef, &store.frame, p_enu);
        assert_int_equal(geodetic_from_ecef(&place, p_ecef), STATUS_OK);
        CHECK_NEAR(place.h_m, n ? 200.57 : 201.1, 0.15);
    }
    culture_free(&culture);

    /* made again it is written again, the same; on a stranger's word only within the store's folder */
    char own[2 * temp_name_size], elsewhere[2 * temp_name_size];
    snprintf(own, sizeof own, "%s.first", geojson);
    CHECK(rename(geojson, own) == 0);
    assert_int_equal(terrain_store_rebuild(out, store.options, false), STATUS_OK);
    CHECK(same_files(own, geojson));
    snprintf(elsewhere, sizeof elsewhere, "surface %s\nhorizon 1\nvertical ellipsoid\nbuildings %s-stranger.geojson\n",
             path, folder);
    FILE *letter = fopen(geojson, "w");
    CHECK(letter && fputs("{\"type\": \"FeatureCollection\"}", letter) >= 0 && fclose(letter) == 0);
    log_set_sink(check_listen, NULL);
    CHECK(terrain_store_rebuild(out, store.options, false) == STATUS_BAD_VALUE &&
          strstr(check_said, "no file of an import"));
    CHECK(!same_files(own, geojson));
    CHECK(terrain_store_rebuild(out, elsewhere, false) == STATUS_BAD_VALUE &&
          strstr(check_said, "outside its own folder"));
    log_set_sink(NULL, NULL);
    snprintf(elsewhere, sizeof elsewhere, "%s-stranger.geojson", folder);
    CHECK(access(elsewhere, F_OK) != 0);
    store_close(&store);
}

/* Records written as GeoJSON are the same buildings when they are read. */
static void records_come_back(void **state)
{
    (void)state;
    char               path[temp_name_size];
    LocalFrame         frame;
    Culture            culture = {0}, back = {0};
    CultureReport      report;
    const CultureFiles from = {.buildings = path, .frame = &frame, .half_m = 1000};
    assert_int_equal(local_frame_at(&frame, &(Geodetic){0.8, 0.2, 0}), STATUS_OK);
    path_of(path, "records.geojson");
    for (int n = 0; n < 30; n++) {
        const double x = 40 * (n % 6), y = 40 * (n / 6), a = 0.2 * n, c = cos(a), s = sin(a);
        const double corner_m[4][2] = {
            {x, y}, {x + 14 * c, y + 14 * s}, {x + 14 * c - 9 * s, y + 14 * s + 9 * c}, {x - 9 * s, y + 9 * c}};
        const Building b = {.eaves_m = (float)(1.5 + 0.4 * n),
                            .ridge_m = (float)(1.5 + 0.4 * n + (n % ROOF_SHAPES ? 3 + 0.9 * n : 0)),
                            .ridge_rad = n == 6 ? 0 : (float)remainder(a + 0.5 * pi_rad * (n % 4), 2 * pi_rad),
                            .use = (uint8_t)(n % BUILDING_USES),
                            .roof = (uint8_t)(n % ROOF_SHAPES),
                            .wall_fabric = (uint8_t)(n % FABRIC_TILE),
                            .roof_fabric = (uint8_t)(FABRIC_TILE + n % (FABRICS - FABRIC_TILE)),
                            .levels = (uint8_t)(1 + n % 5),
                            .heated = n % 2,
                            .chimneys = (uint8_t)(n % 4)};
        assert_int_equal(culture_add_building(&culture, &b, corner_m, 4), STATUS_OK);
    }
    assert_int_equal(culture_write_geojson(path, &culture, &(CultureFiles){.frame = &frame}), STATUS_OK);
    assert_int_equal(culture_open(&back, &report, &from), STATUS_OK);
    CHECK(culture.buildings == 30 && back.buildings == 30 && report.mended == 0 && report.unread == 0);
    for (int n = 0; n < 30; n++) {
        const Building *a = &culture.building[n], *b = &back.building[n];
        CHECK(a->corners == b->corners && a->use == b->use && a->roof == b->roof && a->wall_fabric == b->wall_fabric &&
              a->roof_fabric == b->roof_fabric && a->levels == b->levels && a->heated == b->heated &&
              a->chimneys == b->chimneys);
        CHECK_NEAR((double)b->eaves_m, (double)a->eaves_m, 1e-3);
        CHECK_NEAR((double)b->ridge_m, (double)a->ridge_m, 1e-3);
        CHECK_NEAR((double)b->ridge_rad, (double)a->ridge_rad, 1e-3);
        for (int k = 0; k < a->corners; k++)
            for (int i = 0; i < 2; i++)
                CHECK_NEAR(back.corner_m[b->first_corner + k][i], culture.corner_m[a->first_corner + k][i], 1e-3);
    }
    culture_free(&culture), culture_free(&back);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(strips_and_threads_give_the_same_buildings),
        cmocka_unit_test(roofs_stand_where_they_were_far_from_the_origin),
        cmocka_unit_test(records_come_back),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
