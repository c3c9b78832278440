/* Samples of many echoes by gridding against the sum that they stand for, echo by echo, in double. */
#include "tests/check.h"

#include "sensor/radar/echo.h"

static const double light_mps = 299792458.0;
static double       uniform(int i) { return random_uniform(3, 0, 0, (uint64_t)i); }

enum { samples = 128, pulses = 20, echoes = 300, all = interval_channels * pulses * samples };

static const Waveform wave = {
    .centre_hz = 94e9, .bandwidth_hz = 128 * 4e6, .pulse_s = 1e-5, .repeat_hz = 2e4, .samples = samples, .pulses = pulses};
static double complex got[all], want[all];

/* What they stand for; the delay is that of the middle, unless it grows with the pulses as it truly does. */
static void add_by_hand(const Echo *e, bool growing)
{
    const double step_hz = wave.bandwidth_hz / samples;
    for (int c = 0; c < interval_channels; c++)
        for (int p = 0; p < pulses; p++) {
            const double path_m = e->path_m + (p - 0.5 * (pulses - 1)) * e->path_per_pulse_m;
            const double delay_m = growing ? path_m : e->path_m;
            for (int m = 0; m < samples; m++)
                want[(c * pulses + p) * samples + m] +=
                    e->amplitude[c] *
                    cexp(-I * 2 * pi_rad / light_mps * (wave.centre_hz * path_m + (m - samples / 2) * step_hz * delay_m));
        }
}

static double worst(void)
{
    double most = 0;
    for (int i = 0; i < all; i++) most = fmax(most, cabs(got[i] - want[i]));
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
        echo[i].path_m = i < 4 ? (double[]){0, 0.5 * window_m, -0.5 * window_m, window_m}[i] : 1.4 * window_m * (uniform(16 * i) - 0.5);
        echo[i].path_per_pulse_m = 1e-3 * (uniform(16 * i + 1) - 0.5);
        for (int c = 0; c < interval_channels; c++)
            echo[i].amplitude[c] = i % 5 == c ? 0 : (uniform(16 * i + 2 + c) - 0.5) + I * (uniform(16 * i + 8 + c) - 0.5);
        add_by_hand(&echo[i], false);
        total += cabs(echo[i].amplitude[0]);
    }
    static double complex first[all];
    for (int again = 0; again < 3; again++) { /* in one call or two, one thread or three: the same */
        echo_add(grid, echo, again == 1 ? 100 : echoes, again == 2 ? pool : NULL);
        if (again == 1) echo_add(grid, echo + 100, echoes - 100, pool);
        echo_sum(got, grid);
        CHECK(worst() < 1e-6 * total);
        if (again == 0) memcpy(first, got, sizeof first);
        CHECK(memcmp(first, got, sizeof first) == 0);
    }
    echo_sum(got, grid);
    for (int i = 0; i < all; i++) CHECK(got[i] == 0);
    echo_grid_destroy(grid);
    pool_destroy(pool);
}

/* A delay that stays while the path grows by 0.1 mm a pulse: at the band's edge pi B / c of the path that is off,
 * 9.5 pulses of it. */
static void delay_is_that_of_the_middle(void **state)
{
    (void)state;
    const Echo   echo = {.path_m = 7.3, .path_per_pulse_m = 1e-4, .amplitude = {1 + 2 * I, 0, 0.5, 0}};
    const double off = pi_rad * wave.bandwidth_hz / light_mps * 9.5 * 1e-4 * cabs(1 + 2 * I);
    EchoGrid    *grid;
    CHECK(echo_grid_create(&grid, &wave) == STATUS_OK);
    memset(want, 0, sizeof want);
    add_by_hand(&echo, true);
    echo_add(grid, &echo, 1, NULL);
    echo_sum(got, grid);
    CHECK(worst() < 1.01 * off + 1e-5 && worst() > 0.5 * off);
    for (int p = 0; p < pulses; p++) /* mid-band: nothing is off but the gridding */
        CHECK(cabs(got[p * samples + samples / 2] - want[p * samples + samples / 2]) < 3e-6);
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(samples_are_the_sum),
        cmocka_unit_test(delay_is_that_of_the_middle),
        cmocka_unit_test(sizes_are_checked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
