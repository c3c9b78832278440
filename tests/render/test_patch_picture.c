/* Patches in a picture: a plate of four lengths, a hot one between cold ones, pixel by pixel against their blend as
 * it is on paper; its edge is warm, and nowhere is there a step. */
#include "tests/render/hand_world.h"

#include "render/trace/parts/parts.h"

enum { lengths = 4, width = 128, height = 48 };
static const double half_y_m = 3, half_z_m = 1, eye_m = 20, focal_px = 384;
static float        warm_k[lengths];

static int open_plate(void **state)
{
    (void)state;
    Model model;
    if (hand_open(false) != 0) return -1;
    hand_plate(&model, half_y_m, half_z_m);
    hand.model[hand_plate_model] = hand_replace(hand.model[hand_plate_model], &model);
    return 0;
}

/* The plate faces east, its left end south; seen from there. */
static View show(void)
{
    static const double at[3] = {0, 0, 0}, eye[3] = {20, 0, 1}, west[3] = {-1, 0, 0}, noon[3] = {0, -0.6, 0.8};
    double              r[9];
    arena_reset(hand.arena);
    hand_air_off(noon);
    hand_clear();
    hand_attitude(r, 0, 0);
    const int k = hand_add(hand_plate_model, at, r), m = hand.entity[k].model;
    CHECK(tracer_need(hand.world.tracer, m) == STATUS_OK);
    CHECK(heat_patches_need(hand.world.patches, m, tracer_model(hand.world.tracer, m)) == STATUS_OK);
    CHECK(hand.world.patches->of[m].count == lengths);
    hand.entity[k].first_patch = 0, hand.entity[k].patches = lengths;
    hand.snapshot.patch_k = warm_k, hand.snapshot.patch_count = lengths;
    return hand_view(eye, west, width, height, focal_px);
}

/* Rectangles of 1.5 x 2 m along body y, all facing one way: weights are one over the squared distance of a middle and a
 * quarter of the squared standard distance of a rectangle's surface from its middle. Which is which: by its middle. */
static double blend_k(double y_m, double z_m)
{
    const Patches *p = &hand.world.patches->of[hand.model[hand_plate_model]];
    const double   side_m = 2 * half_y_m / lengths, spread_m2 = (side_m * side_m + 4 * half_z_m * half_z_m) / 12;
    double         sum = 0, weights = 0;
    for (int i = 0; i < lengths; i++) {
        const int    from_left = (int)floor((p->patch[i].p_node[1] + half_y_m) / side_m);
        const double y_off_m = y_m + half_y_m - (from_left + 0.5) * side_m, z_off_m = z_m + half_z_m;
        const double w = 1 / (y_off_m * y_off_m + z_off_m * z_off_m + 0.25 * spread_m2);
        sum += w * (double)warm_k[i], weights += w;
    }
    return sum / weights;
}

static void pixels_blend_patches(void **state)
{
    (void)state;
    const View     view = show();
    RenderRequest  request = hand_request(&view);
    const Patches *p = &hand.world.patches->of[hand.model[hand_plate_model]];
    for (int i = 0; i < lengths; i++) warm_k[i] = p->patch[i].p_node[1] > 0 && p->patch[i].p_node[1] < 1.5 ? 380 : 290;
    request.bands = 1 << BAND_LWIR, request.edge_samples = 1;
    const Picture picture = hand_render(&request, hand.pool);
    double        worst_k = 0, worst_lwir = 0, step_k = 0, hottest_k = 0, coldest_k = 1e9;
    int           on = 0;
    for (int row = 0; row < height; row++)
        for (int column = 0; column < width; column++) {
            const size_t at = picture_index(&picture, column, row);
            /* through the pixel's middle: body y to the right seen from its back, so to the left seen from ahead */
            const double right_m = eye_m * (column + 0.5 - 0.5 * width) / focal_px;
            const double up_m = 1 - eye_m * (row + 0.5 - 0.5 * height) / focal_px;
            if (!(fabs(right_m) < half_y_m && up_m > 0 && up_m < 2 * half_z_m)) continue;
            CHECK(picture.entity[at] == 1);
            const double range_m = sqrt(eye_m * eye_m + right_m * right_m + (up_m - 1) * (up_m - 1));
            CHECK_NEAR((double)picture.range_m[at], range_m, 1e-4);
            const double want_k = blend_k(-right_m, -up_m), got_k = (double)picture.temp_k[at];
            const double want_lwir = (1 - (double)hand_rho_ir) * planck_band(8e-6, 12e-6, want_k, NULL);
            worst_k = fmax(worst_k, fabs(got_k - want_k));
            worst_lwir = fmax(worst_lwir, fabs((double)picture.lwir[at] / want_lwir - 1));
            hottest_k = fmax(hottest_k, got_k), coldest_k = fmin(coldest_k, got_k);
            on++;
            if (column > 0 && picture.entity[at - 1] == 1)
                step_k = fmax(step_k, fabs(got_k - (double)picture.temp_k[at - 1]));
            if (row > 0 && picture.entity[at - (size_t)picture.width] == 1)
                step_k = fmax(step_k, fabs(got_k - (double)picture.temp_k[at - (size_t)picture.width]));
        }
    print_message("%d pixels of 0.052 m: within %.4f K and %.1e of the blend; %.1f .. %.1f K, steps up to %.2f K\n", on,
                  worst_k, worst_lwir, coldest_k, hottest_k, step_k);
    CHECK(on > 4000);
    CHECK_NEAR(worst_k, 0, 5e-4);    /* floats of the hit's place and temperature */
    CHECK_NEAR(worst_lwir, 0, 1e-5); /* the table of Planck's law, as tests/render/test_planck.c has it */
    CHECK(hottest_k > 365 && coldest_k < 300);
    CHECK(step_k < 6); /* of 90: the steepest flank, 0.052 m of it; without a blend all 90 in one step */
}

/* A body at one temperature has no patches to be seen. */
static void a_constant_is_even(void **state)
{
    (void)state;
    const View    view = show();
    RenderRequest request = hand_request(&view);
    for (int i = 0; i < lengths; i++) warm_k[i] = 311.25f;
    request.bands = 1 << BAND_LWIR;
    const Picture picture = hand_render(&request, hand.pool);
    for (int i = 0; i < width * height; i++)
        if (picture.entity[i] == 1) CHECK(picture.temp_k[i] == 311.25f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(pixels_blend_patches), cmocka_unit_test(a_constant_is_even)};
    return cmocka_run_group_tests(tests, open_plate, hand_close);
}
