/* The closed forms of modulation transfer against published values, and against numerical integrals of what they
 * are the closed forms of. labels: physics */
#include "tests/check.h"

#include "sensor/detector/blur_private.h"

/* Given to 12 digits; half a unit of the last, and as much for us. */
static void aperture_has_its_published_values(void **state)
{
    (void)state;
    static const double x[3] = {0.25, 0.5, 0.75};
    static const double clear[3] = {0.685037642474, 0.391002218956, 0.144293612814};
    static const double obscured[3] = {0.562859440382, 0.337082178763, 0.158564409686};
    for (int i = 0; i < 3; i++) {
        CHECK_NEAR(mtf_aperture(x[i], 0), clear[i], 1e-12);
        CHECK_NEAR(mtf_aperture(x[i], 0.3), obscured[i], 1e-12);
        CHECK_NEAR(mtf_aperture(-x[i], 0.3), obscured[i], 1e-12);
    }
    for (double e = 0; e < 0.96; e += 0.19) {
        CHECK_NEAR(mtf_aperture(0, e), 1, 1e-15);
        CHECK(mtf_aperture(1, e) == 0 && mtf_aperture(7, e) == 0);
    }
    CHECK(isnan(mtf_aperture(NAN, 0.3)));
}

/* The overlap of two annuli, counted on a fine grid: no formula at all. Cells cut by an edge are wrong by at most one
 * each: 4 circles x circumference / side, over the area; 20 times less by their signs averaging out. */
static void aperture_is_the_overlap_of_two_annuli(void **state)
{
    (void)state;
    const int n = 1200;
    for (double e = 0; e < 0.9; e += 0.27)
        for (double x = 0.05; x < 1; x += 0.15) {
            long inside = 0, both = 0;
            for (int i = 0; i < n; i++)
                for (int j = 0; j < n; j++) {
                    const double u = (2 * i + 1.0) / n - 1, v = (2 * j + 1.0) / n - 1, w = u - 2 * x;
                    const double a = u * u + v * v, b = w * w + v * v;
                    const bool   first = a < 1 && a >= e * e;
                    inside += first;
                    both += first && b < 1 && b >= e * e;
                }
            const double cut = 4 * 2 * pi_rad * n / (20.0 * (double)inside);
            CHECK_NEAR(mtf_aperture(x, e), (double)both / (double)inside, cut + 1e-4);
        }
}

static void sinc_and_jitter_have_theirs(void **state)
{
    (void)state;
    CHECK_NEAR(mtf_sinc(0.5), 2 / pi_rad, 1e-15);
    CHECK(mtf_sinc(0) == 1 && fabs(mtf_sinc(1)) < 1e-15);
    CHECK_NEAR(mtf_sinc(1e-7), 1, 1e-13);
    CHECK_NEAR(mtf_gauss(0.1, 0.5), 0.951849807, 5e-10);
}

/* n rays and what mtf_footprint adds make the sinc of the footprint; frequencies along x, y and across. */
static void footprint_is_counted_once(void **state)
{
    (void)state;
    for (int n = 1; n <= 16; n++)
        for (double f = 0; f <= 0.5; f += 0.1) {
            MtfChain chain = {.cutoff_cyc_px = INFINITY, .footprint_px = 1, .places = n};
            double   rays = 0;
            for (int k = 0; k < n; k++) rays += cos(2 * pi_rad * f * ((k + 0.5) / n - 0.5)) / n;
            CHECK_NEAR(rays * mtf_footprint(&chain, f, 0), mtf_sinc(f), 1e-14);
            CHECK_NEAR(rays * rays * mtf_footprint(&chain, f, -f), mtf_sinc(f) * mtf_sinc(f), 1e-14);
            chain.footprint_px = 0.9;
            CHECK_NEAR(rays * mtf_footprint(&chain, 0, f), mtf_sinc(0.9 * f), 1e-14);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(aperture_has_its_published_values),
        cmocka_unit_test(aperture_is_the_overlap_of_two_annuli),
        cmocka_unit_test(sinc_and_jitter_have_theirs),
        cmocka_unit_test(footprint_is_counted_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
