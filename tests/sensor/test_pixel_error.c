/* Errors pixel by pixel: the spread's median and share, and a displaced bar on level ground, counted by hand. */
#include "tests/check.h"

#include "sensor/truth/frame_error.h"

static void a_spread_has_its_median_and_its_share(void **state)
{
    (void)state;
    ErrorSpread spread = {0}, more = {0};
    CHECK(isnan(error_spread_median_k(&spread)) && isnan(error_spread_rms_k(&spread)) &&
          isnan(error_spread_beyond(&spread)));
    /* a thousand pixels of 0.1 K .. 0.3 K, evenly spread, and ten of 200 K */
    for (int i = 0; i < 1000; i++) error_spread_add(&spread, pow(0.1 + 0.2e-3 * i, 2), 1);
    CHECK_NEAR(error_spread_median_k(&spread) / 0.2, 1, 0.003);
    CHECK_NEAR(error_spread_rms_k(&spread), sqrt((0.027 - 0.001) / 3 / 0.2), 1e-3); /* of a uniform distribution */
    for (int i = 0; i < 10; i++) error_spread_add(&more, 4e4, 1);
    error_spread_join(&spread, &more);
    CHECK_NEAR(error_spread_median_k(&spread) / 0.201, 1, 0.003);
    /* the ten, and of those of 0.3 K one in a thousand: tables of the normal distribution */
    CHECK(error_spread_beyond(&spread) > 9.9 / 1010 && error_spread_beyond(&spread) < 10.3 / 1010);
    static const double sigma_k[3] = {0.5, 1, 2}, beyond[3] = {0.045500, 0.317311, 0.617075};
    for (int k = 0; k < 3; k++) {
        ErrorSpread alike = {0};
        error_spread_add(&alike, sigma_k[k] * sigma_k[k], 7);
        CHECK_NEAR(error_spread_beyond(&alike), beyond[k], 1e-6);
    }
    CHECK_NEAR(error_spread_rms_k(&spread), sqrt((10 * 4e4 + 1000 * 0.04333) / 1010),
               0.01); /* the ten, and nothing else */
    ErrorSpread none = {0};
    error_spread_add(&none, 0, 5);
    CHECK(error_spread_median_k(&none) == 0 && error_spread_beyond(&none) == 0);
}

/* Bins of 64 a decade from 1e-4 K on: bin n from 1e-4 10^(n / 64) K to the next; the first has all that is smaller, and
 * counts as none, the last of 8 decades all that is larger. A median is where half of the pixels are below, evenly
 * within its bin. */
static double bin_k(double n) { return 1e-4 * pow(10, n / 64); }

static void bins_of_errors(void **state)
{
    (void)state;
    static const int edge[] = {1, 2, 64, 200, 256, 320, 510, 511};
    for (size_t k = 0; k < sizeof edge / sizeof *edge; k++)
        for (int side = -1; side <= 1; side += 2) {
            const double at_k = bin_k(edge[k]) * (1 + 1e-6 * side);
            const int    bin = side < 0 ? edge[k] - 1 : edge[k];
            ErrorSpread  one = {0};
            error_spread_add(&one, at_k * at_k, 3);
            CHECK_NEAR(error_spread_median_k(&one) / bin_k(bin + 0.5), bin > 0, 1e-9);
            CHECK(one.px[bin] == 3 && one.all_px == 3);
        }
    static const double beyond_the_bins_k[2] = {1e-9, 1e6};
    for (int k = 0; k < 2; k++) {
        ErrorSpread one = {0};
        error_spread_add(&one, beyond_the_bins_k[k] * beyond_the_bins_k[k], 1);
        CHECK(one.px[k ? error_bins - 1 : 0] == 1);
    }
    /* 3 px in bin 100 and 5 in bin 300: the fourth is a fifth of the way through these; of 4 and 4 it is the last of
     * the lower ones, of 5 and 3 it is four fifths through them */
    static const double lower_px[3] = {3, 4, 5}, median[3] = {300.2, 101, 100.8};
    for (int k = 0; k < 3; k++) {
        ErrorSpread two = {0};
        error_spread_add(&two, pow(bin_k(100.5), 2), lower_px[k]);
        error_spread_add(&two, pow(bin_k(300.5), 2), 8 - lower_px[k]);
        CHECK_NEAR(error_spread_median_k(&two) / bin_k(median[k]), 1, 1e-9);
        ErrorSpread joined = {0}, upper = {0};
        error_spread_add(&upper, pow(bin_k(300.5), 2), 8 - lower_px[k]);
        error_spread_add(&joined, pow(bin_k(100.5), 2), lower_px[k]);
        error_spread_join(&joined, &upper);
        assert_memory_equal(&joined, &two, sizeof two);
    }
}

enum { width = 40, height = 30 };

typedef struct Bar {
    Picture      picture;
    TargetPixels px;
    uint32_t     id[width * height];
    float        lwir[width * height];
    PlanckTable *planck;
} Bar;

/* 310 K, from column 15 and row 10 on, 10 x 10 pixels, on 300 K. */
static Bar *bar(void)
{
    static Bar b;
    if (!b.planck) CHECK(planck_table_create(&b.planck, 8e-6, 12e-6) == STATUS_OK);
    for (int i = 0; i < width * height; i++) {
        const int  x = i % width, y = i / width;
        const bool on = x >= 15 && x < 25 && y >= 10 && y < 20;
        b.id[i] = on ? 1 : 0;
        b.lwir[i] = (float)planck_table_radiance(b.planck, on ? 310 : 300);
    }
    b.picture = (Picture){.width = width, .height = height, .entity = b.id, .lwir = b.lwir};
    b.px = (TargetPixels){.visible = 100, .box = {15, 10, 25, 20}};
    return &b;
}

static DisplacedTarget displaced(Bar *b, double way_px, double further_k2)
{
    return (DisplacedTarget){.picture = &b->picture,
                             .px = &b->px,
                             .value = b->lwir,
                             .planck = b->planck,
                             .way_px = way_px,
                             .further_k2 = further_k2,
                             .air_k = NAN};
}

static void a_displaced_bar_is_wrong_at_its_edges(void **state)
{
    (void)state;
    Bar        *b = bar();
    ErrorSpread touched = {0}, own = {0};
    /* by 2 px: of four directions 20 pixels lose the bar in each: 80 of 400 pairs are 10 K apart, and 80 pixels beside
     * it meet it in one direction of four */
    DisplacedTarget t = displaced(b, 2, 0);
    error_spread_of_displaced(&touched, &own, &t);
    CHECK_NEAR(own.all_px, 100, 1e-9);
    CHECK_NEAR(error_spread_rms_k(&own), sqrt(100 * 80 / 400.0), 1e-3);
    /* all but the inner 6 x 6: 48 of 5 K, 16 in the corners of sqrt(50) K; tables of the normal distribution */
    CHECK_NEAR(error_spread_beyond(&own), (48 * 0.841481 + 16 * 0.887537) / 100, 1e-6);
    CHECK_NEAR(error_spread_median_k(&own), 5, 0.2); /* 36 of 0, 48 of 5, 16 of 7.1 K */
    CHECK_NEAR(touched.all_px, 180, 1e-9);
    CHECK_NEAR(touched.squares_px_k2, 2 * 80 * 25, 1);
    /* by a quarter of a pixel: a sixteenth of the squares at one pixel; nothing but other sources where it stays */
    touched = own = (ErrorSpread){0};
    t = displaced(b, 0.25, 0.01);
    error_spread_of_displaced(&touched, &own, &t);
    CHECK_NEAR(error_spread_rms_k(&own), sqrt(100 * 40 / 400.0 / 16 + 0.01), 1e-3);
    CHECK_NEAR(error_spread_median_k(&own) / 0.1, 1, 0.04);
    /* 2.6 px are 3 */
    touched = own = (ErrorSpread){0};
    t = displaced(b, 2.6, 0);
    error_spread_of_displaced(&touched, &own, &t);
    CHECK_NEAR(error_spread_rms_k(&own), sqrt(100 * 120 / 400.0), 1e-3);
    touched = own = (ErrorSpread){0};
    t = displaced(b, 0, 0.01);
    error_spread_of_displaced(&touched, &own, &t);
    CHECK_NEAR(error_spread_rms_k(&own), 0.1, 1e-9);
}

/* In corners of the image, where two sides have no neighbours: of the bar the two rows and two columns that face the
 * image differ from one neighbour of four, in the two rows or columns at its edge from one of three, 10 K each. The
 * same for as many beside it. */
static void a_bar_in_a_corner(void **state)
{
    (void)state;
    Bar *b = bar();
    for (int k = 0; k < 2; k++) {
        const int x0 = k ? width - 10 : 0, y0 = k ? height - 10 : 0;
        for (int i = 0; i < width * height; i++) {
            const int  x = i % width, y = i / width;
            const bool on = x >= x0 && x < x0 + 10 && y >= y0 && y < y0 + 10;
            b->id[i] = on ? 3 : 1; /* amid another's pixels */
            b->lwir[i] = (float)planck_table_radiance(b->planck, on ? 310 : 300);
        }
        b->px.box[0] = x0, b->px.box[1] = y0, b->px.box[2] = x0 + 10, b->px.box[3] = y0 + 10;
        ErrorSpread     touched = {0}, own = {0};
        DisplacedTarget t = displaced(b, 2, 0);
        t.index = 2;
        error_spread_of_displaced(&touched, &own, &t);
        const double facing_k2 = 2 * (2 * 2 * 100 / 3.0 + 2 * 8 * 100 / 4.0);
        CHECK_NEAR(own.squares_px_k2, facing_k2, 0.5);
        CHECK_NEAR(touched.squares_px_k2, 2 * facing_k2, 1);
        CHECK(own.all_px == 100 && touched.all_px == 140);
    }
}

/* Half a pixel of a small target, 10 K from the ground in its pixel: it differs from all four neighbours, and each of
 * these from one of its own four. Its own heat counts by its share, as a radiance: 0.038 + 0.0045 (40 - 15) K. */
static void a_small_target_counts_by_its_share(void **state)
{
    (void)state;
    static float covered[width * height], temp_k[width * height];
    Bar         *b = bar();
    const int    at = 15 * width + 20;
    for (int i = 0; i < width * height; i++) {
        b->id[i] = 0;
        temp_k[i] = 310;
        b->lwir[i] = (float)planck_table_radiance(b->planck, i == at ? 310 : 300);
    }
    covered[at] = 0.5f;
    b->picture.covered = covered;
    b->px = (TargetPixels){.visible = 0.5, .small = true, .box = {20, 15, 21, 16}};
    ErrorSpread     touched = {0}, own = {0};
    DisplacedTarget t = displaced(b, 1, 0);
    error_spread_of_displaced(&touched, &own, &t);
    CHECK(own.all_px == 0.5 && touched.all_px == 5);
    CHECK_NEAR(own.squares_px_k2, 0.5 * 100, 0.05);
    CHECK_NEAR(touched.squares_px_k2, 100 + 4 * 25, 0.1);

    const double heat_k2 = 0.25 * 0.1505 * 0.1505;
    b->picture.temp_k = temp_k;
    t = displaced(b, 0, 0);
    t.air_k = 270;
    touched = own = (ErrorSpread){0};
    error_spread_of_displaced(&touched, &own, &t);
    CHECK_NEAR(own.squares_px_k2, 0.5 * heat_k2, 1e-9);
    CHECK_NEAR(touched.squares_px_k2, heat_k2, 1e-9); /* the neighbours are ground, which stays */
    temp_k[at] = NAN;
    own = (ErrorSpread){0};
    error_spread_of_displaced(&touched, &own, &t);
    CHECK(own.all_px == 0.5 && own.squares_px_k2 == 0);
    temp_k[at] = 310, b->picture.temp_k = NULL;
    own = (ErrorSpread){0};
    error_spread_of_displaced(&touched, &own, &t);
    CHECK(own.all_px == 0.5 && own.squares_px_k2 == 0);
}

/* A large one by every third pixel each way: with the way 84 x 64 pixels, 2.3 as many a side as 1024. Columns and rows
 * from the second on: 1 before the bar, 2, 5 .. 77 in it, 1 behind; rows 1 before, 2, 5 .. 59 in it, 1 behind: it
 * has 61. Of a small one every pixel, wherever it is. */
static void of_a_large_target_some_pixels_stand_for_others(void **state)
{
    (void)state;
    enum { wide = 120, high = 90 };
    static uint32_t id[wide * high];
    static float    lwir[wide * high];
    Bar            *b = bar();
    for (int i = 0; i < wide * high; i++) {
        const int x = i % wide, y = i / wide;
        id[i] = x >= 20 && x < 100 && y >= 15 && y < 76;
        lwir[i] = (float)planck_table_radiance(b->planck, id[i] ? 310 : 300);
    }
    b->picture = (Picture){.width = wide, .height = high, .entity = id, .lwir = lwir};
    b->px = (TargetPixels){.visible = 4880, .box = {20, 15, 100, 76}};
    ErrorSpread     touched = {0}, own = {0};
    DisplacedTarget t = displaced(b, 2, 0);
    t.value = lwir;
    error_spread_of_displaced(&touched, &own, &t);
    CHECK(own.all_px == 26 * 20 * 9 && touched.all_px == (26 * 20 + 2 * 20 + 2 * 26) * 9);
    /* of its own the last row differs from what is two below it */
    CHECK_NEAR(own.squares_px_k2, 26 * 9 * 25, 2);
    CHECK_NEAR(touched.squares_px_k2, (26 + 2 * 20 + 2 * 26) * 9 * 25, 6);
    for (int i = 0; i < wide * high; i++) id[i] = i % wide >= 100 && i / wide >= 70;
    b->px.box[0] = 100, b->px.box[1] = 70, b->px.box[2] = wide, b->px.box[3] = high;
    touched = own = (ErrorSpread){0};
    error_spread_of_displaced(&touched, &own, &t);
    CHECK(own.all_px == 400 && touched.all_px == 400 + 2 * 2 * 20);
}

/* At the image's edge, and with a way longer than the image. */
static void the_image_ends_somewhere(void **state)
{
    (void)state;
    Bar *b = bar();
    for (int way = 1; way < 3000; way = 3 * way) {
        ErrorSpread     touched = {0}, own = {0};
        DisplacedTarget t = displaced(b, way, 0);
        b->px.box[0] = 0, b->px.box[1] = 0, b->px.box[2] = width, b->px.box[3] = height;
        error_spread_of_displaced(&touched, &own, &t);
        CHECK(isfinite(error_spread_rms_k(&own)) && own.all_px == 100);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_spread_has_its_median_and_its_share),
        cmocka_unit_test(bins_of_errors),
        cmocka_unit_test(a_displaced_bar_is_wrong_at_its_edges),
        cmocka_unit_test(a_bar_in_a_corner),
        cmocka_unit_test(a_small_target_counts_by_its_share),
        cmocka_unit_test(of_a_large_target_some_pixels_stand_for_others),
        cmocka_unit_test(the_image_ends_somewhere),
    };
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    planck_table_destroy(bar()->planck);
    return failed;
}
