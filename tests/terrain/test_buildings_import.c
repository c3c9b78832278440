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

enum { apart = 24, town_nx = 1152, town_ny = 792 }; /* cells of 2 m; houses every 24 of them */
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
    CHECK(long_m2 > 316 * 12 && long_m2 < 324 * 20); /* walls within a cell */
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
    snprintf(elsewhere, sizeof elsewhere, "surface %s\nhorizon 1\nvertical ellipsoid\nbuildings %s-stranger.geojson\n", path,
             folder);
    log_set_sink(check_listen, NULL);
    CHECK(terrain_store_rebuild(out, elsewhere, false) == STATUS_BAD_VALUE && strstr(check_said, "outside its own folder"));
    log_set_sink(NULL, NULL);
    snprintf(elsewhere, sizeof elsewhere, "%s-stranger.geojson", folder);
    CHECK(access(elsewhere, F_OK) != 0);
    store_close(&store);
}

/* Records written as GeoJSON are the same buildings when they are read. */
static void records_come_back(void **state)
{
    (void)state;
    char       path[temp_name_size];
    LocalFrame frame;
    Culture    culture = {0}, back = {0};
    CultureReport      report;
    const CultureFiles from = {.buildings = path, .frame = &frame, .half_m = 1000};
    assert_int_equal(local_frame_at(&frame, &(Geodetic){0.8, 0.2, 0}), STATUS_OK);
    path_of(path, "records.geojson");
    for (int n = 0; n < 30; n++) {
        const double   x = 40 * (n % 6), y = 40 * (n / 6), a = 0.2 * n, c = cos(a), s = sin(a);
        const double   corner_m[4][2] = {{x, y}, {x + 14 * c, y + 14 * s}, {x + 14 * c - 9 * s, y + 14 * s + 9 * c},
                                         {x - 9 * s, y + 9 * c}};
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
    assert_int_equal(culture_write_geojson(path, &culture, &frame), STATUS_OK);
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

/* Both models on the posts of a store. */
typedef struct Judge {
    Posts surface, terrain;
} Judge;

/* Whether a post is more than 2 m over the terrain model, and the surface there. */
static bool is_high(const Judge *j, int x, int y, double *z_m)
{
    if (x < 0 || y < 0 || x >= j->surface.level.nx || y >= j->surface.level.ny) return false;
    const size_t n = (size_t)y * (size_t)j->surface.level.nx + (size_t)x;
    *z_m = (double)j->surface.z_m[n];
    return (double)(j->surface.z_m[n] - j->terrain.z_m[n]) > 2;
}

/* Distance of a place, in cells from the middle of cell (0, 0), from the surface's edges, at most 8: the boundary of high
 * cells, and steps of more than 1 m among them. */
static double off_edge(const Judge *j, double u, double v)
{
    enum { reach = 8 };
    double least = reach;
    for (int y = (int)floor(v) - reach; y <= (int)floor(v) + reach; y++)
        for (int x = (int)floor(u) - reach; x <= (int)floor(u) + reach; x++)
            for (int way = 0; way < 2; way++) { /* the side between a cell and its eastern, northern neighbour */
                double     a_m = 0, b_m = 0;
                const bool a = is_high(j, x, y, &a_m), b = is_high(j, x + !way, y + way, &b_m);
                if (a == b && !(a && fabs(a_m - b_m) > 1)) continue;
                const double du = way ? fmax(fabs(u - x) - 0.5, 0) : u - x - 0.5;
                const double dv = way ? v - y - 0.5 : fmax(fabs(v - y) - 0.5, 0);
                least = fmin(least, hypot(du, dv));
            }
    return least;
}

static bool is_in(const Culture *c, const Building *b, double x_m, double y_m)
{
    bool in = false;
    for (int k = 0; k < b->corners; k++) {
        const double *p = c->corner_m[b->first_corner + k], *q = c->corner_m[b->first_corner + (k + 1) % b->corners];
        if ((p[1] > y_m) != (q[1] > y_m) && x_m < p[0] + (y_m - p[1]) / (q[1] - p[1]) * (q[0] - p[0])) in = !in;
    }
    return in;
}

/* The building whose roof is the highest over each post, as it is seen from above; -1: none. */
static void fill_tops(int *of, float *top_m, const Culture *c, const StreamLevel *l)
{
    for (size_t n = 0; n < (size_t)l->nx * (size_t)l->ny; n++) of[n] = -1, top_m[n] = NAN;
    for (int n = 0; n < c->buildings; n++) {
        const Building *b = &c->building[n];
        double          low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
        for (int k = 0; k < b->corners; k++)
            for (int i = 0; i < 2; i++) {
                low[i] = fmin(low[i], c->corner_m[b->first_corner + k][i] / l->spacing_m);
                high[i] = fmax(high[i], c->corner_m[b->first_corner + k][i] / l->spacing_m);
            }
        for (int y = (int)fmax(floor(low[1]) - l->j0, 0); y <= ceil(high[1]) - l->j0 && y < l->ny; y++)
            for (int x = (int)fmax(floor(low[0]) - l->i0, 0); x <= ceil(high[0]) - l->i0 && x < l->nx; x++) {
                const double x_m = (l->i0 + x) * l->spacing_m, y_m = (l->j0 + y) * l->spacing_m;
                const size_t at = (size_t)y * (size_t)l->nx + (size_t)x;
                if (!is_in(c, b, x_m, y_m)) continue;
                const float z_m = (float)roof_z(c, b, x_m, y_m);
                if (!(z_m <= top_m[at])) of[at] = n, top_m[at] = z_m;
            }
    }
}

/* About the stadium, whose stands rise from the ground without an edge: x, y, radius. */
static const double stadium[3] = {60, 140, 160};

/* What the records of a surface model are worth, by the model itself and a terrain model that was not used. */
typedef struct Worth {
    int    buildings; /* with posts of their own */
    int    right;     /* whose median of roof - surface over them is within 0.5 m */
    int    close;     /* whose median of |roof - surface| is: where half of a roof is right, not its mean alone */
    double m2, right_m2;
    int    points;         /* every 0.5 m of outlines, where no other building is 2 m outside of them */
    int    free;           /* of these, those that nothing high is 3 m outside of, without the stadium */
    double *off_m, *free_m; /* their distances from the surface's own edges */
} Worth;

static void judge_roofs(Worth *w, const Culture *c, const Judge *j, const int *of, const float *top_m)
{
    const size_t posts = (size_t)j->surface.level.nx * (size_t)j->surface.level.ny;
    const double s = j->surface.level.spacing_m;
    double      *off = malloc(posts * sizeof *off);
    CHECK(off != NULL);
    for (int n = 0; n < c->buildings; n++) {
        int count = 0;
        for (size_t at = 0; at < posts; at++)
            if (of[at] == n) off[count++] = (double)(top_m[at] - j->surface.z_m[at]);
        if (count == 0) continue; /* it lies under others */
        const bool right = fabs(quantile(off, count, 0.5)) <= 0.5;
        for (int k = 0; k < count; k++) off[k] = fabs(off[k]);
        w->close += quantile(off, count, 0.5) <= 0.5;
        w->buildings++, w->right += right;
        w->m2 += count * s * s, w->right_m2 += right ? count * s * s : 0;
    }
    free(off);
}

static void judge_outlines(Worth *w, const Culture *c, const Judge *j)
{
    enum { most = 1 << 18 };
    const StreamLevel *l = &j->surface.level;
    w->off_m = malloc(most * sizeof *w->off_m), w->free_m = malloc(most * sizeof *w->free_m);
    CHECK(w->off_m && w->free_m);
    for (int n = 0; n < c->buildings; n++) {
        const Building *b = &c->building[n];
        for (int k = 0; k < b->corners; k++) {
            const double *p = c->corner_m[b->first_corner + k], *q = c->corner_m[b->first_corner + (k + 1) % b->corners];
            const double  length_m = hypot(q[0] - p[0], q[1] - p[1]);
            const double  along[2] = {(q[0] - p[0]) / length_m, (q[1] - p[1]) / length_m};
            for (double t = 0.25; t < length_m && w->points < most; t += 0.5) {
                const double x_m = p[0] + t * along[0], y_m = p[1] + t * along[1];
                if (culture_building_at(c, x_m + 2 * along[1], y_m - 2 * along[0], 0) >= 0) continue;
                const double u = x_m / l->spacing_m - l->i0, v = y_m / l->spacing_m - l->j0;
                const double off_m = l->spacing_m * off_edge(j, u, v);
                double       z_m;
                const int    out[2] = {(int)rint(u + 3 * along[1] / l->spacing_m), (int)rint(v - 3 * along[0] / l->spacing_m)};
                w->off_m[w->points++] = off_m;
                if (hypot(x_m - stadium[0], y_m - stadium[1]) < stadium[2]) continue;
                if (!is_high(j, out[0], out[1], &z_m)) w->free_m[w->free++] = off_m;
            }
        }
    }
}

/* The distances say nothing of buildings that are missing: the area of the records does. */
static void houses_of_real_lidar(void **state)
{
    (void)state;
    char             dsm[512], dtm[512], out[temp_name_size], geojson[temp_name_size];
    const char      *why;
    TerrainOptions   o;
    TerrainReport    r;
    TerrainStore     store;
    CultureReport    report;
    Judge            judge = {0};
    Worth            w = {0};
    ElevationStream *stream[2];
    Pool            *pool;
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
    Culture            culture = read_back(&report, geojson, &store);
    const StreamLevel *l = &judge.surface.level;
    const size_t       posts = (size_t)l->nx * (size_t)l->ny;
    int               *of = malloc(posts * sizeof *of);
    float             *top_m = malloc(posts * sizeof *top_m);
    CHECK(of && top_m && culture.buildings == r.records && culture_index(&culture) == STATUS_OK);
    fill_tops(of, top_m, &culture, l);
    judge_roofs(&w, &culture, &judge, of, top_m);
    judge_outlines(&w, &culture, &judge);
    const double cells_m2 = r.kind_share[1] * (double)posts * l->spacing_m * l->spacing_m;
    const double right = (double)w.right / w.buildings, right_m2 = w.right_m2 / w.m2;
    const double all_m = quantile(w.off_m, w.points, 0.9), free_m = quantile(w.free_m, w.free, 0.9);
    print_message("%d buildings, %d patches left out, %.0f m2 of %.0f m2 of posts of buildings; roofs within 0.5 m: %.1f %% of "
                  "the buildings, %.1f %% of their area; half of the roof: %.1f %%\n",
                  culture.buildings, r.records_left, w.m2, cells_m2, 100 * right, 100 * right_m2,
                  100.0 * w.close / w.buildings);
    print_message("outlines: p90 %.2f m from the surface's edges, %.2f where nothing high is outside (%.0f %% of them)\n",
                  all_m, free_m, 100.0 * w.free / w.points);
    CHECK(right >= 0.95 && right_m2 >= 0.94 && w.close >= 0.94 * w.buildings);
    CHECK(w.m2 > 0.9 * cells_m2 && w.m2 < 1.02 * cells_m2);
    CHECK(free_m <= 1);
    free(w.off_m), free(w.free_m), free(of), free(top_m), free(judge.surface.z_m), free(judge.terrain.z_m);
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
        cmocka_unit_test(records_come_back),
        cmocka_unit_test(houses_of_real_lidar),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
