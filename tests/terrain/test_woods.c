/* Where plants stand: a pure function of ground and seed, none where none may be, as many as the table and the layers
 * of a store say. labels: physics */
#include "tests/check.h"

#include "terrain/ground/landscape.h"
#include "terrain/store/store.h"
#include "terrain/woods/woods.h"

static Landscape  landscape;
static LocalFrame frame;

enum { fixes = 5 };
static GroundFix fix[fixes];

static int open_ground(void **state)
{
    LandscapeConfig config = landscape_default_config();
    (void)state;
    config.seed = 7;
    if (local_frame_at(&frame, &(Geodetic){50.1 * rad_per_deg, 8.6 * rad_per_deg, 100}) != STATUS_OK) return 1;
    for (int k = 0; k < fixes; k++) fix[k] = (GroundFix){.p_enu = {40.0 * k - 80, 15.0 * k, 2}, .voter = k + 1};
    return landscape_create(&landscape, &config, &frame, fix, fixes, NULL, 0) != STATUS_OK;
}

static int close_ground(void **state)
{
    (void)state;
    landscape_destroy(&landscape);
    return 0;
}

static const WoodsPath track = {{-300, -500}, {500, 300}, 6, 6};

static WoodsConfig about(double x_m, double y_m, double half_m)
{
    return (WoodsConfig){.seed = 11,
                         .centre_m = {x_m, y_m},
                         .half_width_m = half_m,
                         .most_trees = woods_most_trees,
                         .path_count = 1,
                         .path = &track};
}

static void place_of(double p[3], const Woods *w, int k)
{
    for (int c = 0; c < 3; c++) p[c] = w->origin_enu[c] + (double)w->plant[k].p_m[c];
}

/* ---- where none may stand --------------------------------------------------------------------- */

static void on_ground_that_bears_them(void **state)
{
    Woods             w;
    const WoodsConfig config = about(0, 0, 1500);
    double            worst_m = 0;
    (void)state;
    assert_int_equal(woods_create(&w, &landscape, &config, NULL), STATUS_OK);
    CHECK(w.count > 2000);
    for (int k = 0; k < w.count; k++) {
        double   p[3];
        WayPlace way;
        place_of(p, &w, k);
        const SurfaceClass surface = landscape_surface(&landscape, p[0], p[1]);
        CHECK(surface != SURFACE_WATER && surface != SURFACE_ROAD && surface != SURFACE_TRACK);
        if (landscape_way(&way, &landscape, p[0], p[1])) CHECK(fabs(way.across_m) > way.half_m + 0.9);
        const double across = ((p[0] + 300) - (p[1] + 500)) / sqrt(2); /* the path runs north-east */
        if (p[0] > -300 && p[0] < 500 && p[1] > -500 && p[1] < 300) CHECK(fabs(across) > 5.99);
        worst_m = fmax(worst_m, fabs(p[2] - elevation_height(&landscape.elevation, p[0], p[1], NULL)));
    }
    CHECK(worst_m < 1e-4); /* floats of a kilometre step by 6e-5 m, half of it is rounding */
    woods_destroy(&w);
}

/* ---- a pure function -------------------------------------------------------------------------- */

static void threads(void **state)
{
    Woods             one, many;
    Pool             *pool;
    const WoodsConfig config = about(100, -50, 700);
    (void)state;
    assert_int_equal(pool_create(&pool, 4), STATUS_OK);
    assert_int_equal(woods_create(&one, &landscape, &config, NULL), STATUS_OK);
    assert_int_equal(woods_create(&many, &landscape, &config, pool), STATUS_OK);
    assert_int_equal(one.count, many.count);
    assert_memory_equal(one.plant, many.plant, (size_t)one.count * sizeof *one.plant);
    woods_destroy(&one), woods_destroy(&many);
    pool_destroy(pool);
}

/* Another centre and width: the plants that both have are the same, within the rounding of their floats. */
static void another_square(void **state)
{
    Woods             a, b;
    const WoodsConfig first = about(0, 0, 600), second = about(300, 200, 500);
    int               common = 0;
    (void)state;
    assert_int_equal(woods_create(&a, &landscape, &first, NULL), STATUS_OK);
    assert_int_equal(woods_create(&b, &landscape, &second, NULL), STATUS_OK);
    for (int j = 0; j < a.ny; j++)
        for (int i = 0; i < a.nx; i++) {
            const int    bi = i + (int)lrint((a.origin_enu[0] - b.origin_enu[0]) / woods_square_m);
            const int    bj = j + (int)lrint((a.origin_enu[1] - b.origin_enu[1]) / woods_square_m);
            const size_t n = (size_t)j * (size_t)a.nx + (size_t)i;
            if (bi < 0 || bj < 0 || bi >= b.nx || bj >= b.ny) continue;
            const size_t m = (size_t)bj * (size_t)b.nx + (size_t)bi;
            assert_int_equal(a.first[n + 1] - a.first[n], b.first[m + 1] - b.first[m]);
            for (uint32_t k = 0; k < a.first[n + 1] - a.first[n]; k++) {
                double p[3], q[3];
                place_of(p, &a, (int)(a.first[n] + k)), place_of(q, &b, (int)(b.first[m] + k));
                CHECK(fabs(p[0] - q[0]) < 1e-4 && fabs(p[1] - q[1]) < 1e-4 &&
                      fabs(p[2] - q[2]) < 1e-4); /* floats: 6e-5 */
                assert_int_equal(a.plant[a.first[n] + k].kind, b.plant[b.first[m] + k].kind);
                assert_int_equal(a.plant[a.first[n] + k].twist, b.plant[b.first[m] + k].twist);
                common++;
            }
        }
    CHECK(common > 100);
    woods_destroy(&a), woods_destroy(&b);
}

static void at_most_so_many(void **state)
{
    Woods       all, some;
    WoodsConfig config = about(0, 0, 1000);
    (void)state;
    assert_int_equal(woods_create(&all, &landscape, &config, NULL), STATUS_OK);
    config.most_trees = all.count / 3;
    assert_int_equal(woods_create(&some, &landscape, &config, NULL), STATUS_OK);
    CHECK(some.count <= config.most_trees && some.count > config.most_trees / 2);
    assert_int_equal(some.count + some.left_out, all.count);
    int within = 0, kept = 0;
    for (int k = 0; k < all.count; k++) {
        double p[3];
        place_of(p, &all, k);
        within += hypot(p[0], p[1]) < some.reach_m;
    }
    for (int k = 0; k < some.count; k++) {
        double p[3];
        place_of(p, &some, k);
        kept += hypot(p[0], p[1]) < some.reach_m;
    }
    assert_int_equal(kept, within); /* complete within the reach */
    woods_destroy(&some);

    /* about places: complete within the reach of each, and no tree stands that is farther from all than one left out */
    static const WoodsPlace place[] = {{{-700, 100}}, {{600, -450}}, {{640, -450}}, {{1e6, 0}}};
    config.place = place, config.place_count = 4;
    assert_int_equal(woods_create(&some, &landscape, &config, NULL), STATUS_OK);
    CHECK(some.count <= config.most_trees && some.count > config.most_trees / 2 && some.reach_m > 100);
    assert_int_equal(some.count + some.left_out, all.count);
    within = kept = 0;
    double farthest_m = 0;
    for (int k = 0; k < all.count; k++) {
        double p[3], away_m = INFINITY;
        place_of(p, &all, k);
        for (int n = 0; n < 4; n++) away_m = fmin(away_m, hypot(p[0] - place[n].p_m[0], p[1] - place[n].p_m[1]));
        within += away_m < some.reach_m;
    }
    for (int k = 0; k < some.count; k++) {
        double p[3], away_m = INFINITY;
        place_of(p, &some, k);
        for (int n = 0; n < 4; n++) away_m = fmin(away_m, hypot(p[0] - place[n].p_m[0], p[1] - place[n].p_m[1]));
        kept += away_m < some.reach_m;
        farthest_m = fmax(farthest_m, away_m);
    }
    assert_int_equal(kept, within);
    CHECK(farthest_m < some.reach_m + 2 * 1.4143 * woods_square_m);
    woods_destroy(&all), woods_destroy(&some);
    config.most_trees = 0;
    assert_int_equal(woods_create(&some, &landscape, &config, NULL), STATUS_OK);
    assert_int_equal(some.count, 0);
    woods_destroy(&some);
    config.half_width_m = 1e9;
    assert_int_equal(woods_create(&some, &landscape, &config, NULL), STATUS_BAD_VALUE);
}

/* ---- numbers ---------------------------------------------------------------------------------- */

/* Plants of forest classes a hectare, against the table: patches make it vary, so within a fifth. The area of a class
 * is counted on a lattice of its own. */
static void as_many_as_the_table_says(void **state)
{
    Woods       w;
    WoodsTable  table;
    WoodsConfig config = about(0, 0, 3000);
    double      area_ha[SURFACE_COUNT] = {0}, plants[SURFACE_COUNT] = {0};
    int         tested = 0;
    (void)state;
    config.path_count = 0;
    assert_int_equal(woods_table_read(&table, "etc/woods.csv"), STATUS_OK);
    assert_int_equal(woods_create(&w, &landscape, &config, NULL), STATUS_OK);
    for (double y = -2990; y < 3000; y += 20)
        for (double x = -2990; x < 3000; x += 20) area_ha[landscape_surface(&landscape, x, y)] += 20 * 20 * 1e-4;
    for (int k = 0; k < w.count; k++) {
        double p[3];
        place_of(p, &w, k);
        if (fabs(p[0]) < 3000 && fabs(p[1]) < 3000) plants[landscape_surface(&landscape, p[0], p[1])]++;
    }
    for (int s = SURFACE_NONE + 1; s < SURFACE_COUNT; s++) {
        const double want = 1e4 * table.of[s].per_m2 * area_ha[s];
        if (s == SURFACE_SCRUB || !(want > 300)) continue; /* scrub has hedges */
        CHECK_NEAR(plants[s] / want, 1, 0.2);
        tested++;
    }
    CHECK(tested >= 1);
    woods_destroy(&w);
}

static void leans_and_heights(void **state)
{
    Woods             w;
    const WoodsConfig config = about(0, 0, 1500);
    double            steepest = 0;
    (void)state;
    assert_int_equal(woods_create(&w, &landscape, &config, NULL), STATUS_OK);
    for (int k = 0; k < w.count; k++) {
        double m[9];
        plant_transform(m, &w.plant[k], NULL);
        const double axis[3] = {m[2], m[5], m[8]}, length = v3_length(axis);
        CHECK_NEAR(length, plant_height_m(&w.plant[k]), 1e-9 * length);
        steepest = fmax(steepest, acos(axis[2] / length));
        CHECK(length > 0.3 && length < 40);
    }
    CHECK(steepest < 15 * rad_per_deg && steepest > 5 * rad_per_deg);
    woods_destroy(&w);
}

/* plant_transform against rotations multiplied one after the other. */
static void transform(void **state)
{
    (void)state;
    for (int n = 0; n < 200; n++) {
        double       m[9];
        const Plant  p = {.height = (uint16_t)(100 + 9 * n),
                          .twist = (uint16_t)(n * 317),
                          .width = (uint8_t)(64 + n / 2),
                          .lean = {(int8_t)(n - 100), (int8_t)(60 - n / 2)}};
        const double step = plant_most_tilt_rad / 127, e = p.lean[0] * step, u = p.lean[1] * step;
        const double tilt = atan(hypot(e, u)), turn = p.twist * (2 * pi_rad / 65536), at = atan2(u, e);
        plant_transform(m, &p, NULL);
        for (int c = 0; c < 3; c++) {
            const double wide = plant_height_m(&p) * p.width / 128, high = plant_height_m(&p);
            const double v[3] = {c == 0 ? wide : 0, c == 1 ? wide : 0, c == 2 ? high : 0};
            /* twist about up, then a turn by tilt about the horizontal axis at right angles to the lean */
            const double t[3] = {cos(turn) * v[0] - sin(turn) * v[1], sin(turn) * v[0] + cos(turn) * v[1], v[2]};
            const double k[3] = {-sin(at), cos(at), 0}, along = v3_dot(k, t);
            double       cross[3];
            v3_cross(cross, k, t);
            for (int x = 0; x < 3; x++) {
                const double want = t[x] * cos(tilt) + cross[x] * sin(tilt) + k[x] * along * (1 - cos(tilt));
                CHECK_NEAR(m[3 * x + c], want, 1e-9 * high + 1e-12);
            }
        }
    }
}

static void near_a_place(void **state)
{
    Woods             w;
    const WoodsConfig config = about(0, 0, 800);
    (void)state;
    assert_int_equal(woods_create(&w, &landscape, &config, NULL), STATUS_OK);
    for (int n = 0; n < 300; n++) {
        const double x = 1500 * random_uniform(1, 1, 0, (uint64_t)n) - 750,
                     y = 1500 * random_uniform(1, 2, 0, (uint64_t)n) - 750;
        const double radius_m = 12 * random_uniform(1, 3, 0, (uint64_t)n);
        int          index[8], want = 0;
        const int    found = woods_near(index, 8, &w, x, y, radius_m);
        for (int k = 0; k < w.count; k++) {
            double p[3];
            place_of(p, &w, k);
            want += plant_is_tree((PlantKind)w.plant[k].kind) &&
                    hypot(p[0] - x, p[1] - y) <= radius_m + woods_trunk_m(&w.plant[k]);
        }
        assert_int_equal(found, want);
    }
    woods_destroy(&w);
}

/* ---- low plants ------------------------------------------------------------------------------- */

static void low_plants(void **state)
{
    static Plant      plant[woods_low_most];
    Woods             w;
    const WoodsConfig config = about(0, 0, 500);
    int               all = 0;
    (void)state;
    assert_int_equal(woods_create(&w, &landscape, &config, NULL), STATUS_OK);
    for (int64_t j = 40; j < 60; j++)
        for (int64_t i = 40; i < 60; i++) {
            const int count = woods_low_plants(plant, &w, i, j);
            assert_in_range(count, 0, woods_low_most);
            for (int k = 0; k < count; k++) {
                const double x = w.origin_enu[0] + (double)i * woods_low_m + (double)plant[k].p_m[0];
                const double y = w.origin_enu[1] + (double)j * woods_low_m + (double)plant[k].p_m[1];
                CHECK(plant[k].p_m[0] > -1 && plant[k].p_m[0] < woods_low_m + 1 && plant[k].p_m[1] > -1);
                CHECK(plant[k].kind >= PLANT_STANDING && plant_height_m(&plant[k]) < 3.1);
                const SurfaceClass surface = landscape_surface(&landscape, x, y);
                CHECK(surface != SURFACE_WATER && surface != SURFACE_ROAD && surface != SURFACE_TRACK);
            }
            all += count;
        }
    CHECK(all > 200);
    woods_destroy(&w);
}

/* Low plants in the middle of the square, in all and within 4 m of the path. */
static void count_low(int *all, int *on_path, const WoodsPath *path)
{
    static Plant plant[woods_low_most];
    Woods        w;
    WoodsConfig  config = about(0, 0, 500);
    config.path = path;
    *all = *on_path = 0;
    assert_int_equal(woods_create(&w, &landscape, &config, NULL), STATUS_OK);
    for (int64_t j = 20; j < 100; j++)
        for (int64_t i = 20; i < 100; i++) {
            const int count = woods_low_plants(plant, &w, i, j);
            for (int k = 0; k < count; k++) {
                const double x = w.origin_enu[0] + (double)i * woods_low_m + (double)plant[k].p_m[0];
                const double y = w.origin_enu[1] + (double)j * woods_low_m + (double)plant[k].p_m[1];
                const bool   along = x > -300 && x < 500 && y > -500 && y < 300;
                *on_path += along && fabs((x + 300) - (y + 500)) / sqrt(2) < 4;
            }
            *all += count;
        }
    woods_destroy(&w);
}

/* Low plants stay where a path clears standing ones alone. */
static void low_plants_below_flights(void **state)
{
    const WoodsPath flight = {{-300, -500}, {500, 300}, 6, 0};
    int             all[2], on_path[2];
    (void)state;
    count_low(&all[0], &on_path[0], &track);
    count_low(&all[1], &on_path[1], &flight);
    CHECK(on_path[0] == 0 && on_path[1] > 20 && all[1] > all[0]);
}

/* ---- a terrain store -------------------------------------------------------------------------- */

enum { posts = 129, layer = 64 };

/* Level ground of 512 m, forest; the western half of it under a canopy of 0.6 and 15 m, three marked crowns in the
 * north-east. */
static bool write_store(const char *path)
{
    static float    z[posts * posts];
    static uint8_t  classes[layer * layer], height[layer * layer], cover[layer * layer];
    const Crown     crown[3] = {{100, 120, 18, 4}, {130, 180, 12, 3}, {180, 130, 9, 2.5f}};
    StorePlan       plan = {.origin = {50 * rad_per_deg, 8 * rad_per_deg, 0},
                            .level_count = 1,
                            .posting_m = 4,
                            .seed = 3,
                            .options = "",
                            .crs = "",
                            .vertical_datum = "",
                            .provenance = "made by a test"};
    StoreWriter    *writer;
    StoreReport     report;
    const StoreGrid grid = {layer, layer, -256, -256, 8};
    plan.level[0] = (StoreLevel){posts, posts, -256, -256, 4, 0, 0, -1};
    plan.surface[0] = plan.canopy_height = plan.canopy_cover = grid;
    for (int n = 0; n < layer * layer; n++) {
        classes[n] = SURFACE_FOREST_BROADLEAF;
        height[n] = n % layer < layer / 2 ? (uint8_t)(15 / store_canopy_height_m) : 0;
        cover[n] = n % layer < layer / 2 ? (uint8_t)(0.6 / store_canopy_cover) : 0;
    }
    return store_writer_create(&writer, path, &plan, NULL) == STATUS_OK &&
           store_write_posts(writer, 0, posts, z) == STATUS_OK &&
           store_write_surface(writer, 0, layer, classes) == STATUS_OK &&
           store_write_canopy_height(writer, layer, height) == STATUS_OK &&
           store_write_canopy_cover(writer, layer, cover) == STATUS_OK &&
           store_write_crowns(writer, 3, crown) == STATUS_OK && store_writer_finish(writer, 0, &report) == STATUS_OK;
}

/* Share of places in the west that some crown covers: that of the layer within 5 %; the marked crowns stand where they
 * were marked. */
static void layers_of_a_store(void **state)
{
    char      path_of[64];
    Landscape ground;
    Woods     w;
    int       covered = 0, crowns = 0;
    enum { places = 20000 };
    (void)state;
    snprintf(path_of, sizeof path_of, "/tmp/test_woods_%ld.store", (long)getpid());
    assert_true(write_store(path_of));
    assert_int_equal(store_open_landscape(&ground, path_of, 3), STATUS_OK);
    WoodsConfig config = about(0, 0, 250);
    config.path_count = 0, config.store = path_of;
    assert_int_equal(woods_create(&w, &ground, &config, NULL), STATUS_OK);
    CHECK(w.from_canopy > 100);
    assert_int_equal(w.from_crowns, 3);
    for (int n = 0; n < places; n++) {
        const double x = -230 + 210 * random_uniform(2, 1, 0, (uint64_t)n),
                     y = 460 * random_uniform(2, 2, 0, (uint64_t)n) - 230;
        bool under = false;
        for (int k = 0; k < w.count && !under; k++) {
            double       p[3];
            const double radius_m =
                plant_height_m(&w.plant[k]) * w.plant[k].width / 128 * plant_crown_share((PlantKind)w.plant[k].kind);
            place_of(p, &w, k);
            under = hypot(p[0] - x, p[1] - y) < radius_m;
        }
        covered += under;
    }
    CHECK_NEAR(covered / (double)places, 0.6, 0.05);
    for (int k = 0; k < w.count; k++) {
        double p[3];
        place_of(p, &w, k);
        if (p[0] > 90 && p[1] > 110 && p[0] < 190 && p[1] < 190) crowns++;
        if (hypot(p[0] - 100, p[1] - 120) < 0.01) {
            CHECK_NEAR(plant_height_m(&w.plant[k]), 18, 0.01);
            CHECK_NEAR(18.0 * w.plant[k].width / 128 * plant_crown_share((PlantKind)w.plant[k].kind), 4, 0.1);
        }
    }
    assert_int_equal(crowns, 3);
    woods_destroy(&w);
    landscape_destroy(&ground);
    unlink(path_of);
}

/* ---- the table -------------------------------------------------------------------------------- */

static Status read_text(const char *text)
{
    char       path_of[64];
    WoodsTable table;
    snprintf(path_of, sizeof path_of, "/tmp/test_woods_%ld.csv", (long)getpid());
    FILE *file = fopen(path_of, "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
    const Status status = woods_table_read(&table, path_of);
    unlink(path_of);
    return status;
}

static void tables(void **state)
{
    static const char head[] = "surface,per_ha,low_m,high_m,pine,floor,floor_per_m2,floor_low_m,floor_high_m,ground\n";
    static const struct {
        const char *row;
        Status      want;
    } rows[] = {{"grass,10,2,4,1,grass_tuft,1,0.1,0.2,same\n", STATUS_OK},
                {"meadow,10,2,4,1,grass_tuft,1,0.1,0.2,same\n", STATUS_BAD_VALUE},
                {"grass,-1,2,4,1,grass_tuft,1,0.1,0.2,same\n", STATUS_BAD_VALUE},
                {"grass,10,4,2,1,grass_tuft,1,0.1,0.2,same\n", STATUS_BAD_VALUE},
                {"grass,10,2,4,0,grass_tuft,1,0.1,0.2,same\n", STATUS_BAD_VALUE},
                {"grass,10,2,4,1,pine,1,0.1,0.2,same\n", STATUS_BAD_VALUE},
                {"grass,10,2,4,1,moss,1,0.1,0.2,same\n", STATUS_BAD_VALUE},
                {"grass,10,2,4,1,none,0,0.1,0.2,same\ngrass,10,2,4,1,none,0,0.1,0.2,same\n", STATUS_BAD_VALUE},
                {"grass,ten,2,4,1,none,0,0.1,0.2,same\n", STATUS_BAD_VALUE}};
    (void)state;
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        char text[512];
        snprintf(text, sizeof text, "%s%s", head, rows[k].row);
        assert_int_equal(read_text(text), rows[k].want);
    }
    assert_int_equal(read_text("surface,per_ha\ngrass,1\n"), STATUS_BAD_VALUE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(on_ground_that_bears_them),
        cmocka_unit_test(threads),
        cmocka_unit_test(another_square),
        cmocka_unit_test(at_most_so_many),
        cmocka_unit_test(as_many_as_the_table_says),
        cmocka_unit_test(leans_and_heights),
        cmocka_unit_test(transform),
        cmocka_unit_test(near_a_place),
        cmocka_unit_test(low_plants),
        cmocka_unit_test(low_plants_below_flights),
        cmocka_unit_test(layers_of_a_store),
        cmocka_unit_test(tables),
    };
    return cmocka_run_group_tests(tests, open_ground, close_ground);
}
