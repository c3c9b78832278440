/* Electrons from radiance: photon integrals of 25 digits, and shot-limited temperature differences computed
 * elsewhere. labels: physics */
#include "tests/check.h"

#include "render/materials/planck.h"
#include "sensor/detector/photons.h"

static void photons_agree_with_25_digits(void **state)
{
    (void)state;
    char path[512];
    if (!reference_path(path, "thermal/planck_band_reference.csv")) skip();
    Table table;
    assert_int_equal(table_open(&table, path), STATUS_OK);
    int rows = 0;
    for (int r = 0; r < table.rows; r++) {
        double v[6];
        for (int c = 0; c < 6; c++) v[c] = strtod(table_text(&table, r, c), NULL);
        if (!(v[2] >= 180 && v[2] <= 1500 && v[0] >= 3)) continue; /* thermal bands */
        /* the integrand is smooth over each of 16 panels: 8 points leave less than the tables of light hold */
        CHECK_NEAR(photon_band(v[0] * 1e-6, v[1] * 1e-6, v[2], NULL) / v[5], 1, 1e-10);
        double       slope;
        const double step = 1e-3 * v[2];
        photon_band(v[0] * 1e-6, v[1] * 1e-6, v[2], &slope);
        /* Richardson's difference: fourth order, (1e-3)^4 times a fifth derivative of about (30)^5 */
        const double a = v[0] * 1e-6, b = v[1] * 1e-6;
        const double d1 = (photon_band(a, b, v[2] + step, NULL) - photon_band(a, b, v[2] - step, NULL)) / (2 * step);
        const double warm = photon_band(a, b, v[2] + 2 * step, NULL), cool = photon_band(a, b, v[2] - 2 * step, NULL);
        const double d2 = (warm - cool) / (4 * step);
        CHECK_NEAR(slope / ((4 * d1 - d2) / 3), 1, 1e-6);
        rows++;
    }
    table_close(&table);
    CHECK(rows >= 15);
}

static PhotonDetector reference_detector(double low_um, double high_um, double time_s)
{
    return (PhotonDetector){.low_m = low_um * 1e-6,
                            .high_m = high_um * 1e-6,
                            .f_number = 2,
                            .transmission = 0.8,
                            .qe = 0.7,
                            .pitch_m = 30e-6,
                            .integration_s = time_s};
}

/* F/2, transmission 0.8, QE 0.7, 30 um, pi / (4 N^2 + 1): computed by another program to seven digits: half
 * a unit of the last. */
static void netd_from_first_principles(void **state)
{
    (void)state;
    const PhotonDetector mwir = reference_detector(3.4, 4.8, 5e-3), lwir = reference_detector(8, 12, 100e-6);
    CHECK_NEAR(photon_electrons(&mwir, 300, NULL), 1.368430e7, 5);
    CHECK_NEAR(photon_netd_k(&mwir, 300, 0, 0), 7.332610e-3, 6e-10);
    CHECK_NEAR(photon_electrons(&lwir, 300, NULL), 1.803135e7, 5);
    CHECK_NEAR(photon_netd_k(&lwir, 300, 0, 0), 14.582702e-3, 6e-10);

    /* other noise adds in squares: as much dark current as signal makes it a root of two more */
    PhotonDetector dark = lwir;
    dark.dark_e = photon_electrons(&lwir, 300, NULL);
    CHECK_NEAR(photon_netd_k(&dark, 300, 0, 0) / photon_netd_k(&lwir, 300, 0, 0), sqrt(2), 1e-12);
    dark.dark_e = 0;
    dark.read_e = 3 * sqrt(photon_electrons(&lwir, 300, NULL));
    CHECK_NEAR(photon_netd_k(&dark, 300, 0, 4 * dark.read_e / 3) / photon_netd_k(&lwir, 300, 0, 0), sqrt(26), 1e-12);
}

static void table_agrees_with_the_integral(void **state)
{
    (void)state;
    const PhotonDetector mwir = reference_detector(3.4, 4.8, 5e-3);
    PhotonTable         *table;
    assert_int_equal(photon_table_create(&table, &mwir, true), STATUS_OK);
    double last = -1;
    for (double temp_k = 180; temp_k < 1500; temp_k *= 1.0137) {
        const double got = photon_table_electrons(table, planck_band(3.4e-6, 4.8e-6, temp_k, NULL));
        CHECK_NEAR(got / photon_electrons(&mwir, temp_k, NULL), 1, 1e-6);
        CHECK(got > last);
        last = got;
    }
    CHECK(photon_table_electrons(table, 0) == 0 && photon_table_electrons(table, -1) == 0);
    CHECK(isnan(photon_table_electrons(table, NAN)) && isinf(photon_table_electrons(table, INFINITY)));
    photon_table_destroy(table);

    /* light: one photon energy, that of 0.55 um: h c / 0.55 um = 3.6117197e-19 J */
    PhotonDetector tv = reference_detector(0.4, 0.7, 1e-3);
    assert_int_equal(photon_table_create(&table, &tv, false), STATUS_OK);
    CHECK_NEAR(photon_table_electrons(table, 10), 10 * photon_etendue(&tv) / 3.6117197e-19,
               1e-6 * photon_table_electrons(table, 10));
    photon_table_destroy(table);
}

/* Simpson's sum over 2 million points, elsewhere, of wavelength^-4 / (exp(c2 / wavelength T) - 1). */
static void mean_wavelengths_are_those_of_the_photons(void **state)
{
    (void)state;
    static const double low_um[4] = {3.4, 8, 0.4, 3.4}, high_um[4] = {4.8, 12, 0.7, 4.8},
                        temp_k[4] = {300, 300, 5772, 1000};
    static const double want_um[4] = {4.364478931296, 10.118813834165, 0.559410531402, 4.086442309890};
    for (int k = 0; k < 4; k++)
        CHECK_NEAR(1e6 * photon_mean_wavelength_m(1e-6 * low_um[k], 1e-6 * high_um[k], temp_k[k]) / want_um[k], 1,
                   1e-10);
    CHECK(isnan(photon_mean_wavelength_m(5e-6, 4e-6, 300)) && isnan(photon_mean_wavelength_m(3e-6, 4e-6, 0)));
}

/* A channel's own response, a triangle of 8, 10 and 12 um: photons of a black body, their slope and mean wavelength by
 * mpmath 1.3 (quad, 30 digits); electrons of them times pi / (4 N^2 + 1), the pixel, time, optics and QE; of reflected
 * light a watt has as many photons as at the triangle's middle, 10 um. */
static void detector_counts_what_it_sees(void **state)
{
    (void)state;
    static const double want[][4] = {{180, 4.1056358083138e+19, 10.2561272504},
                                     {300, 9.8346695569212e+20, 10.0578888428},
                                     {1000, 3.7988348161917e+22, 9.85886643154}};
    char                path[] = "/tmp/test_photons_XXXXXX";
    const int           handle = mkstemp(path);
    SpectralResponse   *r = NULL;
    FILE               *file = handle >= 0 ? fdopen(handle, "w") : NULL;
    CHECK(file != NULL && fputs("wavelength_um,response\n8,0\n10,1\n12,0\n", file) >= 0 && fclose(file) == 0);
    CHECK(response_open(&r, path) == STATUS_OK && remove(path) == 0);
    PhotonDetector     d = reference_detector(8, 12, 100e-6);
    const SpectralBand band = {d.low_m, d.high_m, r};
    d.response = r;
    for (int i = 0; i < 3; i++) {
        const double temp_k = want[i][0], step_k = 1e-3 * temp_k;
        double       slope;
        CHECK_NEAR(photon_seen(&band, temp_k, &slope) / want[i][1], 1, 1e-8);
        CHECK_NEAR(photon_seen_wavelength_m(&band, temp_k) * 1e6 / want[i][2], 1, 1e-8);
        const double rise = photon_seen(&band, temp_k + step_k, NULL) - photon_seen(&band, temp_k - step_k, NULL);
        CHECK_NEAR(rise / (2 * step_k) / slope, 1, 2e-5); /* (1e-3)^2 / 6 times (x - 2)^2, x = 8 and less */
    }
    const double etendue = pi_rad / 17 * 9e-10 * 0.56 * 1e-4, per_w = 10e-6 / (6.62607015e-34 * 299792458.0);
    PhotonTable *emitted = NULL, *reflected = NULL;
    CHECK_NEAR(photon_electrons(&d, 300, NULL) / (etendue * want[1][1]), 1, 1e-8);
    CHECK(photon_table_create(&emitted, &d, true) == STATUS_OK);
    CHECK(photon_table_create(&reflected, &d, false) == STATUS_OK);
    CHECK_NEAR(photon_table_electrons(emitted, 19.550490581936) / (etendue * want[1][1]), 1, 1e-6);
    CHECK_NEAR(photon_table_electrons(reflected, 1) / (etendue * per_w), 1, 1e-8);
    photon_table_destroy(emitted);
    photon_table_destroy(reflected);
    response_close(r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(photons_agree_with_25_digits),
        cmocka_unit_test(netd_from_first_principles),
        cmocka_unit_test(table_agrees_with_the_integral),
        cmocka_unit_test(detector_counts_what_it_sees),
        cmocka_unit_test(mean_wavelengths_are_those_of_the_photons),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
