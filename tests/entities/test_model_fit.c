/* Sizes of a model against those it should have: boxes of known sides, drawn along any axes and in any unit; the remedy
 * must be the one that was put in. */
#include "tests/check.h"

#include "entities/catalog/model_size_private.h"

static const double sides_m[3] = {6.7, 3.1, 2.6};

/* A box whose side along body axis k (forward, right, up) is size[k], loaded from a file whose axes are x forward, y
 * right, z down. */
static void fit_of(ModelFit *fit, const double size[3], double scale_m, const ModelSize *want, double tolerance)
{
    const Model model = {.length_m = size[0], .width_m = size[1], .height_m = size[2], .box_low = {0, 0, -size[2]}};
    const ModelImport import = {.scale_m = scale_m, .r_body_from_file = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    model_fit(fit, &model, &import, want, tolerance);
}

static void every_turn_and_unit(void **state)
{
    (void)state;
    static const double      unit[] = {1, 0.001, 0.01, 0.0254, 0.3048};
    static const char *const name[] = {NULL, "millimetres", "centimetres", "inches", "feet"};
    const ModelSize          want = {sides_m[0], sides_m[1], sides_m[2]};
    ModelFit                 fit;
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
            for (int u = 0; u < 5 && a != b; u++) {
                const int axis[3] = {a, b, 3 - a - b};
                double    size[3];
                for (int k = 0; k < 3; k++) size[axis[k]] = sides_m[k] / unit[u];
                fit_of(&fit, size, 1, &want, 1.1);
                CHECK(fit.fits == (u == 0 && a == 0 && b == 1));
                CHECK_NEAR(fit.factor, unit[u], 1e-12);
                for (int k = 0; k < 3; k++) CHECK(fit.axis[k] == axis[k]);
                char axes[32];
                snprintf(axes, sizeof axes, "'+%c +%c'", 'x' + axis[0], 'x' + axis[2]);
                CHECK(fit.fits || !(axis[0] != 0 || axis[2] != 2) == !strstr(fit.advice, axes));
                CHECK(!name[u] || strstr(fit.advice, name[u]));
            }
}

static void what_is_near_enough_or_unknown(void **state)
{
    (void)state;
    ModelFit        fit;
    const ModelSize long_alone = {.length_m = 6.7}, none = {0};
    fit_of(&fit, (double[3]){7.3, 9, 9}, 1, &long_alone, 1.1);
    CHECK(fit.fits); /* 9 % more */
    fit_of(&fit, (double[3]){7.5, 9, 9}, 1, &long_alone, 1.1);
    CHECK(!fit.fits);
    fit_of(&fit, (double[3]){100, 9, 9}, 1, &none, 1.1);
    CHECK(fit.fits);
    fit_of(&fit, (double[3]){100, 0, 9}, 1, &long_alone, 1.1);
    CHECK(fit.fits); /* a flat thing: nothing to hold it against */
}

static void odd_scales_and_other_vehicles(void **state)
{
    (void)state;
    ModelFit        fit;
    const ModelSize want = {sides_m[0], sides_m[1], sides_m[2]};
    fit_of(&fit, (double[3]){2 * 6.7, 2 * 3.1, 2 * 2.6}, 0.5, &want, 1.1);
    CHECK_NEAR(fit.factor, 0.5, 1e-9); /* on top of the sidecar's own half */
    CHECK(strstr(fit.advice, "`scale: 0.25`"));
    fit_of(&fit, (double[3]){2 * 6.7, 2 * 3.1, 2 * 2.6}, 1, &want, 1.6); /* roughly known: no odd scale */
    CHECK(fit.factor == 0);
    fit_of(&fit, (double[3]){20, 1, 1}, 1, &want, 1.1);
    CHECK(fit.factor == 0);
    CHECK(strstr(fit.advice, "is it this model?"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_turn_and_unit),
                                       cmocka_unit_test(what_is_near_enough_or_unknown),
                                       cmocka_unit_test(odd_scales_and_other_vehicles)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
