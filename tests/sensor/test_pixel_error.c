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
    touched = own = (ErrorSpread){0};
    t = displaced(b, 0, 0.01);
    error_spread_of_displaced(&touched, &own, &t);
    CHECK_NEAR(error_spread_rms_k(&own), 0.1, 1e-9);
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
        cmocka_unit_test(a_displaced_bar_is_wrong_at_its_edges),
        cmocka_unit_test(the_image_ends_somewhere),
    };
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    planck_table_destroy(bar()->planck);
    return failed;
}
