/* Samples of many echoes by gridding against the sum that they stand for, echo by echo, in double. labels: physics */
#include "tests/check.h"

#include "sensor/radar/echo_private.h"

static const double light_mps = 299792458.0;
static double       uniform(int i) { return random_uniform(3, 0, 0, (uint64_t)i); }

enum { samples = 128, pulses = 20, echoes = 300, all = interval_channels * pulses * samples, most_pulses = 97 };

static const Waveform wave = {.centre_hz = 94e9,
                              .bandwidth_hz = 128 * 4e6,
                              .pulse_s = 1e-5,
                              .repeat_hz = 2e4,
                              .samples = samples,
                              .pulses = pulses};
static double complex got[interval_channels * most_pulses * samples], want[interval_channels * most_pulses * samples];

/* What they stand for, from the times and frequencies of interval.h's Waveform. */
static void add_by_hand(const Waveform *w, const Echo *e, double unfollowed_m)
{
    const double step_hz = w->bandwidth_hz / samples, row_s = 1 / w->repeat_hz;
    const double step_s = w->kind == WAVEFORM_PULSE_DOPPLER ? 0
                          : w->kind == WAVEFORM_STEPPED     ? row_s / samples
                                                            : w->pulse_s / samples;
    const double turn = pi_rad * w->centre_hz / light_mps * (e->path_per_pulse_m + unfollowed_m) / row_s * w->pulse_s;
    const bool   plain = w->kind == WAVEFORM_PULSE_DOPPLER || w->kind == WAVEFORM_STEPPED;
    const double left = plain && turn != 0 ? sin(turn) / turn : 1;
    for (int c = 0; c < interval_channels; c++)
        for (int p = 0; p < w->pulses; p++)
            for (int m = 0; m < samples; m++) {
                const double t_s = (p - 0.5 * (w->pulses - 1)) * row_s + (m - samples / 2) * step_s;
                const double path_m = e->path_m + (e->path_per_pulse_m + unfollowed_m) * t_s / row_s;
                want[(c * w->pulses + p) * samples + m] +=
                    left * e->amplitude[c] *
                    cexp(-I * 2 * pi_rad / light_mps * (w->centre_hz + (m - samples / 2) * step_hz) * path_m);
            }
}

static double worst(int rows)
{
    double most = 0;
    for (int i = 0; i < interval_channels * rows * samples; i++) most = fmax(most, cabs(got[i] - want[i]));
    return most;
}

static void samples_are_the_sum(void **state)
{
    (void)state;
    const double window_m = light_mps * samples / wave.bandwidth_hz;
    static Echo  echo[echoes];
    EchoGrid    *grid;
    Pool        *pool;
    double       total = 0;
    CHECK(echo_grid_create(&grid, &wave) == STATUS_OK && pool_create(&pool, 3) == STATUS_OK);
    for (int i = 0; i < echoes; i++) {
        /* beyond half the window too: they fold over; and at its very ends */
        echo[i].path_m = i < 4 ? (double[]){0, 0.5 * window_m, -0.5 * window_m, window_m}[i]
                               : 1.4 * window_m * (uniform(16 * i) - 0.5);
        for (int c = 0; c < interval_channels; c++)
            echo[i].amplitude[c] =
                i % 5 == c ? 0 : (uniform(16 * i + 2 + c) - 0.5) + I * (uniform(16 * i + 8 + c) - 0.5);
        add_by_hand(&wave, &echo[i], 0);
        total += cabs(echo[i].amplitude[0]);
    }
    static double complex first[all];
    for (int again = 0; again < 3; again++) { /* in one call or two, one thread or three: the same */
        echo_add(grid, echo, again == 1 ? 100 : echoes, again == 2 ? pool : NULL);
        if (again == 1) echo_add(grid, echo + 100, echoes - 100, pool);
        echo_sum(got, grid);
        CHECK(worst(pulses) < 1e-6 * total);
        if (again == 0) memcpy(first, got, sizeof first);
        CHECK(memcmp(first, got, sizeof first) == 0);
    }
    echo_sum(got, grid);
    for (int i = 0; i < all; i++) CHECK(got[i] == 0);
    echo_grid_destroy(grid);
    pool_destroy(pool);
}

/* Echoes that move, of each waveform: every sample at its own time and frequency. */
static void moving_echoes_are_at_their_times(void **state)
{
    (void)state;
    static const struct {
        WaveformKind kind;
        double       most_mps, pulse_s, repeat_hz, unfollowed_mps; /* of path */
    } of[] = {{WAVEFORM_LFM, 600, 2e-5, 2e4, 0},
              {WAVEFORM_FMCW, 100, 1e-4, 8e3, 0},
              {WAVEFORM_FMCW, 100, 1e-4, 8e3, -600},
              {WAVEFORM_STEPPED, 40, 2.5e-7, 781.25, 0},
              {WAVEFORM_STEPPED, 500, 2.5e-7, 781.25, 0},
              {WAVEFORM_STEPPED, 40, 2.5e-7, 781.25, -500},
              {WAVEFORM_STEPPED, 15000, 2.5e-7, 781.25, 0},
              {WAVEFORM_PULSE_DOPPLER, 2000, 1e-6, 4e6, 0},
              {WAVEFORM_PULSE_DOPPLER, 2000, 1e-6, 4e6, 900}};
    for (size_t k = 0; k < sizeof of / sizeof *of; k++) {
        Waveform  w = wave;
        EchoGrid *grid;
        double    edge = 0, middle = 0;
        w.kind = of[k].kind, w.pulse_s = of[k].pulse_s, w.repeat_hz = of[k].repeat_hz;
        CHECK(echo_grid_create(&grid, &w) == STATUS_OK);
        for (int i = 0; i < 12; i++) {
            const Echo echo = {.path_m = 60 * (uniform(i) - 0.5),
                               .amplitude = {1, 0, I, 0},
                               .path_per_pulse_m =
                                   (i < 2 ? 2 * i - 1 : uniform(i + 100) - 0.5) * of[k].most_mps / w.repeat_hz};
            memset(want, 0, sizeof want);
            add_by_hand(&w, &echo, of[k].unfollowed_mps / w.repeat_hz);
            echo_unfollowed(grid, of[k].unfollowed_mps / w.repeat_hz);
            echo_add(grid, &echo, 1, NULL);
            echo_sum(got, grid);
            CHECK(echo_status(grid) == STATUS_OK);
            edge = fmax(edge, worst(pulses));
            for (int p = 0; p < pulses; p++)
                middle = fmax(middle, cabs(got[p * samples + samples / 2] - want[p * samples + samples / 2]));
        }
        printf("%s, %g m/s: %.1e at the band's ends, %.1e in its middle\n", waveform_name[w.kind], of[k].most_mps, edge,
               middle);
        CHECK(edge < 3e-3 && middle < 1e-4);
        echo_grid_destroy(grid);
    }
}

/* An echo that moves by up to 3 m a row in a stepped waveform bends by exp(-j q u^2), q = pi B growth / (2 c): factors
 * by Bessel functions of q / 2 from 0.03 to 4, whatever their recurrence passes through. */
static void bends_of_every_size(void **state)
{
    (void)state;
    Waveform  w = wave;
    EchoGrid *grid;
    double    edge = 0;
    w.kind = WAVEFORM_STEPPED, w.pulse_s = 2.5e-7, w.repeat_hz = 781.25, w.pulses = 2;
    CHECK(echo_grid_create(&grid, &w) == STATUS_OK);
    for (int i = 1; i <= 300; i++) {
        const Echo echo = {.path_m = 3, .amplitude = {1}, .path_per_pulse_m = (i % 2 ? -0.01 : 0.01) * i};
        memset(want, 0, sizeof want);
        add_by_hand(&w, &echo, 0);
        echo_add(grid, &echo, 1, NULL);
        echo_sum(got, grid);
        edge = fmax(edge, worst(2));
    }
    CHECK(echo_status(grid) == STATUS_OK);
    printf("bends: %.1e\n", edge);
    CHECK(edge < 3e-3);
    echo_grid_destroy(grid);
}

/* One fast echo among many: the same bits for any pool and any division into calls. */
static void fast_echoes_have_the_same_bits(void **state)
{
    (void)state;
    static Echo           echo[echoes];
    static double complex first[all];
    Waveform              w = wave;
    EchoGrid             *grid;
    Pool                 *pool;
    w.kind = WAVEFORM_STEPPED, w.repeat_hz = 781.25, w.pulse_s = 2.5e-7;
    CHECK(echo_grid_create(&grid, &w) == STATUS_OK && pool_create(&pool, 3) == STATUS_OK);
    for (int i = 0; i < echoes; i++)
        echo[i] = (Echo){uniform(i), (i == 200 ? 1 : 1e-3) * (uniform(i + 500) - 0.5), {1, I, 0, uniform(i + 900)}};
    for (int again = 0; again < 3; again++) {
        echo_add(grid, echo, again == 1 ? 100 : echoes, again == 2 ? pool : NULL);
        if (again == 1) echo_add(grid, echo + 100, echoes - 100, pool);
        echo_sum(got, grid);
        if (again == 0) memcpy(first, got, sizeof first);
        CHECK(memcmp(first, got, sizeof first) == 0);
    }
    echo_grid_destroy(grid);
    pool_destroy(pool);
}

/* From standing echoes to some that need another term each, and on to those that go row by row: all are right, and of
 * either side the same bits for any pool and any division into calls. Even numbers of rows and odd ones. */
static void slow_and_fast_echoes_are_alike(void **state)
{
    (void)state;
    enum { rates = 48, many = 2 * rates };
    static double complex first[interval_channels * most_pulses * samples];
    static const struct {
        WaveformKind kind;
        int          rows, terms_most;
        double       pulse_s, repeat_hz;
    } of[] = {{WAVEFORM_LFM, 96, 8, 2e-5, 2e4},
              {WAVEFORM_LFM, 97, 8, 2e-5, 2e4},
              {WAVEFORM_FMCW, 48, 6, 1e-4, 8e3},
              {WAVEFORM_STEPPED, 32, 4, 2.5e-7, 781.25},
              {WAVEFORM_PULSE_DOPPLER, 16, 2, 1e-6, 4e6}};
    Pool *pool;
    CHECK(pool_create(&pool, 3) == STATUS_OK);
    for (size_t k = 0; k < sizeof of / sizeof *of; k++) {
        Waveform  w = wave;
        EchoGrid *grid;
        Echo      echo[many];
        int       terms = 1, most = 0;
        double    edge = 0, middle = 0, even = 0;
        w.kind = of[k].kind, w.pulses = of[k].rows, w.pulse_s = of[k].pulse_s, w.repeat_hz = of[k].repeat_hz;
        CHECK(echo_grid_create(&grid, &w) == STATUS_OK);
        /* radians at the band's ends and the interval's that the delay moves by: 0, then 1e-3 .. 4 */
        for (int i = 0; i < many; i++) {
            const double by = i / 2 ? 1e-3 * pow(4000, (i / 2 - 1) / (rates - 2.0)) : 0;
            echo[i] = (Echo){.path_m = 20 * (uniform(i) - 0.5), .amplitude = {1, 0, I, 0}};
            echo[i].path_per_pulse_m = (i % 2 ? -1 : 1) * by * light_mps / (pi_rad * w.bandwidth_hz * 0.5 * w.pulses);
            memset(want, 0, sizeof want);
            add_by_hand(&w, &echo[i], 0);
            echo_add(grid, &echo[i], 1, NULL);
            echo_sum(got, grid);
            const int used = echo_terms(grid, echo[i].path_per_pulse_m);
            CHECK(used == 0 || (used >= terms && used <= of[k].terms_most)); /* 0 once, 0 ever after */
            terms = used ? used : 1000;
            most = used > most ? used : most;
            if (used == 1 && by == 0) CHECK(worst(w.pulses) < 1e-6);
            edge = fmax(edge, worst(w.pulses));
            if (used) even = fmax(even, worst(w.pulses));
            for (int p = 0; p < w.pulses; p++)
                middle = fmax(middle, cabs(got[p * samples + samples / 2] - want[p * samples + samples / 2]));
        }
        CHECK(terms == 1000 && most == of[k].terms_most && echo_terms(grid, 0) == 1);
        CHECK(echo_terms(grid, echo[many - 1].path_per_pulse_m) == 0);
        printf("%s, %d rows: %.1e, over delay and Doppler %.1e; %.1e in the middle of the band\n",
               waveform_name[w.kind], w.pulses, edge, even, middle);
        CHECK(edge < 3e-3 && middle < 1e-4);
        CHECK(even > 1e-4); /* some needed their terms */
        for (int again = 0; again < 3; again++) {
            echo_add(grid, echo, again == 1 ? 9 : many, again == 2 ? pool : NULL);
            if (again == 1) echo_add(grid, echo + 9, many - 9, pool);
            echo_sum(got, grid);
            if (again == 0) memcpy(first, got, sizeof first);
            CHECK(memcmp(first, got, (size_t)interval_channels * (size_t)w.pulses * samples * sizeof *got) == 0);
        }
        echo_grid_destroy(grid);
    }
    pool_destroy(pool);
}

/* An LFM echo that crosses the fold within the interval, early or late in it, or comes from beyond: samples are alike
 * whole repetitions of path apart, but for the phase of the carrier, row by row. A repetition is no whole number of
 * turns a sample, so that folds to the wrong side show. */
static void an_echo_folds_over_within_the_interval(void **state)
{
    (void)state;
    Waveform     w = wave;
    EchoGrid    *grid;
    const double repeat_hz = 1.9e4, repeat_m = light_mps / repeat_hz, growth_m = 1e-4;
    const double step_hz = wave.bandwidth_hz / samples;
    w.pulses = 32, w.repeat_hz = repeat_hz;
    CHECK(echo_grid_create(&grid, &w) == STATUS_OK && echo_terms(grid, growth_m) > 0);
    const double coupled_m = w.centre_hz / w.bandwidth_hz * w.pulse_s * w.repeat_hz * growth_m;
    /* repetitions, rows: well within; across the fold in the middle, early and late, between the blocks of 8 rows that
     * share a delay and within one; beyond it on either side */
    static const double at[][2] = {{0.25, 0}, {0.5, 0},  {0.5, 8},   {0.5, -8},   {-0.5, 8}, {-0.5, -8},
                                   {0.5, 15}, {0.5, -3}, {-0.5, -1}, {-0.5, 4.5}, {1.3, 0},  {-0.8, 0}};
    for (size_t i = 0; i < sizeof at / sizeof *at; i++) {
        const double at_m = at[i][0] * repeat_m - coupled_m + at[i][1] * growth_m;
        const Echo   echo = {at_m, growth_m, {1, 0, 0, 0}};
        echo_add(grid, &echo, 1, NULL);
        echo_sum(got, grid);
        /* by hand: each row with the delay that is folded over for it */
        double most = 0;
        for (int p = 0; p < w.pulses; p++)
            for (int m = 0; m < samples; m++) {
                const double path_m = at_m + (p - 15.5) * growth_m, off = m - samples / 2;
                const double folded_m = path_m + coupled_m, back_m = repeat_m * nearbyint(folded_m / repeat_m);
                const double within_m = growth_m * w.repeat_hz * w.pulse_s / samples * off;
                const double all_m = path_m + within_m;
                const double turns = (w.centre_hz * all_m + off * step_hz * (all_m - back_m)) / light_mps;
                most = fmax(most, cabs(got[p * samples + m] - cexp(-I * 2 * pi_rad * turns)));
            }
        printf("%g repetitions and %g rows: %.1e\n", at[i][0], at[i][1], most);
        CHECK(most < 3e-3);
    }
    echo_grid_destroy(grid);
}

static void sizes_are_checked(void **state)
{
    (void)state;
    EchoGrid *grid = NULL;
    Waveform  bad = wave;
    bad.samples = 7;
    CHECK(echo_grid_create(&grid, &bad) == STATUS_BAD_VALUE);
    bad = wave, bad.samples = 65536, bad.pulses = 4096;
    CHECK(echo_grid_create(&grid, &bad) == STATUS_BAD_VALUE);
    bad = wave, bad.centre_hz = NAN;
    CHECK(echo_grid_create(&grid, &bad) == STATUS_BAD_VALUE);
    CHECK(grid == NULL);
    echo_grid_destroy(NULL);
}

/* A series of exp(-j x) leaves out x^n / n! behind n terms, which may be 2e-3; x: the phase that delay and Doppler
 * leave at the ends of band and interval, pi B / c of the path there, half of (pulses - 1 + share of a row) times its
 * growth. Up to one term for 8 pulses, and 8; beyond that it goes row by row. */
static void terms_by_hand(void **state)
{
    (void)state;
    for (int rows = 16; rows <= 96; rows += 16) {
        Waveform  w = wave;
        EchoGrid *grid;
        double    factorial = 1;
        w.pulses = rows;
        CHECK(echo_grid_create(&grid, &w) == STATUS_OK);
        const double rad_m = pi_rad * 512e6 / light_mps * (rows - 1 + 0.2) / 2; /* 10 us of 50 us */
        const int    most = rows / 8 < 8 ? rows / 8 : 8;
        for (int n = 1; n <= 8; n++) {
            factorial *= n;
            const double x = pow(2e-3 * factorial, 1.0 / n);
            for (int sign = -1; sign <= 1; sign += 2) {
                CHECK(echo_terms(grid, sign * 0.999 * x / rad_m) == (n <= most ? n : 0));
                CHECK(echo_terms(grid, sign * 1.001 * x / rad_m) == (n + 1 <= most ? n + 1 : 0));
            }
        }
        echo_grid_destroy(grid);
    }
}

/* What a rate leaves of an echo whose pulse has one frequency: sinc of pi f / c rate pulse, here of 1 radian and more,
 * at which a tenth of it is 3 %. Followed or not, on either grid. */
static void a_rate_takes_from_a_pulse(void **state)
{
    (void)state;
    static const WaveformKind kind[] = {WAVEFORM_PULSE_DOPPLER, WAVEFORM_STEPPED, WAVEFORM_LFM};
    for (int i = 0; i < 6; i++) {
        Waveform  w = wave;
        EchoGrid *grid;
        w.kind = kind[i / 2];
        if (w.kind == WAVEFORM_STEPPED) w.repeat_hz = 500, w.pulse_s = 1e-5;
        const double one_m = light_mps / (pi_rad * w.centre_hz * w.pulse_s * w.repeat_hz); /* of growth: 1 rad */
        Echo         e = {.path_m = 0.3, .path_per_pulse_m = (i % 2 ? 0.4 : 1.3) * one_m};
        const double unfollowed_m = i % 2 ? 0.9 * one_m : 0;
        for (int c = 0; c < interval_channels; c++) e.amplitude[c] = 1.0 + c - I;
        CHECK(echo_grid_create(&grid, &w) == STATUS_OK);
        echo_unfollowed(grid, unfollowed_m);
        memset(got, 0, sizeof got), memset(want, 0, sizeof want);
        echo_add(grid, &e, 1, NULL);
        echo_sum(got, grid);
        add_by_hand(&w, &e, unfollowed_m);
        const int middle = pulses / 2 * samples + samples / 2;
        printf("kind %d: %.4f of the amplitude, %.4f on paper\n", (int)w.kind, cabs(got[middle]) / cabs(e.amplitude[0]),
               cabs(want[middle]) / cabs(e.amplitude[0]));
        CHECK_NEAR(cabs(got[middle]) / cabs(e.amplitude[0]), cabs(want[middle]) / cabs(e.amplitude[0]), 2e-3);
        echo_grid_destroy(grid);
    }
}

/* The kernel of Barnett, Magland & af Klinteberg, exp(beta ((1 - x^2)^0.5 - 1)) over x = -1 .. 1, 8 points wide,
 * beta 2.30 times the width for twice the points; the polynomials in its place are off by 1.6e-8. Corrections: one over
 * its transform, here by an integral of the test's own. */
static void the_kernel_is_barnetts(void **state)
{
    (void)state;
    enum { points = 64, steps = 20000 };
    for (int i = 0; i < 200; i++) {
        const double turns = 3 * uniform(i) - 1, at = turns * points;
        double       weight[gridding_width];
        const int    first = gridding_spread(weight, turns, points);
        CHECK(first >= 0 && first < points);
        for (int k = 0; k < gridding_width; k++) {
            const double x = remainder(first + k - at, points) / 4;
            CHECK_NEAR(weight[k], fabs(x) < 1 ? exp(2.30 * 8 * (sqrt(1 - x * x) - 1)) : 0, 2e-8);
        }
    }
    double *correction = gridding_corrections(32, points);
    CHECK(correction);
    for (int i = 0; i < 32; i++) {
        double sum = 0;
        for (int k = 0; k < steps; k++) {
            const double x = 2 * (k + 0.5) / steps - 1;
            sum += exp(2.30 * 8 * (sqrt(1 - x * x) - 1)) * cos(2 * pi_rad * (i - 16) / points * 4 * x) * 8 / steps;
        }
        CHECK_NEAR(correction[i] * sum, 1, 1e-7);
    }
    free(correction);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(samples_are_the_sum),
        cmocka_unit_test(moving_echoes_are_at_their_times),
        cmocka_unit_test(bends_of_every_size),
        cmocka_unit_test(fast_echoes_have_the_same_bits),
        cmocka_unit_test(slow_and_fast_echoes_are_alike),
        cmocka_unit_test(an_echo_folds_over_within_the_interval),
        cmocka_unit_test(the_kernel_is_barnetts),
        cmocka_unit_test(terms_by_hand),
        cmocka_unit_test(a_rate_takes_from_a_pulse),
        cmocka_unit_test(sizes_are_checked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
