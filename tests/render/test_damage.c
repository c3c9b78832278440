/* What a sidecar says of damage is what is seen: parts gone, materials changed, in the state the sender reports.
 * labels: physics */
#include "tests/check.h"

#include "render/frame/render.h"

#include <sys/stat.h>
#include <unistd.h>

/* Two plates across the x axis, 2 m a side: the screen at x = 2 hides the wall at x = 0. */
static const char obj[] = "o screen\nv 2 -1 0\nv 2 1 0\nv 2 1 2\nv 2 -1 2\nf 1 2 3\nf 1 3 4\n"
                          "o wall\nv 0 -1 0\nv 0 1 0\nv 0 1 2\nv 0 -1 2\nf 5 6 7\nf 5 7 8\n";
static const char sidecar[] = "axes: +x +z\norigin: 0 0 0\nnode_materials: {\"*\": paint_sand}\n"
                              "damage:\n  moderate: {materials: {wall: concrete, screen: brick_red}}\n"
                              "  destroyed: {hide: [screen], materials: {wall: metal_dark}}\n";

static char     folder[] = "/tmp/pitviper-test-XXXXXX", path[3][96];
static Catalog *catalog;
static World    world;
static Pool    *pool;
static Arena   *arena;

static void write_file(const char *name, const char *text)
{
    FILE *file = fopen(name, "w");
    CHECK(file && fputs(text, file) >= 0 && fclose(file) == 0);
}

static int open_world(void **state)
{
    (void)state;
    LocalFrame     frame;
    const Geodetic origin = {0.6, -2.1, 0};
    CHECK(mkdtemp(folder) != NULL);
    static const char *const name[3] = {"plates.obj", "plates.yaml", "catalog.csv"};
    const char *const        text[3] = {obj, sidecar, "type,model,origin\n1,plates.obj,base\n2,tank,base\n"};
    for (int i = 0; i < 3; i++) {
        snprintf(path[i], sizeof path[i], "%s/%s", folder, name[i]);
        write_file(path[i], text[i]);
    }
    arena = arena_create();
    CHECK(catalog_open(&catalog, path[2], 0.02) == STATUS_OK && arena);
    CHECK(local_frame_at(&frame, &origin) == STATUS_OK && pool_create(&pool, 1) == STATUS_OK);
    return world_open(&world, catalog, NULL, &frame, "avx2") == STATUS_OK ? 0 : -1;
}

static int close_world(void **state)
{
    (void)state;
    pool_destroy(pool);
    world_close(&world);
    catalog_close(catalog);
    arena_destroy(arena);
    for (int i = 0; i < 3; i++) unlink(path[i]);
    rmdir(folder);
    return 0;
}

/* Material and range at the middle of a picture from 12 m before an entity of this kind, its front towards the eye. */
static const char *seen(double *range_m, uint8_t kind, int damage)
{
    static const double dark[AIR_BAND_COUNT] = {0};
    SnapshotEntity      entity = {.id = {1, 1, 1}, .type = {.kind = kind}, .appearance = (uint32_t)damage << 3};
    NodePose            node[64];
    Air                 air;
    Picture             picture;
    Origin              base;
    entity.model = catalog_find(catalog, entity.type, &base, NULL);
    const Model *model = catalog_model(catalog, entity.model);
    CHECK(model->node_count <= 64);
    model_pose(node, model, NULL);
    memcpy(entity.p_ecef, world.frame.origin_ecef, sizeof entity.p_ecef);
    for (int i = 0; i < 3; i++) { /* forward east, right south, down */
        entity.r_ecef_from_body[3 * i] = world.frame.r_ecef_from_enu[3 * i];
        entity.r_ecef_from_body[3 * i + 1] = -world.frame.r_ecef_from_enu[3 * i + 1];
        entity.r_ecef_from_body[3 * i + 2] = -world.frame.r_ecef_from_enu[3 * i + 2];
    }
    const Snapshot      snapshot = {.count = 1, .node_count = model->node_count, .entity = &entity, .node = node};
    const RenderRequest request = {.view = {.p_enu = {12, 0, 1},
                                            .width = 9,
                                            .height = 9,
                                            .focal_px = 90,
                                            .r_enu_from_cam = {0, 0, -1, 1, 0, 0, 0, -1, 0}}, /* looking west */
                                   .bands = 1 << BAND_LWIR,
                                   .truth = true,
                                   .samples = 1,
                                   .hidden_entity = -1};
    air_even(&air, (const double[3]){0, 0, 1}, 0, dark, 0, world.planck_mwir, world.planck_lwir);
    arena_reset(arena);
    CHECK(render(&picture, &world, &snapshot, &request, &air, pool, arena) == STATUS_OK);
    *range_m = picture.range_m[40];
    return world.materials.material[picture.material[40]].name;
}

static void a_sidecar_says_what_damage_shows(void **state)
{
    (void)state;
    double range_m;
    assert_string_equal(seen(&range_m, 1, 0), "paint_sand");
    CHECK_NEAR(range_m, 10, 1e-6);
    assert_string_equal(seen(&range_m, 1, 1), "paint_sand"); /* slight: nothing is said of it */
    CHECK_NEAR(range_m, 10, 1e-6);
    assert_string_equal(seen(&range_m, 1, 2), "brick_red");
    CHECK_NEAR(range_m, 10, 1e-6);
    assert_string_equal(seen(&range_m, 1, 3), "metal_dark"); /* the screen is gone: the wall */
    CHECK_NEAR(range_m, 12, 1e-6);
}

/* Who says nothing is burnt when he is destroyed; only platforms are (a munition's bits mean something else). */
static void others_are_burnt(void **state)
{
    (void)state;
    double range_m, same_m;
    CHECK(materials_find(&world.materials, "burnt") > 0);
    const SnapshotEntity munition = {.type = {.kind = 2}, .appearance = 3 << 3};
    CHECK(snapshot_damage(&munition) == 0 && !snapshot_is_wreck(&munition));
    const char *whole = seen(&range_m, 2, 0);
    assert_string_equal(seen(&same_m, 2, 3), whole);
    CHECK(range_m == same_m && strcmp(whole, "burnt") != 0);
    for (int m = 0; m < catalog_model_count(catalog); m++)
        for (int p = 0;
             strcmp(catalog_model(catalog, m)->name, "tank") == 0 && p < catalog_model(catalog, m)->part_count; p++) {
            CHECK(material_of_part(&world.materials, m, p, 3) == materials_find(&world.materials, "burnt"));
            CHECK(material_of_part(&world.materials, m, p, 2) == world.materials.part[m][p]);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sidecar_says_what_damage_shows),
        cmocka_unit_test(others_are_burnt),
    };
    return cmocka_run_group_tests(tests, open_world, close_world);
}
