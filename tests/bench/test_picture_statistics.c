/* Figures of pictures, on pictures whose figures are worked out on paper. */
#include "tests/bench/picture_statistics.h"
#include "tests/check.h"

enum { side = 96 };

static float plane[6][side * side];

/* Standard normal noise of a pixel. */
static float noise(uint32_t stream, int i) { return (float)random_normal(7, stream, 0, (uint64_t)i); }

/* Five numbers, a mean: the jackknife is sqrt(s^2 / n) with s^2 by n - 1. Of 1 2 3 4 10: mean 4, squares about it
 * 9 + 4 + 1 + 0 + 36 = 50, s^2 = 12.5, se = sqrt(12.5 / 5) = sqrt(2.5). */
static double mean_without(const void *user, int without)
{
    const double *value = user;
    double        sum[2], of[10];
    for (int k = 0; k < 5; k++) of[2 * k] = value[k], of[2 * k + 1] = 1;
    group_sums(sum, of, 5, 2, without);
    return sum[0] / sum[1];
}

static void a_mean_has_its_usual_standard_error(void **state)
{
    static const double value[5] = {1, 2, 3, 4, 10};
    (void)state;
    const Estimate got = group_estimate(mean_without, value, 5);
    CHECK_NEAR(got.value, 4, 1e-12);
    CHECK_NEAR(got.se, sqrt(2.5), 1e-12);
    CHECK(isnan(group_estimate(mean_without, value, 1).se));
    CHECK_NEAR(signed_root(-9), -3, 0);
    CHECK_NEAR(signed_root(4), 2, 0);
}

/* Blocks of 4 x 4 px by turns 0.5 above and below, plus noise of 1 a pixel, independent in all four pictures. The noise
 * of a block's mean is 1 / 4, so the mean of the squared difference is 0.25 + 2 / 16 = 0.375; of products of two
 * independent differences 0.25. A block's square scatters by sqrt(4 / 4 / 8 + 2 / 64) = 0.4 (s^2 = 1 / 4, noise 1 / 8),
 * a product by less, the mean of 576 blocks by 0.017: four of these allowed. */
static void products_of_differences_are_without_noise(void **state)
{
    PlaneTile tile;
    (void)state;
    for (int i = 0; i < side * side; i++) {
        const float there = (i % side / 4 + i / side / 4) % 2 ? 0.5F : -0.5F;
        for (uint32_t k = 0; k < 4; k++) plane[k][i] = noise(k, i) + (k % 2 ? 0 : there);
    }
    CHECK(plane_tiles(&tile, 1, side, side, side) == 1);
    CHECK_NEAR(tile_product(&tile, 4, plane[0], plane[1], plane[0], plane[1]), 0.375, 0.07);
    CHECK_NEAR(tile_product(&tile, 4, plane[0], plane[1], plane[2], plane[3]), 0.25, 0.07);
    /* without noise to the last digits: the difference 0.5 or -0.5 in each block; over 8 x 8 px it cancels */
    for (int i = 0; i < side * side; i++) {
        plane[0][i] = (i % side / 4 + i / side / 4) % 2 ? 3.5F : 2.5F;
        plane[1][i] = 3;
    }
    CHECK_NEAR(tile_product(&tile, 4, plane[0], plane[1], plane[0], plane[1]), 0.25, 1e-12);
    CHECK_NEAR(tile_product(&tile, 8, plane[0], plane[1], plane[0], plane[1]), 0, 1e-12);
    CHECK_NEAR(tile_mean(&tile, plane[0]), 3, 1e-12);
}

static void tiles_are_whole_and_apart(void **state)
{
    PlaneTile tile[8];
    (void)state;
    /* 100 x 50 px in tiles of 24: four columns, two rows */
    CHECK(plane_tiles(tile, 8, 100, 50, 24) == 8);
    CHECK(tile[0].x0 == 0 && tile[3].x0 == 72 && tile[3].y0 == 0 && tile[7].x0 == 72 && tile[7].y0 == 24);
    CHECK(plane_tiles(tile, 3, 100, 50, 24) == 3);
    CHECK(plane_tiles(tile, 8, 20, 50, 24) == 0);
    /* the mean of a plane that is 1 in the last tile alone */
    static float ones[100 * 50];
    for (int y = 24; y < 48; y++)
        for (int x = 72; x < 96; x++) ones[y * 100 + x] = 1;
    CHECK_NEAR(tile_mean(&tile[7], ones), 1, 0);
    CHECK_NEAR(tile_mean(&tile[6], ones), 0, 0);
}

/* White noise that is averaged over squares of w x w px has a correlation of 1 - k / w at distance k along a row or
 * column, so it falls to 1/e at w (1 - 1/e): 5.057 px for w = 8, exactly, since what is interpolated is a straight
 * line. Some (96 / 8)^2 = 144 independent squares: the length scatters by some 0.4 px. */
static void a_blurred_field_has_its_correlation_length(void **state)
{
    enum { w = 8, more = side + w };
    static float white[2][more * more];
    double       lag[most_lags];
    PlaneTile    tile;
    (void)state;
    for (uint32_t k = 0; k < 2; k++)
        for (int i = 0; i < more * more; i++) white[k][i] = noise(10 + k, i);
    for (int y = 0; y < side; y++)
        for (int x = 0; x < side; x++) {
            double sum = 0;
            for (int i = 0; i < w * w; i++) sum += (double)white[0][(y + i / w) * more + x + i % w];
            plane[0][y * side + x] = (float)(sum / w); /* variance 1 */
            /* the same field with independent noise of its own in each, as large as the field */
            plane[1][y * side + x] = plane[0][y * side + x] + white[1][y * more + x];
            plane[2][y * side + x] = plane[0][y * side + x] + noise(12, y * side + x);
        }
    CHECK(plane_tiles(&tile, 1, side, side, side) == 1);
    tile_lags(lag, 16, &tile, plane[0], plane[0]);
    CHECK_NEAR(lag[0], 1, 0.35); /* 144 squares: sqrt(2 / 144) = 0.12; three of these */
    CHECK_NEAR(correlation_length(lag, 16), w * (1 - exp(-1)), 1);
    /* two pictures with independent noise: the field's own length; one of them with itself: the noise is in lag 0 */
    tile_lags(lag, 16, &tile, plane[1], plane[2]);
    CHECK_NEAR(lag[0], 1, 0.4);
    CHECK_NEAR(correlation_length(lag, 16), w * (1 - exp(-1)), 1);
    tile_lags(lag, 16, &tile, plane[1], plane[1]);
    CHECK_NEAR(lag[0], 2, 0.5);
    CHECK(correlation_length(lag, 16) < 3.5); /* (1 - k / 8) / 2 = 1/e at 2.1 */
}

/* A cosine along rows, 6 whole periods of 16 px, constant along columns: at distance k the columns give its variance
 * 1/2, the rows cos(2 pi k / 16) / 2 and a little for the pairs that the edge leaves out: with k = 8 pairs over 88 px,
 * the mean of cos(a) cos(a + pi) = -cos^2(a) over 5.5 periods is -1/2. Together lag[8] = 0. */
static void lags_go_along_rows_and_columns(void **state)
{
    double    lag[most_lags];
    PlaneTile tile;
    (void)state;
    for (int i = 0; i < side * side; i++) plane[0][i] = 4 + cosf((float)(2 * pi_rad / 16 * (i % side)));
    CHECK(plane_tiles(&tile, 1, side, side, side) == 1);
    tile_lags(lag, 9, &tile, plane[0], plane[0]);
    CHECK_NEAR(lag[0], 0.5, 1e-6);
    CHECK_NEAR(lag[8], 0, 1e-6);
    /* by hand: 1, 0.6, 0.2: 1/e = 0.3679 is (0.6 - 0.3679) / 0.4 = 0.5803 beyond 1 */
    CHECK_NEAR(correlation_length((const double[]){1, 0.6, 0.2}, 3), 1.5803, 1e-4);
    CHECK(isnan(correlation_length((const double[]){1, 0.6, 0.5}, 3)));
    CHECK(isnan(correlation_length((const double[]){0, 0, 0}, 3)));
    CHECK(isnan(correlation_length((const double[]){-1, -2, -3}, 3))); /* of products of noise alone */
}

/* Columns by turns 1 and -1 have mean 0 and standard deviation 1 in a ring of whole pairs, nearly so in this one: outer
 * 9, guard 5. About column x: the outer square has 9 columns, 5 of the centre's sign; the guard 5, 3 of it. The ring's
 * sum is 9 (5 - 4) - 5 (3 - 2) = 4 of 81 - 25 = 56 px: mean 1 / 14 of the centre's sign, variance 1 - 1 / 196. An inner
 * square of 3 x 3 that is 5 everywhere, centre's sign +: contrast (5 - 1 / 14) / sqrt(195 / 196) = 4.9412; of
 * -: 5 + 1 / 14: 5.0844. */
static void a_double_window_finds_a_known_contrast(void **state)
{
    const DoubleWindow window = {3, 5, 9, 1};
    static float       contrast[side * side];
    static uint8_t     mask[side * side];
    (void)state;
    for (int i = 0; i < side * side; i++) plane[0][i] = i % 2 ? -1 : 1;
    for (int k = 0; k < 2; k++)
        for (int y = 39; y < 42; y++)
            for (int x = 39; x < 42; x++) plane[0][y * side + x + 31 * k] = 5; /* about columns 40 and 71, row 40 */
    const int places = double_window(contrast, &window, plane[0], NULL, side, side);
    CHECK(places == 88 * 88);
    float  at[2] = {0, 0};
    size_t first = double_window_centre(&window, side, 0);
    CHECK(first == 4 * side + 4);
    for (int k = 0; k < places; k++) {
        const size_t centre = double_window_centre(&window, side, k);
        if (centre == 40 * side + 40) at[0] = contrast[k];
        if (centre == 40 * side + 71) at[1] = contrast[k];
    }
    CHECK_NEAR((double)at[0], (5 - 1 / 14.0) / sqrt(195 / 196.0), 1e-5);
    CHECK_NEAR((double)at[1], (5 + 1 / 14.0) / sqrt(195 / 196.0), 1e-5);
    /* above 4: those two centres alone; the inner square's mean elsewhere is at most 5 - 6 / 3 * (5 - 1) / 3 */
    int above = 0;
    for (int k = 0; k < places; k++) above += contrast[k] > 4;
    CHECK(above == 2);
    /* a masked pixel takes the 9 x 9 places about it away */
    mask[20 * side + 20] = 1;
    int masked = 0;
    CHECK(double_window(contrast, &window, plane[0], mask, side, side) == places);
    for (int k = 0; k < places; k++) masked += isnan(contrast[k]);
    CHECK(masked == 81);
    /* steps of 3: (96 - 9) / 3 + 1 = 30 a side; nothing but a constant: no contrast; a plane too small: no place */
    const DoubleWindow steps = {3, 5, 9, 3};
    for (int i = 0; i < side * side; i++) plane[0][i] = 2;
    CHECK(double_window(contrast, &steps, plane[0], NULL, side, side) == 900 && contrast[0] == 0 && contrast[899] == 0);
    CHECK(double_window(NULL, &window, plane[0], NULL, 8, side) == 0);
}

/* Pairs by hand: ones score 3, 1, 1; zeros 2, 1. Of 6 pairs the ones win 3>2, 3>1: 2, tie 1=1 twice: 1, lose the rest:
 * 3 of 6. */
static void an_auc_counts_pairs(void **state)
{
    static const double  score[] = {3, 1, 1, 2, 1};
    static const uint8_t label[] = {1, 1, 1, 0, 0};
    static const int     group[] = {0, 1, 1, 0, 1};
    (void)state;
    CHECK_NEAR(auc_of(score, label, NULL, 5, -1), 0.5, 1e-12);
    CHECK_NEAR(auc_of(score, label, group, 5, 1), 1, 1e-12);   /* 3 > 2 */
    CHECK_NEAR(auc_of(score, label, group, 5, 0), 0.5, 1e-12); /* two ties */
    CHECK(isnan(auc_of(score, label, NULL, 3, -1)));
}

/* Two classes of normal features, apart by 2 spreads along (1, 1) / sqrt(2), a third feature that says nothing. The
 * best linear score has an AUC of Phi(2 / sqrt(2)) = Phi(1.41421) = 0.92135 (Green and Swets 1966: Phi(d' / sqrt 2)),
 * and by Hanley and McNeil (1982) a standard error of 0.0062 for 1000 of each; the weights are in the ratio 1 : 1 : 0.
 * Without any difference the AUC is 0.5 with 0.013. */
static void a_classifier_reaches_the_best_auc(void **state)
{
    enum { n = 2000 };
    static double  feature[2][n][3], score[n];
    static uint8_t label[n], fold[n];
    (void)state;
    for (int i = 0; i < n; i++) {
        label[i] = (uint8_t)(i % 2), fold[i] = (uint8_t)(i / 2 % 2);
        for (int f = 0; f < 3; f++) {
            feature[0][i][f] = random_normal(3, (uint32_t)f, 0, (uint64_t)i);
            feature[1][i][f] = 50 + 10 * (feature[0][i][f] + (f < 2 && label[i] ? sqrt(2) : 0));
        }
    }
    LabelledSamples samples = {n, 3, feature[1][0], label, fold};
    Logistic        fit;
    logistic_cross(score, &samples);
    CHECK_NEAR(auc_of(score, label, NULL, n, -1), 0.92135, 0.02);
    logistic_fit(&fit, &samples, -1);
    /* of a normal feature with spread s and means m apart the weight is m / s^2 (linear discriminant): sqrt(2) here
     * each, per spread of all, which is sqrt(1 + 1/2): 1.73; 15 % for noise and the ridge */
    CHECK_NEAR(fit.weight[0], sqrt(2) * sqrt(1.5), 0.3);
    CHECK_NEAR(fit.weight[1], sqrt(2) * sqrt(1.5), 0.3);
    CHECK_NEAR(fit.weight[2], 0, 0.3);
    samples.feature = feature[0][0];
    logistic_cross(score, &samples);
    CHECK_NEAR(auc_of(score, label, NULL, n, -1), 0.5, 0.05);
}

/* One feature, 1 for ones and -1 for zeros, as many of each: by symmetry the constant is 0, and the weight is where the
 * slope n (1 - 1 / (1 + exp(-w))) of the log likelihood equals the ridge's w. For n = 2000: w = ln(2000 / w - 1), by
 * iteration 5.8342. Without the ridge there would be no end. */
static void separated_classes_have_a_finite_weight(void **state)
{
    enum { n = 2000 };
    static double  feature[n], score[n];
    static uint8_t label[n], fold[n];
    Logistic       fit;
    (void)state;
    for (int i = 0; i < n; i++) {
        label[i] = (uint8_t)(i % 2), fold[i] = (uint8_t)(i / 2 % 2);
        feature[i] = i % 2 ? 1 : -1;
    }
    const LabelledSamples samples = {n, 1, feature, label, fold};
    logistic_fit(&fit, &samples, -1);
    CHECK_NEAR(fit.weight[0], 5.8342, 1e-3);
    CHECK_NEAR(fit.weight[1], 0, 1e-6);
    CHECK_NEAR(logistic_score(&fit, &feature[1]), 5.8342, 1e-3);
    logistic_cross(score, &samples);
    CHECK_NEAR(auc_of(score, label, NULL, n, -1), 1, 1e-12);
}

/* Twelve features of noise explain 32 samples nearly in full, but say nothing about others: cross-validated, the AUC is
 * 0.5. One of 16 + 16 scatters by 0.1 (Hanley and McNeil: sqrt((n1 + n0 + 1) / (12 n1 n0))), the mean of 100 by 0.01.
 */
static void folds_do_not_see_their_own_samples(void **state)
{
    enum { n = 32, sets = 100 };
    double  feature[n][most_features], score[n], mean = 0;
    uint8_t label[n], fold[n];
    (void)state;
    for (int s = 0; s < sets; s++) {
        for (int i = 0; i < n; i++) {
            label[i] = (uint8_t)(i % 2), fold[i] = (uint8_t)(i / 2 % 2);
            for (int f = 0; f < most_features; f++)
                feature[i][f] = random_normal(5, (uint32_t)s, (uint32_t)f, (uint64_t)i);
        }
        logistic_cross(score, &(LabelledSamples){n, most_features, feature[0], label, fold});
        mean += auc_of(score, label, NULL, n, -1) / sets;
    }
    CHECK_NEAR(mean, 0.5, 0.05);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_mean_has_its_usual_standard_error),
        cmocka_unit_test(products_of_differences_are_without_noise),
        cmocka_unit_test(tiles_are_whole_and_apart),
        cmocka_unit_test(a_blurred_field_has_its_correlation_length),
        cmocka_unit_test(lags_go_along_rows_and_columns),
        cmocka_unit_test(a_double_window_finds_a_known_contrast),
        cmocka_unit_test(an_auc_counts_pairs),
        cmocka_unit_test(a_classifier_reaches_the_best_auc),
        cmocka_unit_test(separated_classes_have_a_finite_weight),
        cmocka_unit_test(folds_do_not_see_their_own_samples),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
