/* The ground behind clutter that drives: as warm as behind an entity that drives the same way, ahead of it as bare
 * ground; without it, as if there were no such thing. labels: physics */
#include "tests/render/hand_world.h"

static const double noon_s = 1782000000 + 43200; /* of 2026-06-21 at 0 E */

static int open_stage(void **state)
{
    (void)state;
    return hand_open(true);
}

static double ground_k(const GroundMarks *marks, double unix_s, double east_m, double north_m)
{
    HeatScene   *scene;
    double       lifted_k;
    const double up[3] = {0, 0, 1}, p[3] = {east_m, north_m, 0};
    CHECK(world_heat_at(&scene, &hand.world, marks, unix_s, hand.arena) == STATUS_OK && scene);
    return heat_scene_ground_k(&lifted_k, scene, SURFACE_GRASS, p, up, 1);
}

/* East along 400 m at 10 m/s from exercise time 0 on, and back 50 m beside it. */
static void behind_what_drives(void **state)
{
    (void)state;
    static const double now_s = 20, eye[3] = {0, -100, 50};
    double              path[4][3] = {{0, 0, 0}, {400, 0, 0}, {400, 50, 0}, {0, 50, 0}}, warmest_k = 0;
    uint8_t             loose[4] = {1, 1, 1, 1};
    Model               model;
    HeatConfig          config = heat_default_config();
    GroundMarks         seen, own = {0};
    hand_box(&model, (const double[3]){-4, -1.25, -3}, (const double[3]){4, 1.25, 0});
    strcpy(model.part[0].name, "wall"), strcpy(model.part[0].material, "metal_steel_galvanized");
    model.length_m = 8, model.width_m = 2.5, model.height_m = 3;
    SceneryState  cold = {0};
    SceneryObject object = {
        .id = 5, .kind = SCENERY_CLUTTER, .class = CLUTTER_LORRY, .r_enu_from_body = {0, 1, 0, 1, 0, 0, 0, 0, -1}};
    SceneryMover mover = {.count = 4, .speed_mps = 10};
    Scenery      scenery = {.models = 1,
                            .objects = 1,
                            .states = 1,
                            .movers = 1,
                            .paths = 4,
                            .model = &model,
                            .object = &object,
                            .state = &cold,
                            .mover = &mover,
                            .path_enu = path,
                            .path_loose = loose};
    config.unix_s = noon_s;
    CHECK(world_scenery(&hand.world, &scenery, "avx2", hand.pool) == STATUS_OK);
    CHECK(world_warm_clear(&hand.world, &config, 0, hand.pool) == STATUS_OK);
    const double unix_s = noon_s + now_s;
    CHECK(world_marks_at(&seen, &hand.world, NULL, eye, unix_s, hand.arena) == STATUS_OK && seen.tracks > 0);

    /* an entity that did the same, by hand: the widths of its wheels, the friction of its weight */
    const double width_m = 0.1 * model.width_m;
    const double weight_n = 350 * model.length_m * model.width_m * model.height_m * 9.80665;
    GroundTrack  track = {.b_s = now_s,
                          .width_m = (float)width_m,
                          .apart_m = (float)(model.width_m - width_m),
                          .heat_j_m2 = (float)(0.5 * 0.03 * weight_n / (2 * width_m))};
    ecef_from_enu(track.a_ecef, &hand.world.frame, (const double[3]){0, 0, 0});
    ecef_from_enu(track.b_ecef, &hand.world.frame, (const double[3]){200, 0, 0});
    own.tracks = 1, own.track = &track;
    const double wheel_m = 0.5 * (model.width_m - width_m);
    for (int east_m = 5; east_m < 398; east_m += 8)
        for (int side = -1; side <= 1; side++) {
            const double bare_k = ground_k(NULL, unix_s, east_m, side * wheel_m);
            const double ours_k = ground_k(&seen, unix_s, east_m, side * wheel_m);
            const double theirs_k = ground_k(&own, unix_s, east_m, side * wheel_m);
            /* what it left on its last round, 45 s or more ago, is there too: cooler, and loosened alike */
            if (east_m < 195) CHECK_NEAR(ours_k, theirs_k, 1e-4);
            if (side == 0) CHECK(ours_k == bare_k);
            else if (east_m < 195) warmest_k = fmax(warmest_k, ours_k - bare_k);
        }
    print_message("behind it up to %.2f K warmer than bare ground\n", warmest_k);
    CHECK(warmest_k > 0.5 && warmest_k < 20);
    /* paved, or not there: no marks, and the entities' own are left as they are */
    memset(loose, 0, sizeof loose);
    CHECK(world_marks_at(&seen, &hand.world, &own, eye, unix_s, hand.arena) == STATUS_OK);
    CHECK(seen.tracks == 1 && seen.track == &track);
    world_cool(&hand.world);
    model_destroy(&model);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(behind_what_drives)};
    return cmocka_run_group_tests(tests, open_stage, hand_close);
}
