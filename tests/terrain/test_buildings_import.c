/* Buildings of surface models as records: those of a town that the test built, wherever windows and strips meet and far
 * from the origin; and of a real lidar model, against its own heights and edges. */
#include "tests/check.h"

#include "terrain/from_files/culture_import.h"
#include "terrain/import/terrain_import_private.h"

#include <unistd.h>

static char folder[temp_path_size];

static int set_up(void **state)
{
    (void)state;
    strcpy(folder, "/tmp/pitviper-buildings-XXXXXX");
    return mkdtemp(folder) ? 0 : 1;
}

static int tear_down(void **state)
{
    (void)state;
    char line[temp_path_size + 16];
    snprintf(line, sizeof line, "rm -rf %s", folder);
    return system(line);
}

static void path_of(char out[temp_name_size], const char *name) { snprintf(out, temp_name_size, "%s/%s", folder, name); }

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

enum { apart = 24, town_nx = 1160, town_ny = 800 }; /* cells of 2 m; houses every 24 of them */
static const int long_j[2] = {268, 276}, long_i[2] = {944, 1104}; /* 320 m, across where windows meet */

static bool in_long(int i, int j) { return i >= long_i[0] && i < long_i[1] && j >= long_j[0] && j < long_j[1]; }

static float town(int i, int j)
{
    const int  a = i / apart, b = j / apart, x = i % apart, y = j % apart;
    const int  wide = 6 + (a * 7 + b * 3) % 7, deep = 5 + (a * 5 + b * 11) % 5, at = 3 + (a + b) % 4;
    const bool near_long = i >= long_i[0] - apart && i < long_i[1] + apart && j >= long_j[0] - apart && j < long_j[1] + apart;
    const bool house = !near_long && x >= at && x < at + wide && y >= at && y < at + deep;
    return (float)(200 + 0.02 * i + 0.01 * j + (house ? 4 + (a + 2 * b) % 4 : in_long(i, j) ? 9 : 0));
}

static int houses_of_town(void)
{
    int count = 0;
    for (int b = 0; b * apart < town_ny; b++)
        for (int a = 0; a * apart < town_nx; a++) {
            const int i = a * apart + 8, j = b * apart + 8; /* of every house */
            if (i < town_nx && j < town_ny) count += (double)town(i, j) - (200 + 0.02 * i + 0.01 * j) > 3 && !in_long(i, j);
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
    Culture      part = buildings_by(&from, level.ny, 150);
    const int    houses = houses_of_town();
    double       long_m2 = 0;
    int          pieces = 0;
    print_message("%d buildings, in strips %d; %d houses and the long one\n", whole.buildings, part.buildings, houses);
    CHECK(level.nx > 1024 && whole.buildings == part.buildings);
    for (int n = 0; n < whole.buildings; n++) {
        Building a = whole.building[n], b = part.building[n];
        const double(*p)[2] = (const double(*)[2])whole.corner_m + a.first_corner;
        CHECK(a.corners == b.corners &&
              memcmp(p, part.corner_m + b.first_corner, (size_t)a.corners * sizeof *p) == 0);
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
    CHECK_NEAR(long_m2, 320 * 16, 0.1 * 320 * 16);
    culture_free(&whole), culture_free(&part);
    elevation_stream_close(stream);
    pool_destroy(pool);
}

/* ---- far from the origin ----------------------------------------------------------------------------- */

static double ground_of(void *user, double x_m, double y_m)
{
    return elevation_height(&((const TerrainStore *)user)->elevation, x_m, y_m, NULL);
}

static Culture read_back(CultureReport *report, const char *path, const TerrainStore *store)
{
    const CultureFiles from = {.buildings = path,
                               .frame = &store->frame,
                               .ground = ground_of,
                               .user = (void *)store,
                               .half_m = 30000};
    Culture            culture = {0};
    assert_int_equal(culture_open(&culture, report, &from), STATUS_OK);
    return culture;
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
    CHECK(!terrain_options_set(&o, &why, "buildings", "/tmp/a.txt"));
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
    store_close(&store);
}

/* ---- real lidar -------------------------------------------------------------------------------------- */

/* Height of a building's roof over a place within its outline, from what its record says (culture.h). */
static double roof_z(const Culture *c, const Building *b, double x_m, double y_m)
{
    double       low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY}, wall_m = INFINITY, inner_m = 0;
    const double e[2] = {cos((double)b->ridge_rad), sin((double)b->ridge_rad)};
    for (int k = 0; k < b->corners; k++) {
        const double *p = c->corner_m[b->first_corner + k], *q = c->corner_m[b->first_corner + (k + 1) % b->corners];
        const double  at[2] = {e[0] * p[0] + e[1] * p[1], e[0] * p[1] - e[1] * p[0]};
        for (int i = 0; i < 2; i++) low[i] = fmin(low[i], at[i]), high[i] = fmax(high[i], at[i]);
        const double dx = q[0] - p[0], dy = q[1] - p[1];
        const double t = clamp(((x_m - p[0]) * dx + (y_m - p[1]) * dy) / (dx * dx + dy * dy), 0, 1);
        wall_m = fmin(wall_m, hypot(x_m - p[0] - t * dx, y_m - p[1] - t * dy));
    }
    inner_m = 0.5 * fmin(high[0] - low[0], high[1] - low[1]);
    const double u = e[0] * x_m + e[1] * y_m, v = e[0] * y_m - e[1] * x_m;
    const double rise_m = (double)(b->ridge_m - b->eaves_m);
    double       share = 0;
    if (b->roof == ROOF_GABLED) share = 1 - fabs(v - 0.5 * (low[1] + high[1])) / (0.5 * (high[1] - low[1]));
    else if (b->roof == ROOF_SKILLION) share = (high[0] - u) / (high[0] - low[0]);
    else if (b->roof != ROOF_FLAT) share = wall_m / inner_m;
    return (double)(b->base_m + b->eaves_m) + rise_m * clamp(share, 0, 1);
}

/* Posts of one of the files on a store's level 0, ENU z. */
typedef struct Posts {
    StreamLevel level;
    float      *z_m;
} Posts;

static Posts posts_of(const char *path, const LocalFrame *frame, const ElevationStream *like, ElevationStream **stream,
                      Pool *pool)
{
    Posts                p;
    const ElevationFiles files = {.paths = path, .geoid_path = "", .horizon_m = 1000};
    assert_int_equal(elevation_stream_open(stream, &files, frame, like, pool), STATUS_OK);
    assert_int_equal(elevation_stream_begin(*stream, 0), STATUS_OK);
    elevation_stream_level(&p.level, *stream, 0);
    p.z_m = malloc((size_t)p.level.nx * (size_t)p.level.ny * sizeof *p.z_m);
    CHECK(p.z_m);
    assert_int_equal(elevation_stream_heights(*stream, 0, p.level.ny, p.z_m, NULL, false), STATUS_OK);
    assert_int_equal(elevation_stream_bend(*stream, 0, p.level.ny, p.z_m), STATUS_OK);
    return p;
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double quantile(double *value, int count, double share)
{
    qsort(value, (size_t)count, sizeof *value, by_size);
    return count ? value[(int)fmin(share * count, count - 1)] : NAN;
}

/* Cells more than 2 m over the terrain model, and the surface there. */
typedef struct Judge {
    Posts   surface, terrain;
    bool    steps;
} Judge;

static bool is_high(const Judge *j, int x, int y, double *z_m)
{
    if (x < 0 || y < 0 || x >= j->surface.level.nx || y >= j->surface.level.ny) return false;
    const size_t n = (size_t)y * (size_t)j->surface.level.nx + (size_t)x;
    *z_m = (double)j->surface.z_m[n];
    return (double)(j->surface.z_m[n] - j->terrain.z_m[n]) > 2;
}

/* Distance of a place, in cells from the middle of cell (0, 0), from the boundary of high cells, at most 8. */
static double off_edge(const Judge *j, double u, double v)
{
    enum { reach = 8 };
    double least = reach;
    for (int y = (int)floor(v) - reach; y <= (int)floor(v) + reach; y++)
        for (int x = (int)floor(u) - reach; x <= (int)floor(u) + reach; x++)
            for (int way = 0; way < 2; way++) { /* the side between a cell and its eastern, northern neighbour */
                double     a_m = 0, b_m = 0;
                const bool a = is_high(j, x, y, &a_m), b = is_high(j, x + !way, y + way, &b_m);
                if (a == b && !(j->steps && a && fabs(a_m - b_m) > 1)) continue;
                const double du = way ? fmax(fabs(u - x) - 0.5, 0) : u - x - 0.5;
                const double dv = way ? v - y - 0.5 : fmax(fabs(v - y) - 0.5, 0);
                least = fmin(least, hypot(du, dv));
            }
    return least;
}

static void houses_of_real_lidar(void **state)
{
    (void)state;
    char            dsm[512], dtm[512], out[temp_name_size], geojson[temp_name_size];
    const char     *why;
    TerrainOptions  o;
    TerrainReport   r;
    TerrainStore    store;
    CultureReport   report;
    Judge           judge = {0};
    ElevationStream *stream[2];
    Pool           *pool;
    if (!reference_path(dsm, "terrain/autzen/autzen_dsm_1m.tif") ||
        !reference_path(dtm, "terrain/autzen/autzen_dtm_1m.tif"))
        skip();
    path_of(out, "autzen.store"), path_of(geojson, "autzen.geojson");
    assert_int_equal(pool_create(&pool, 2), STATUS_OK);
    terrain_options_default(&o);
    CHECK(terrain_options_set(&o, &why, "surface", dsm) && terrain_options_set(&o, &why, "horizon", "1") &&
          terrain_options_set(&o, &why, "buildings", geojson));
    assert_int_equal(terrain_import(&r, &o, out, pool, NULL), STATUS_OK);
    assert_int_equal(store_open(&store, out), STATUS_OK);
    judge.surface = posts_of(dsm, &store.frame, NULL, &stream[0], pool);
    judge.terrain = posts_of(dtm, &store.frame, stream[0], &stream[1], pool);
    Culture      culture = read_back(&report, geojson, &store);
    const double s = judge.surface.level.spacing_m;
    const int    nx = judge.surface.level.nx, ny = judge.surface.level.ny;
    CHECK(culture.buildings == r.records && culture.buildings > 100);
    enum { most = 1 << 20 };
    double *off = malloc(most * sizeof *off), *edge = malloc(most * sizeof *edge), *step = malloc(most * sizeof *step);
    double  all_m2 = 0, good_m2 = 0;
    int     good = 0, points = 0;
    CHECK(off && edge && step && culture_index(&culture) == STATUS_OK);
    for (int n = 0; n < culture.buildings; n++) {
        const Building *b = &culture.building[n];
        int             low[2] = {1 << 30, 1 << 30}, high[2] = {0, 0}, count = 0;
        for (int k = 0; k < b->corners; k++) {
            const double *p = culture.corner_m[b->first_corner + k],
                         *q = culture.corner_m[b->first_corner + (k + 1) % b->corners];
            const int     at[2] = {(int)floor(p[0] / s) - judge.surface.level.i0, (int)floor(p[1] / s) - judge.surface.level.j0};
            for (int c = 0; c < 2; c++) low[c] = at[c] < low[c] ? at[c] : low[c], high[c] = at[c] > high[c] ? at[c] : high[c];
            const double length_m = hypot(q[0] - p[0], q[1] - p[1]);
            for (double t = 0.25; t < length_m && points < most; t += 0.5, points++) {
                const double u = (p[0] + t / length_m * (q[0] - p[0])) / s - judge.surface.level.i0;
                const double v = (p[1] + t / length_m * (q[1] - p[1])) / s - judge.surface.level.j0;
                judge.steps = false, edge[points] = s * off_edge(&judge, u, v);
                judge.steps = true, step[points] = s * off_edge(&judge, u, v);
            }
        }
        for (int y = low[1]; y <= high[1] + 1 && y < ny; y++)
            for (int x = low[0]; x <= high[0] + 1 && x < nx; x++) {
                const double x_m = (judge.surface.level.i0 + x) * s, y_m = (judge.surface.level.j0 + y) * s;
                if (x < 0 || y < 0 || culture_building_at(&culture, x_m, y_m, 0) != n || count == most) continue;
                off[count++] = fabs(roof_z(&culture, b, x_m, y_m) - (double)judge.surface.z_m[(size_t)y * (size_t)nx + (size_t)x]);
            }
        const bool   right = quantile(off, count, 0.5) <= 0.5;
        const double m2 = count * s * s;
        good += right, good_m2 += right ? m2 : 0, all_m2 += m2;
    }
    const double right = (double)good / culture.buildings, right_m2 = good_m2 / all_m2;
    const double edge_m = quantile(edge, points, 0.9), step_m = quantile(step, points, 0.9);
    print_message("%d buildings, %d left out, %.0f m2 of %.0f m2 of cells of buildings; median within 0.5 m: %.1f %% of "
                  "them, %.1f %% of their area\n",
                  culture.buildings, r.records_left, all_m2, r.kind_share[1] * nx * ny * s * s, 100 * right,
                  100 * right_m2);
    print_message("outlines: p90 %.2f m from the boundary of high cells, %.2f with steps of roofs; medians %.2f, %.2f\n",
                  edge_m, step_m, quantile(edge, points, 0.5), quantile(step, points, 0.5));
    CHECK(right >= 0.9 && right_m2 >= 0.9);
    CHECK(step_m <= 1);
    free(off), free(edge), free(step), free(judge.surface.z_m), free(judge.terrain.z_m);
    culture_free(&culture);
    elevation_stream_close(stream[1]), elevation_stream_close(stream[0]);
    store_close(&store);
    pool_destroy(pool);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(strips_and_threads_give_the_same_buildings),
        cmocka_unit_test(roofs_stand_where_they_were_far_from_the_origin),
        cmocka_unit_test(houses_of_real_lidar),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
