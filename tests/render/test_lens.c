/* A lens that distorts: its formula and the way back against long double and OpenCV's numbers, which lenses are
 * refused, culling that never loses anything, boxes, areas and solid angles. labels: physics slow */
#include "tests/check.h"

#include "tests/render/hand_world.h"

typedef long double Real;

static double draw(int index, int axis, double low, double high)
{
    return low + (high - low) * random_uniform(41, (uint32_t)axis, 0, (uint64_t)index);
}

/* cv2.projectPoints (opencv-python-headless 5.0.0) of (x, y, 1), camera matrix the identity, k1 k2 p1 p2 k3 =
 * -0.28, 0.09, 0.0011, -0.0023, -0.012. */
static void numbers_of_opencv(void **state)
{
    (void)state;
    static const double at[][4] = {{0, 0, 0, 0},
                                   {0.1, 0, 0.09965189880000001, 1.1000000000000003e-05},
                                   {0, -0.2, -9.200000000000001e-05, -0.19765664640000002},
                                   {0.3, 0.2, 0.2889473908, 0.19297392720000003},
                                   {-0.45, 0.35, -0.41516794062500006, 0.322684509375},
                                   {0.6, 0.5, 0.5135801367999999, 0.42982361399999996},
                                   {-0.6, -0.5, -0.5183781368, -0.430141614},
                                   {0.02, -0.47, 0.01831476155137672, -0.44211473145735286}};
    const double        k[3] = {-0.28, 0.09, -0.012}, p[2] = {0.0011, -0.0023}, half[2] = {0.6, 0.5};
    Lens                lens;
    assert_int_equal(view_lens_make(&lens, k, p, half), STATUS_OK);
    for (size_t i = 0; i < sizeof at / sizeof *at; i++) {
        double image[2], back[2];
        view_lens_image(image, &lens, at[i][0], at[i][1]);
        for (int c = 0; c < 2; c++) CHECK_NEAR(image[c], at[i][2 + c], 1e-14);
        view_lens_back(back, &lens, at[i][2], at[i][3]);
        for (int c = 0; c < 2; c++) CHECK_NEAR(back[c], at[i][c], 1e-12);
    }
}

/* A lens by lot, from a hair to 25 % at the corner. */
static bool draw_lens(Lens *lens, double half[2], int n)
{
    half[0] = exp(draw(n, 0, log(0.005), log(1.2)));
    half[1] = half[0] * draw(n, 1, 0.4, 1.3);
    const double r = hypot(half[0], half[1]), r2 = r * r, most = n % 3 == 0 ? 0.25 : n % 3 == 1 ? 0.05 : 0.002;
    const double k[3] = {draw(n, 2, -most, most) / r2, draw(n, 3, -most, most) / 3 / (r2 * r2),
                         draw(n, 4, -most, most) / 9 / (r2 * r2 * r2)};
    const double p[2] = {draw(n, 5, -most, most) / 9 / r, draw(n, 6, -most, most) / 9 / r};
    return view_lens_make(lens, k, p, half) == STATUS_OK;
}

static void there_and_back(void **state)
{
    (void)state;
    int good = 0;
    for (int n = 0; n < 60; n++) {
        Lens   lens;
        double half[2];
        if (!draw_lens(&lens, half, n)) continue;
        good++;
        for (int i = 0; i < 80; i++) {
            /* within the picture, and up to four times beyond, where the image runs straight on */
            const double far = i % 4 == 0 ? 4 : 1;
            const double x = far * half[0] * draw(n * 80 + i, 7, -1, 1), y = far * half[1] * draw(n * 80 + i, 8, -1, 1);
            double       at[2], image[2];
            view_lens_back(at, &lens, x, y);
            view_lens_image(image, &lens, at[0], at[1]);
            CHECK_NEAR(hypot(image[0] - x, image[1] - y), 0, far > 1 ? 1e-9 : 1e-12);
            /* what is beyond the picture stays out of it */
            const double out = 1.5 + i, u = at[0] * out, v = at[1] * out;
            if (hypot(u, v) < lens.reach) continue;
            view_lens_image(image, &lens, u, v);
            CHECK(fabs(image[0]) > half[0] || fabs(image[1]) > half[1]);
        }
    }
    CHECK(good > 45);
}

static void arrays_give_the_bits_of_single_points(void **state)
{
    (void)state;
    const double k[3] = {-0.28, 0.09, -0.012}, p[2] = {0.0011, -0.0023}, half[2] = {0.6, 0.5};
    Lens         lens;
    assert_int_equal(view_lens_make(&lens, k, p, half), STATUS_OK);
    for (int i = 0; i < 5000; i++) {
        const double x = draw(i, 0, -0.6, 0.6), y = draw(i, 1, -0.5, 0.5);
        double       quick[2], any[2];
        lens_back_within(quick, &lens, x, y);
        view_lens_back(any, &lens, x, y);
        assert_memory_equal(quick, any, sizeof quick);
    }
}

static void lenses_that_fold_are_refused(void **state)
{
    (void)state;
    const double p[2] = {0, 0}, half[2] = {0.5, 0.5};
    Lens         lens;
    /* r (1 - r2 k) turns back at r = sqrt(1 / 3k); the picture's corner, on the image, must lie below 2/3 of that */
    for (int n = 1; n < 60; n += 3) {
        const double k[3] = {-0.02 * n, 0, 0}, turn = sqrt(1 / (0.06 * n)), highest = 2.0 / 3 * turn;
        const bool   folds = lens_room * hypot(0.5, 0.5) > highest;
        const bool   clearly = lens_room * hypot(0.5, 0.5) < 0.9 * highest;
        const Status got = view_lens_make(&lens, k, p, half);
        if (folds) assert_int_equal(got, STATUS_BAD_VALUE);
        if (clearly) assert_int_equal(got, STATUS_OK);
    }
    assert_int_equal(view_lens_make(&lens, (const double[3]){NAN, 0, 0}, p, half), STATUS_BAD_VALUE);
    assert_int_equal(view_lens_make(&lens, (const double[3]){0, INFINITY, 0}, p, half), STATUS_BAD_VALUE);
    assert_int_equal(view_lens_make(&lens, (const double[3]){0, 0, 0}, (const double[2]){3, 0}, half),
                     STATUS_BAD_VALUE);
    /* none: a pinhole, to the bit */
    assert_int_equal(view_lens_make(&lens, (const double[3]){0, 0, 0}, p, half), STATUS_OK);
    CHECK(lens.reach == 0);
}

/* A block of the picture lies within its tangents, and the picture within its own. */
static void boxes_hold_what_is_in_them(void **state)
{
    (void)state;
    for (int n = 0; n < 30; n++) {
        Lens   lens;
        double half[2];
        if (!draw_lens(&lens, half, n)) continue;
        for (int b = 0; b < 20; b++) {
            const int    i = n * 20 + b;
            const double far = b % 5 == 0 ? 1.5 : 1, w = half[0] * draw(i, 0, 0.01, b % 7 ? 0.2 : 1);
            double       image[4] = {far * half[0] * draw(i, 1, -1, 1), far * half[1] * draw(i, 2, -1, 1)}, box[4];
            image[2] = image[0] + w, image[3] = image[1] + w;
            if (far == 1) image[2] = fmin(image[2], half[0]), image[3] = fmin(image[3], half[1]);
            view_lens_box(box, &lens, image);
            for (int k = 0; k < 64; k++) {
                double at[2];
                view_lens_back(at, &lens, image[0] + (image[2] - image[0]) * (k % 8) / 7,
                               image[1] + (image[3] - image[1]) * (k / 8) / 7);
                CHECK(at[0] >= box[0] && at[0] <= box[2] && at[1] >= box[1] && at[1] <= box[3]);
                if (far == 1) CHECK(fabs(at[0]) <= lens.tangent[0] && fabs(at[1]) <= lens.tangent[1]);
            }
        }
    }
}

/* ---- pictures ---------------------------------------------------------------------------------- */

static const double eye_enu[3] = {0, 0, 1000}, north[3] = {0, 1, 0};

static View distorted_view(int width, int height, double hfov_rad, double corner_share)
{
    View         view = hand_view(eye_enu, north, width, height, view_focal_px(width, hfov_rad));
    const double half[2] = {0.5 * width / view.focal_px, 0.5 * height / view.focal_px};
    const double r2 = half[0] * half[0] + half[1] * half[1], r = sqrt(r2);
    const double k[3] = {corner_share / r2, 0.2 * fabs(corner_share) / (r2 * r2), 0},
                 p[2] = {0.1 * corner_share / r, -0.07 * corner_share / r};
    assert_int_equal(view_lens_make(&view.lens, k, p, half), STATUS_OK);
    return view;
}

/* The solid angle of the picture: pixel by pixel from the renderer, and by Gauss's divergence of the undistorted
 * outline: the sum of spherical triangles from the boresight to 4 x 1000 points of it (Van Oosterom & Strackee, 1983).
 */
static void pixels_fill_the_picture_s_solid_angle(void **state)
{
    (void)state;
    for (int n = 0; n < 4; n++) {
        static const double share[4] = {-0.12, 0.08, -0.01, 0.2};
        const View          view = distorted_view(320, 240, n % 2 ? 0.9 : 0.1, share[n]);
        double              sum = 0;
        for (int y = 0; y < view.height; y++)
            for (int x = 0; x < view.width; x++) sum += view_pixel_share(&view, x, y);
        sum /= view.focal_px * view.focal_px;
        enum { side = 1000 };
        Real want = 0, before[3] = {0};
        for (int i = 0; i <= 4 * side; i++) {
            const double along = i % side / (double)side;
            const int    s = i / side % 4;
            const double column = view.width * (s == 0 ? along : s == 1 ? 1 : s == 2 ? 1 - along : 0);
            const double row = view.height * (s == 0 ? 0 : s == 1 ? along : s == 2 ? 1 : 1 - along);
            double       at[2];
            view_lens_back(at, &view.lens, (column - 0.5 * view.width) / view.focal_px,
                           (row - 0.5 * view.height) / view.focal_px);
            const Real length = sqrtl((Real)at[0] * at[0] + (Real)at[1] * at[1] + 1),
                       d[3] = {at[0] / length, at[1] / length, 1 / length};
            if (i > 0) {
                const Real triple = before[0] * d[1] - before[1] * d[0]; /* with (0, 0, 1) */
                const Real cosines = 1 + before[0] * d[0] + before[1] * d[1] + before[2] * d[2] + before[2] + d[2];
                want += 2 * atan2l(triple, cosines);
            }
            memcpy(before, d, sizeof before);
        }
        CHECK_NEAR(sum / (double)want, 1, 2e-5); /* the midpoint rule on 320 x 240 cells */
    }
}

/* In-band intensity of a ball, wherever it is in the picture: its own radiance by its disc. Small ones and large. */
static void a_ball_s_intensity_is_the_same_all_over(void **state)
{
    (void)state;
    const double up[3] = {0, 0, 1}, r_enu_from_body[9] = {0, 1, 0, 1, 0, 0, 0, 0, -1};
    View         view = distorted_view(320, 240, 0.5, -0.15);
    hand_air_off(up);
    for (int size = 0; size < 2; size++)
        for (int i = 0; i < 5; i++) {
            const double range_m = size ? 900 : 60;
            const double u = draw(i, 0, 0.1, 0.9) * view.width, v = draw(i, 1, 0.12, 0.88) * view.height;
            double       d_enu[3], p_enu[3], box_px[2], p_cam[3], off[3];
            view_ray(d_enu, &view, u, v);
            v3_add_scaled(p_enu, view.p_enu, range_m, d_enu);
            hand_clear();
            hand_add(hand_sphere_model, p_enu, r_enu_from_body);
            RenderRequest       request = hand_request(&view);
            const Picture       p = hand_render(&request, hand.pool);
            const TargetPixels *t = &p.target[0];
            const double        want = hand_emitted(BAND_LWIR) * pi_rad * hand_sphere_m * hand_sphere_m;
            const double        got = t->radiance[picture_lwir] / (view.focal_px * view.focal_px) * range_m * range_m;
            /* sampling, as of a pinhole: cells of a small one, edge pixels of a large one; the lens itself makes 30 %
             * of it */
            CHECK_NEAR(got / want, 1, size ? 0.01 : 0.003);
            /* the middle of its box is where the formula puts its middle: a sphere's image leans out by less than 0.1
             * px */
            v3_sub(off, p_enu, view.p_enu);
            m3_tmul_v3(p_cam, view.r_enu_from_cam, off);
            view_project(box_px, &view, p_cam);
            CHECK_NEAR(hypot(box_px[0] - u, box_px[1] - v), 0, 1e-8);
            if (size)
                for (int c = 0; c < 2; c++)
                    CHECK_NEAR(0.5 * (t->projected_box[c] + t->projected_box[c + 2]), box_px[c], 0.05);
            arena_reset(hand.arena);
        }
}

/* Many rays at once: each leads back to its place, and is the one asked for alone, to the bit. */
static void rays_of_a_row_are_those_of_its_points(void **state)
{
    (void)state;
    for (int n = 0; n < 2; n++) {
        enum { points = 37 };
        View   view = distorted_view(128, 96, 0.6, -0.15);
        double column_px[points], row_px[points], d[3][points];
        if (n == 0) view.lens = (Lens){0};
        for (int i = 0; i < points; i++)
            column_px[i] = draw(i, 4 + n, 0, view.width), row_px[i] = draw(i, 6 + n, 0, view.height);
        view_rays((double *const[3]){d[0], d[1], d[2]}, &view, points, column_px, row_px);
        for (int i = 0; i < points; i++) {
            const double d_enu[3] = {d[0][i], d[1][i], d[2][i]};
            double       alone[3], p_cam[3], at_px[2];
            view_ray(alone, &view, column_px[i], row_px[i]);
            assert_memory_equal(alone, d_enu, sizeof alone);
            m3_tmul_v3(p_cam, view.r_enu_from_cam, d_enu);
            view_project(at_px, &view, p_cam);
            CHECK_NEAR(v3_length(d_enu), 1, 1e-15);
            CHECK_NEAR(hypot(at_px[0] - column_px[i], at_px[1] - row_px[i]), 0, 1e-9);
        }
    }
}

/* All that is skipped changes nothing, with a lens as without: every block's list, the ground's walk, smoke. */
static void skips_change_nothing(void **state)
{
    (void)state;
    const double sun[3] = {0.3, -0.5, 0.81};
    const double r_enu_from_body[9] = {0, 1, 0, 1, 0, 0, 0, 0, -1};
    hand_air_on(sun, 1000);
    for (int n = 0; n < 2; n++) {
        View view = distorted_view(128, 96, 0.6, n == 0 ? -0.15 : 0.15);
        hand_clear();
        for (int i = 0; i < 24; i++) {
            double       d_enu[3], p_enu[3];
            const double range_m = exp(draw(i, 0, log(15), log(900)));
            view_ray(d_enu, &view, draw(40 * n + i, 1, -0.1, 1.1) * view.width,
                     draw(40 * n + i, 2, -0.1, 1.1) * view.height);
            v3_add_scaled(p_enu, view.p_enu, range_m, d_enu);
            hand_add(i % hand_models, p_enu, r_enu_from_body);
        }
        RenderRequest request = hand_request(&view);
        const Picture quick = hand_render(&request, hand.pool);
        request.skips_off = skips_all_off;
        const Picture plain = hand_render(&request, hand.pool);
        const size_t  octets = (size_t)view.width * (size_t)view.height * sizeof(float);
        int           seen = 0;
        for (int k = 0; k < picture_plane_count; k++)
            if (picture_plane(&quick, k))
                assert_memory_equal(picture_plane(&quick, k), picture_plane(&plain, k), octets);
        assert_memory_equal(quick.entity, plain.entity, octets);
        assert_memory_equal(quick.range_m, plain.range_m, octets);
        for (int i = 0; i < 24; i++) seen += quick.target[i].visible > 0;
        CHECK(seen > 10);
        arena_reset(hand.arena);
    }
}

/* A lens of nothing is a pinhole to the bit; colours that part by nothing, too; and green does not move. */
static void no_distortion_is_a_pinhole(void **state)
{
    (void)state;
    const double sun[3] = {0.3, -0.5, 0.81}, r_enu_from_body[9] = {0, 1, 0, 1, 0, 0, 0, 0, -1};
    const double at[3] = {3, 60, 1001};
    hand_air_on(sun, 1000);
    hand_clear();
    hand_add(hand_sphere_model, at, r_enu_from_body);
    View          view = hand_view(eye_enu, north, 96, 64, 400);
    RenderRequest request = hand_request(&view);
    request.optical = OPTICAL_RGB;
    const Picture plain = hand_render(&request, hand.pool);
    request.lateral[0] = 0.01;
    const Picture parted = hand_render(&request, hand.pool);
    const size_t  octets = 96 * 64 * sizeof(float);
    assert_memory_equal(plain.optical[1], parted.optical[1], octets);
    assert_memory_equal(plain.optical[2], parted.optical[2], octets);
    CHECK(memcmp(plain.optical[0], parted.optical[0], octets) != 0);
    assert_memory_equal(plain.entity, parted.entity, octets);
    CHECK(plain.target[0].radiance[picture_optical] == parted.target[0].radiance[picture_optical]);
    request.lateral[0] = 0.03;
    Picture none;
    assert_int_equal(render(&none, &hand.world, &hand.snapshot, &request, &hand.air, hand.pool, hand.arena),
                     STATUS_BAD_VALUE);
    arena_reset(hand.arena);
}

static int open_world(void **state)
{
    (void)state;
    return hand_open(true);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_of_opencv),
        cmocka_unit_test(there_and_back),
        cmocka_unit_test(arrays_give_the_bits_of_single_points),
        cmocka_unit_test(lenses_that_fold_are_refused),
        cmocka_unit_test(boxes_hold_what_is_in_them),
        cmocka_unit_test(pixels_fill_the_picture_s_solid_angle),
        cmocka_unit_test(a_ball_s_intensity_is_the_same_all_over),
        cmocka_unit_test(rays_of_a_row_are_those_of_its_points),
        cmocka_unit_test(skips_change_nothing),
        cmocka_unit_test(no_distortion_is_a_pinhole),
    };
    return cmocka_run_group_tests(tests, open_world, hand_close);
}
