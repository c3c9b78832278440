/* Sky that buildings hide, against closed forms: beside a wall without end, on level ground and on a wall that faces
 * it, at several distances and heights; on its top; away from it. */
#include "tests/render/hand_models.h"

#include "render/light/sky_horizon.h"

enum { posts = 101 };
static const double high_m = 12, thick_m = 6, long_m = 400;

static struct {
    Elevation      ground;
    Model          model;
    SceneryObject  object;
    Scenery        scenery;
    SceneryTracer *tracer;
    Materials      materials;
    SkyHorizons   *horizons;
} stage;

/* A wall along north about x = 0, on level ground at 100 m. */
static int open_stage(void **state)
{
    (void)state;
    char                path[512], surfaces[512];
    const ElevationGrid grid = {posts, posts, -500, -500, 10, -100, 1.0 / 64};
    if (elevation_level_create(&stage.ground, 0, &grid) != STATUS_OK) return -1;
    for (int t = 0; t < stage.ground.level[0].tiles_x * stage.ground.level[0].tiles_y; t++)
        stage.ground.level[0].tile[t] = (ElevationTile){0, 0};
    stage.ground.level[0].plain = true;
    for (int j = 0; j < posts; j++)
        for (int i = 0; i < posts; i++) elevation_set_post(&stage.ground.level[0], i, j, 6400);
    elevation_build_pyramids(&stage.ground);
    hand_box(&stage.model, (const double[3]){-0.5 * long_m, -0.5 * thick_m, -high_m},
             (const double[3]){0.5 * long_m, 0.5 * thick_m, 0});
    strcpy(stage.model.part[0].material, "brick_red");
    stage.object = (SceneryObject){.kind = SCENERY_BUILDINGS,
                                   .state = -1,
                                   .p_enu = {0, 0, elevation_height(&stage.ground, 0, 0, NULL)},
                                   .r_enu_from_body = {0, 1, 0, 1, 0, 0, 0, 0, -1}};
    stage.scenery = (Scenery){.models = 1, .objects = 1, .model = &stage.model, .object = &stage.object};
    return etc_path(path, sizeof path, "materials.csv") && etc_path(surfaces, sizeof surfaces, "surfaces.csv") &&
                   materials_open(&stage.materials, path, surfaces, NULL) == STATUS_OK &&
                   scenery_tracer_create(&stage.tracer, &stage.scenery, "avx2") == STATUS_OK &&
                   sky_horizons_create(&stage.horizons, stage.tracer, &stage.ground, &stage.materials, NULL) ==
                       STATUS_OK
               ? 0
               : -1;
}

static int close_stage(void **state)
{
    (void)state;
    sky_horizons_destroy(stage.horizons);
    scenery_tracer_destroy(stage.tracer);
    materials_close(&stage.materials);
    elevation_destroy(&stage.ground);
    hand_free(&stage.model);
    return 0;
}

static double share(double x, double y, double z_m, double nx, double nz)
{
    const double p[3] = {x, y, stage.object.p_enu[2] + z_m}, n[3] = {nx, 0, nz};
    return sky_horizon_share(stage.horizons, p, n);
}

/* Seen at an elevation h an edge without end leaves (1 + cos h) / 2 of its light to level ground; to a wall that faces
 * it, which has half a sky, 1 - sin h. */
static void beside_a_wall(void **state)
{
    (void)state;
    double worst[3] = {0};
    for (double away_m = 0.1; away_m < 36; away_m += away_m < 3 ? 0.13 : 0.37)
        for (int side = -1; side <= 1; side += 2) {
            const double h = atan(high_m / away_m), x = side * (0.5 * thick_m + away_m), y = 3.7 * away_m - 60;
            const double level = share(x, y, 0, 0, 1), facing = share(x, y, 0, -side, 0),
                         turned = share(x, y, 0, side, 0);
            worst[0] = fmax(worst[0], fabs(level - 0.5 * (1 + cos(h))));
            if (away_m >= 3) worst[1] = fmax(worst[1], fabs(facing - (1 - sin(h))));
            CHECK(turned > 0.99);
            if (away_m < 3) worst[2] = fmax(worst[2], fabs(level / (0.5 * (1 + cos(h))) - 1));
        }
    print_message("level ground within %.3f, a wall that faces it within %.3f of an open sky's light; the last 3 m "
                  "before a wall within %.1f %%\n",
                  worst[0], worst[1], 100 * worst[2]);
    CHECK(worst[0] < 0.02 && worst[1] < 0.06 && worst[2] < 0.03);
}

/* A wall that faces it, higher up: what rises above its place hides. */
static void higher_up(void **state)
{
    (void)state;
    double worst = 0;
    for (double away_m = 6; away_m < 30; away_m += 2)
        for (double z_m = 0; z_m < 2 * high_m; z_m += 3) {
            const double h = z_m < high_m ? atan((high_m - z_m) / away_m) : 0;
            worst = fmax(worst, fabs(share(0.5 * thick_m + away_m, 10, z_m, -1, 0) - (1 - sin(h))));
            if (z_m >= high_m) CHECK(share(0.5 * thick_m + away_m, 10, z_m, -1, 0) == 1);
        }
    print_message("higher up within %.3f\n", worst);
    CHECK(worst < 0.06);
    CHECK(share(0, 0, high_m, 0, 1) > 0.99); /* on its top */
}

static void away_from_it_the_sky_is_open(void **state)
{
    (void)state;
    CHECK(share(200, 0, 0, 0, 1) == 1 && share(-450, 300, 0, 1, 0) == 1 && share(5000, 0, 0, 0, 1) == 1);
    CHECK(share(NAN, 0, 0, 0, 1) == 1);
    CHECK(sky_horizons_bytes(stage.horizons) > 10000 && sky_horizons_bytes(stage.horizons) < 4u << 20);
}

/* Cells are filled eight at a time where none of them is covered: which eight follows from where the grid begins. With
 * another wall 300 m off it begins 150 cells, and not a multiple of eight, farther west. */
static void wherever_the_grid_begins(void **state)
{
    (void)state;
    SceneryObject  two[2] = {stage.object, stage.object};
    const Scenery  scenery = {.models = 1, .objects = 2, .model = &stage.model, .object = two};
    SceneryTracer *tracer;
    SkyHorizons   *other;
    int            hidden = 0;
    two[1].p_enu[0] = -300;
    assert_int_equal(scenery_tracer_create(&tracer, &scenery, "avx2"), STATUS_OK);
    assert_int_equal(sky_horizons_create(&other, tracer, &stage.ground, &stage.materials, NULL), STATUS_OK);
    for (int i = 0; i < 4000; i++) {
        const double p[3] = {-70 + 0.035 * i, -240 + 0.17 * (i * 37 % 2800), stage.object.p_enu[2]}, up[3] = {0, 0, 1};
        const double one = sky_horizon_share(stage.horizons, p, up), both = sky_horizon_share(other, p, up);
        CHECK_NEAR(both, one, 1e-5);
        hidden += one < 0.95;
    }
    CHECK(hidden > 500);
    sky_horizons_destroy(other);
    scenery_tracer_destroy(tracer);
}

/* A plane of ground receives what is left of the sky, and of the wall what a wall shines. */
static void light_on_ground(void **state)
{
    (void)state;
    static Hits           hits;
    static float          factor[AIR_BAND_COUNT][hits_capacity], below[AIR_BAND_COUNT][hits_capacity];
    const SkyHorizonLight light = {.sky = {100, 100, 100, 100, 100, 100, 100}, .level = {50}, .wall = {40, 0, 100}};
    hits.count = 2;
    for (int i = 0; i < 2; i++) {
        hits.kind[i] = i ? hit_part : hit_ground;
        hits.p_enu[0][i] = 9, hits.p_enu[1][i] = 0, hits.p_enu[2][i] = stage.object.p_enu[2];
        hits.n_enu[0][i] = hits.n_enu[1][i] = 0, hits.n_enu[2][i] = 1;
        for (int b = 0; b < AIR_BAND_COUNT; b++) factor[b][i] = 1;
    }
    CHECK(!sky_horizon_open(factor, below, stage.horizons, &light, 7, &hits)); /* without sun nothing is in shadow */
    const double open = share(9, 0, 0, 0, 1);
    CHECK(open > 0.6 && open < 0.8);
    CHECK_NEAR((double)factor[0][0], open + (1 - open) * 0.4, 1e-5);
    CHECK_NEAR((double)factor[1][0], open, 1e-5);
    CHECK_NEAR((double)factor[2][0], 1, 1e-5);
    CHECK(factor[3][0] == 1 && factor[0][1] == 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(beside_a_wall),
        cmocka_unit_test(higher_up),
        cmocka_unit_test(away_from_it_the_sky_is_open),
        cmocka_unit_test(wherever_the_grid_begins),
        cmocka_unit_test(light_on_ground),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
