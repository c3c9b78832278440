/* A budget changes no plane, is the same on one thread, and small pictures have one too. labels: slow */
#include "tests/sensor/error_scenes.h"

static const ErrorScene scenes[] = {
    {"vehicles at 60 m", 60, 12, 40, 6, false, 0, true},
    {"vehicles at 600 m", 600, 60, 12, 10, false, 0, false},
};

/* The planes are those without a budget, and the budget is that of one thread, to the bit. */
static void nothing_else_changes(void **state)
{
    (void)state;
    TrialScene scene;
    Pool      *one = NULL;
    char       hash[2][sha256_text_size];
    open_scene(&scene, &lab.ground, &scenes[1]);
    RenderRequest request = request_of(&scene, &scenes[1]);
    request.bands = 15;
    TrialFrame with = frame_of(&scene, &request, 0);
    assert_int_equal(pool_create(&one, 1), STATUS_OK);
    TrialFrame single = {.scene = &scene, .request = request, .pool = one, .arena = lab.arena[1]};
    trial_frame(&single);
    CHECK(single.status == STATUS_OK && with.picture.budget && single.picture.budget);
    with.picture.budget->ms = single.picture.budget->ms = 0;
    ErrorBudget *const a = with.picture.budget, *const b = single.picture.budget;
    assert_int_equal(a->probes, b->probes);
    assert_memory_equal(a->probe_px, b->probe_px, (size_t)a->probes * sizeof *a->probe_px);
    for (int k = 0; k < error_thermal_planes; k++) {
        assert_memory_equal(a->probe_square[k], b->probe_square[k], (size_t)a->probes * sizeof *a->probe_square[k]);
        a->probe_square[k] = b->probe_square[k] = NULL;
    }
    a->probe_px = b->probe_px = NULL;
    assert_memory_equal(a, b, sizeof *a);
    for (int i = 0; i < with.snapshot.count; i++)
        assert_memory_equal(with.picture.target[i].radiance_error, single.picture.target[i].radiance_error,
                            sizeof with.picture.target[i].radiance_error);
    CHECK(with.picture.budget->sampling[picture_radar] > 0);
    request.budget = false;
    const TrialFrame without = frame_of(&scene, &request, 2);
    CHECK(!without.picture.budget);
    assert_int_equal(trial_frame_hash(hash[0], &with), STATUS_OK);
    assert_int_equal(trial_frame_hash(hash[1], &without), STATUS_OK);
    assert_string_equal(hash[0], hash[1]);
    for (int i = 0; i < with.snapshot.count; i++)
        CHECK(with.picture.target[i].radiance[picture_lwir] == without.picture.target[i].radiance[picture_lwir]);
    pool_destroy(one);
    trial_scene_close(&scene);
}

/* Sizes of pictures, and grids of rays, that leave little to draw from. */
static void small_pictures_have_a_budget(void **state)
{
    (void)state;
    static const int sizes[][2] = {{1, 1}, {8, 8}, {3, 97}, {31, 33}},
                     grids[][2] = {{1, 4}, {1, 0}, {2, 4}, {5, 0}, {16, 0}, {1, 2}};
    TrialScene scene;
    open_scene(&scene, &lab.ground, &scenes[1]);
    for (int s = 0; s < 4; s++)
        for (int g = 0; g < 6; g++) {
            RenderRequest request = request_of(&scene, &scenes[1]);
            request.view.width = sizes[s][0], request.view.height = sizes[s][1];
            request.samples = grids[g][0], request.edge_samples = grids[g][1], request.bands = 15;
            const TrialFrame f = frame_of(&scene, &request, 0);
            for (int k = 0; k < picture_plane_count; k++) {
                const ErrorBudget *b = f.picture.budget;
                CHECK(b->sampling[k] >= 0 && b->level_of_detail[k] >= 0 && b->tables[k] >= 0 && isfinite(b->mean[k]));
                CHECK(isfinite(b->sampling[k]) && isfinite(b->level_of_detail[k]) && isfinite(b->tables[k]));
            }
        }
    trial_scene_close(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(nothing_else_changes),
                                       cmocka_unit_test(small_pictures_have_a_budget)};
    return cmocka_run_group_tests(tests, lab_open, lab_close);
}
