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

    /* the last cell of a row is no neighbour of the next row's first */
    for (int i = 0; i < rows * columns; i++) power[i] = 2;
    power[5 * columns] = 400, power[4 * columns + columns - 1] = 500;
    power[30 * columns] = 500, power[29 * columns + columns - 1] = 400;
    CHECK(detect_cfar(hit, 8, &config, power, rows, columns) == 4);

    CfarConfig bad = config;
    bad.pfa = 0;
    CHECK(detect_cfar(hit, 8, &bad, power, rows, columns) == -1);
    bad = config, bad.training[0] = 40;
    CHECK(detect_cfar(hit, 8, &bad, power, rows, columns) == -1); /* wider than the plane goes round */
}

/* A map of 15 x 17 cells of power 1, one of them 2 and one the peak, with windows that differ in rows and columns: the
 * mean of N training cells is 1 + 1 / N where the 2 is one of them, and 1 where it is not. By hand: guard 1 row and 2
 * columns, training 2 rows and 3 columns beyond: of (2 3 + 1) (2 5 + 1) = 77 cells in the plane 3 5 = 15 are guarded,
 * N = 62; at the edges what lies in the plane counts, and with rows that go round the far rows do. */
enum { small_rows = 15, small_columns = 17 };

static void each_training_cell_counts_once(const int peak[2], bool wrap, int training)
{
    static double power[small_rows * small_columns];
    /* a false-alarm rate that any peak passes */
    const CfarConfig config = {.pfa = 0.5, .guard = {1, 2}, .training = {2, 3}, .wrap_rows = wrap};
    int              counted = 0;
    for (int r = 0; r < small_rows; r++)
        for (int c = 0; c < small_columns; c++) {
            CfarHit hit[8];
            if (r == peak[0] && c == peak[1]) continue;
            int       away = abs(r - peak[0]);
            const int across = abs(c - peak[1]);
            if (wrap && away > small_rows / 2) away = small_rows - away;
            const bool trains = away <= 3 && across <= 5 && !(away <= 1 && across <= 2);
            for (int i = 0; i < small_rows * small_columns; i++) power[i] = 1;
            power[r * small_columns + c] = 2;
            power[peak[0] * small_columns + peak[1]] = 1000;
            const int found = detect_cfar(hit, 8, &config, power, small_rows, small_columns);
            int       of = 0;
            while (of < found && of < 7 && hit[of].power < 1000) of++;
            CHECK(hit[of].row == peak[0] && hit[of].column == peak[1] && hit[of].power == 1000);
            CHECK_NEAR(hit[of].floor, trains ? 1 + 1.0 / training : 1, 1e-12);
            counted += trains;
        }
    CHECK(counted == training);
}

static void training_cells_are_those_between_guard_and_reach(void **state)
{
    (void)state;
    each_training_cell_counts_once((const int[2]){7, 8}, false, 62);
    each_training_cell_counts_once((const int[2]){7, 0}, false, 7 * 6 - 3 * 3);
    each_training_cell_counts_once((const int[2]){7, 16}, false, 7 * 6 - 3 * 3);
    each_training_cell_counts_once((const int[2]){7, 14}, false, 7 * 8 - 3 * 5);
    each_training_cell_counts_once((const int[2]){0, 8}, false, 4 * 11 - 2 * 5);
    each_training_cell_counts_once((const int[2]){14, 8}, false, 4 * 11 - 2 * 5);
    each_training_cell_counts_once((const int[2]){0, 0}, false, 4 * 6 - 2 * 3);
    each_training_cell_counts_once((const int[2]){14, 16}, false, 4 * 6 - 2 * 3);
    each_training_cell_counts_once((const int[2]){0, 8}, true, 62);
    each_training_cell_counts_once((const int[2]){14, 8}, true, 62);
    each_training_cell_counts_once((const int[2]){13, 16}, true, 7 * 6 - 3 * 3);
}

/* Whether the middle of seven cells a, b, 0, peak, 0, c, d passes: one row, one guard cell and two training cells a
 * side. */
static int passes(double *floor, const CfarConfig *config, double peak)
{
    CfarHit      hit[4];
    const double power[7] = {3, 1, 0, peak, 0, 4, 2};
    const int    found = detect_cfar(hit, 4, config, power, 1, 7);
    for (int i = 0; i < found; i++)
        if (hit[i].column == 3) {
            *floor = hit[i].floor;
            return 1;
        }
    return 0;
}

/* Of training cells 1, 2, 3, 4, N = 4. Cell averaging: mean 2.5; (1 + a / 4)^-4 = 1 / 81 where a = 8: the threshold is
 * 20. Ordered, the third: 4 / (4 + a) 3 / (3 + a) 2 / (2 + a) = 1 / 30 where a = 6: 6 times 3 is 18, and the third of
 * four of mean m is expected at m (1/4 + 1/3 + 1/2). The first of them, 4 / (4 + a) = 1 / 9 where a = 32: 32 times 1.
 */
static void thresholds_are_those_on_paper(void **state)
{
    (void)state;
    CfarConfig config = {.pfa = 1.0 / 81, .guard = {0, 1}, .training = {0, 2}};
    double     floor = 0;
    CHECK(passes(&floor, &config, 20 * (1 + 1e-9)) == 1 && passes(&floor, &config, 20 * (1 - 1e-9)) == 0);
    CHECK(passes(&floor, &config, 21) == 1);
    CHECK_NEAR(floor, 2.5, 1e-12);
    config.pfa = 1.0 / 30, config.ordered = 0.75;
    CHECK(passes(&floor, &config, 18 * (1 + 1e-9)) == 1 && passes(&floor, &config, 18 * (1 - 1e-9)) == 0);
    CHECK(passes(&floor, &config, 19) == 1);
    CHECK_NEAR(floor, 3 / (13.0 / 12), 1e-12);
    config.pfa = 1.0 / 9, config.ordered = 0.1; /* below one cell: the first */
    CHECK(passes(&floor, &config, 32 * (1 + 1e-9)) == 1 && passes(&floor, &config, 32 * (1 - 1e-9)) == 0);
    /* three training cells are too few: four rows of one column, the last of them the peak */
    const double     power[6] = {1, 1, 1, 1, 0, 1e6};
    const CfarConfig down = {.pfa = 0.1, .guard = {1, 0}, .training = {3, 0}};
    CfarHit          hit[4];
    CHECK(detect_cfar(hit, 4, &down, power + 1, 5, 1) == 0 && detect_cfar(hit, 4, &down, power, 6, 1) == 0);
    const CfarConfig longer = {.pfa = 0.1, .guard = {1, 0}, .training = {4, 0}};
    CHECK(detect_cfar(hit, 4, &longer, power, 6, 1) == 1 && hit[0].row == 5);
}

/* Of equal neighbours the first is the hit: in a row, in a column, askew, and from the last row to the first where rows
 * go round. */
static void equal_neighbours_are_one_hit(void **state)
{
    (void)state;
    static const int at[5][2][2] = {
        {{5, 6}, {5, 7}}, {{5, 6}, {6, 6}}, {{5, 6}, {6, 7}}, {{5, 7}, {6, 6}}, {{0, 6}, {14, 6}}};
    static double power[small_rows * small_columns];
    for (int k = 0; k < 6; k++) {
        const int(*twin)[2] = at[k < 5 ? k : 4];
        const CfarConfig config = {.pfa = 1e-3, .guard = {1, 2}, .training = {2, 3}, .wrap_rows = k < 5};
        CfarHit          hit[8];
        for (int i = 0; i < small_rows * small_columns; i++) power[i] = 1;
        for (int i = 0; i < 2; i++) power[twin[i][0] * small_columns + twin[i][1]] = 1000;
        CHECK(detect_cfar(hit, 8, &config, power, small_rows, small_columns) == (k < 5 ? 1 : 2));
        CHECK(hit[0].row == twin[0][0] && hit[0].column == twin[0][1]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(multipliers_are_those_of_the_table),
        cmocka_unit_test(ordered_multipliers_solve_their_product),
        cmocka_unit_test(noise_has_the_rate_asked),
        cmocka_unit_test(targets_are_found_where_they_are),
        cmocka_unit_test(training_cells_are_those_between_guard_and_reach),
        cmocka_unit_test(thresholds_are_those_on_paper),
        cmocka_unit_test(equal_neighbours_are_one_hit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
