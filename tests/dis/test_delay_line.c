/* The lower hull of delays against a hull made of all points at once, drift on lines made by hand, and the trend
 * against the textbook's sums. */
#include "tests/check.h"

#include "dis/clock/exercise_clock_private.h"

/* Andrew's monotone chain over columns of which only the lowest point counts; low[x] < 0: there is none. */
static int chain(int x[64], int y[64], const int low[64])
{
    int n = 0;
    for (int c = 0; c < 64; c++) {
        if (low[c] < 0) continue;
        while (n >= 2 && (x[n - 1] - x[n - 2]) * (low[c] - y[n - 2]) <= (y[n - 1] - y[n - 2]) * (c - x[n - 2])) n--;
        x[n] = c, y[n] = low[c], n++;
    }
    return n;
}

static void the_hull_is_that_of_all_points(void **state)
{
    (void)state;
    int most = 0;
    for (uint64_t round = 0; round < 400; round++) {
        const int width = 2 + (int)(30 * random_uniform(5, 1, 0, round)), height = round % 2 ? 200 : 8;
        int       low[64], x[64], y[64], n = 0;
        double    sum_x = 0, sum_y = 0;
        DelayLine line;
        for (int c = 0; c < 64; c++) low[c] = -1;
        for (uint64_t p = 0; p < 60; p++) {
            const int px = (int)(width * random_uniform(5, 2, (uint32_t)p, round));
            const int bowl = round % 4 == 3 ? (px - width / 2) * (px - width / 2) / 2 : 0; /* makes many vertices */
            const int py = bowl + (int)(height * random_uniform(5, 3, (uint32_t)p, round));
            if (low[px] < 0 || py < low[px]) low[px] = py;
            sum_x += px, sum_y += py;
            if (p == 0) delay_line_begin(&line, px, py);
            else delay_line_add(&line, px, py);
            n = chain(x, y, low);
            assert_true(n <= delay_line_vertices);
            assert_int_equal(line.count, n);
            for (int i = 0; i < n; i++) CHECK(line.x_s[i] == x[i] && line.y_s[i] == y[i]);
            const double mean = sum_x / (double)(p + 1);
            CHECK(line.points == p + 1);
            CHECK_NEAR(line.mean_x_s, mean, 1e-12);
            CHECK_NEAR(line.mean_y_s, sum_y / (double)(p + 1), 1e-11);

            double span, middle;
            double slope = delay_line_edge(&span, &middle, &line);
            CHECK(span == x[n - 1] - x[0]);
            if (n == 1) CHECK(slope == 0 && middle == y[0]);
            for (int i = 0; i + 1 < n; i++) { /* the edge below the mean */
                if (!(mean > x[i] + 1e-9 && mean < x[i + 1] - 1e-9)) continue;
                const double want = (double)(y[i + 1] - y[i]) / (x[i + 1] - x[i]);
                CHECK_NEAR(slope, want, 1e-12);
                CHECK_NEAR(middle, y[i] + want * (mean - x[i]), 1e-10);
            }
        }
        most = n > most ? n : most;
    }
    CHECK(most >= 8);
}

/* Sixteen vertices are kept. Of seventeen on a parabola, whose triangles all have the area 1, that one goes whose
 * triangle is made flatter. */
static void the_flattest_vertex_goes(void **state)
{
    (void)state;
    for (int flat = 1; flat <= 15; flat++) {
        DelayLine line;
        for (int k = 0; k <= 16; k++) {
            const int x = k < 16 ? (k * 7) % 16 : 16; /* 0 .. 15 in another order */
            if (k == 0) delay_line_begin(&line, x, x * x);
            else delay_line_add(&line, x, x * x + (x == flat ? 0.5 : 0));
        }
        assert_int_equal(line.count, 16);
        for (int i = 0; i < 16; i++) CHECK(line.x_s[i] == (i < flat ? i : i + 1));
    }
}

/* Points a second apart on a rising edge, every other one late; returns the slope that is applied after the last one.
 */
static double applied_slope(double slope, double late_s, int points)
{
    DelayLine line;
    delay_line_begin(&line, 0, 5);
    for (int k = 1; k < points; k++) delay_line_add(&line, k, 5 + slope * k + (k % 2 ? late_s : 0));
    return line.slope;
}

/* A slope is a drift after 64 points, up to 2e-4 s a second, where it amounts to 1 ms, and to more than 30 J / N: with
 * J twice the mean's height above the edge, here late_s 64 / 65, a slope of 1.5e-4 over 64 s may have late_s up to 9.6
 * ms 65 / 30 65 / 64 = 21.1 ms; at the point before it is 9.45 ms 64 / 30 = 20.2 ms. */
static void what_is_a_drift(void **state)
{
    (void)state;
    CHECK_NEAR(applied_slope(1.5e-4, 0, 64), 1.5e-4, 1e-12);
    CHECK(applied_slope(1.5e-4, 0, 63) == 0);
    CHECK_NEAR(applied_slope(1.95e-4, 0, 64), 1.95e-4, 1e-12);
    CHECK_NEAR(applied_slope(-1.95e-4, 0, 64), -1.95e-4, 1e-12);
    CHECK(applied_slope(2.05e-4, 0, 64) == 0 && applied_slope(-2.05e-4, 0, 64) == 0);
    CHECK_NEAR(applied_slope(1.04e-3 / 63, 0, 64), 1.04e-3 / 63, 1e-12);
    CHECK(applied_slope(0.96e-3 / 63, 0, 64) == 0);
    CHECK_NEAR(applied_slope(1.5e-4, 0.0206, 65), 1.5e-4, 1e-12);
    CHECK(applied_slope(1.5e-4, 0.0217, 65) == 0);
}

/* An offset is applied when the line changes by more than 0.1 ms at its first or at its last point. */
static void small_changes_are_not_applied(void **state)
{
    (void)state;
    for (int k = 0; k < 2; k++) {
        DelayLine line;
        delay_line_begin(&line, 0, 5);
        delay_line_add(&line, 10, 5 - (k ? 1.05e-4 : 0.95e-4));
        CHECK(delay_line_at(&line, 3) == (k ? 5 - 1.05e-4 : 5));
        delay_line_add(&line, 20, 7); /* late: nothing changes */
        CHECK(delay_line_at(&line, 3) == (k ? 5 - 1.05e-4 : 5));
    }
}

/* Least squares: slope Sxy / Sxx, variance of the residuals (Syy - Sxy^2 / Sxx) / (n - 2), of the slope that over Sxx.
 */
static void the_trend_is_least_squares(void **state)
{
    (void)state;
    DelayTrend t = {0};
    double     x[40], y[40], slope, error;
    for (int n = 0; n < 40; n++) {
        x[n] = 100 + n + 0.3 * random_uniform(5, 5, 0, (uint64_t)n) - (n == 7 ? 20 : 0);
        y[n] = 3 - 0.02 * n + random_uniform(5, 6, 0, (uint64_t)n);
        delay_trend_add(&t, x[n], y[n]);
        delay_trend_add(&t, x[n], y[n]); /* of the same datagram: one point */
        CHECK(t.points == (uint64_t)n + 1);
        double mean_x = 0, mean_y = 0, xx = 0, xy = 0, yy = 0, first = INFINITY, last = -INFINITY;
        for (int i = 0; i <= n; i++) mean_x += x[i] / (n + 1), mean_y += y[i] / (n + 1);
        for (int i = 0; i <= n; i++) {
            xx += (x[i] - mean_x) * (x[i] - mean_x);
            xy += (x[i] - mean_x) * (y[i] - mean_y);
            yy += (y[i] - mean_y) * (y[i] - mean_y);
            first = fmin(first, x[i]), last = fmax(last, x[i]);
        }
        CHECK(t.first_x_s == first && t.last_x_s == last);
        CHECK(delay_trend_slope(&slope, &error, &t) == (n >= 2));
        if (n < 2) CHECK(isinf(delay_trend_scatter(&t)));
        if (n < 2) continue;
        const double variance = (yy - xy * xy / xx) / (n - 1);
        CHECK_NEAR(slope, xy / xx, 1e-12);
        CHECK_NEAR(error, sqrt(variance / xx), 1e-9);
        CHECK_NEAR(delay_trend_scatter(&t), sqrt(variance), 1e-9);
    }
    delay_trend_add(&t, x[39], 9); /* one stamp, another arrival; one arrival, another stamp */
    delay_trend_add(&t, 200, 9);
    CHECK(t.points == 42);
}

/* On a straight line nothing is left but the resolution, 2 us a point: of n points sqrt(n / (n - 2)) 2 us. */
static void a_trend_is_no_better_than_its_clocks(void **state)
{
    (void)state;
    DelayTrend t = {0};
    double     slope, error;
    for (int n = 0; n < 5; n++) delay_trend_add(&t, n, 0.25 * n);
    CHECK(delay_trend_slope(&slope, &error, &t));
    CHECK_NEAR(slope, 0.25, 0);
    CHECK_NEAR(delay_trend_scatter(&t), 2e-6 * sqrt(5.0 / 3), 1e-15);
    CHECK_NEAR(error, 2e-6 * sqrt(5.0 / 3 / 10), 1e-15); /* Sxx of 0 .. 4 is 10 */
    t = (DelayTrend){0};
    for (int n = 0; n < 5; n++) delay_trend_add(&t, 7, 0.25 * n); /* of one stamp */
    CHECK(!delay_trend_slope(&slope, &error, &t));
    CHECK_NEAR(delay_trend_scatter(&t), sqrt(0.625 / 3), 1e-12); /* Syy of 0 .. 1 in quarters is 0.625 */
}

/* Student's t, two-sided, 0.01 %: quantile 0.99995 by scipy.stats.t.ppf for 1 .. 9 degrees of freedom. The last one is
 * kept for more of them, whose quantiles are smaller. */
static void critical_ratios_are_students(void **state)
{
    (void)state;
    static const double t[] = {6366, 99.99, 28, 15.54, 11.18, 9.082, 7.885, 7.12, 6.594};
    CHECK(isinf(delay_trend_critical(0)) && isinf(delay_trend_critical(2)));
    for (int d = 1; d <= 8; d++) CHECK_NEAR(delay_trend_critical((uint64_t)d + 2) / t[d - 1], 1, 3e-3);
    for (int d = 9; d < 1000; d *= 3) CHECK_NEAR(delay_trend_critical((uint64_t)d + 2), t[8], 0.02);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_hull_is_that_of_all_points),
        cmocka_unit_test(the_flattest_vertex_goes),
        cmocka_unit_test(what_is_a_drift),
        cmocka_unit_test(small_changes_are_not_applied),
        cmocka_unit_test(the_trend_is_least_squares),
        cmocka_unit_test(a_trend_is_no_better_than_its_clocks),
        cmocka_unit_test(critical_ratios_are_students),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
