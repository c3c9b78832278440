/* Detection at a constant rate of false alarms: multipliers against computed ones, the rate in noise by counting,
 * targets that are found. labels: physics */
#include "tests/check.h"

#include "sensor/radar/detect_private.h"

/* Probability that cell averaging detects a target whose power is exponential with mean snr times that of the noise, in
 * one look (Swerling 1). */
static double detection_probability(int training, double pfa, double snr)
{
    const double a = detect_cfar_multiplier(training, pfa);
    return exp(-training * log1p(a / (training * (1 + snr))));
}

/* data/radar/signal/ca_cfar_alpha.csv. */
static void multipliers_are_those_of_the_table(void **state)
{
    (void)state;
    static const double want[][3] = {{8, 1e-2, 6.22623528031},  {8, 1e-6, 36.9873060152},  {16, 1e-4, 12.4524705606},
                                     {32, 1e-3, 7.71000834406}, {64, 1e-6, 15.4200166881}, {64, 1e-2, 4.77490101256}};
    for (size_t i = 0; i < sizeof want / sizeof *want; i++)
        CHECK_NEAR(detect_cfar_multiplier((int)want[i][0], want[i][1]) / want[i][2], 1, 1e-11);
    CHECK(isnan(detect_cfar_multiplier(0, 1e-3)) && isnan(detect_cfar_multiplier(8, 0)) &&
          isnan(detect_cfar_multiplier(8, NAN)));
    /* no target: what is detected are false alarms; many cells: the exponential law itself */
    CHECK_NEAR(detection_probability(16, 1e-4, 0) / 1e-4, 1, 1e-12);
    CHECK_NEAR(detection_probability(100000, 1e-6, 31) / pow(1e-6, 1 / 32.0), 1, 1e-3);
}

/* Rohling's product as he gives it, and the greatest of one cell: a = 1 / pfa - 1. */
static void ordered_multipliers_solve_their_product(void **state)
{
    (void)state;
    for (int n = 4; n <= 64; n *= 2)
        for (double pfa = 1e-2; pfa > 1e-9; pfa *= 0.1) {
            const int    rank = 3 * n / 4;
            const double a = detect_ordered_multiplier(n, rank, pfa);
            double       product = 1;
            for (int i = 0; i < rank; i++) product *= (n - i) / (n - i + a);
            CHECK_NEAR(product / pfa, 1, 1e-10);
        }
    CHECK_NEAR(detect_ordered_multiplier(1, 1, 1e-3), 999, 1e-8);
    CHECK(isnan(detect_ordered_multiplier(8, 9, 1e-3)));
}

enum { rows = 64, columns = 512, planes = 40 };

/* Peaks over the threshold of noise alone, beside the rate asked. A cell is a false alarm only where it is the
 * greatest of its nine; at these thresholds its neighbours seldom pass it, so that the count is less than pfa by a
 * few per cent at most. */
static void rate_in_noise(double ordered)
{
    static double  power[rows * columns];
    const double   pfa = 1e-3;
    CfarConfig     config = {.pfa = pfa, .guard = {2, 2}, .training = {4, 6}, .ordered = ordered, .wrap_rows = true};
    static CfarHit hit[1000];
    int            found = 0;
    for (int k = 0; k < planes; k++) {
        for (int i = 0; i < rows * columns; i++) power[i] = -5 * log(random_uniform(7, 0, (uint32_t)k, (uint64_t)i));
        found += detect_cfar(hit, 1000, &config, power, rows, columns);
    }
    const double want = pfa * rows * columns * planes; /* 1311; counting alone scatters by 36 */
    CHECK(found > 0.9 * want && found < 1.1 * want);
}

static void noise_has_the_rate_asked(void **state)
{
    (void)state;
    rate_in_noise(0);
    rate_in_noise(0.75);
}

static void targets_are_found_where_they_are(void **state)
{
    (void)state;
    static double    power[rows * columns];
    const CfarConfig config = {.pfa = 1e-6, .guard = {1, 2}, .training = {4, 8}, .wrap_rows = true};
    CfarHit          hit[8];
    for (int i = 0; i < rows * columns; i++) power[i] = 2 * (1 + 0.2 * random_uniform(8, 0, 0, (uint64_t)i));
    power[0 * columns + 100] = 400;  /* at the edge of Doppler: its training cells are on both sides */
    power[40 * columns + 511] = 300; /* at the edge of range */
    power[20 * columns + 7] = power[20 * columns + 8] = 500; /* twins: one hit, the first */
    CHECK(detect_cfar(hit, 8, &config, power, rows, columns) == 3);
    CHECK(hit[0].row == 0 && hit[0].column == 100 && hit[1].row == 20 && hit[1].column == 7);
    CHECK(hit[2].row == 40 && hit[2].column == 511);
    CHECK_NEAR(hit[0].floor, 2.2, 0.05);
    CHECK(hit[1].power == 500);
    CHECK(detect_cfar(hit, 1, &config, power, rows, columns) == 3); /* how many there are */

    CfarConfig bad = config;
    bad.pfa = 0;
    CHECK(detect_cfar(hit, 8, &bad, power, rows, columns) == -1);
    bad = config, bad.training[0] = 40;
    CHECK(detect_cfar(hit, 8, &bad, power, rows, columns) == -1); /* wider than the plane goes round */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(multipliers_are_those_of_the_table),
        cmocka_unit_test(ordered_multipliers_solve_their_product),
        cmocka_unit_test(noise_has_the_rate_asked),
        cmocka_unit_test(targets_are_found_where_they_are),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
