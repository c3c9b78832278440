/* The price of tables in a frame; a thousand frames are in test_plant_price_deep.c. labels: slow */
#include "tests/render/plant_price_stage.h"

static void thirty_frames(void **state)
{
    (void)state;
    frames_say_what_changes(30);
}

static void threads_change_no_bit(void **state)
{
    Pool *alone = NULL;
    (void)state;
    hand.world.forest = by_table;
    const PlantPrice two = price_of(7, hand.pool);
    assert_int_equal(pool_create(&alone, 1), STATUS_OK);
    const PlantPrice one = price_of(7, alone), other = price_of(8, alone);
    pool_destroy(alone);
    assert_memory_equal(&one, &two, sizeof one);
    CHECK(memcmp(&other, &one, sizeof one) != 0);
}

static void full_detail_has_no_price(void **state)
{
    (void)state;
    hand.world.forest = in_full;
    const PlantPrice price = price_of(7, hand.pool);
    CHECK(price.rays == 0 && price.met == 0);
}

/* ---- pixels' expected values, on paper -------------------------------------------------------- */

/* A picture of 40 x 40 px looks level at a plate of leaf that fills its first columns, 100 m away; simplified, the
 * plate is upright strips. The four rays of a pixel have different columns, 1/8 px from the borders of its halves. */
enum { plate_px = 40, drawn = plate_px * plate_px / 400 };

static const double plate_m = 20, away_m = 100, focal_px = 400;
static Plant        plate;

/* From and to columns of the picture. */
static void upright(PlantQuad *out, double from, double to)
{
    const double per_px = away_m / focal_px / plate_m;
    *out = (PlantQuad){.organ = PLANT_LEAF, .open_up = 0.5f, .open_down = 0.5f};
    for (int c = 0; c < 4; c++) {
        const double x = (c == 1 || c == 2 ? to : from) - 0.5 * plate_px;
        out->corner[c][0] = (float)(x * per_px), out->corner[c][2] = c >= 2 ? 0.9f : 0.1f;
        out->n[c][1] = -1;
    }
}

/* A strip begins in each column of `every`, and is so wide. whole: the plate itself. */
static void grow(PlantShape *out, bool whole, int columns, int every, double wide)
{
    out->quads = whole ? 1 : columns / every;
    for (int k = 0; k < out->quads; k++)
        upright(&out->quad[k], whole ? 0 : every * k, whole ? columns : every * k + wide);
    out->leaves = out->quads, out->pieces = out->bark_quads = 0;
    for (int c = 0; c < 3; c++) out->low[c] = c < 2 ? -0.3f : 0, out->high[c] = c < 2 ? 0.3f : 1;
}

/* What a frame says whose plants are those of this level. */
static ErrorBudget budget_of(int level, double t_s)
{
    static const double zero[3] = {0, 0, 0};
    const ForestConfig  config = {.leaves = true, .level1_px = level == plant_simple ? 1e6 : 0};
    const double        foot_m = ground_at(0, 0) + 300, eye_enu[3] = {0, -away_m, foot_m + 0.5 * plate_m};
    const View          view = hand_view(eye_enu, (const double[3]){0, 1, 0}, plate_px, plate_px, focal_px);
    RenderRequest       request = hand_request(&view);
    Woods               stand = hand_stand(&plate, 1, zero, 1);
    Forest             *forest;
    plate = (Plant){.p_m = {0, 0, (float)foot_m},
                    .height = (uint16_t)(plate_m / plant_height_step_m),
                    .width = 128,
                    .kind = PLANT_ALDER};
    assert_int_equal(forest_create(&forest, &stand, &hand_plants, &config, "avx2"), STATUS_OK);
    request.edge_samples = 0, request.t_s = t_s, request.budget = true;
    hand.world.forest = forest;
    arena_reset(hand.arena);
    const Picture picture = hand_render(&request, hand.pool);
    assert_non_null(picture.budget);
    hand.world.forest = in_full;
    forest_destroy(forest);
    return *picture.budget;
}

/* Half of each pixel is strip. Two of its four rays differ by -1 from full detail, two by nothing: the mean product of
 * the differences of two rays is 2 / 12, where the square of the pixel's mean difference is 1 / 4, of which 1 / 12 is
 * what rays differ by among themselves. */
static void strips_of_half_a_pixel(void **state)
{
    (void)state;
    hand_grow(true, 0.06);
    grow(&hand_plants.shape[PLANT_ALDER][plant_whole], true, plate_px, 1, 1);
    grow(&hand_plants.shape[PLANT_ALDER][plant_simple], false, plate_px, 1, 0.5);
    const PlantPrice price = budget_of(plant_simple, 3).plants;
    assert_int_equal(price.rays, 4 * drawn);
    assert_int_equal(price.met, 4 * drawn);
    CHECK_NEAR(price.cover, 1, 0);
    CHECK_NEAR(price.bias[price_cover], -0.5, 1e-12);
    CHECK_NEAR(price.bias_se[price_cover], 0, 1e-12);
    CHECK_NEAR(price.rms[price_cover], sqrt(0.5), 1e-12);
    CHECK_NEAR(price.structure_square[price_cover], 2 / 12.0, 1e-12);
}

/* Every other column of the plate's half of the picture is strip: of the pixels drawn, those in the gaps differ by -1
 * in all their rays, so the mean square of what pixels differ by is their share. The frame's error by level of detail
 * has the square of it beside that of the same picture without a price; probes that show a plant have it over the
 * pixels that do. */
static void strips_of_whole_pixels(void **state)
{
    enum { frames = 30, most_probes = 4096 };
    static float square[error_thermal_planes][most_probes];
    double       gaps = 0;
    (void)state;
    hand_grow(true, 0.06);
    for (int f = 0; f < frames; f++) {
        double detail[picture_plane_count];
        int    raised = 0, planes = 0;
        grow(&hand_plants.shape[PLANT_ALDER][plant_whole], true, plate_px / 2, 1, 1);
        grow(&hand_plants.shape[PLANT_ALDER][plant_simple], false, plate_px / 2, 2, 1);
        const ErrorBudget priced = budget_of(plant_simple, f);
        const PlantPrice *price = &priced.plants;
        CHECK(price->met % 4 == 0 && price->met <= 4 * drawn && priced.probes <= most_probes);
        CHECK_NEAR(price->structure_square[price_cover], -price->bias[price_cover], 1e-12);
        CHECK_NEAR(price->rms[price_cover], sqrt(-price->bias[price_cover]), 1e-12);
        gaps -= price->bias[price_cover] / frames;
        memcpy(detail, priced.level_of_detail, sizeof detail);
        for (int k = 0; k < error_thermal_planes; k++)
            memcpy(square[k], priced.probe_square[k], (size_t)priced.probes * sizeof *square[k]);
        const int probes = priced.probes;
        grow(&hand_plants.shape[PLANT_ALDER][plant_whole], false, plate_px / 2, 2, 1);
        const ErrorBudget plain = budget_of(plant_whole, f);
        assert_int_equal(plain.plants.rays, 0);
        assert_int_equal(plain.probes, probes);
        for (int k = 0; k < picture_radar; k++) {
            const double of_plants = fmax(price->structure_square[k], 0);
            CHECK(isnan(detail[k]) == isnan(plain.level_of_detail[k]));
            if (isnan(detail[k])) continue; /* there is no such plane */
            planes++;
            CHECK(price->bias[price_cover] == 0 || of_plants > 0);
            CHECK_NEAR(detail[k] * detail[k], plain.level_of_detail[k] * plain.level_of_detail[k] + of_plants,
                       1e-9 * of_plants + 1e-14 * detail[k] * detail[k]);
        }
        for (int k = 0; k < error_thermal_planes && price->met > 0; k++) {
            const double each = fmax(price->structure_square[picture_mwir + k], 0) * price->rays / price->met;
            for (int i = 0; i < probes; i++) {
                const double more = (double)square[k][i] - (double)plain.probe_square[k][i];
                if (isnan(more) || more == 0) continue;
                CHECK_NEAR(more, each, 1e-5 * ((double)square[k][i] + each));
                raised++;
            }
        }
        CHECK(planes == 3); /* of light, 3-5 and 8-12 um */
        CHECK(price->bias[price_cover] == 0 || raised > 0);
    }
    CHECK_NEAR(gaps, 0.25, 3 * sqrt(0.25 * 0.75 / (frames * drawn)));
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(thirty_frames), cmocka_unit_test(threads_change_no_bit),
                                       cmocka_unit_test(full_detail_has_no_price),
                                       cmocka_unit_test(strips_of_half_a_pixel),
                                       cmocka_unit_test(strips_of_whole_pixels)};
    return cmocka_run_group_tests(tests, open_wood, close_wood);
}
