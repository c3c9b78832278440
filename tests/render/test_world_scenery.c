/* Scenery in a world that is warm: its ground stays as it was to the bit, and its houses follow the world's weather and
 * the place's own noon. labels: physics */
#include "tests/render/hand_world.h"

#include "render/heat/scenery_heat.h"

static const double noon_s = 1782000000 + 43200; /* of 2026-06-21 at 0 E */

static int open_stage(void **state)
{
    (void)state;
    return hand_open(true);
}

static double ground_k(double unix_s)
{
    HeatScene   *scene;
    double       lifted_k;
    const double up[3] = {0, 0, 1}, p[3] = {0};
    CHECK(world_heat_at(&scene, &hand.world, NULL, unix_s, hand.arena) == STATUS_OK && scene);
    return heat_scene_ground_k(&lifted_k, scene, SURFACE_GRASS, p, up, 1);
}

static void a_warm_world_warms_its_scenery(void **state)
{
    static const double here[3] = {2, 0, -1}, wall[4][3] = {{0, 1, 0}, {1, 0, 0}, {0, -1, 0}, {-1, 0, 0}};
    const double        local_noon_s = noon_s - 43200 * hand.world.frame.origin.lon_rad / pi_rad;
    HeatConfig          config = heat_default_config();
    SceneryTemps       *t;
    Model               model;
    SceneryObject object = {.kind = SCENERY_BUILDINGS, .state = -1, .r_enu_from_body = {0, 1, 0, 1, 0, 0, 0, 0, -1}};
    (void)state;
    hand_box(&model, (const double[3]){-2, -2, -3}, (const double[3]){2, 2, 0});
    strcpy(model.part[0].name, "wall"), strcpy(model.part[0].material, "metal_steel_galvanized");
    const Scenery scenery = {.models = 1, .objects = 1, .model = &model, .object = &object};
    config.unix_s = local_noon_s - 4 * 3600;
    CHECK(world_scenery_temps(&t, &hand.world, config.unix_s, hand.arena) == STATUS_OK && !t); /* there are none yet */
    CHECK(world_warm_clear(&hand.world, &config, 0, hand.pool) == STATUS_OK);
    double before_k[9];
    for (int k = 0; k < 9; k++) before_k[k] = ground_k(config.unix_s + 3600 * k);
    CHECK(world_warm_scenery(&hand.world, &scenery, &config, "avx2", hand.pool) == STATUS_OK);
    for (int k = 0; k < 9; k++) CHECK(ground_k(config.unix_s + 3600 * k) == before_k[k]);
    /* four hours before and after noon: the sun in the east, the south and the west */
    for (int k = 0; k < 3; k++) {
        double k_of[4];
        CHECK(world_scenery_temps(&t, &hand.world, config.unix_s + 4 * 3600 * k, hand.arena) == STATUS_OK && t);
        for (int n = 0; n < 4; n++) k_of[n] = scenery_temp_k(t, 0, 0, here, wall[n]);
        const double air_k = world_air_k(&hand.world, config.unix_s + 4 * 3600 * k);
        print_message("%+d h: north %.1f, east %.1f, south %.1f, west %.1f K in air of %.1f K\n", 4 * k - 4, k_of[0],
                      k_of[1], k_of[2], k_of[3], air_k);
        const int warmest = k_of[1] > k_of[2] && k_of[1] > k_of[3] ? 1 : k_of[2] > k_of[3] ? 2 : 3;
        CHECK(warmest == k + 1 && k_of[warmest] > air_k + 8 && k_of[0] > air_k - 2);
    }
    world_cool(&hand.world);
    CHECK(world_scenery_temps(&t, &hand.world, config.unix_s, hand.arena) == STATUS_OK && !t);
    model_destroy(&model);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_warm_world_warms_its_scenery)};
    return cmocka_run_group_tests(tests, open_stage, hand_close);
}
