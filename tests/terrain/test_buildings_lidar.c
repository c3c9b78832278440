/* Buildings of a real lidar surface model, judged by its own heights and edges and by a terrain model that the import
 * did not see. */
#include "tests/terrain/buildings_lab.h"

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

/* Posts of one of the files on a store's level 0: ENU z of its nearest cell, and between its cells. */
typedef struct Posts {
    StreamLevel level;
    float      *z_m, *between_m;
    uint8_t    *of_file; /* 1: the file has the post */
} Posts;

static Posts posts_of(const char *path, const LocalFrame *frame, const ElevationStream *like, ElevationStream **stream,
                      Pool *pool)
{
    Posts                p;
    const ElevationFiles files = {.paths = path, .geoid_path = "", .horizon_m = 1000};
    assert_int_equal(elevation_stream_open(stream, &files, frame, like, pool), STATUS_OK);
    assert_int_equal(elevation_stream_begin(*stream, 0), STATUS_OK);
    elevation_stream_level(&p.level, *stream, 0);
    const size_t posts = (size_t)p.level.nx * (size_t)p.level.ny;
    p.z_m = malloc(posts * sizeof *p.z_m), p.between_m = malloc(posts * sizeof *p.between_m), p.of_file = malloc(posts);
    CHECK(p.z_m && p.between_m && p.of_file);
    assert_int_equal(elevation_stream_cells(*stream, 0, p.level.ny, p.between_m, p.z_m, p.of_file), STATUS_OK);
    assert_int_equal(elevation_stream_bend(*stream, 0, p.level.ny, p.z_m), STATUS_OK);
    assert_int_equal(elevation_stream_bend(*stream, 0, p.level.ny, p.between_m), STATUS_OK);
    return p;
}

static void posts_free(Posts *p) { free(p->z_m), free(p->between_m), free(p->of_file); }

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

/* Distance of a place, in cells from the middle of cell (0, 0), from the surface's edges, at most 8: the boundary of
 * high cells, and steps of more than 1 m among them. */
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

/* About the stadium, whose stands rise from the ground, and tier from tier, without an edge: x, y, radius. */
static const double stadium[3] = {33, 231, 150};

/* What the records of a surface model are worth, by the model itself and a terrain model that was not used. */
typedef struct Worth {
    int     buildings; /* with posts of their own */
    int     right;     /* whose median of roof - surface over them is within 0.5 m */
    int     close;     /* whose median of |roof - surface| is: where half of a roof is right, not its mean alone */
    double  m2, right_m2;
    int     points;                   /* every 0.5 m of outlines, where no other building is 2 m outside of them */
    int     apart;                    /* of these, those outside the stadium */
    int     free;                     /* of these, those that nothing high is 3 m outside of */
    double *off_m, *apart_m, *free_m; /* their distances from the surface's own edges */
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
    w->apart_m = malloc(most * sizeof *w->apart_m);
    CHECK(w->off_m && w->free_m && w->apart_m);
    for (int n = 0; n < c->buildings; n++) {
        const Building *b = &c->building[n];
        for (int k = 0; k < b->corners; k++) {
            const double *p = c->corner_m[b->first_corner + k],
                         *q = c->corner_m[b->first_corner + (k + 1) % b->corners];
            const double length_m = hypot(q[0] - p[0], q[1] - p[1]);
            const double along[2] = {(q[0] - p[0]) / length_m, (q[1] - p[1]) / length_m};
            for (double t = 0.25; t < length_m && w->points < most; t += 0.5) {
                const double x_m = p[0] + t * along[0], y_m = p[1] + t * along[1];
                if (culture_building_at(c, x_m + 2 * along[1], y_m - 2 * along[0], 0) >= 0) continue;
                const double u = x_m / l->spacing_m - l->i0, v = y_m / l->spacing_m - l->j0;
                const double off_m = l->spacing_m * off_edge(j, u, v);
                double       z_m;
                const int    out[2] = {(int)rint(u + 3 * along[1] / l->spacing_m),
                                       (int)rint(v - 3 * along[0] / l->spacing_m)};
                w->off_m[w->points++] = off_m;
                if (hypot(x_m - stadium[0], y_m - stadium[1]) < stadium[2]) continue;
                w->apart_m[w->apart++] = off_m;
                if (!is_high(j, out[0], out[1], &z_m)) w->free_m[w->free++] = off_m;
            }
        }
    }
}

/* What of the surface is more than 2 m over the terrain model and has bare ground in the store that is more than 1 m
 * over it; and what of the ground (within 0.3 m of that model) is lost, that is more than 0.3 m above the bare ground.
 */
static void judge_ground(double *left, double *lost, const Judge *j, const Elevation *stored)
{
    const StreamLevel *l = &j->surface.level;
    double             high = 0, low = 0;
    *left = *lost = 0;
    for (int y = 0; y < l->ny; y++)
        for (int x = 0; x < l->nx; x++) {
            const size_t n = (size_t)y * (size_t)l->nx + (size_t)x;
            if (j->surface.of_file[n] != 1 || j->terrain.of_file[n] != 1) continue;
            const double bare_m =
                elevation_height(stored, (l->i0 + x) * l->spacing_m, (l->j0 + y) * l->spacing_m, NULL);
            const double surface_m = (double)j->surface.z_m[n], terrain_m = (double)j->terrain.between_m[n];
            if (surface_m - terrain_m > 2) high++, *left += bare_m - terrain_m > 1;
            if (surface_m - terrain_m < 0.3) low++, *lost += bare_m < surface_m - 0.3;
        }
    *left /= high, *lost /= low;
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
    double left, lost;
    judge_ground(&left, &lost, &judge, &store.elevation);
    print_message("high posts left in the ground: %.2f %%; ground lost: %.3f %%\n", 100 * left, 100 * lost);
    CHECK(left <= 0.08 && lost <= 0.0031);
    const double cells_m2 = r.kind_share[1] * (double)posts * l->spacing_m * l->spacing_m;
    const double right = (double)w.right / w.buildings, right_m2 = w.right_m2 / w.m2;
    const double all_m = quantile(w.off_m, w.points, 0.9), apart_m = quantile(w.apart_m, w.apart, 0.9),
                 free_m = quantile(w.free_m, w.free, 0.9);
    print_message(
        "%d buildings, %d patches left out, %.0f m2 of %.0f m2 of posts of buildings; roofs within 0.5 m: %.1f %% of "
        "the buildings, %.1f %% of their area; half of the roof: %.1f %%\n",
        culture.buildings, r.records_left, w.m2, cells_m2, 100 * right, 100 * right_m2, 100.0 * w.close / w.buildings);
    print_message(
        "outlines: p90 %.2f m from the surface's edges, %.2f outside the stadium (%.0f %% of them), %.2f where nothing "
        "high is outside either (%.0f %%)\n",
        all_m, apart_m, 100.0 * w.apart / w.points, free_m, 100.0 * w.free / w.points);
    CHECK(right >= 0.95 && right_m2 >= 0.94 && w.close >= 0.94 * w.buildings);
    CHECK(w.m2 > 0.9 * cells_m2 && w.m2 < 1.02 * cells_m2);
    CHECK(apart_m <= 1.2 && free_m <= 0.8);
    free(w.off_m), free(w.apart_m), free(w.free_m), free(of), free(top_m);
    posts_free(&judge.surface), posts_free(&judge.terrain);
    culture_free(&culture);
    elevation_stream_close(stream[1]), elevation_stream_close(stream[0]);
    store_close(&store);
    pool_destroy(pool);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(houses_of_real_lidar),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
