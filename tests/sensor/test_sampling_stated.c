/* Steps of sampling (RenderRequest.sampling): what a frame says of its own error at each step, against frames of many
 * rays. Which pixels have rays: test_sampling_steps.c. labels: slow */
#include "tests/sensor/error_scenes.h"

static const ErrorScene scenes[] = {
    {"a vehicle and its smoke at 60 m, the horizon", 60, 12, 40, 6, true, 8, false},
    {"vehicles at 600 m", 600, 60, 12, 10, false, 0, false},
};
enum { steps = SAMPLING_QUARTER + 1 };

/* The stated error of each step in each band, over the scenes together, is within a factor of 1.5 of the true one: that
 * of one small frame has few probes, and scatters more. */
static void a_frame_states_the_error_of_its_step(void **state)
{
    (void)state;
    static const double factor = 1.5;
    double              stated[steps][BAND_COUNT] = {{0}}, found[steps][BAND_COUNT] = {{0}};
    for (int s = 0; s < 2; s++) {
        TrialScene scene;
        open_scene(&scene, &lab.ground, &scenes[s]);
        RenderRequest request = request_of(&scene, &scenes[s]), fine = request;
        fine.samples = 8, fine.budget = false;
        const TrialFrame many = frame_of(&scene, &fine, 1);
        for (int step = SAMPLING_ALL; step < steps; step++) {
            request.sampling = (Sampling)step;
            TrialFrame       frame = frame_of(&scene, &request, 0);
            const FrameError error = error_of(&frame);
            for (int b = 0; b < radiance_bands; b++) {
                const double states = error.share[b][ERROR_SAMPLING],
                             is = apart(&frame.picture, &many.picture, (Band)b);
                print_message("%s, step %d, %s: stated %.2f %%, is %.2f %%\n", scenes[s].name, step, band_name((Band)b),
                              100 * states, 100 * is);
                stated[step][b] += states * states, found[step][b] += is * is;
            }
        }
        trial_scene_close(&scene);
    }
    for (int step = SAMPLING_ALL; step < steps; step++)
        for (int b = 0; b < radiance_bands; b++) {
            const double ratio = sqrt(stated[step][b] / found[step][b]);
            print_message("step %d, %s: %.2f\n", step, band_name((Band)b), ratio);
            CHECK(ratio < factor && ratio > 1 / factor);
        }
    /* the twin: what the first step states is no answer for the last */
    CHECK(sqrt(stated[SAMPLING_ALL][BAND_OPTICAL] / found[SAMPLING_QUARTER][BAND_OPTICAL]) < 1 / factor);
}

/* The same of as many samples a pixel as the estimate has: the pixels' own variance says nothing of a filled one. */
static void filled_pixels_of_many_samples_too(void **state)
{
    (void)state;
    TrialScene scene;
    open_scene(&scene, &lab.ground, &scenes[1]);
    RenderRequest request = request_of(&scene, &scenes[1]);
    request.samples = 5, request.edge_samples = 0;
    TrialFrame all = frame_of(&scene, &request, 1);
    request.sampling = SAMPLING_QUARTER;
    TrialFrame quarter = frame_of(&scene, &request, 0);
    for (int b = 0; b < radiance_bands; b++) {
        const double was = error_of(&all).share[b][ERROR_SAMPLING], is = error_of(&quarter).share[b][ERROR_SAMPLING];
        const double found = apart(&quarter.picture, &all.picture, (Band)b);
        print_message("25 rays, %s: all %.2f %%, quarter stated %.2f %%, is %.2f %%\n", band_name((Band)b), 100 * was,
                      100 * is, 100 * found);
        CHECK(is < 1.5 * hypot(found, was) && is > hypot(found, was) / 1.5 && is > 1.5 * was);
    }
    trial_scene_close(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_frame_states_the_error_of_its_step),
        cmocka_unit_test(filled_pixels_of_many_samples_too),
    };
    thread_flush_denormals();
    return cmocka_run_group_tests(tests, lab_open, lab_close);
}
