/* The range profile: all of the picture's power, where the ranges are, and no overflow at the largest.
 * labels: physics */
#include "tests/check.h"

#include "render/frame/render.h"

static Catalog *catalog;
static World    world;
static Pool    *pool;
static Arena   *arena;

static int open_world(void **state)
{
    (void)state;
    char           path[text_file_size];
    LocalFrame     frame;
    const Geodetic origin = {0.6, -2.1, 0};
    text_file(path, "type,model,origin\n*.*.*.*.*.*.*,marker,base\n");
    const Status status = catalog_open(&catalog, path, 0.01);
    remove(path);
    arena = arena_create();
    return status == STATUS_OK && arena && local_frame_at(&frame, &origin) == STATUS_OK &&
                   world_open(&world, catalog, NULL, &frame, "avx2") == STATUS_OK && pool_create(&pool, 2) == STATUS_OK
               ? 0
               : -1;
}

static int close_world(void **state)
{
    (void)state;
    pool_destroy(pool);
    world_close(&world);
    catalog_close(catalog);
    arena_destroy(arena);
    return 0;
}

/* The marker's plate faces the eye at range_m, square on. */
static Picture shoot(double range_m, double lobe_rad, int side_px, int samples)
{
    static SnapshotEntity entity;
    static NodePose       node;
    const double          p_enu[3] = {0, 0, 0};
    Air                   air;
    const Sun             sun = {.elevation_rad = 1, .distance_au = 1, .d_enu = {0, 0, 1}};
    Picture               picture;

    entity = (SnapshotEntity){.id = {1, 1, 1}};
    entity.model = catalog_find(catalog, entity.type, &(Origin){ORIGIN_BASE}, NULL);
    model_pose(&node, catalog_model(catalog, entity.model), NULL);
    ecef_from_enu(entity.p_ecef, &world.frame, p_enu);
    /* forward north, right east, down */
    for (int i = 0; i < 3; i++) {
        entity.r_ecef_from_body[3 * i] = world.frame.r_ecef_from_enu[3 * i + 1];
        entity.r_ecef_from_body[3 * i + 1] = world.frame.r_ecef_from_enu[3 * i];
        entity.r_ecef_from_body[3 * i + 2] = -world.frame.r_ecef_from_enu[3 * i + 2];
    }
    const Snapshot snapshot = {.count = 1, .node_count = 1, .entity = &entity, .node = &node};
    RenderRequest  request = {
         .view = {.p_enu = {1.0001 + range_m, 1, 0.85},
                  .width = side_px,
                  .height = side_px,
                  .focal_px = side_px * range_m / 1.0,
                  .r_enu_from_cam = {0, 0, -1, 1, 0, 0, 0, -1, 0}}, /* looking west, right is north */
         .bands = 1 << BAND_RADAR,
         .samples = samples,
         .hidden_entity = -1,
         .profile_near_m = range_m - 20,
         .profile_bin_m = 0.5,
         .profile_bins = 80};
    world.radar.lobe_rad = lobe_rad;
    air_even(&air, sun.d_enu, 0, (const double[AIR_BAND_COUNT]){0}, 0, world.planck_mwir, world.planck_lwir);
    arena_reset(arena);
    assert_int_equal(render(&picture, &world, &snapshot, &request, &air, pool, arena), STATUS_OK);
    return picture;
}

static void it_holds_the_picture_and_no_more(void **state)
{
    (void)state;
    for (int samples = 1; samples <= 3; samples++) {
        const Picture picture = shoot(200, 0.05, 64, samples);
        double        in_picture = 0, in_profile = 0, at_plate = 0;
        for (int i = 0; i < 64 * 64; i++) in_picture += picture.radar[i];
        for (int i = 0; i < 80 * radar_bounces; i++) in_profile += picture.profile[i];
        for (int b = 0; b < radar_bounces; b++) at_plate += picture.profile[40 * radar_bounces + b];
        CHECK(in_picture > 0);
        /* float pixels: 64 x 64 roundings of 6e-8 */
        CHECK_NEAR(in_profile / in_picture, 1, 1e-6);
        CHECK_NEAR(at_plate / in_profile, 1, 1e-9); /* the plate is 200.00 .. 200.01 m off, in bin 40 */
    }
}

/* A narrow lobe square on a mirror, 1 M samples: the sum of the fixed point is what the picture's is. */
static void the_largest_return_does_not_overflow(void **state)
{
    (void)state;
    const Picture picture = shoot(4000, 0.0035, 256, 4);
    double        in_picture = 0, in_profile = 0;
    for (int i = 0; i < 256 * 256; i++) in_picture += picture.radar[i];
    for (int i = 0; i < 80 * radar_bounces; i++) {
        CHECK(picture.profile[i] >= 0);
        in_profile += picture.profile[i];
    }
    CHECK(in_picture > 1e8);
    CHECK_NEAR(in_profile / in_picture, 1, 1e-6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_holds_the_picture_and_no_more),
        cmocka_unit_test(the_largest_return_does_not_overflow),
    };
    return cmocka_run_group_tests(tests, open_world, close_world);
}
