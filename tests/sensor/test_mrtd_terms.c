/* The formula of the minimum resolvable temperature difference, each of its terms by hand; that bars are resolved where
 * it says is test_mrtd.c. labels: physics */
#include "tests/check.h"

#include "sensor/detector/mrtd.h"

/* A sensor without optics, of full pixels, and white noise alone. */
static SensorPreset full_pixels(void)
{
    SensorPreset p = {
        .band = BAND_LWIR,
        .width_px = 100,
        .height_px = 100,
        .hfov_deg = 5,
        .footprint = 1,
        .bits = 16,
        .noise_scale = 1,
        .photons = {.f_number = 1e-9, .transmission = 1, .qe = 1, .pitch_m = 1, .integration_s = 1e-20, .well_e = 1}};
    preset_refresh(&p);
    p.photons.read_e = 1e3;
    return p;
}

static void by_hand(void **state)
{
    (void)state;
    SensorPreset p = full_pixels();
    double       per_k;
    photon_electrons(&p.photons, 300, &per_k);
    const MrtdObserver observer = {.snr = 2.5, .frames = 6, .temp_k = 300};
    Mrtd               got;
    mrtd_predict(&got, &p, 0.25, &observer);
    const double pi = 3.14159265358979323846, sinc = sin(pi / 4) / (pi / 4);
    const double noise = sqrt(1e6 + photon_electrons(&p.photons, 300, NULL)) / per_k;
    /* bars of 2 x 14 px: (1 - 1/6) / 2 and (1 - 1/42) / 14; optics without a cut-off */
    const double want = 2.5 * pi * pi / 8 * noise * sqrt((5.0 / 12) * (41.0 / 42 / 14) / 6) / (sinc * sinc);
    for (int axis = 0; axis < 2; axis++) CHECK_NEAR(got.first_k[axis] / want, 1, 1e-6);
}

/* Variance of the mean, over a length, of noise that is correlated as exp(-distance / reach), or with next: the
 * covariance of two such means side by side; summed up over pairs of points. */
static double mean_product(double length, double reach, bool next)
{
    enum { points = 400 };
    double sum = 0;
    for (int i = 0; i < points; i++)
        for (int j = 0; j < points; j++) {
            const double x = (i + 0.5) / points * length, y = (j + 0.5) / points * length + (next ? length : 0);
            sum += exp(-fabs(x - y) / reach);
        }
    return sum / (points * points);
}

/* Every kind of noise in the mean of a bar, as the header has it, w wide and 7 w long, of a sensor without optics whose
 * MTF is that of its full pixels: white noise of a pixel over frames; vh and the gain, which time does not average;
 * across the bar th over frames, h; across lying bars tv over frames, v; noise along the lines, white or correlated, of
 * ten frames at most; of a sensor that is swept by columns a row has one gain, and the sweep blurs upright bars. What
 * bar and gap share, t, counts for nothing. The ratios refer to the noise at 300 K, the target is at 310 K; all is
 * scaled by 1.5 but the converter's step. Harmonics of four bars of two pixels: sinc(n/4)^2 / n^2 of odd n goes by
 * n^-4, 1.0146377 of the first to n = 15. */
static void every_noise_counts_in_its_way(void **state)
{
    (void)state;
    for (int kind = 0; kind < 4; kind++) {
        SensorPreset p = {
            .band = BAND_LWIR,
            .width_px = 100,
            .height_px = 100,
            .hfov_deg = 5,
            .footprint = 1,
            .bits = 8,
            .noise_scale = 1.5,
            .prnu = 0.01,
            .line_noise = kind == 3 ? 0 : 0.7,
            .line_noise_px = kind == 1 ? 3 : 0,
            .ratio = {.sigma = {1, 0.3, 0.4, 0.5, 9, 0.6, 0.2}},
            .dark_e_s = 1e4 / 1e-20,
            .photons = {
                .f_number = 1e-9, .transmission = 1, .qe = 1, .pitch_m = 1, .integration_s = 1e-20, .well_e = 1e5}};
        p.scan.by_columns = kind == 2;
        p.scan.line_s = kind == 2 ? 2e-20 : 0;
        preset_refresh(&p);
        p.photons.read_e = 120;
        double       per_k;
        const double n = photon_electrons(&p.photons, 310, &per_k), floor2 = 1e4 + 120 * 120;
        const double ref2 = 2.25 * (photon_electrons(&p.photons, 300, NULL) + floor2);
        p.prnu = sqrt(n + floor2) / n;
        const double       gain2 = 2.25 * (n + floor2), pixel2 = 2.25 * (n + floor2) + (1e5 / 255) * (1e5 / 255) / 12;
        const int          frames = kind == 0 ? 25 : 4, pool = kind == 0 ? 10 : 4;
        const MrtdObserver observer = {.snr = 2.5, .frames = frames, .temp_k = 310};
        Mrtd               got;
        mrtd_predict(&got, &p, 0.25, &observer);
        const double w = (1 - 1.0 / 6) / 2, along = (1 - 1.0 / 42) / 14; /* white noise left over 2 px, over 14 px */
        const double line2 = kind == 3 ? 0 : ref2 * 0.49 / pool, sinc = sin(0.25 * pi_rad) / (0.25 * pi_rad);
        double       e2[2] = {0}, mtf[2] = {sinc, sinc};
        for (int axis = 0; axis < 2; axis++) {
            e2[axis] = pixel2 / frames * w * along + ref2 * 0.25 * w * along;
            e2[axis] += axis == 0 ? ref2 * (0.16 / frames + 0.04) * w : ref2 * (0.09 / frames + 0.36) * w;
            e2[axis] += kind != 2 ? gain2 * w * along : axis == 1 ? gain2 * w : 0;
            if (kind != 1) e2[axis] += line2 * w * along;
        }
        if (kind == 1) {
            e2[0] += line2 * (mean_product(2, 3, false) - mean_product(2, 3, true)) * along;
            e2[1] += line2 * mean_product(14, 3, false) * w;
        }
        if (kind == 2) mtf[0] *= sin(0.125 * pi_rad) / (0.125 * pi_rad); /* half a pixel while a stage looks */
        for (int axis = 0; axis < 2; axis++) {
            const double want = 2.5 * pi_rad * pi_rad / 8 * sqrt(e2[axis]) / per_k / (mtf[axis] * sinc);
            CHECK_NEAR(got.mtf[axis] / mtf[axis], 1, 1e-6);
            CHECK_NEAR(got.first_k[axis] / want, 1, 1e-5);
            if (kind != 2) CHECK_NEAR(got.first_k[axis] / got.all_k[axis], 1.0146377, 1e-6);
        }
    }
}

/* Bars of one pixel, at 0.5 cycles: white noise left is 2/3 of that of a pixel across, and (1 - 1/21) / 7 along. Slow
 * bars of correlated noise: a reach of 1e9 px is one value for bar and gap, and counts for nothing on upright ones, and
 * whole along lying ones. */
static void the_shortest_bars_and_the_longest_reach(void **state)
{
    (void)state;
    SensorPreset       p = full_pixels();
    double             per_k;
    const double       pixel2 = 1e6 + photon_electrons(&p.photons, 300, &per_k);
    const MrtdObserver observer = {.snr = 2.5, .frames = 0, .temp_k = 300}; /* fewer than one counts as one */
    Mrtd               got;
    for (int k = 0; k < 3; k++) {
        const double f = k == 0 ? 0.5 : 0.1, width = 0.5 / f, sinc = sin(pi_rad * f) / (pi_rad * f);
        const double across = (1 - 1 / (3 * width)) / width, along = (1 - 1 / (21 * width)) / (7 * width);
        p.line_noise = k == 2 ? 2 : 0, p.line_noise_px = 1e9;
        mrtd_predict(&got, &p, f, &observer);
        for (int axis = 0; axis < 2; axis++) {
            const double e2 = pixel2 * across * along + (k == 2 && axis == 1 ? 4 * pixel2 * across : 0);
            CHECK_NEAR(got.first_k[axis] / (2.5 * pi_rad * pi_rad / 8 * sqrt(e2) / per_k / (sinc * sinc)), 1, 1e-6);
        }
    }
    /* no contrast at all: a footprint of four pixels has its first zero at 0.25 */
    p.line_noise = 0, p.footprint = 4;
    mrtd_predict(&got, &p, 0.25, &observer);
    for (int axis = 0; axis < 2; axis++)
        CHECK(isinf(got.first_k[axis]) && got.first_k[axis] > 0 && got.mtf[axis] < 1e-12);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(by_hand),
        cmocka_unit_test(every_noise_counts_in_its_way),
        cmocka_unit_test(the_shortest_bars_and_the_longest_reach),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
