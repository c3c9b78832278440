/* What frames say of their own error against frames of 16 x 16 rays, of finer ground, and without tables; the rest of
 * the scenes are in test_error_budget_deep.c. And: planes do not change, nor the budget with threads. labels: slow */
#include "tests/sensor/error_scenes.h"

static const ErrorScene scenes[] = {
    {"vehicles at 60 m", 60, 12, 40, 6, false, 0, true},
    {"vehicles at 600 m", 600, 60, 12, 10, false, 0, false},
};
enum { scene_count = sizeof scenes / sizeof *scenes };

static void estimates_are_near_the_truth(void **state)
{
    (void)state;
    Tally rays = {0}, ground = {0}, tables = {0}, heat = {0};
    for (int k = 0; k < scene_count; k++) {
        ErrorCase c;
        open_case(&c, &scenes[k]);
        judge_sampling(&rays, &c);
        judge_ground(&ground, &c);
        judge_tables(&tables, &c);
        if (scenes[k].heat) judge_heat(&heat, &c, 300, 11); /* finer, and other scenes, in the deep test */
        close_case(&c);
    }
    const bool held[] = {nine_in_ten(&rays, "sampling"), nine_in_ten(&ground, "level of detail"),
                         nine_in_ten(&tables, "tables")};
    CHECK(held[0] && held[1] && held[2]);
    for (int b = BAND_MWIR; b <= BAND_LWIR; b++) CHECK(heat.cases[b] == 1 && heat.held[b] == 1);
}

/* What the tests count by can fail, in one band alone, too; and an estimate that is two and a half times the truth
 * does. */
static void too_few_are_too_few(void **state)
{
    (void)state;
    const Tally enough = {{15, 10, 1}, {14, 9, 1}}, one_band = {{15, 15, 15}, {15, 13, 15}}, none = {{0}, {0}};
    CHECK(nine_in_ten(&enough, "enough") && !nine_in_ten(&one_band, "one band") && !nine_in_ten(&none, "none"));
    Tally wrong = {0};
    judge(&wrong, "", "too large", BAND_OPTICAL, 0.025, 0.01);
    judge(&wrong, "", "too small", BAND_MWIR, 0.004, 0.01);
    judge(&wrong, "", "near", BAND_LWIR, 0.015, 0.01);
    CHECK(wrong.held[BAND_OPTICAL] == 0 && wrong.held[BAND_MWIR] == 0 && wrong.held[BAND_LWIR] == 1);
}

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
    assert_memory_equal(with.picture.budget, single.picture.budget, sizeof *with.picture.budget);
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
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(too_few_are_too_few), cmocka_unit_test(estimates_are_near_the_truth),
        cmocka_unit_test(nothing_else_changes), cmocka_unit_test(small_pictures_have_a_budget)};
    return cmocka_run_group_tests(tests, lab_open, lab_close);
}
