/* A wood at one ray a pixel, smoothed among its leaves, beside the same at 64 rays: error, deviation from pixel to
 * pixel, mean; the same bits on any number of threads; rays only about a target. labels: slow */
#include "tests/render/hand_plants.h"
#include "tests/render/hand_world.h"

enum { trees = 2500, width = 120, height = 80, pixels = width * height };

static const double half_m = 70, sun_enu[3] = {-0.6, 0, 0.8};
static Plant        plant[trees];
static Woods        woods;

static double ground_at(double x, double y) { return elevation_height(&hand.landscape.elevation, x, y, NULL); }

static int open_wood(void **state)
{
    static const double zero[3] = {0, 0, 0};
    (void)state;
    if (hand_open(true) != 0) return -1;
    woods = hand_stand(plant, trees, zero, half_m);
    for (int i = 0; i < trees; i++)
        plant[i].p_m[2] = (float)ground_at((double)plant[i].p_m[0], (double)plant[i].p_m[1]);
    if (world_plant(&hand.world, &woods, &(ForestConfig){.leaves = true}, "avx2", hand.pool) != STATUS_OK) return -1;
    hand_air_on(sun_enu, 100);
    hand_clear();
    return 0;
}

/* From 120 m south of the wood's middle, 60 m up: crowns of some 50 px, ground between them. */
static RenderRequest wood_request(void)
{
    const double eye_enu[3] = {0, -120, ground_at(0, -120) + 60}, d_enu[3] = {0, 2, -1};
    const View   view = hand_view(eye_enu, d_enu, width, height, 220);
    return hand_request(&view);
}

typedef struct Statistics {
    double mean, deviation, error; /* of a plane; its rms off another, over the other's mean */
} Statistics;

static Statistics measure(const float *plane, const float *want)
{
    double mean = 0, square = 0, off = 0, of_want = 0;
    for (int i = 0; i < pixels; i++) {
        mean += plane[i] / pixels, square += (double)plane[i] * plane[i] / pixels;
        off += ((double)plane[i] - want[i]) * ((double)plane[i] - want[i]) / pixels, of_want += want[i] / pixels;
    }
    return (Statistics){mean, sqrt(square - mean * mean), sqrt(off) / of_want};
}

/* Renders into buffers of the caller's: the arena is of the last picture alone. */
static Picture wood_picture(float kept[2][pixels], const RenderRequest *request, Pool *pool)
{
    arena_reset(hand.arena);
    const Picture p = hand_render(request, pool);
    memcpy(kept[0], p.optical[0], sizeof kept[0]);
    memcpy(kept[1], p.lwir, sizeof kept[1]);
    return p;
}

static void smoothed_it_is_nearer_the_truth(void **state)
{
    static float  want[2][pixels], raw[2][pixels], got[2][pixels];
    RenderRequest request = wood_request();
    (void)state;
    request.samples = 8, request.edge_samples = 0;
    wood_picture(want, &request, hand.pool);
    request.samples = 1;
    wood_picture(raw, &request, hand.pool);
    request = wood_request();
    const Picture picture = wood_picture(got, &request, hand.pool);
    int           shown = 0;
    for (int i = 0; i < pixels; i++) shown += picture.instance[i] != 0;
    CHECK(shown > 0.7 * pixels && picture.counters.rays_edges == 0);
    for (int k = 0; k < 2; k++) {
        const Statistics truth = measure(want[k], want[k]), one = measure(raw[k], want[k]),
                         smooth = measure(got[k], want[k]);
        print_message("%s: error %.3f, %.3f with one ray; deviation %.3f of the true one, %.3f; mean %.4f\n",
                      k ? "8-12 um" : "red", smooth.error, one.error, smooth.deviation / truth.deviation,
                      one.deviation / truth.deviation, smooth.mean / truth.mean);
        CHECK(smooth.error < 0.6 * one.error);
        /* a pixel is far larger than a leaf here: one ray has all of the leaves' contrast, which means have not */
        CHECK(smooth.deviation - truth.deviation < 0.35 * (one.deviation - truth.deviation));
        CHECK(smooth.deviation > truth.deviation);
        CHECK_NEAR(smooth.mean / truth.mean, 1, 0.015);
    }
}

static void threads_change_no_bit(void **state)
{
    static float        two[2][pixels], one[2][pixels];
    const RenderRequest request = wood_request();
    Pool               *alone = NULL;
    (void)state;
    wood_picture(two, &request, hand.pool);
    assert_int_equal(pool_create(&alone, 1), STATUS_OK);
    wood_picture(one, &request, alone);
    pool_destroy(alone);
    assert_memory_equal(one, two, sizeof one);
}

/* A plate among the trees: they are sampled finely about its box, and nowhere else. */
static void about_a_target_leaves_are_refined(void **state)
{
    static float        kept[2][pixels];
    const RenderRequest request = wood_request();
    const double        p_enu[3] = {0, -20, ground_at(0, -20) + 17};
    double              r[9];
    (void)state;
    hand_attitude(r, -0.5 * pi_rad, 0);
    hand_add(hand_plate_model, p_enu, r);
    const Picture picture = wood_picture(kept, &request, hand.pool);
    const double *box = picture.target[0].projected_box;
    const double  most = (box[2] - box[0] + 8) * (box[3] - box[1] + 8);
    hand_clear();
    print_message("%d pixels refined about a box of %.1f x %.1f px\n", (int)picture.counters.pixels_refined,
                  box[2] - box[0], box[3] - box[1]);
    CHECK(picture.counters.pixels_refined > 10 && (double)picture.counters.pixels_refined <= most);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(smoothed_it_is_nearer_the_truth),
        cmocka_unit_test(threads_change_no_bit),
        cmocka_unit_test(about_a_target_leaves_are_refined),
    };
    thread_flush_denormals();
    return cmocka_run_group_tests(tests, open_wood, hand_close);
}
