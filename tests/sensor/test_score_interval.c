/* Intervals of rates over sequences: published bounds; and how often they hold the truth, in simulations whose frames
 * agree within a sequence as those of one orbit do. Simulated sequences go through the sums that scoring uses
 * (rates.h). */
#include "tests/check.h"

#include "sensor/score/interval.h"
#include "sensor/score/rates.h"

/* Newcombe, Two-sided confidence intervals for the single proportion, Stat. Med. 17 (1998) 857, table I, method 3. */
static void test_published(void **state)
{
    (void)state;
    static const struct {
        int    found, of;
        double low, high;
    } rows[] = {{81, 263, 0.2553, 0.3662}, {15, 148, 0.0624, 0.1605}, {0, 20, 0, 0.1611}, {1, 29, 0.0061, 0.1718}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        const Interval got = interval_of_share((double)rows[i].found / rows[i].of, rows[i].of);
        CHECK_NEAR(got.low, rows[i].low, 5.1e-5);
        CHECK_NEAR(got.high, rows[i].high, 5.1e-5);
    }
    CHECK(interval_of_share(0, 20).low == 0 && interval_of_share(1, 20).high == 1);
    CHECK(isnan(interval_of_share(0.5, 0).low) && isnan(interval_of_count(0.5, 0, 1).high));
}

/* The bounds are the means from which the count is just 1.96 standard deviations away. */
static void test_count_bounds(void **state)
{
    (void)state;
    for (double mean = 0; mean < 20; mean += 0.7)
        for (double samples = 1; samples < 200; samples *= 3)
            for (double dispersion = 1; dispersion < 5; dispersion += 1.5) {
                const Interval i = interval_of_count(mean, samples, dispersion);
                const double   sd = sqrt(i.high * dispersion / samples);
                CHECK_NEAR((i.high - mean) / sd, 1.959963984540054, 1e-9);
                if (mean > 0) CHECK_NEAR((mean - i.low) / sqrt(i.low * dispersion / samples), 1.959963984540054, 1e-6);
                else CHECK(i.low == 0);
            }
}

static void test_samples(void **state)
{
    (void)state;
    CHECK_NEAR(interval_samples(50, 10 * 25), 10, 1e-12);         /* ten of five frames */
    CHECK_NEAR(interval_samples(101, 100 * 100 + 1), 1.02, 1e-3); /* one has nearly all */
    CHECK(interval_samples(0, 0) == 0);
    CHECK_NEAR(interval_dispersion(40, 4 * 100. / 1, 4, 4), 1, 1e-12); /* four equal counts of ten: none between */
    /* counts 0, 0, 20, 20 of one frame each: mean 10, variance 400 / 3 */
    CHECK_NEAR(interval_dispersion(40, 800, 4, 4), 400. / 3 / 10, 1e-12);
    CHECK(interval_dispersion(0, 0, 4, 4) == 1 && interval_dispersion(9, 81, 1, 1) == 1);
}

/* ---- coverage ------------------------------------------------------------------------------------------- */

enum { trials = 4000 };

static double draw(uint32_t stream, int trial, uint64_t index)
{
    return random_uniform(20261130, stream, (uint32_t)trial, index);
}

/* Detection: share of trials whose interval holds p. agree: chance that a frame does as its sequence does, else it is
 * drawn by itself. naive: the same bounds, but each frame taken for a sample. */
static double covered(double *naive, int sequences, double agree)
{
    int held = 0, held_naive = 0;
    for (int t = 0; t < trials; t++) {
        const double p = draw(1, t, 0);
        RateSums     sums = {0};
        for (int s = 0; s < sequences; s++) {
            const int  frames = 10 + (int)(40 * draw(2, t, (uint64_t)s));
            const bool seen = draw(3, t, (uint64_t)s) < p;
            for (int f = 0; f < frames; f++) {
                const uint64_t at = (uint64_t)s * 64 + (uint64_t)f;
                sums.now.chances++, sums.now.frames++;
                sums.now.found += draw(4, t, at) < agree ? seen : draw(5, t, at) < p;
            }
            rates_end_sequence(&sums);
        }
        const ScoreRates r = rates_of(&sums, NAN, NAN);
        const Interval   each = interval_of_share(r.detection.value, (double)r.chances);
        held += p >= r.detection.low && p <= r.detection.high;
        held_naive += p >= each.low && p <= each.high;
    }
    *naive = (double)held_naive / trials;
    return (double)held / trials;
}

static void test_detection_covers(void **state)
{
    (void)state;
    for (int sequences = 10; sequences <= 90; sequences *= 3) {
        double       naive, unused;
        const double all = covered(&naive, sequences, 1), half = covered(&unused, sequences, 0.5);
        printf("%d sequences: %.3f where frames agree, %.3f where half of them do; frames as samples: %.3f\n",
               sequences, all, half, naive);
        CHECK(all >= 0.94 && all <= 0.97); /* 0.95, and three standard errors of 4000 trials */
        CHECK(half >= 0.95);
        CHECK(naive < 0.5);
    }
}

/* Number of events of a Poisson process of this mean. */
static int poisson(double mean, int trial, uint64_t index)
{
    double product = 1;
    int    n = 0;
    for (uint64_t i = 0; i < 200; i++, n++) {
        product *= 1 - draw(6, trial, index * 256 + i);
        if (product < exp(-mean)) break;
    }
    return n;
}

/* False alarms a frame: of sequences in each frame of which as many rocks are taken for targets. cluttered: a third of
 * the sequences has three times the mean, the others none. */
static double covered_count(int sequences, bool cluttered)
{
    int held = 0;
    for (int t = 0; t < trials; t++) {
        const double mean = 0.2 + 3 * draw(7, t, 0);
        RateSums     sums = {0};
        for (int s = 0; s < sequences; s++) {
            const int    frames = 10 + (int)(40 * draw(8, t, (uint64_t)s));
            const double own = !cluttered ? mean : draw(9, t, (uint64_t)s) < 1. / 3 ? 3 * mean : 0;
            sums.now.frames = frames;
            sums.now.false_alarms = (long long)frames * poisson(own, t, (uint64_t)s);
            rates_end_sequence(&sums);
        }
        const ScoreRates r = rates_of(&sums, NAN, NAN);
        held += mean >= r.per_frame.low && mean <= r.per_frame.high;
    }
    return (double)held / trials;
}

static void test_false_alarms_cover(void **state)
{
    (void)state;
    for (int sequences = 10; sequences <= 90; sequences *= 3) {
        const double even = covered_count(sequences, false), cluttered = covered_count(sequences, true);
        printf("%d sequences: %.3f of even clutter, %.3f of clutter in a third of them\n", sequences, even, cluttered);
        CHECK(even >= 0.93 && even <= 0.985);
        CHECK(cluttered >= (sequences < 30 ? 0.85 : 0.93));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_published),
        cmocka_unit_test(test_count_bounds),
        cmocka_unit_test(test_samples),
        cmocka_unit_test(test_detection_covers),
        cmocka_unit_test(test_false_alarms_cover),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
