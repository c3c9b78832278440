/* Samples of many echoes by gridding against the sum that they stand for, echo by echo, in double. */
#include "tests/check.h"

#include "sensor/radar/echo.h"

#include <complex.h>

static const double light_mps = 299792458.0;
static double uniform(uint64_t i) { return random_uniform(3, 0, 0, i); }

enum { samples = 128, pulses = 5, echoes = 400 };

static double worst(const double complex *got, const double complex *want, int count)
{
    double most = 0;
    for (int i = 0; i < count; i++) most = fmax(most, cabs(got[i] - want[i]));
    return most;
}

static void samples_are_the_sum(void **state)
{
    (void)state;
    const double   centre_hz = 94e9, step_hz = 4e6, window_m = light_mps / step_hz;
    EchoGrid      *grid;
    static double complex got[pulses * samples], want[pulses * samples];
    double         total = 0;
    CHECK(echo_grid_create(&grid, samples, pulses, centre_hz, step_hz) == STATUS_OK);
    for (int again = 0; again < 2; again++) { /* the second time as the first */
        memset(want, 0, sizeof want);
        total = 0;
        for (int i = 0; i < echoes; i++) {
            /* beyond half the window too: they fold over; and at its very ends */
            const double         path_m = i < 4 ? (double[]){0, 0.5 * window_m, -0.5 * window_m, window_m}[i]
                                                : 1.4 * window_m * (uniform(4 * (uint64_t)i) - 0.5);
            const double complex a = (uniform(4 * (uint64_t)i + 1) - 0.5) + I * (uniform(4 * (uint64_t)i + 2) - 0.5);
            const int            pulse = i % pulses;
            echo_add(grid, pulse, path_m, a);
            for (int m = 0; m < samples; m++)
                want[pulse * samples + m] +=
                    a * cexp(-I * 2 * pi_rad * (centre_hz + (m - samples / 2) * step_hz) * (path_m / light_mps));
            total += cabs(a) / pulses;
        }
        echo_voltages(got, grid);
        CHECK(worst(got, want, pulses * samples) < 1e-6 * total);
    }
    echo_grid_destroy(grid);
}

/* A train's phases are exact, its delay is that of the middle: a path that grows by 0.1 mm a pulse, against a resolution of 0.6 m. */
static void train_is_its_pulses(void **state)
{
    (void)state;
    const double   centre_hz = 35e9, step_hz = 4e6, growth_m = 1e-4;
    EchoGrid      *grid;
    static double complex got[pulses * samples], want[pulses * samples];
    CHECK(echo_grid_create(&grid, samples, pulses, centre_hz, step_hz) == STATUS_OK);
    echo_add_train(grid, 7.3, growth_m, 1 + 2 * I);
    echo_voltages(got, grid);
    for (int p = 0; p < pulses; p++) echo_add(grid, p, 7.3 + p * growth_m, 1 + 2 * I);
    echo_voltages(want, grid);
    /* the band's edge turns by pi B / c of the path that is off, at most 2 pulses of it */
    const double off = pi_rad * samples * step_hz / light_mps * 2 * growth_m * cabs(1 + 2 * I);
    CHECK(worst(got, want, pulses * samples) < off + 1e-6);
    CHECK(worst(got, want, pulses * samples) > 0.1 * off); /* the check can see it */
    for (int p = 0; p < pulses; p++) /* mid-band: nothing is off but the gridding */
        CHECK(cabs(got[p * samples + samples / 2] - want[p * samples + samples / 2]) < 3e-6);
    echo_grid_destroy(grid);
}

static void sizes_are_checked(void **state)
{
    (void)state;
    EchoGrid *grid = NULL;
    CHECK(echo_grid_create(&grid, 7, 1, 1e9, 1e6) == STATUS_BAD_VALUE);
    CHECK(echo_grid_create(&grid, 65536, 4096, 1e9, 1e6) == STATUS_BAD_VALUE);
    CHECK(echo_grid_create(&grid, 128, 1, NAN, 1e6) == STATUS_BAD_VALUE);
    CHECK(grid == NULL);
    echo_grid_destroy(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(samples_are_the_sum),
        cmocka_unit_test(train_is_its_pulses),
        cmocka_unit_test(sizes_are_checked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
