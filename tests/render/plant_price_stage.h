/* tests/render/plant_price_stage.h: what a frame says that tables of plants change in it (PlantPrice), against the same
 * picture with and without tables. */
#ifndef TESTS_RENDER_PLANT_PRICE_STAGE_H
#define TESTS_RENDER_PLANT_PRICE_STAGE_H

#include "tests/render/hand_plants.h"
#include "tests/render/hand_world.h"

enum { trees = 2500, width = 120, height = 80, pixels = width * height };

static const double half_m = 70, sun_enu[3] = {-0.6, 0, 0.8};
static Plant        plant[trees];
static Woods        woods;
static Forest      *by_table, *in_full;

static double ground_at(double x, double y) { return elevation_height(&hand.landscape.elevation, x, y, NULL); }

static int open_wood(void **state)
{
    static const double zero[3] = {0, 0, 0};
    const ForestConfig  full = {.leaves = true}, tables = {.leaves = true, .tables = true};
    (void)state;
    if (hand_open(true) != 0) return -1;
    woods = hand_stand(plant, trees, zero, half_m);
    for (int i = 0; i < trees; i++)
        plant[i].p_m[2] = (float)ground_at((double)plant[i].p_m[0], (double)plant[i].p_m[1]);
    if (world_plant(&hand.world, &woods, &full, "avx2", hand.pool) != STATUS_OK) return -1;
    in_full = hand.world.forest;
    if (forest_create(&by_table, &woods, hand.world.plants, &tables, "avx2") != STATUS_OK) return -1;
    hand_air_on(sun_enu, 100);
    hand_clear();
    return 0;
}

static int close_wood(void **state)
{
    hand.world.forest = in_full;
    forest_destroy(by_table);
    return hand_close(state);
}

/* From 500 m south of the wood's middle, 200 m up: crowns of some 10 px. Two rays a side: those of the price. */
static RenderRequest wood_request(double t_s)
{
    const double  eye_enu[3] = {0, -500, ground_at(0, -500) + 200}, d_enu[3] = {0, 2.5, -1};
    const View    view = hand_view(eye_enu, d_enu, width, height, 500);
    RenderRequest request = hand_request(&view);
    request.samples = 2, request.edge_samples = 0, request.t_s = t_s;
    return request;
}

static PlantPrice price_of(double t_s, Pool *pool)
{
    RenderRequest request = wood_request(t_s);
    request.budget = true;
    arena_reset(hand.arena);
    const Picture picture = hand_render(&request, pool);
    assert_non_null(picture.budget);
    return picture.budget->plants;
}

/* Mean of a plane. */
static double mean_of(int plane)
{
    const RenderRequest request = wood_request(0);
    arena_reset(hand.arena);
    const Picture p = hand_render(&request, hand.pool);
    const float  *value = picture_plane(&p, plane);
    double        sum = 0;
    for (int i = 0; i < pixels; i++) sum += (double)value[i] / pixels;
    return sum;
}

/* Pixels are drawn evenly, so the mean of what frames say is the change of the whole picture, by the interval that
 * they say. */
static void frames_say_what_changes(int frames)
{
    static const int planes[] = {picture_optical, picture_lwir};
    double           sum[2] = {0}, square[2] = {0}, truth[2];
    int              within[2] = {0};
    for (int k = 0; k < 2; k++) {
        hand.world.forest = by_table;
        truth[k] = mean_of(planes[k]);
        hand.world.forest = in_full;
        truth[k] -= mean_of(planes[k]);
    }
    hand.world.forest = by_table;
    for (int f = 0; f < frames; f++) {
        const PlantPrice price = price_of(0.1 * f, hand.pool);
        assert_int_equal(price.rays, 4 * pixels / 400);
        CHECK(price.met > 0.3 * price.rays && price.met <= price.rays);
        CHECK(price.cover > 0.3 && fabs(price.bias[price_cover]) < 0.3 && price.bias[price_visible] == 0);
        for (int k = 0; k < 2; k++) {
            const double bias = price.bias[planes[k]], se = price.bias_se[planes[k]];
            CHECK(price.rms[planes[k]] > 0 &&
                  price.structure_square[planes[k]] < price.rms[planes[k]] * price.rms[planes[k]]);
            sum[k] += bias / frames, square[k] += se * se;
            within[k] += fabs(bias - truth[k]) < 2 * se;
        }
    }
    for (int k = 0; k < 2; k++) {
        const double se = sqrt(square[k]) / frames;
        print_message("plane %d: %.3g, mean of frames %.3g +- %.2g; %d of %d within twice theirs\n", planes[k],
                      truth[k], sum[k], se, within[k], frames);
        CHECK_NEAR(sum[k], truth[k], 3 * se);
        CHECK(within[k] > 0.8 * frames);
    }
}

#endif
