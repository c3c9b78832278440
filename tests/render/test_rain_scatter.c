/* Mie's series against the exact one of metal spheres and Rayleigh's limit; rain against Z = 200 R^1.6, Marshall and
 * Palmer's closed form, and P.838's loss. labels: physics */
#include "tests/check.h"

#include "render/scattering/paths/attenuation.h"
#include "render/scattering/clutter/volume_scatter.h"
#include "render/scattering/scatter.h"

static double db(double ratio) { return 10 * log10(ratio); }

/* A sphere of permittivity -j 1e12 is one of metal: its surface impedance is 1e-6 of free space's. */
static void metal_spheres_equal_the_exact_series(void **state)
{
    (void)state;
    char   path[512];
    Table  table;
    double worst = 0;
    int    rows = 0;
    if (!reference_path(path, "radar/mie/mie_pec_backscatter.csv")) skip();
    CHECK(table_open(&table, path) == STATUS_OK);
    const int ka = table_column(&table, "ka"), sigma = table_column(&table, "sigma_over_pi_a2");
    for (int row = 0; row < table.rows; row++) {
        double k, want;
        CHECK(table_number(&k, &table, row, ka, 0, 1e5) == STATUS_OK &&
              table_number(&want, &table, row, sigma, 0, 1e9) == STATUS_OK);
        if (k > 20) continue;
        /* |m| x has to stay below 2000: the larger, the better a conductor */
        const double    m = fmin(1900 / k, 1e3), radius_m = 1, wavelength_m = 2 * pi_rad / k;
        const MieSphere got = mie_sphere(radius_m, CMPLX(0, -m * m), wavelength_m);
        /* where it is strong: fields, which the finite conductor shifts by 2 / |m| at most */
        worst = fmax(worst, fabs(sqrt(got.back_m2 / pi_rad) - sqrt(want)) * m);
        rows++;
    }
    table_close(&table);
    printf("%d metal spheres: amplitude within %.2f / |m| of the exact series\n", rows, worst);
    CHECK(rows > 100 && worst < 4);
}

static void small_spheres_are_rayleigh_s(void **state)
{
    (void)state;
    const double complex e = water_permittivity(10, 283.15), k = (e - 1) / (e + 2);
    const double         l = 0.03, d = 1e-5; /* 10 um: higher orders are (pi d / l)^2 |e| = 1e-4 */
    const MieSphere      s = mie_sphere(0.5 * d, e, l);
    CHECK_NEAR(s.back_m2 / (pow(pi_rad, 5) / pow(l, 4) * creal(k * conj(k)) * pow(d, 6)), 1, 1e-3);
    CHECK_NEAR(s.scattering_m2 / (2.0 / 3 * pow(pi_rad, 5) / pow(l, 4) * creal(k * conj(k)) * pow(d, 6)), 1, 1e-3);
    CHECK_NEAR(s.extinction_m2 / (pi_rad * pi_rad / l * -cimag(k) * pow(d, 3)), 1, 1e-3);
    CHECK(isnan(mie_sphere(0, e, l).back_m2) && isnan(mie_sphere(10, e, l).back_m2) &&
          isnan(mie_sphere(1e-3, CMPLX(NAN, NAN), l).back_m2));
    /* nothing is taken that is not scattered, without loss */
    const MieSphere clear = mie_sphere(2e-3, CMPLX(6, 0), 3e-3);
    CHECK_NEAR(clear.extinction_m2 / clear.scattering_m2, 1, 1e-12);
}

/* Bohren & Huffman's sample output of BHMIE (Appendix A): index 1.55, radius 0.525, wavelength 0.6328; and Wiscombe's
 * test (NCAR TN-140, 1979) of index 1.33 - 1e-5 j, size 100. */
static void spheres_are_as_published(void **state)
{
    (void)state;
    const MieSphere bohren = mie_sphere(0.525, 1.55 * 1.55, 0.6328);
    const double    disc = pi_rad * 0.525 * 0.525;
    CHECK_NEAR(bohren.scattering_m2 / disc, 3.10543, 1e-5);
    CHECK_NEAR(bohren.extinction_m2 / disc, 3.10543, 1e-5);
    CHECK_NEAR(bohren.back_m2 / disc, 2.92534, 1e-5);
    const MieSphere wiscombe = mie_sphere(1, CMPLX(1.33, -1e-5) * CMPLX(1.33, -1e-5), 2 * pi_rad / 100);
    CHECK_NEAR(wiscombe.extinction_m2 / pi_rad, 2.101321, 1e-6);
    CHECK_NEAR(wiscombe.scattering_m2 / pi_rad, 2.096594, 1e-6);
}

/* P.840's own cloud coefficient is -Im K by the volume of water: 1 g in a m3 is 1e-6. */
static void water_takes_what_cloud_does(void **state)
{
    (void)state;
    const double complex e = water_permittivity(35, 283.15), k = (e - 1) / (e + 2);
    const double         l = 1e-9 * light_mps / 35, np_m = 6 * pi_rad / l * -cimag(k) * 1e-6;
    CHECK_NEAR(np_m * 1e3 * 10 / log(10) / cloud_attenuation(35, 283.15), 1, 2e-3); /* 0.819 has three digits */
    CHECK(isnan(creal(water_permittivity(0.5, 283))) && isnan(creal(water_permittivity(201, 283))));
}

static void rain_is_marshall_and_palmer_s(void **state)
{
    (void)state;
    for (double r = 1; r <= 25; r *= 5) {
        RainScatter  rain;
        const double slope = 4.1 * pow(r, -0.21), f = 3, l = 1e-9 * light_mps / f;
        CHECK(rain_scatter(&rain, f, 283.15, r));
        CHECK_NEAR(rain.z_mm6_m3 / (8000 * 720 / pow(slope, 7)), 1, 0.015); /* drops end at 8 mm: 1.4 % at 25 mm/h */
        CHECK_NEAR(db(rain.z_mm6_m3 / (200 * pow(r, 1.6))), 0, 1.8);        /* two fits of rain: 1.7 dB at 1 mm/h */
        const double complex e = water_permittivity(f, 283.15), k = (e - 1) / (e + 2);
        CHECK_NEAR(db(rain.back_1_m / (pow(pi_rad, 5) / pow(l, 4) * creal(k * conj(k)) * 1e-18 * rain.z_mm6_m3)), 0,
                   0.4);
        /* half of D^6 exp(-slope D) comes from above 6.670 / slope: the median of the gamma distribution of shape 7 */
        CHECK_NEAR(rain_fall_mps(&rain, 0.5), 9.65 - 10.3 * exp(-0.6 * 6.670 / slope), 0.06);
        CHECK(rain_fall_mps(&rain, 0) < 1 && rain_fall_mps(&rain, 1) < 9.65 && rain_fall_mps(&rain, 1) > 9.5);
    }
}

/* One sum over drops takes what P.838's fit of another (T-matrix, Laws and Parsons) takes: within 35 % at 2 .. 50 mm/h.
 */
static void rain_takes_what_p838_says(void **state)
{
    (void)state;
    double worst = 0;
    for (int i = 0; i < 3; i++)
        for (double r = 2; r <= 50; r *= 5) {
            RainScatter  rain;
            const double f = (const double[]){16.5, 35, 94}[i];
            CHECK(rain_scatter(&rain, f, 283.15, r));
            worst =
                fmax(worst, fabs(rain.extinction_1_m * 1e4 / log(10) / rain_attenuation(f, r, 0, 0.25 * pi_rad) - 1));
        }
    printf("loss by rain within %.0f %% of P.838's\n", 100 * worst);
    CHECK(worst < 0.35);
}

static void sums_are_fine_enough(void **state)
{
    (void)state;
    for (int i = 0; i < 3; i++) {
        RainScatter          rain;
        const double         f = (const double[]){16.5, 35, 94}[i], r = 10, slope = 4.1 * pow(r, -0.21);
        const double complex e = water_permittivity(f, 283.15);
        double               sum = 0;
        enum { fine = 5 * rain_sizes };
        CHECK(rain_scatter(&rain, f, 283.15, r));
        for (int d = 0; d < fine; d++) {
            const double mm = (d + 0.5) * 8 / fine;
            sum += 8000 * exp(-slope * mm) * 8 / fine * mie_sphere(0.5e-3 * mm, e, 1e-9 * light_mps / f).back_m2;
        }
        CHECK_NEAR(rain.back_1_m / sum, 1, 1e-3);
    }
    RainScatter none;
    CHECK(rain_scatter(&none, 35, 283, 0) && none.back_1_m == 0);
    CHECK(!rain_scatter(&none, 35, 283, 301) && !rain_scatter(&none, 35, 283, NAN) &&
          !rain_scatter(&none, 201, 283, 1) && !rain_scatter(&none, 35, 260, 1));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(metal_spheres_equal_the_exact_series),
        cmocka_unit_test(small_spheres_are_rayleigh_s),
        cmocka_unit_test(spheres_are_as_published),
        cmocka_unit_test(water_takes_what_cloud_does),
        cmocka_unit_test(rain_is_marshall_and_palmer_s),
        cmocka_unit_test(rain_takes_what_p838_says),
        cmocka_unit_test(sums_are_fine_enough),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
