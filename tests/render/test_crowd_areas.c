/* Whole outlines of targets that others hide, against rectangles on paper. One sample a pixel finds each of the four
 * sides of a rectangle along the pixels within half a pixel, evenly: 1 / 12 px^2 a side, so an area of w x h px within
 * sqrt((w^2 + h^2) / 6) px, rms. Where more than 40 boxes share a tile that is the error of what is hidden; where fewer
 * do, that of edges, an eighth or less. What is shown has that of edges in both, and no bit depends on skips or
 * threads. labels: slow */
#include "tests/render/hand_world.h"

static const double eye_enu[3] = {0, 0, 3000}, sun_enu[3] = {-0.6, 0, 0.8};
static const double focal_px = 2250, range_m = 225;
enum { side_px = 96, most = 90 };

static int open_world(void **state)
{
    (void)state;
    return hand_open(false);
}

/* A plate whose middle is so many pixels from that of the picture; returns its area on the image. */
static double put_plate(double at_m, double right_px, double down_px, double side[2])
{
    const double p_enu[3] = {eye_enu[0] + at_m, eye_enu[1] - right_px / focal_px * at_m,
                             eye_enu[2] - down_px / focal_px * at_m - hand_plate_z_m};
    double       r[9];
    hand_attitude(r, pi_rad, 0);
    hand_add(hand_plate_model, p_enu, r);
    side[0] = 2 * hand_plate_y_m * focal_px / at_m, side[1] = 2 * hand_plate_z_m * focal_px / at_m;
    return side[0] * side[1];
}

typedef struct Stand {
    double area_px[most], expected_px; /* rms error of one sample a pixel */
} Stand;

/* One plate close by, which hides all others: 20 px each, at places of no order. */
static void stand(Stand *s, int plates)
{
    double side[2], square = 0;
    hand_air_off(sun_enu);
    hand_clear();
    s->area_px[0] = put_plate(0.45 * range_m, 0.3, -0.2, side);
    for (int k = 1; k < plates; k++) {
        const double u = random_uniform(3, 0, 0, (uint64_t)k), v = random_uniform(3, 1, 0, (uint64_t)k);
        s->area_px[k] = put_plate(range_m + 0.1 * k, 16 * (u - 0.5), 16 * (v - 0.5), side);
        square += (side[0] * side[0] + side[1] * side[1]) / 6 / (plates - 1);
    }
    s->expected_px = sqrt(square);
}

static Picture render_stand(const View *view, unsigned skips_off, Pool *pool)
{
    RenderRequest request = hand_request(view);
    request.skips_off = skips_off;
    arena_reset(hand.arena);
    return hand_render(&request, pool);
}

/* rms error of the hidden ones' outlines over that of one sample a pixel. */
static double hidden_error(const Picture *p, const Stand *s, int plates)
{
    double square = 0;
    for (int k = 1; k < plates; k++) {
        const TargetPixels *t = &p->target[k];
        CHECK(!t->small && t->visible == 0 && t->occluder == 0);
        CHECK_NEAR(t->occluded_entity, t->amodal, 0);
        square += (t->amodal - s->area_px[k]) * (t->amodal - s->area_px[k]) / (plates - 1);
    }
    return sqrt(square) / s->expected_px;
}

static void outlines_are_as_good_as_said(void **state)
{
    (void)state;
    const View view = hand_view(eye_enu, (const double[3]){1, 0, 0}, side_px, side_px, focal_px);
    Stand      s;
    for (int crowd = 0; crowd < 2; crowd++) {
        const int plates = crowd ? most : 40;
        stand(&s, plates);
        const Picture p = render_stand(&view, 0, hand.pool);
        const double  error = hidden_error(&p, &s, plates);
        print_message("%d plates: hidden outlines off by %.2f of one sample a pixel's %.1f px, rms\n", plates, error,
                      s.expected_px);
        if (crowd)
            CHECK(error > 0.7 &&
                  error < 1.3); /* of 89: a standard error of 0.08, and the widths' fractions are not all of 0 .. 1 */
        else CHECK(error < 0.125);
        CHECK_NEAR(p.target[0].visible, p.target[0].amodal, 1e-9);
        CHECK_NEAR(p.target[0].amodal / s.area_px[0], 1, 0.005); /* 1 / 16 px of 44, both ways */
    }
}

static void no_skip_and_no_thread_changes_them(void **state)
{
    (void)state;
    const View          view = hand_view(eye_enu, (const double[3]){1, 0, 0}, side_px, side_px, focal_px);
    static TargetPixels before[most];
    Stand               s;
    Pool               *one;
    assert_int_equal(pool_create(&one, 1), STATUS_OK);
    stand(&s, most);
    for (int k = 0; k < 3; k++) {
        const Picture p = render_stand(&view, k == 1 ? skips_all_off : 0, k == 2 ? one : hand.pool);
        for (int i = 0; i < most; i++) {
            if (k == 0) before[i] = p.target[i];
            CHECK(p.target[i].amodal == before[i].amodal && p.target[i].visible == before[i].visible);
            CHECK(p.target[i].occluded_entity == before[i].occluded_entity &&
                  p.target[i].occluder == before[i].occluder);
            assert_memory_equal(p.target[i].amodal_box, before[i].amodal_box, sizeof before[i].amodal_box);
            assert_memory_equal(p.target[i].radiance, before[i].radiance, sizeof before[i].radiance);
        }
    }
    pool_destroy(one);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(outlines_are_as_good_as_said),
        cmocka_unit_test(no_skip_and_no_thread_changes_them),
    };
    thread_flush_denormals();
    return cmocka_run_group_tests(tests, open_world, hand_close);
}
