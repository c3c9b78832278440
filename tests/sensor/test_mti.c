/* Cancellers of moving-target indication: gain of a target, blind speeds, noise, and the improvement factor over
 * clutter of a Gaussian spectrum, against closed forms. labels: physics */
#include "tests/check.h"

#include "sensor/radar/echo.h"
#include "sensor/radar/detect_private.h"

enum { samples = 128, pulses = 256, all = samples * pulses, echoes = 12000 };
static const double   light = 299792458.0;
static const Waveform wave = {.kind = WAVEFORM_PULSE_DOPPLER,
                              .centre_hz = 16.5e9,
                              .bandwidth_hz = 12.8e6,
                              .pulse_s = 1e-6,
                              .repeat_hz = 1e5,
                              .samples = samples,
                              .pulses = pulses};
static double complex sample[interval_channels * all];

/* Mean power over the columns, before and behind each canceller. */
static void powers(double out[4], double clutter_path_m)
{
    Window         rect;
    IntervalPlan  *plan;
    double         profile[samples];
    const Interval interval = {.wave = wave, .sample = sample};
    CHECK(!window_parse(&rect, "rect") && interval_plan_create(&plan, &wave, &rect, &rect) == STATUS_OK);
    interval_compress(plan, &interval, 1, NULL);
    for (int rows = 1; rows <= mti_rows_most; rows++) {
        if (rows == 1) interval_profile(profile, plan, CHANNEL_SUM);
        else detect_mti_profile(profile, interval_pulses(plan, CHANNEL_SUM), &wave, rows, clutter_path_m);
        out[rows] = 0;
        for (int m = 0; m < samples; m++) out[rows] += profile[m] / samples;
    }
    interval_plan_destroy(plan);
}

/* Rates normal about a mean that the radar knows: rho(k) = exp(-(4 pi s k T / lambda)^2 / 2). */
static void clutter_is_cancelled_as_on_paper(void **state)
{
    (void)state;
    static Echo  echo[echoes];
    const double wave_m = light / wave.centre_hz, mean_mps = 37;
    for (int wide = 0; wide < 3; wide++) {
        const double sigma_mps = (double[]){4, 12, 40}[wide];
        EchoGrid    *grid;
        double       got[4];
        CHECK(echo_grid_create(&grid, &wave) == STATUS_OK);
        for (int i = 0; i < echoes; i++) {
            const double rate = mean_mps + sigma_mps * random_normal(1, 2, (uint32_t)wide, 2 * (uint64_t)i);
            echo[i] = (Echo){1499 * random_uniform(1, 3, (uint32_t)wide, (uint64_t)i),
                             2 * rate / wave.repeat_hz,
                             {cexp(2 * I * pi_rad * random_uniform(1, 4, (uint32_t)wide, (uint64_t)i)), 0, 0, 0}};
        }
        echo_add(grid, echo, echoes, NULL);
        echo_sum(sample, grid);
        powers(got, 2 * mean_mps / wave.repeat_hz);
        const double turn = 4 * pi_rad * sigma_mps / wave.repeat_hz / wave_m;
        const double rho1 = exp(-turn * turn / 2), rho2 = exp(-2 * turn * turn);
        const double two_db = -10 * log10(1 - rho1), three_db = 10 * log10(3 / (3 - 4 * rho1 + rho2));
        printf("clutter of %g m/s: improvement %.2f and %.2f dB, on paper %.2f and %.2f\n", sigma_mps,
               10 * log10(got[1] / got[2]), 10 * log10(got[1] / got[3]), two_db, three_db);
        CHECK_NEAR(10 * log10(got[1] / got[2]), two_db, 0.3);
        CHECK_NEAR(10 * log10(got[1] / got[3]), three_db, 0.3);
        if (wide == 0) { /* narrow: (PRF / (2 pi s_f))^2 and half its square (Skolnik) */
            const double sigma_hz = 2 * sigma_mps / wave_m, ratio = wave.repeat_hz / (2 * pi_rad * sigma_hz);
            CHECK_NEAR(two_db, 10 * log10(2 * ratio * ratio), 0.1);
            CHECK_NEAR(three_db, 10 * log10(2 * pow(ratio, 4)), 0.1);
            powers(got, 0); /* not locked to it: the mean rate stays */
            CHECK(10 * log10(got[1] / got[2]) < two_db - 10);
        }
        echo_grid_destroy(grid);
    }
}

/* 2 sin^2(x) and 8 sin^4(x) / 3 of x = 2 pi v T / lambda; 0 at lambda / 2 T = 908.46 m/s and its multiples. */
static void targets_pass_but_for_blind_speeds(void **state)
{
    (void)state;
    for (int i = -40; i <= 40; i++) {
        const double rate = 45.42309967 * i, x = pi_rad * i / 20, path_m = 2 * rate / wave.repeat_hz,
                     s2 = sin(x) * sin(x);
        CHECK_NEAR(detect_mti_gain(&wave, 2, path_m), 2 * s2, 1e-6);
        CHECK_NEAR(detect_mti_gain(&wave, 3, path_m), 8 * s2 * s2 / 3, 1e-6);
        CHECK(detect_moves(rate + 11, 11, 20, 908.4619939) == (i % 20 != 0));
    }
    CHECK(!detect_moves(30, 11, 20, 908.46) && detect_moves(32, 11, 20, 908.46) &&
          !detect_moves(11 - 908.46 + 19, 11, 20, 908.46));
    /* of a target alone, through the samples */
    EchoGrid *grid;
    double    got[4];
    CHECK(echo_grid_create(&grid, &wave) == STATUS_OK);
    echo_add(grid, &(Echo){300, 2 * 150 / wave.repeat_hz, {1, 0, 0, 0}}, 1, NULL);
    echo_sum(sample, grid);
    powers(got, 2 * 20 / wave.repeat_hz);
    for (int rows = 2; rows <= 3; rows++)
        CHECK_NEAR(got[rows] / got[1] / detect_mti_gain(&wave, rows, 2 * 130 / wave.repeat_hz), 1,
                   1e-4); /* a moving echo's gridding */
    echo_grid_destroy(grid);
}

static void noise_keeps_its_power(void **state)
{
    (void)state;
    double got[4];
    for (int i = 0; i < all; i++)
        sample[i] = random_normal(3, 0, 0, 4 * (uint64_t)i) + I * random_normal(3, 0, 0, 4 * (uint64_t)i + 2);
    powers(got, 1e-3);
    for (int rows = 2; rows <= 3; rows++)
        CHECK_NEAR(got[rows] / got[1], 1, 0.03); /* of 32768 exponential draws, weighted */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(clutter_is_cancelled_as_on_paper),
        cmocka_unit_test(targets_pass_but_for_blind_speeds),
        cmocka_unit_test(noise_keeps_its_power),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
