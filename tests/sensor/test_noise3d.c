/* Three-dimensional noise against its own definition: what was put in comes out, and each component stands still in the
 * axes it lacks. labels: physics */
#include "tests/check.h"

#include "sensor/detector/array_noise.h"

enum { frames = 100, rows = 120, columns = 160 };
static float  cube[(size_t)frames * rows * columns], plane[rows * columns];
static double scratch[columns];

static void make_cube(const Noise3d *noise, uint64_t seed)
{
    static float fixed[rows * columns];
    memset(fixed, 0, sizeof fixed);
    noise3d_add_fixed(fixed, columns, rows, noise, seed, 5);
    for (int k = 0; k < frames; k++) {
        float *at = cube + (size_t)k * rows * columns;
        memcpy(at, fixed, sizeof fixed);
        noise3d_add_moving(at, columns, rows, noise, &(NoiseDraw){seed, 5, k}, scratch);
    }
}

/* sigma_tvh within 1 % and pairs within 2 % (their sampling deviations are 0.05 % and 0.5 %); single axes by
 * chi-square with n - 1 degrees of freedom: in sigma 1 / sqrt(2 (n - 1)), four deviations each way, plus what an
 * estimate subtracts. */
static void estimates_recover_what_went_in(void **state)
{
    (void)state;
    static const Noise3d cases[3] = {
        {{1, 0.3, 0.2, 0.4, 0.15, 0.25, 0.35}}, {{1, 1, 1, 1, 1, 1, 1}}, {{0.5, 2, 1.5, 1, 3, 2, 4}}};
    static const int n[noise_axes] = {0, 0, 0, 0, frames, rows, columns};
    for (int k = 0; k < 3; k++) {
        Noise3d got;
        make_cube(&cases[k], 11 + (uint64_t)k);
        assert_int_equal(noise3d_estimate(&got, cube, frames, rows, columns), STATUS_OK);
        for (int a = 0; a < noise_axes; a++) {
            const double want = cases[k].sigma[a];
            const double bound = a == NOISE_TVH ? 0.01 : a <= NOISE_VH ? 0.02 : 4 / sqrt(2.0 * (n[a] - 1));
            CHECK_NEAR(got.sigma[a] / want, 1, bound);
        }
    }
}

/* With no component in an axis the naive average still shows one (sigma_tvh / sqrt(H) in tv): the estimate must
 * not. The unbiased variance of nothing is 0 within its sampling deviation. */
static void what_is_not_there_is_not_found(void **state)
{
    (void)state;
    const Noise3d only = {{10}};
    Noise3d       got;
    make_cube(&only, 3);
    assert_int_equal(noise3d_estimate(&got, cube, frames, rows, columns), STATUS_OK);
    CHECK_NEAR(got.sigma[NOISE_TVH], 10, 0.1);
    /* variance of S_tv - S_tvh / H: (100 / 160) sqrt(2 / (100 x 120)) = 0.008; five of them; sigma is its root */
    CHECK(got.sigma[NOISE_TV] * got.sigma[NOISE_TV] < 5 * 100.0 / columns * sqrt(2.0 / (frames * rows)));
    CHECK(got.sigma[NOISE_TH] * got.sigma[NOISE_TH] < 5 * 100.0 / rows * sqrt(2.0 / (frames * columns)));
    CHECK(got.sigma[NOISE_VH] * got.sigma[NOISE_VH] < 5 * 100.0 / frames * sqrt(2.0 / (rows * columns)));
    CHECK(got.sigma[NOISE_T] * got.sigma[NOISE_T] < 5 * 100.0 / (rows * columns) * sqrt(2.0 / frames));
}

static void components_stand_still_where_they_should(void **state)
{
    (void)state;
    static const char *const name[noise_axes] = {"tvh", "tv", "th", "vh", "t", "v", "h"};
    for (int a = 0; a < noise_axes; a++) {
        const NoiseAxis axis = (NoiseAxis)a;
        assert_string_equal(noise_axis_name[a], name[a]);
        const double here = noise3d_unit(axis, 9, 1, 4, 5, 6);
        CHECK((noise3d_unit(axis, 9, 1, 7, 5, 6) == here) == !strchr(name[a], 't'));
        CHECK((noise3d_unit(axis, 9, 1, 4, 7, 6) == here) == !strchr(name[a], 'v'));
        CHECK((noise3d_unit(axis, 9, 1, 4, 5, 7) == here) == !strchr(name[a], 'h'));
        CHECK(noise3d_unit(axis, 8, 1, 4, 5, 6) != here && noise3d_unit(axis, 9, 2, 4, 5, 6) != here);
    }
    /* planes and single places are the same function */
    const Noise3d noise = {{1, 0.3, 0.2, 0.4, 0.15, 0.25, 0.35}};
    memset(plane, 0, sizeof plane);
    noise3d_add_fixed(plane, columns, rows, &noise, 9, 1);
    noise3d_add_moving(plane, columns, rows, &noise, &(NoiseDraw){9, 1, 4}, scratch);
    for (int r = 0; r < rows; r += 7)
        for (int c = 0; c < columns; c += 3)
            CHECK_NEAR(plane[r * columns + c], noise3d_at(&noise, 9, 1, 4, r, c), 1e-6);
}

int main(void)
{
    thread_flush_denormals();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(estimates_recover_what_went_in),
        cmocka_unit_test(what_is_not_there_is_not_found),
        cmocka_unit_test(components_stand_still_where_they_should),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
