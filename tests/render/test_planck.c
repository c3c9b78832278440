/* Blackbody radiance against 25-digit values, Stefan-Boltzmann, and itself by other roads. labels: physics */
#include "tests/check.h"
#include "render/materials/planck.h"

static const double h_j_s = 6.62607015e-34, c_mps = 299792458.0, k_j_k = 1.380649e-23;

static double relative(double got, double want) { return fabs(got / want - 1); }

static void spectral_has_its_limits(void **state)
{
    (void)state;
    /* Wien's displacement: the peak in wavelength is at b / T, b = 2.897771955e-3 m K (CODATA) */
    const double peak_m = 2.897771955e-3 / 300;
    CHECK(planck_radiance(peak_m, 300) > planck_radiance(peak_m * 1.0001, 300));
    CHECK(planck_radiance(peak_m, 300) > planck_radiance(peak_m * 0.9999, 300));
    /* Rayleigh-Jeans: 2 c k T / w^4, short by half of x = h c / (w k T) */
    const double w = 1e2;
    const double x = 1.438776877e-2 / (w * 300), limit = 2 * c_mps * k_j_k * 300 / pow(w, 4);
    CHECK_NEAR(planck_radiance(w, 300) / limit, 1 - 0.5 * x, 1e-12);
    CHECK(planck_radiance(1e-9, 10) == 0);
    CHECK(isnan(planck_radiance(0, 300)) && isnan(planck_radiance(1e-5, -1)) && isnan(planck_radiance(NAN, 300)));
}

static void spectral_integrates_to_stefan_boltzmann(void **state)
{
    (void)state;
    const double sigma = 5.670374419184429e-8; /* W m^-2 K^-4, exact since 2019, rounded */
    for (double temp_k = 200; temp_k <= 1500; temp_k += 433) {
        /* trapezoid in ln(wavelength): exponentially convergent, the integrand dies at both ends */
        const int    n = 20000;
        const double a = log(1e-7), b = log(1e2), step = (b - a) / n;
        double       sum = 0;
        for (int i = 0; i <= n; i++) {
            const double w = exp(a + i * step);
            sum += planck_radiance(w, temp_k) * w * step;
        }
        const double want = sigma * pow(temp_k, 4) / pi_rad;
        CHECK_NEAR(sum / want, 1, 1e-12);
        /* in band over everything, by the series: an independent road to the same number */
        double slope;
        CHECK_NEAR(planck_band(1e-9, INFINITY, temp_k, &slope) / want, 1, 1e-14);
        CHECK_NEAR(slope / (4 * want / temp_k), 1, 1e-14);
    }
}

static void band_agrees_with_25_digits(void **state)
{
    (void)state;
    char path[512];
    if (!reference_path(path, "thermal/planck_band_reference.csv")) skip();
    FILE *file = fopen(path, "r");
    CHECK(file != NULL);
    char line[512];
    CHECK(fgets(line, sizeof line, file) != NULL);
    double worst = 0, worst_slope = 0;
    int    rows = 0, normal = 0;
    while (fgets(line, sizeof line, file)) {
        char  *at = line;
        double v[5];
        for (int i = 0; i < 5; i++) {
            v[i] = strtod(at, &at); /* 1e-8923 reads as 0 */
            if (*at == ',') at++;
        }
        double       slope;
        const double got = planck_band(v[0] * 1e-6, v[1] * 1e-6, v[2], &slope);
        rows++;
        if (v[3] < 2.3e-308) {
            CHECK(got >= 0 && got < 2.3e-308);
            CHECK(slope >= 0 && slope < 1e-300);
            continue;
        }
        normal++;
        worst = fmax(worst, relative(got, v[3]));
        worst_slope = fmax(worst_slope, relative(slope, v[4]));
    }
    fclose(file);
    print_message("in band against 25 digits: %d rows, %d normal, worst %.2g, slope %.2g\n", rows, normal, worst,
                  worst_slope);
    CHECK(rows == 112 && normal > 70);
    CHECK(worst < 1e-12 && worst_slope < 1e-12);
}

static void band_pins(void **state)
{
    (void)state;
    double slope;
    CHECK_NEAR(planck_band(8e-6, 12e-6, 300, &slope), 38.50042393334786, 1e-13 * 38.5);
    CHECK_NEAR(slope, 0.6297043467222092, 1e-13);
    CHECK_NEAR(planck_band(3.4e-6, 4.8e-6, 300, &slope), 1.3460717111444394, 1e-13);
    CHECK_NEAR(slope, 0.0499705439934400, 1e-14);
    CHECK(planck_band(8e-6, 12e-6, 1, &slope) == 0 && slope == 0);
    CHECK(isnan(planck_band(12e-6, 8e-6, 300, NULL)) && isnan(planck_band(8e-6, 8e-6, 300, NULL)));
    CHECK(isnan(planck_band(0, 8e-6, 300, NULL)) && isnan(planck_band(8e-6, 12e-6, 0, &slope)) && isnan(slope));
    CHECK(isnan(planck_band(8e-6, 12e-6, NAN, NULL)));
}

/* Additivity: a band cut in pieces of any width, which sends the pieces down different branches. */
static void band_is_the_sum_of_its_pieces(void **state)
{
    (void)state;
    for (double temp_k = 2; temp_k < 2e5; temp_k *= 2.7) {
        const double low = 3e-7, high = 3e-5;
        double       slope, slopes = 0, sum = 0;
        const double whole = planck_band(low, high, temp_k, &slope);
        if (!(whole > 1e-290)) continue;
        for (int i = 0; i < 137; i++) {
            double s;
            sum += planck_band(low * pow(high / low, i / 137.0), low * pow(high / low, (i + 1) / 137.0), temp_k, &s);
            slopes += s;
        }
        CHECK_NEAR(sum / whole, 1, 3e-13); /* x up to 500 here: its rounding, times the exponential */
        CHECK_NEAR(slopes / slope, 1, 3e-13);
    }
}

/* A laser line: the band must tend to spectral radiance times width, with all its digits. */
static void narrow_band_is_spectral(void **state)
{
    (void)state;
    for (double w = 4e-7; w < 2e-4; w *= 3) {
        for (double temp_k = 30; temp_k < 1e4; temp_k *= 3) {
            const double want = planck_radiance(w, temp_k);
            const double low = w * (1 - 0x1p-20), high = w * (1 + 0x1p-20); /* near edges, exactly apart */
            if (!(want > 1e-290)) continue;
            const double x = h_j_s * c_mps / (w * k_j_k * temp_k);
            /* second order: (width / w)^2 / 24 times (w^2 B'' / B), below (x + 6)^2 */
            const double bound = 0x1p-38 * (x + 6) * (x + 6) / 24 + 1e-12;
            CHECK_NEAR(planck_band(low, high, temp_k, NULL) / (high - low) / want, 1, bound);
        }
    }
}

static void derivative_is_the_derivative(void **state)
{
    (void)state;
    for (double temp_k = 150; temp_k < 3000; temp_k *= 1.3) {
        double       slope;
        const double h = temp_k * 1e-3;
        planck_band(3.4e-6, 4.8e-6, temp_k, &slope);
        const double d1 = planck_band(3.4e-6, 4.8e-6, temp_k + h, NULL) - planck_band(3.4e-6, 4.8e-6, temp_k - h, NULL);
        const double d2 =
            planck_band(3.4e-6, 4.8e-6, temp_k + 2 * h, NULL) - planck_band(3.4e-6, 4.8e-6, temp_k - 2 * h, NULL);
        CHECK_NEAR((8 * d1 - d2) / (12 * h) / slope, 1, 1e-7); /* (x h / T)^4 / 30, x <= 28 */
    }
}

static void inverse_inverts(void **state)
{
    (void)state;
    static const double band[][2] = {{4e-7, 7e-7},     {7e-7, 1.1e-6},    {1.4e-6, 2.5e-6}, {3e-6, 5e-6},
                                     {3.4e-6, 4.8e-6}, {7.5e-6, 13.5e-6}, {8e-6, 12e-6}};
    for (int b = 0; b < 7; b++) {
        for (double temp_k = 40; temp_k < 2e4; temp_k *= 1.37) {
            const double l = planck_band(band[b][0], band[b][1], temp_k, NULL);
            if (!(l > 1e-300)) continue;
            CHECK_NEAR(planck_band_inverse(band[b][0], band[b][1], l) / temp_k, 1, 1e-12);
        }
    }
    CHECK(isnan(planck_band_inverse(8e-6, 12e-6, 0)) && isnan(planck_band_inverse(8e-6, 12e-6, -1)));
    CHECK(isnan(planck_band_inverse(8e-6, 12e-6, NAN)) && isnan(planck_band_inverse(8e-6, 12e-6, INFINITY)));
    CHECK(isnan(planck_band_inverse(12e-6, 8e-6, 1)));
    /* extremes end, and invert */
    CHECK_NEAR(planck_band(8e-6, 12e-6, planck_band_inverse(8e-6, 12e-6, 1e-250), NULL) / 1e-250, 1, 1e-9);
    CHECK_NEAR(planck_band(8e-6, 12e-6, planck_band_inverse(8e-6, 12e-6, 1e9), NULL) / 1e9, 1, 1e-12);
}

/* Four at a time as one by one, within the table and beyond, in the very knots and next to them. */
static void many_temperatures_are_each_ones(void **state)
{
    enum { count = 4003 };
    static const double band[][2] = {{4e-7, 7e-7}, {3e-6, 5e-6}, {8e-6, 12e-6}};
    static float        radiance[count];
    static double       temp_k[count];
    (void)state;
    for (int b = 0; b < 3; b++) {
        PlanckTable *table = NULL;
        CHECK(planck_table_create(&table, band[b][0], band[b][1]) == STATUS_OK);
        const double u0 = 1 / 1500.0, step = (1 / 180.0 - u0) / 4096;
        for (int i = 0; i < count; i++) {
            const double at = i % 3 == 0 ? i : 4096 * random_uniform(5, 5, (uint64_t)b, (uint64_t)i);
            radiance[i] = (float)planck_band(band[b][0], band[b][1], 1 / (u0 + step * at), NULL);
            if (i % 97 == 5) radiance[i] *= 1e4f;
        }
        radiance[7] = NAN, radiance[12] = 0, radiance[17] = -1, radiance[count - 1] = 1e-30f;
        planck_table_temps(temp_k, table, radiance, count);
        for (int i = 0; i < count; i++) {
            const double one_k = planck_table_temp(table, (double)radiance[i]);
            CHECK(temp_k[i] == one_k || (isnan(temp_k[i]) && isnan(one_k)));
        }
        planck_table_destroy(table);
    }
}

static void table_follows_the_function(void **state)
{
    (void)state;
    static const double band[][2] = {{4e-7, 7e-7},     {7e-7, 1.1e-6},    {1.4e-6, 2.5e-6}, {3e-6, 5e-6},
                                     {3.4e-6, 4.8e-6}, {7.5e-6, 13.5e-6}, {8e-6, 12e-6}};
    double              worst = 0, worst_infrared = 0, worst_temp = 0;
    for (int b = 0; b < 7; b++) {
        PlanckTable *table = NULL;
        CHECK(planck_table_create(&table, band[b][0], band[b][1]) == STATUS_OK);
        for (double temp_k = 180; temp_k <= 1500; temp_k += 0.0317) { /* falls anywhere within a cell */
            const double want = planck_band(band[b][0], band[b][1], temp_k, NULL);
            const double error = relative(planck_table_radiance(table, temp_k), want);
            worst = fmax(worst, error);
            if (b > 1) worst_infrared = fmax(worst_infrared, error);
            if (((int)(temp_k * 100) & 15) == 0)
                worst_temp = fmax(worst_temp, fabs(planck_table_temp(table, want) - temp_k));
        }
        /* the ends and beyond them */
        CHECK_NEAR(planck_table_radiance(table, 180) / planck_band(band[b][0], band[b][1], 180, NULL), 1, 1e-8);
        CHECK_NEAR(planck_table_radiance(table, 1500) / planck_band(band[b][0], band[b][1], 1500, NULL), 1, 1e-8);
        CHECK(planck_table_radiance(table, 2000) == planck_band(band[b][0], band[b][1], 2000, NULL));
        CHECK(planck_table_radiance(table, 100) == planck_band(band[b][0], band[b][1], 100, NULL));
        CHECK(isnan(planck_table_radiance(table, NAN)) && isnan(planck_table_temp(table, NAN)));
        CHECK(isnan(planck_table_radiance(table, 0)) && isnan(planck_table_temp(table, 0)));
        CHECK_NEAR(planck_table_temp(table, planck_band(band[b][0], band[b][1], 3000, NULL)), 3000, 1e-6);
        planck_table_destroy(table);
    }
    print_message("table over 180 .. 1500 K: worst %.2g, beyond 1.4 um %.2g, inverse %.2g K\n", worst, worst_infrared,
                  worst_temp);
    CHECK(worst < 1e-8 && worst_infrared < 1e-10 && worst_temp < 1e-3);
    PlanckTable *none = NULL;
    CHECK(planck_table_create(&none, 12e-6, 8e-6) == STATUS_BAD_VALUE && none == NULL);
    planck_table_destroy(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spectral_has_its_limits),         cmocka_unit_test(spectral_integrates_to_stefan_boltzmann),
        cmocka_unit_test(band_agrees_with_25_digits),      cmocka_unit_test(band_pins),
        cmocka_unit_test(band_is_the_sum_of_its_pieces),   cmocka_unit_test(narrow_band_is_spectral),
        cmocka_unit_test(derivative_is_the_derivative),    cmocka_unit_test(inverse_inverts),
        cmocka_unit_test(many_temperatures_are_each_ones), cmocka_unit_test(table_follows_the_function),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
