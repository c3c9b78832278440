/* What frames say of their own error against frames of 16 x 16 rays, of finer ground, and without tables; the rest of
 * the scenes are in test_error_budget_deep.c. Planes and threads: test_error_budget_same.c. labels: slow */
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

/* Without antialiasing a band's error is that of a few pixels of vehicles, between which the fields of other pixels
 * fall. */
static void targets_that_are_not_refined_count(void **state)
{
    (void)state;
    static const ErrorScene far[] = {{"vehicles at 600 m, off", 600, 60, 16, 10, false, 0, false},
                                     {"vehicles at 1500 m, off", 1500, 150, 12, 15, false, 0, false}};
    Tally                   rays = {0};
    for (int k = 0; k < 2; k++) {
        TrialScene scene;
        open_scene(&scene, &lab.ground, &far[k]);
        RenderRequest request = request_of(&scene, &far[k]);
        request.view = trial_view(&scene, far[k].back_m, far[k].above_m, far[k].hfov_deg * rad_per_deg, 160, 120);
        request.edge_samples = request.target_samples = 0;
        TrialFrame       frame = frame_of(&scene, &request, 0);
        const FrameError error = error_of(&frame);
        request.budget = false;
        request.samples = 8;
        const TrialFrame better = frame_of(&scene, &request, 1);
        for (int b = 0; b < radiance_bands; b++)
            judge(&rays, far[k].name, "sampling", (Band)b, error.share[b][ERROR_SAMPLING],
                  apart(&frame.picture, &better.picture, (Band)b));
        trial_scene_close(&scene);
    }
    CHECK(nine_in_ten(&rays, "sampling, off"));
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

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(too_few_are_too_few),
                                       cmocka_unit_test(estimates_are_near_the_truth),
                                       cmocka_unit_test(targets_that_are_not_refined_count)};
    return cmocka_run_group_tests(tests, lab_open, lab_close);
}
