/* Adaptive antialiasing against the picture that has all the rays everywhere: the same bits where it refined, close
 * elsewhere, few rays on bare ground, and the same picture whatever else was asked for; by how many threads:
 * test_antialias_threads.c. labels: slow */
#include "tests/render/strewn_world.h"

#include "terrain/ground/landscape.h"

/* No band's bits hang on what other bands were asked for: shadows show in two of them only. */
static void a_band_alone_is_the_band_in_company(void **state)
{
    (void)state;
    const View    view = strew(30, 160, 120);
    RenderRequest request = request_of(&view);
    arena_reset(hand.arena);
    const Picture all = hand_render(&request, hand.pool);
    for (int b = 0; b < BAND_COUNT; b++) {
        request.bands = 1u << b;
        const Picture alone = hand_render(&request, hand.pool);
        const size_t  n = (size_t)(view.width * view.height);
        for (int plane = 0; plane < picture_plane_count; plane++)
            if (picture_plane(&alone, plane))
                assert_memory_equal(picture_plane(&all, plane), picture_plane(&alone, plane), n * sizeof(float));
    }
    /* and truth may be left out */
    request.bands = 15;
    request.truth = false;
    const Picture untold = hand_render(&request, hand.pool);
    CHECK(!untold.entity && !untold.range_m && !untold.target);
    assert_memory_equal(all.lwir, untold.lwir, (size_t)(view.width * view.height) * sizeof(float));
    assert_memory_equal(all.radar, untold.radar, (size_t)(view.width * view.height) * sizeof(float));
}

/* Bodies only, no small targets: the refined pixels are those of the picture with 4 x 4 everywhere, to the bit. */
static void refined_pixels_are_those_of_the_full_picture(void **state)
{
    (void)state;
    const View    view = strew(60, 240, 160);
    RenderRequest request = request_of(&view);
    request.target_samples = 0;
    arena_reset(hand.arena);
    const Picture adaptive = hand_render(&request, hand.pool);
    request.edge_samples = 0;
    const Picture plain = hand_render(&request, hand.pool);
    request.samples = 4;
    const Picture full = hand_render(&request, hand.pool);
    request.samples = 2;
    const Picture half = hand_render(&request, hand.pool);
    int           of_full = 0, of_half = 0, of_ground = 0, kept = 0, at_edge = 0, edges = 0;
    for (int y = 0; y < view.height; y++)
        for (int x = 0; x < view.width; x++) {
            const int i = y * view.width + x;
            /* radar: no ground is spread for it */
            if (adaptive.radar[i] == full.radar[i] && adaptive.lwir[i] == full.lwir[i]) of_full++;
            else if (adaptive.radar[i] == half.radar[i] && adaptive.lwir[i] == half.lwir[i]) of_half++;
            else if (adaptive.radar[i] == plain.radar[i] && adaptive.lwir[i] == plain.lwir[i]) kept++;
            else if (!adaptive.entity[i]) of_ground++; /* by kinds of ground; see the test of these below */
            else fail_msg("pixel %d, %d is neither as it was nor refined", x, y);
            /* every pixel where an entity begins or ends is refined */
            for (int k = 0; k < 4; k++) {
                const int xb = x + (k == 0) - (k == 1), yb = y + (k == 2) - (k == 3);
                if (xb < 0 || yb < 0 || xb >= view.width || yb >= view.height ||
                    plain.entity[i] == plain.entity[yb * view.width + xb])
                    continue;
                edges++;
                at_edge += adaptive.lwir[i] == full.lwir[i] && adaptive.optical[0][i] == full.optical[0][i];
            }
        }
    print_message("of %d pixels: %d as with 4 x 4, %d as with 2 x 2, %d spread ground, %d as they were\n",
                  view.width * view.height, of_full, of_half, of_ground, kept);
    print_message("%d of %d at edges of entities\n", at_edge, edges);
    CHECK(edges > 300 && at_edge == edges);
    CHECK(of_ground > 100);
    /* the full picture and the adaptive one say the same of a target that lies in its refined box */
    int compared = 0;
    for (int i = 0; i < hand.snapshot.count; i++) {
        const double *box = adaptive.target[i].projected_box;
        if (!adaptive.target[i].projected || fmax(box[2] - box[0], box[3] - box[1]) > 60 || box[0] < 1 || box[1] < 1 ||
            box[2] > view.width - 1 || box[3] > view.height - 1)
            continue;
        CHECK_NEAR(adaptive.target[i].visible, full.target[i].visible, 1e-9);
        CHECK_NEAR(adaptive.target[i].amodal, full.target[i].amodal, 1e-9);
        compared += full.target[i].visible > 0;
    }
    CHECK(compared > 5);
}

static double rms(const Picture *a, const Picture *b, int plane, double *most)
{
    double    sum = 0;
    const int n = a->width * a->height;
    *most = 0;
    for (int i = 0; i < n; i++) {
        const double e = picture_plane(a, plane)[i] - picture_plane(b, plane)[i];
        sum += e * e;
        *most = fmax(*most, fabs(e));
    }
    return sqrt(sum / n);
}

/* What the saving costs: rms against 8 x 8 rays everywhere, of one ray, of the adaptive picture, of 4 x 4. */
static void the_error_and_its_price(void **state)
{
    (void)state;
    const View    view = strew(40, 160, 120);
    RenderRequest request = request_of(&view);
    arena_reset(hand.arena);
    const Picture adaptive = hand_render(&request, hand.pool);
    request.edge_samples = request.target_samples = 0;
    const Picture plain = hand_render(&request, hand.pool);
    request.samples = 4;
    const Picture full = hand_render(&request, hand.pool);
    request.samples = 8;
    const Picture    best = hand_render(&request, hand.pool);
    static const int planes[] = {picture_optical, picture_mwir, picture_lwir};
    const double     pixels = view.width * view.height;
    print_message("rays a pixel: 1, %.2f adaptive, 16\n", (double)adaptive.counters.rays_primary / pixels);
    for (int k = 0; k < 3; k++) {
        double       most[3];
        const double before = rms(&plain, &best, planes[k], &most[0]),
                     after = rms(&adaptive, &best, planes[k], &most[1]);
        const double all = rms(&full, &best, planes[k], &most[2]);
        print_message("plane %d: rms off 8 x 8: %.4f with 1, %.4f adaptive, %.4f with 16; most %.3f %.3f %.3f\n",
                      planes[k], before, after, all, most[0], most[1], most[2]);
        /* the bound of this priced skip: no more than half of the error is left (a third, as measured) */
        CHECK(after < 0.5 * before);
    }
}

/* Borders between kinds of ground (grass is 10 K colder than a track) under an eye that moves by a third of a pixel a
 * frame: apparent temperature against 8 x 8 rays, and how much that error changes from frame to frame, which is what
 * flickers. With four samples on such a pixel the first was 0.59 K and the second 0.48 K. Without the ground's noise:
 * of what is finer than a pixel one ray shows the statistics, not the mean of this place
 * (tests/render/test_ground_detail.c). */
static void borders_of_kinds_of_ground_do_not_flicker(void **state)
{
    (void)state;
    enum { frames = 4, width = 96, height = 64 };
    static const double per_k = 0.6; /* W/(m2 sr) a kelvin, 8-12 um at 295 K: 0.60 (Planck) */
    static float        error[frames][width * height];
    static bool         border[width * height];
    DetailTable        *detail = hand.world.detail;
    hand.world.detail = NULL;
    hand_air_on(sun_enu, 40);
    hand_clear();
    for (int k = 0; k < frames; k++) {
        const double  ahead[3] = {0.8, 0.1, -0.6}, x_m = -400 + 0.7 * k;
        const double  eye_enu[3] = {x_m, 60, ground_at(-400, 60) + 300};
        const View    view = hand_view(eye_enu, ahead, width, height, 150);
        RenderRequest request = hand_request(&view);
        request.bands = 1 << BAND_LWIR;
        arena_reset(hand.arena);
        const Picture adaptive = hand_render(&request, hand.pool);
        request.edge_samples = request.target_samples = 0;
        request.samples = 8;
        const Picture best = hand_render(&request, hand.pool);
        for (int i = 0; i < width * height; i++) {
            error[k][i] = (adaptive.lwir[i] - best.lwir[i]) / (float)per_k;
            border[i] |= i % width > 0 && adaptive.material[i] != adaptive.material[i - 1];
        }
    }
    double square = 0, change = 0;
    int    count = 0;
    for (int i = 0; i < width * height; i++) {
        if (!border[i]) continue;
        count++;
        for (int k = 0; k < frames; k++) square += error[k][i] * error[k][i] / frames;
        for (int k = 1; k < frames; k++)
            change += (error[k][i] - error[k - 1][i]) * (error[k][i] - error[k - 1][i]) / (2.0 * (frames - 1));
    }
    print_message("%d pixels at borders: rms %.3f K off 8 x 8 rays, %.3f K from frame to frame\n", count,
                  sqrt(square / count), sqrt(change / count));
    hand.world.detail = detail;
    CHECK(count > 100);
    CHECK(sqrt(square / count) < 0.2 && sqrt(change / count) < 0.2);
}

/* Whether a road, lane, track or stream is met within a pixel, on the plane of the ground there. */
static bool way_within(const Picture *p, const View *view, int x, int y)
{
    enum { fine = 8 };
    const int    i = y * view->width + x;
    const double n[3] = {(double)p->normal[0][i], (double)p->normal[1][i], (double)p->normal[2][i]};
    double       centre[3];
    view_ray(centre, view, x + 0.5, y + 0.5);
    for (int k = 0; k < fine * fine; k++) {
        double   d[3];
        WayPlace way;
        view_ray(d, view, x + (k % fine + 0.5) / fine, y + (k / fine + 0.5) / fine);
        const double range_m = (double)p->range_m[i] * v3_dot(n, centre) / v3_dot(n, d);
        if (landscape_way(&way, &hand.landscape, view->p_enu[0] + range_m * d[0], view->p_enu[1] + range_m * d[1]) &&
            fabs(way.across_m) <= way.half_m)
            return true;
    }
    return false;
}

/* Roads and tracks of 3 to 6 m about a village, of half a pixel to several: those pixels against 8 x 8 rays, straight
 * down and aslant. One ray a pixel shows them as dashes: errors of 15 to 35 % of the light. */
static void ways_narrower_than_a_pixel_keep_their_light(void **state)
{
    (void)state;
    enum { width = 64, height = 48 };
    static const double pixel_m[] = {2, 8}, down[2][3] = {{0.001, 0, -1}, {1, 0.1, -0.15}};
    DetailTable        *detail = hand.world.detail;
    double              village[2];
    hand.world.detail = NULL;
    hand_clear();
    CHECK(landscape_village(village, &hand.landscape, 0));
    for (int k = 0; k < 4; k++) {
        double d[3] = {0, 0, -1}, eye_enu[3] = {village[0], village[1], ground_at(village[0], village[1])};
        v3_normalize(d, down[k / 2]);
        v3_add_scaled(eye_enu, eye_enu, -pixel_m[k % 2] * 400, d);
        hand_air_on(sun_enu, 300);
        const View    view = hand_view(eye_enu, d, width, height, 400);
        RenderRequest request = hand_request(&view);
        request.bands = 1 << BAND_OPTICAL;
        arena_reset(hand.arena);
        const Picture adaptive = hand_render(&request, hand.pool);
        request.edge_samples = request.target_samples = 0;
        const Picture one = hand_render(&request, hand.pool);
        request.samples = 8;
        const Picture best = hand_render(&request, hand.pool);
        double        sum = 0, off = 0, square = 0, square_one = 0;
        int           count = 0;
        for (int i = 0; i < width * height; i++) {
            if (!(adaptive.range_m[i] < INFINITY) || !way_within(&adaptive, &view, i % width, i / width)) continue;
            const double want = (double)best.optical[0][i], is = (double)adaptive.optical[0][i] - want,
                         was = (double)one.optical[0][i] - want;
            sum += want, off += is, square += is * is, square_one += was * was, count++;
        }
        const double mean = sum / count, rms = sqrt(square / count) / mean, rms_one = sqrt(square_one / count) / mean;
        print_message("ways, pixels of %g m, %s: %d pixels, mean off by %+.2f %%, rms %.1f %% (one ray: %.1f %%)\n",
                      pixel_m[k % 2], k < 2 ? "straight down" : "aslant", count, 100 * off / sum, 100 * rms,
                      100 * rms_one);
        CHECK(count > 100 && rms_one > 0.08);
        CHECK(fabs(off / sum) < 0.01 && rms < 0.25 * rms_one);
    }
    hand.world.detail = detail;
}

/* Ground and sky alone, to the horizon: less than a tenth more rays. */
static void bare_ground_stays_cheap(void **state)
{
    (void)state;
    const View          view = strew(0, 240, 160);
    const RenderRequest request = request_of(&view);
    arena_reset(hand.arena);
    const Picture picture = hand_render(&request, hand.pool);
    const double  ratio = (double)picture.counters.rays_primary / (double)picture.counters.pixels;
    print_message("bare ground: %.3f rays a pixel, %.1f %% of pixels refined\n", ratio,
                  100 * (double)picture.counters.pixels_refined / (double)picture.counters.pixels);
    CHECK(ratio < 1.1 && picture.counters.pixels_refined > picture.counters.pixels / 50);
}

/* A mast of 6 cm, a sixth of a pixel, at every place between two columns: no row of it is lost. */
static void a_mast_between_the_pixels_is_seen(void **state)
{
    (void)state;
    const double  eye_enu[3] = {0, 0, 3000}, ahead[3] = {1, 0, 0};
    const View    view = hand_view(eye_enu, ahead, 64, 64, 500);
    RenderRequest request = hand_request(&view);
    double        r[9], worst = 0;
    hand_air_off(sun_enu);
    hand_attitude(r, 0, 0);
    request.target_samples = 0; /* by its box alone */
    int missed = 0;
    for (int k = 0; k < 40; k++) {
        const double p_enu[3] = {180, -k / 40.0 * 180 / 500, 3000 - 4};
        hand_clear();
        hand_add(hand_mast_model, p_enu, r);
        arena_reset(hand.arena);
        RenderRequest one = request;
        one.edge_samples = 0;
        const Picture picture = hand_render(&request, hand.pool), plain = hand_render(&one, hand.pool);
        double        area = 0, by_one = 0;
        for (int i = 0; i < 64 * 64; i++) area += picture.lwir[i] > 0, by_one += plain.lwir[i] > 0;
        CHECK(area >= 20); /* 22 rows, the ends by parts */
        missed += by_one == 0;
        const double want = 0.06 * 8 * 500 * 500 / (180.0 * 180.0);
        worst =
            fmax(worst,
                 fabs(hand_irradiance(&picture, &view, picture_lwir, 0) * 250000 / hand_emitted(BAND_LWIR) / want - 1));
    }
    print_message("mast: area off by up to %.1f %%; one ray a pixel misses it at %d of 40 places\n", 100 * worst,
                  missed);
    CHECK(missed > 20);
    CHECK(worst < 0.5); /* one of sixteen columns of samples more or less, of 2.7: 37 %; and its nearer face is wider */
}

/* The same mast, half a pixel wide, of a target too large to be refined as a whole: upright, and leaning so that it
 * crosses columns. Its light is that of its area on paper, row by row; one ray a pixel loses it or doubles it. */
static void a_thin_piece_of_a_large_target_is_no_dashes(void **state)
{
    (void)state;
    enum { side = 96 };
    static const double range_m = 180, focal_px = 1520, lean_rad[] = {0, 0.3, 0.7};
    const double        eye_enu[3] = {0, 0, 3000}, ahead[3] = {1, 0, 0};
    const View          view = hand_view(eye_enu, ahead, side, side, focal_px);
    RenderRequest       request = hand_request(&view);
    hand_air_off(sun_enu);
    request.target_samples = 0;
    for (int l = 0; l < 3; l++) {
        const double c = cos(lean_rad[l]), s = sin(lean_rad[l]);
        const double r[9] = {1,  0, 0, 0, -c,
                             -s, 0, s, -c}; /* forward east, right southward, down; leaning about the sight */
        double       worst = 0, worst_row = 0, by_one = 0;
        for (int k = 0; k < 20; k++) {
            /* its middle before the eye */
            const double across_m = k / 20.0 * range_m / focal_px, p_enu[3] = {range_m, across_m - 4 * s, 3000 - 4 * c};
            hand_clear();
            hand_add(hand_mast_model, p_enu, r);
            arena_reset(hand.arena);
            const Picture picture = hand_render(&request, hand.pool);
            RenderRequest one = request;
            one.edge_samples = 0;
            const Picture plain = hand_render(&one, hand.pool);
            const double  row_px = 0.06 / c * focal_px / (range_m - 0.03); /* its nearer face */
            double        sum = 0;
            for (int y = side / 2 - 20; y < side / 2 + 20; y++) {
                double row = 0, row_one = 0;
                for (int x = 0; x < side; x++) {
                    row += (double)picture.lwir[y * side + x] / hand_emitted(BAND_LWIR);
                    row_one += (double)plain.lwir[y * side + x] / hand_emitted(BAND_LWIR);
                }
                sum += row / row_px / 40;
                worst_row = fmax(worst_row, fabs(row - row_px));
                by_one = fmax(by_one, fabs(row_one - row_px));
            }
            worst = fmax(worst, fabs(sum - 1));
        }
        print_message(
            "mast of half a pixel, leaning %.1f: rows off by up to %.2f px (one ray: %.2f), all of it by %.1f %%\n",
            lean_rad[l], worst_row, by_one, 100 * worst);
        /* four columns of samples a pixel: a row is right to one of them, a leaning mast's mean better */
        CHECK(worst_row <= 0.25 && by_one > 0.4);
        CHECK(worst < (l ? 0.05 : 0.5));
    }
}

/* An edge that moves over a pixel is met in as many steps as render_places says, all of a size: what the detector's
 * footprint takes for granted. A plate of 24 px before a dark sky, moved a pixel in 64 steps that fall on no sample. */
static void an_edge_has_its_places(void **state)
{
    (void)state;
    enum { steps = 64, side = 40 };
    static const int samples_of[4] = {1, 2, 4, 1}, edge_of[4] = {0, 0, 0, 4};
    const double     eye_enu[3] = {0, 0, ground_at(0, 0) + 300}, up[3] = {1, 0, 1}, range_m = 20;
    const View       view = hand_view(eye_enu, up, side, side, 240);
    hand_air_off(sun_enu);
    for (int k = 0; k < 4; k++) {
        const int     places = render_places(samples_of[k], edge_of[k]);
        RenderRequest request = hand_request(&view);
        double        last = NAN;
        int           jumps = 0;
        request.samples = samples_of[k];
        request.edge_samples = edge_of[k];
        request.target_samples = 0;
        for (int n = 0; n <= steps; n++) {
            /* columns lie along the south; the plate's left edge runs through pixel 8, its right one off the sum */
            const double edge_px = 8 + (n + 0.5) / steps, aside_m = (edge_px + 12 - 0.5 * side) / 240 * range_m;
            double       p_enu[3], r[9], row = 0;
            for (int i = 0; i < 3; i++)
                p_enu[i] = eye_enu[i] + range_m * view.r_enu_from_cam[3 * i + 2] +
                           aside_m * view.r_enu_from_cam[3 * i] + 1.0 * view.r_enu_from_cam[3 * i + 1];
            for (int i = 0; i < 3; i++) { /* faces the eye: forward against the boresight, right to its left, down */
                r[3 * i] = -view.r_enu_from_cam[3 * i + 2];
                r[3 * i + 1] = -view.r_enu_from_cam[3 * i];
                r[3 * i + 2] = view.r_enu_from_cam[3 * i + 1];
            }
            hand_clear();
            hand_add(hand_plate_model, p_enu, r);
            arena_reset(hand.arena);
            const Picture picture = hand_render(&request, hand.pool);
            for (int x = 0; x < side / 2; x++) row += picture.lwir[side / 2 * side + x] / hand_emitted(BAND_LWIR);
            CHECK_NEAR(row, 20 - edge_px, 0.5 / places + 1e-5); /* half a step; floats */
            if (n > 0) {
                const double fell = (last - row) * places;
                CHECK(fabs(fell - rint(fell)) < 1e-3); /* 24 px of floats */
                jumps += (int)lrint(fell);
            }
            last = row;
        }
        CHECK(jumps == places);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_band_alone_is_the_band_in_company),
        cmocka_unit_test(refined_pixels_are_those_of_the_full_picture),
        cmocka_unit_test(the_error_and_its_price),
        cmocka_unit_test(borders_of_kinds_of_ground_do_not_flicker),
        cmocka_unit_test(ways_narrower_than_a_pixel_keep_their_light),
        cmocka_unit_test(bare_ground_stays_cheap),
        cmocka_unit_test(a_mast_between_the_pixels_is_seen),
        cmocka_unit_test(a_thin_piece_of_a_large_target_is_no_dashes),
        cmocka_unit_test(an_edge_has_its_places),
    };
    thread_flush_denormals();
    return cmocka_run_group_tests(tests, open_world, hand_close);
}
