/* In-band intensity of a target that fills the picture, or a hundredth of a pixel: against closed forms, wherever the
 * pixels fall. No air: a plate of radiance L and area A sends L A cos(tilt); a Lambertian sphere under the sun
 * rho E a^2 (2 / 3 pi) (sin p + (pi - p) cos p) at phase angle p; one that glows by itself L pi a^2. labels: slow */
#include "tests/render/hand_world.h"

static const double eye_enu[3] = {0, 0, 3000};
static const double sun_enu[3] = {-0.6, 0, 0.8};
enum { side_px = 96, shifts = 50 };

static int open_world(void **state)
{
    (void)state;
    return hand_open(false);
}

/* Looking east, with 90 px across 2 m at 50 m. */
static View east(void) { return hand_view(eye_enu, (const double[3]){1, 0, 0}, side_px, side_px, 2250); }

/* The place whose image is this far, in pixels, from the middle of the picture. */
static void place_at(double p_enu[3], const View *view, double range_m, double right_px, double down_px)
{
    p_enu[0] = eye_enu[0] + range_m;
    p_enu[1] = eye_enu[1] - right_px / view->focal_px * range_m;
    p_enu[2] = eye_enu[2] - down_px / view->focal_px * range_m;
}

typedef struct Worst {
    double picture, truth, flicker; /* shares: off the answer, by picture and truth; about the mean of all shifts */
} Worst;

static double relative(double got, double want) { return fabs(got / want - 1); }

/* A target at range_m over 50 shifts of up to a pixel; want: its intensity in each plane, W/sr. */
static void shoot(Worst worst[picture_plane_count], int model, const double r[9], double middle_m, double range_m,
                  const double want[picture_plane_count], int target_samples)
{
    const View    view = east();
    RenderRequest request = hand_request(&view);
    double        seen[picture_plane_count][shifts];
    request.target_samples = target_samples;
    if (target_samples == 0) request.edge_samples = 0;
    for (int k = 0; k < shifts; k++) {
        double       p_enu[3], offset[3];
        const double centre_body[3] = {0, 0, -middle_m};
        /* near, a shift is small against the picture: held so that the target stays inside */
        place_at(p_enu, &view, range_m, random_uniform(7, 0, 0, (uint64_t)k) - 0.5,
                 random_uniform(7, 1, 0, (uint64_t)k) - 0.5);
        m3_mul_v3(offset, r, centre_body);
        v3_sub(p_enu, p_enu, offset);
        hand_clear();
        hand_add(model, p_enu, r);
        arena_reset(hand.arena);
        const Picture picture = hand_render(&request, hand.pool);
        for (int plane = 0; plane < picture_plane_count; plane++) {
            if (!(want[plane] > 0)) continue;
            const double in_picture = hand_irradiance(&picture, &view, plane, 0) * range_m * range_m;
            const double in_truth =
                picture.target[0].radiance[plane] / (view.focal_px * view.focal_px) * range_m * range_m;
            worst[plane].picture = fmax(worst[plane].picture, relative(in_picture, want[plane]));
            worst[plane].truth = fmax(worst[plane].truth, relative(in_truth, want[plane]));
            seen[plane][k] = in_picture;
        }
        CHECK_NEAR(picture.target[0].visible, picture.target[0].amodal, 1e-9);
    }
    for (int plane = 0; plane < picture_plane_count; plane++) {
        double mean = 0;
        if (!(want[plane] > 0)) continue;
        for (int k = 0; k < shifts; k++) mean += seen[plane][k] / shifts;
        for (int k = 0; k < shifts; k++)
            worst[plane].flicker = fmax(worst[plane].flicker, relative(seen[plane][k], mean));
    }
}

static const double ranges_m[] = {50, 90, 160, 280, 300, 420, 700, 1300, 2500, 5000, 10000, 20000, 45000};
enum { range_count = sizeof ranges_m / sizeof *ranges_m };

static void check(const char *what, double range_m, const Worst worst[picture_plane_count],
                  const double want[picture_plane_count])
{
    Worst most = {0};
    for (int plane = 0; plane < picture_plane_count; plane++) {
        if (!(want[plane] > 0)) continue;
        most.picture = fmax(most.picture, worst[plane].picture);
        most.truth = fmax(most.truth, worst[plane].truth);
        most.flicker = fmax(most.flicker, worst[plane].flicker);
    }
    print_message("%s at %6.0f m, %8.3f px across: off by %.2f %% (truth %.2f %%), flicker %.2f %%\n", what, range_m,
                  2 * 2250 / range_m, 100 * most.picture, 100 * most.truth, 100 * most.flicker);
    /* 2 %: what an automatic target recogniser is promised (the sampling error of the frame's budget) */
    CHECK(most.picture <= 0.02);
    CHECK(most.truth <= 0.02);
    CHECK(most.flicker <= 0.02);
}

static void a_plate_keeps_its_intensity(void **state)
{
    (void)state;
    hand_air_off(sun_enu);
    /* faces the eye but for 40 degrees; its axes lie along the pixels, which is the hardest for a grid */
    const double turn = 40 * rad_per_deg, area_m2 = 4 * hand_plate_y_m * hand_plate_z_m * cos(turn);
    double       r[9], n_enu[3];
    hand_attitude(r, pi_rad + turn, 0);
    for (int k = 0; k < 3; k++) n_enu[k] = r[3 * k];
    double want[picture_plane_count] = {0};
    want[picture_optical] =
        hand_rho * hand.air.light.sun_w_m2[optical_channel_pan] * v3_dot(n_enu, sun_enu) / pi_rad * area_m2;
    want[picture_mwir] = hand_emitted(BAND_MWIR) * area_m2;
    want[picture_lwir] = hand_emitted(BAND_LWIR) * area_m2;
    for (int k = 0; k < range_count; k++) {
        Worst worst[picture_plane_count] = {0};
        shoot(worst, hand_plate_model, r, hand_plate_z_m, ranges_m[k], want, 48);
        check("plate", ranges_m[k], worst, want);
    }
}

/* rho E / pi n.s over all of the sphere that both sun and an eye at range_m see, times range^2 at the eye. */
static double sunlit_sphere(double range_m, const double towards_sun[3])
{
    enum { steps = 600 };
    double sum = 0;
    for (int i = 0; i < steps; i++)
        for (int k = 0; k < 2 * steps; k++) {
            const double up = -1 + (i + 0.5) * 2 / steps, around = (k + 0.5) * pi_rad / steps;
            const double n[3] = {sqrt(1 - up * up) * cos(around), sqrt(1 - up * up) * sin(around), up};
            const double eye[3] = {-range_m - hand_sphere_m * n[0], -hand_sphere_m * n[1], -hand_sphere_m * n[2]};
            const double lit = v3_dot(n, towards_sun), seen = v3_dot(n, eye);
            if (lit > 0 && seen > 0) sum += lit * seen / pow(v3_length(eye), 3);
        }
    return hand_rho / pi_rad * hand.air.light.sun_w_m2[optical_channel_pan] * sum * hand_sphere_m * hand_sphere_m * 2 *
           pi_rad / ((double)steps * steps) * range_m * range_m;
}

static void a_sphere_keeps_its_intensity(void **state)
{
    (void)state;
    for (int phase_deg = 20; phase_deg <= 110; phase_deg += 45) {
        /* the eye is west of it; the sun is turned from there to the north and a little up */
        const double p = phase_deg * rad_per_deg, sun[3] = {-cos(p), sin(p) * 0.8, sin(p) * 0.6};
        double       r[9], want[picture_plane_count] = {0};
        hand_air_off(sun);
        hand_attitude(r, 0.3, 0.2);
        const double from_afar = hand_rho * hand.air.light.sun_w_m2[optical_channel_pan] * hand_sphere_m *
                                 hand_sphere_m * 2 / (3 * pi_rad) * (sin(p) + (pi_rad - p) * cos(p));
        CHECK_NEAR(sunlit_sphere(1e5, sun) / from_afar, 1, 1e-3); /* 600 steps of the sum, and 1e-5 of nearness */
        want[picture_mwir] = hand_emitted(BAND_MWIR) * pi_rad * hand_sphere_m * hand_sphere_m;
        want[picture_lwir] = hand_emitted(BAND_LWIR) * pi_rad * hand_sphere_m * hand_sphere_m;
        for (int k = 0; k < range_count; k += 2) {
            Worst worst[picture_plane_count] = {0};
            want[picture_optical] =
                sunlit_sphere(ranges_m[k], sun); /* 3 % less than from afar at 50 m and 110 degrees */
            shoot(worst, hand_sphere_model, r, 0, ranges_m[k], want, 48);
            check("sphere", ranges_m[k], worst, want);
        }
    }
}

/* The twin: with one ray a pixel and no footprint the same target is there or is not. */
static void without_footprints_it_flickers(void **state)
{
    (void)state;
    double r[9], want[picture_plane_count] = {0};
    Worst  worst[picture_plane_count] = {0};
    hand_air_off(sun_enu);
    hand_attitude(r, 0.3, 0.2);
    want[picture_lwir] = hand_emitted(BAND_LWIR) * pi_rad * hand_sphere_m * hand_sphere_m;
    shoot(worst, hand_sphere_model, r, 0, 10000, want, 0);
    CHECK(worst[picture_lwir].flicker > 0.9 && worst[picture_lwir].truth > 0.9);
}

/* Sky of an even radiance behind: the picture holds what the target hides of it, and no more. */
static void the_background_gives_way_by_as_much(void **state)
{
    (void)state;
    const View view = east();
    double     r[9], p_enu[3];
    hand_air_off(sun_enu);
    for (int i = 0; i <= air_sky_ups; i++) hand.air.sky_eye[AIR_LWIR].thermal_w_m2_sr[i] = 12;
    hand_attitude(r, pi_rad, 0);
    place_at(p_enu, &view, 8000, 0.31, 0.77);
    hand_clear();
    hand_add(hand_plate_model, p_enu, r);
    arena_reset(hand.arena);
    const RenderRequest request = hand_request(&view);
    const Picture       picture = hand_render(&request, hand.pool);
    const double        want = (hand_emitted(BAND_LWIR) - 12) * 4 * hand_plate_y_m * hand_plate_z_m / (8000.0 * 8000.0);
    /* float pixels about 12: 1e-6 of it in each of 9216, of a sum of some 0.4 px of 20 */
    CHECK_NEAR(hand_irradiance(&picture, &view, picture_lwir, 12) / want, 1, 0.005);
}

/* Two behind each other, one half behind a large wall, one half out of the picture: areas by geometry. */
static void overlap_occlusion_and_the_picture_s_edge(void **state)
{
    (void)state;
    const View          view = east();
    const RenderRequest request = hand_request(&view);
    double              r[9], p_enu[3];
    hand_air_off(sun_enu);
    hand_attitude(r, pi_rad, 0);

    /* the nearer plate covers the right half of the farther, both about 0.9 px: the same size on the image */
    const double px_m = 4000 / view.focal_px, size_px = 2 / px_m;
    hand_clear();
    place_at(p_enu, &view, 4000, 3.3, -5.4);
    hand_add(hand_plate_model, p_enu, r);
    place_at(p_enu, &view, 3999, 3.3 + 0.5 * size_px, -5.4);
    hand_add(hand_plate_model, p_enu, r);
    arena_reset(hand.arena);
    Picture             picture = hand_render(&request, hand.pool);
    const TargetPixels *t = picture.target;
    CHECK(t[0].small && t[1].small);
    CHECK_NEAR(t[0].visible / t[0].amodal, 0.5, 0.01); /* the half falls on a column of cells or beside it: 1 / 64 */
    CHECK_NEAR(t[1].visible / t[1].amodal, 1, 1e-9);
    CHECK_NEAR(t[0].occluded_entity, 0.5 * size_px * size_px, 0.01 * size_px * size_px);
    CHECK(t[0].occluder == 1 && t[1].occluder == -1 && t[0].occluded_ground == 0);
    CHECK_NEAR(hand_irradiance(&picture, &view, picture_lwir, 0) * 4000 * 4000 / (hand_emitted(BAND_LWIR) * 6), 1,
               0.01);

    /* a wall: the plate again, so near that it is no small target, over the right half of a small one */
    hand_clear();
    place_at(p_enu, &view, 4000, 0.2, 0.3);
    p_enu[2] -= 1;
    hand_add(hand_plate_model, p_enu, r);
    place_at(p_enu, &view, 60, 0.2, 0.3);
    p_enu[1] -= 1;
    p_enu[2] -= 1;
    hand_add(hand_plate_model, p_enu, r);
    arena_reset(hand.arena);
    picture = hand_render(&request, hand.pool);
    t = picture.target;
    CHECK(t[0].small && !t[1].small);
    CHECK_NEAR(t[0].visible / t[0].amodal, 0.5, 0.01);
    CHECK(t[0].occluder == 1);

    /* half out of the picture, on the right: only what is inside counts */
    hand_clear();
    place_at(p_enu, &view, 4000, 0.5 * side_px, 0.3);
    hand_add(hand_plate_model, p_enu, r);
    arena_reset(hand.arena);
    picture = hand_render(&request, hand.pool);
    t = picture.target;
    CHECK_NEAR(t[0].amodal, 0.5 * size_px * size_px, 0.005 * size_px * size_px); /* place on the image: 1e-3 px */
    CHECK(t[0].box[2] == side_px && t[0].amodal_box[2] == side_px);
    CHECK_NEAR(hand_irradiance(&picture, &view, picture_lwir, 0) * 4000 * 4000 / (hand_emitted(BAND_LWIR) * 2), 1,
               0.01);
}

/* A plate behind a row of masts half a pixel wide, all of one radiance, before a brighter sky: the sky goes where the
 * plate stands between the masts, all of it. The pixels' own samples see half sky there. */
static void nothing_shines_through_gaps_that_it_fills(void **state)
{
    enum { masts = 14 };
    static const double range_m = 250, sky_w_m2_sr = 200, turn = 75 * rad_per_deg, pitch_m = 0.12;
    (void)state;
    const View    view = east();
    RenderRequest request = hand_request(&view);
    double        r[9], upright[9], p_enu[3], irradiance[2];
    request.samples = 8, request.edge_samples = 0; /* one ray a pixel misses most of the masts */
    hand_air_off(sun_enu);
    for (int i = 0; i <= air_sky_ups; i++) hand.air.sky_eye[AIR_LWIR].thermal_w_m2_sr[i] = sky_w_m2_sr;
    hand_attitude(r, pi_rad + turn, 0);
    hand_attitude(upright, pi_rad, 0);
    for (int with_plate = 0; with_plate < 2; with_plate++) {
        hand_clear();
        for (int k = 0; k < masts; k++) {
            place_at(p_enu, &view, range_m - 2, 0.31, 0);
            p_enu[1] += (k - 0.5 * masts) * pitch_m, p_enu[2] -= 4;
            hand_add(hand_mast_model, p_enu, upright);
        }
        place_at(p_enu, &view, range_m, 0.31, 0.2);
        p_enu[2] -= hand_plate_z_m;
        if (with_plate) hand_add(hand_plate_model, p_enu, r);
        arena_reset(hand.arena);
        const Picture picture = hand_render(&request, hand.pool);
        irradiance[with_plate] = hand_irradiance(&picture, &view, picture_lwir, sky_w_m2_sr);
        if (!with_plate) continue;
        const TargetPixels *t = &picture.target[masts];
        CHECK(t->small && !picture.target[masts / 2].small);
        CHECK_NEAR(t->visible / t->amodal, 0.47, 0.02); /* of masts 6 cm thick, 12 cm apart, 2 m nearer */
        const double area_m2 = 4 * hand_plate_y_m * hand_plate_z_m * cos(turn) * t->visible / t->amodal;
        const double want = (hand_emitted(BAND_LWIR) - sky_w_m2_sr) * area_m2 / (range_m * range_m);
        CHECK_NEAR((irradiance[1] - irradiance[0]) / want, 1,
                   0.03); /* 0.5 with the pixels' means in place of the masts */
    }
}

/* Every pair of target and occluder counts, however many a tile of pixels holds: 24 walls, one behind the other. */
static void all_that_is_hidden_names_what_hides_it(void **state)
{
    enum { walls = 24 };
    (void)state;
    const View          view = east();
    const RenderRequest request = hand_request(&view);
    double              r[9], p_enu[3];
    hand_air_off(sun_enu);
    hand_attitude(r, pi_rad, 0);
    hand_clear();
    for (int k = 0; k < walls; k++) {
        place_at(p_enu, &view, 80 - k, 0.2, 0.3);
        p_enu[2] -= 1;
        hand_add(hand_plate_model, p_enu, r);
    }
    arena_reset(hand.arena);
    const Picture       picture = hand_render(&request, hand.pool);
    const TargetPixels *t = picture.target;
    for (int k = 0; k < walls - 1; k++) {
        CHECK(!t[k].small && t[k].visible == 0 && t[k].occluded_entity == t[k].amodal);
        assert_int_equal(t[k].occluder, walls - 1);
    }
    assert_int_equal(t[walls - 1].occluder, -1);
}

/* Planes of ids hold the target where it covers more than half of a pixel; areas hold it always. */
/* 80 plates in 10 columns of 8, 9 and 11 px apart: 56 footprints of 48 x 48 cells fit into 2^17, those of the places
 * nearest the image's centre; the others keep their areas, by pixels and edges. */
static void a_crowd_keeps_the_footprints_near_the_boresight(void **state)
{
    (void)state;
    enum { plates = 80, kept = (1 << 17) / (48 * 48) };
    const View    view = east();
    RenderRequest request = hand_request(&view);
    double        square_px[plates], r[9], area_px = 0;
    hand_air_off(sun_enu);
    hand_attitude(r, pi_rad, 0);
    hand_clear();
    for (int k = 0; k < plates; k++) {
        double       p_enu[3];
        const double right_px = 9 * (k % 10) - 40.3, down_px = 11 * (k / 10) - 38.1;
        place_at(p_enu, &view, 2000, right_px, down_px);
        p_enu[2] -= hand_plate_z_m; /* its origin is at its foot */
        hand_add(hand_plate_model, p_enu, r);
        square_px[k] = right_px * right_px + down_px * down_px;
    }
    request.target_samples = 48;
    arena_reset(hand.arena);
    const Picture picture = hand_render(&request, hand.pool);
    assert_int_equal(picture.counters.small_targets, kept);
    assert_int_equal(picture.counters.small_targets_by_pixels, plates - kept);
    for (int k = 0; k < plates; k++) {
        int nearer = 0;
        for (int i = 0; i < plates; i++) nearer += square_px[i] < square_px[k];
        if (picture.target[k].small != (nearer < kept)) fail_msg("plate %d: %d are nearer the centre", k, nearer);
        if (picture.target[k].small) area_px = picture.target[k].visible;
    }
    for (int k = 0; k < plates; k++)
        CHECK_NEAR(picture.target[k].visible / area_px, 1, 0.1); /* edges: 1 / 16 px of 2 */
    request.target_samples = 200;                                /* no fewer than with the usual grids */
    arena_reset(hand.arena);
    const Picture fine = hand_render(&request, hand.pool);
    assert_int_equal(fine.counters.small_targets, kept);
    request.target_samples = 24; /* a quarter of the cells: all have footprints */
    arena_reset(hand.arena);
    const Picture all = hand_render(&request, hand.pool);
    assert_int_equal(all.counters.small_targets_by_pixels, 0);
}

/* Twenty equal plates at 96 x 96 cells do not fit into 2^17: they keep their grids, of 80 x 80, and their areas scatter
 * no more about the mean of those by the usual grids than these. By pixels 6 of them would scatter by 3 %. */
static void finer_grids_than_fit_become_coarser(void **state)
{
    (void)state;
    enum { plates = 20 };
    static const int cells[] = {48, 64, 80, 96, 256};
    const View       view = east();
    RenderRequest    request = hand_request(&view);
    double           r[9];
    hand_air_off(sun_enu);
    hand_attitude(r, pi_rad, 0.2);
    hand_clear();
    for (int k = 0; k < plates; k++) {
        double p_enu[3];
        place_at(p_enu, &view, 2000, 9.13 * (k % 5) - 20.3, 11.27 * (k / 5) - 18.1);
        hand_add(hand_plate_model, p_enu, r);
    }
    double mean_px = 0, rms[5];
    for (int c = 0; c < 5; c++) {
        double square = 0;
        request.target_samples = cells[c];
        arena_reset(hand.arena);
        const Picture p = hand_render(&request, hand.pool);
        assert_int_equal(p.counters.small_targets, plates);
        assert_int_equal(p.counters.small_targets_by_pixels, 0);
        for (int k = 0; k < plates && c == 0; k++) mean_px += p.target[k].visible / plates;
        for (int k = 0; k < plates; k++)
            square += (p.target[k].visible / mean_px - 1) * (p.target[k].visible / mean_px - 1);
        rms[c] = sqrt(square / plates);
        print_message("%d cells a side: areas scatter by %.4f\n", cells[c], rms[c]);
    }
    for (int c = 1; c < 5; c++) CHECK(rms[c] <= 1.1 * rms[0]);
}

static void a_pixel_is_whose_most_of_it_is(void **state)
{
    (void)state;
    const View          view = east();
    const RenderRequest request = hand_request(&view);
    double              r[9], p_enu[3];
    hand_air_off(sun_enu);
    hand_attitude(r, pi_rad, 0);
    /* 1.5 px a side, its left upper corner at (0.4, 0.9) of a pixel: rows 0.1, 1, 0.4; columns 0.6, 0.9 */
    const double range_m = 2 * view.focal_px / 1.5;
    place_at(p_enu, &view, range_m, 0.4 + 0.75, 0.9 + 0.75);
    p_enu[2] -= 1; /* its origin is its foot */
    hand_clear();
    hand_add(hand_plate_model, p_enu, r);
    arena_reset(hand.arena);
    const Picture       picture = hand_render(&request, hand.pool);
    static const double column[3] = {0.6, 0.9, 0}, row[3] = {0.1, 1, 0.4};
    for (int y = 0; y < 3; y++)
        for (int x = 0; x < 3; x++) {
            const size_t px = (size_t)(side_px / 2 + y) * side_px + (size_t)(side_px / 2 + x);
            const double covered = column[x] * row[y];
            CHECK_NEAR(picture.covered[px], covered, 1e-3);
            assert_int_equal(picture.entity[px], covered > 0.5);
            CHECK_NEAR(picture.lwir[px] / hand_emitted(BAND_LWIR), covered, 1e-3); /* the table of Planck: 1e-5 */
            if (covered > 0.5) CHECK_NEAR(picture.range_m[px], range_m, 0.01);
            else CHECK(isinf(picture.range_m[px]));
        }
    static const int box[4] = {side_px / 2, side_px / 2, side_px / 2 + 2, side_px / 2 + 3};
    for (int k = 0; k < 4; k++) assert_int_equal(picture.target[0].box[k], box[k]);
    CHECK_NEAR(picture.target[0].visible, 2.25, 1e-3);
    CHECK_NEAR(picture.target[0].peak_area, 0.9, 1e-3);
}

/* A plate of 20.4 px, which is no small target: it fills 0.7 of the pixels along its edges and with that their centres,
 * so the box ends with them, on all four sides: columns 40 .. 60, rows 44 .. 64 of 96, the last two exclusive 61, 65.
 * Beyond the picture's edges it ends with the picture: four plates, each over one corner. */
static void the_box_holds_just_what_shows(void **state)
{
    (void)state;
    const double        side = 20.4;
    const View          view = east();
    const RenderRequest request = hand_request(&view);
    const double        range_m = 2 * view.focal_px / side, half = 0.5 * side_px;
    double              r[9], p_enu[3];
    hand_air_off(sun_enu);
    hand_attitude(r, pi_rad, 0);
    for (int k = 0; k < 5; k++) {
        const int right = k < 2 ? -1 : 1, down = k % 2 ? 1 : -1;
        double    at[2] = {-7.7 + 0.5 * side, -3.7 + 0.5 * side};
        int       want[4] = {40, 44, 61, 65};
        if (k < 4) { /* 10.2 - 2.5 = 7.7 px within the picture either way */
            at[0] = right * (half + 2.5), at[1] = down * (half + 2.5);
            want[0] = right < 0 ? 0 : side_px - 8, want[2] = right < 0 ? 8 : side_px;
            want[1] = down < 0 ? 0 : side_px - 8, want[3] = down < 0 ? 8 : side_px;
        }
        hand_clear();
        place_at(p_enu, &view, range_m, at[0], at[1]);
        p_enu[2] -= 1; /* its origin is its foot */
        hand_add(hand_plate_model, p_enu, r);
        arena_reset(hand.arena);
        const Picture picture = hand_render(&request, hand.pool);
        CHECK(!picture.target[0].small);
        for (int c = 0; c < 4; c++)
            if (picture.target[0].box[c] != want[c])
                fail_msg("plate %d, side %d: %d, want %d", k, c, picture.target[0].box[c], want[c]);
    }
}

/* The radar's profile is the picture's sum still, behind and on small targets. */
static void the_profile_holds_the_picture(void **state)
{
    (void)state;
    const View    view = east();
    RenderRequest request = hand_request(&view);
    double        r[9], p_enu[3];
    hand_air_off(sun_enu);
    hand_attitude(r, pi_rad, 0);
    hand_clear();
    place_at(p_enu, &view, 500, 9.3, 40.2); /* 9 px; behind it a wall of 45 px */
    hand_add(hand_plate_model, p_enu, r);
    place_at(p_enu, &view, 100, 5, 30);
    p_enu[0] += 900;
    hand_add(hand_plate_model, p_enu, r);
    place_at(p_enu, &view, 150, 3.7, 20.1);
    hand_add(hand_plate_model, p_enu, r);
    place_at(p_enu, &view, 145, -30.2, -10.7);
    hand_add(hand_sphere_model, p_enu, r);
    request.bands = 1 << BAND_RADAR;
    request.profile_bin_m = 1;
    request.profile_bins = 1500;
    arena_reset(hand.arena);
    const Picture picture = hand_render(&request, hand.pool);
    double        in_picture = 0, in_profile = 0;
    for (int i = 0; i < side_px * side_px; i++) in_picture += picture.radar[i];
    for (int i = 0; i < 1500 * radar_bounces; i++) in_profile += picture.profile[i];
    CHECK(picture.counters.small_targets == 2 && picture.counters.pixels_refined > 1000);
    CHECK(in_picture > 0);
    /* float pixels: 9216 roundings of 6e-8 */
    CHECK_NEAR(in_profile / in_picture, 1, 1e-6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_plate_keeps_its_intensity),
        cmocka_unit_test(a_sphere_keeps_its_intensity),
        cmocka_unit_test(without_footprints_it_flickers),
        cmocka_unit_test(the_background_gives_way_by_as_much),
        cmocka_unit_test(overlap_occlusion_and_the_picture_s_edge),
        cmocka_unit_test(nothing_shines_through_gaps_that_it_fills),
        cmocka_unit_test(all_that_is_hidden_names_what_hides_it),
        cmocka_unit_test(a_crowd_keeps_the_footprints_near_the_boresight),
        cmocka_unit_test(finer_grids_than_fit_become_coarser),
        cmocka_unit_test(a_pixel_is_whose_most_of_it_is),
        cmocka_unit_test(the_box_holds_just_what_shows),
        cmocka_unit_test(the_profile_holds_the_picture),
    };
    thread_flush_denormals();
    return cmocka_run_group_tests(tests, open_world, hand_close);
}
