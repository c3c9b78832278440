/* The dish's patterns against published widths and side lobes and against sums over its aperture; angles by
 * monopulse. labels: physics */
#include "tests/check.h"

#include "sensor/radar/antenna_private.h"

/* Skolnik's table of tapered circular apertures: half-power width in wavelengths over diameter, first side lobe,
 * relative gain; printed to three figures. */
static void widths_and_lobes_are_published_ones(void **state)
{
    (void)state;
    static const double table[][3] = {{58.9, -17.6, 1}, {72.8, -24.6, 0.75}, {84.2, -30.6, 0.56}};
    for (int n = 0; n < 3; n++) {
        const Antenna a = {.diameter_m = 5, .taper = n, .wavelength_m = 0.01};
        const double  per_rad = a.diameter_m / a.wavelength_m;
        CHECK_NEAR(antenna_width_rad(&a) / rad_per_deg * per_rad, table[n][0],
                   0.3); /* n = 1: 72.7 to one more figure */
        CHECK_NEAR(antenna_peak_gain(&a) / pow(pi_rad * per_rad, 2), table[n][2], 0.005);
        double lobe = 0;
        for (double u = 3.9 + 1.3 * n; u < 12; u += 1e-3)
            lobe = fmax(lobe, fabs(antenna_gain(&a, u / (pi_rad * per_rad), 0).sum));
        CHECK_NEAR(20 * log10(lobe) - 10 * log10(antenna_peak_gain(&a)), table[n][1], 0.06);
    }
}

/* Sums over the aperture itself, in steps of 1/200 of its radius; what that leaves of its round edge, 1e-3 of the
 * peak. */
static void patterns_are_sums_over_the_aperture(void **state)
{
    (void)state;
    const int steps = 200;
    for (int n = 0; n < 3; n++) {
        const Antenna a = {.diameter_m = 0.2, .taper = n, .wavelength_m = 0.003189};
        double        power = 0, power_x = 0;
        double        sum[5] = {0}, difference[5] = {0},
               at[5][2] = {{0, 0}, {0.004, 0}, {0.009, 0.006}, {-0.013, 0.002}, {0.031, -0.02}};
        for (int i = -steps; i < steps; i++)
            for (int j = -steps; j < steps; j++) {
                const double x = (i + 0.5) / steps, y = (j + 0.5) / steps, r2 = x * x + y * y;
                if (r2 >= 1) continue;
                const double f = pow(1 - r2, n), reach = pi_rad * a.diameter_m / a.wavelength_m;
                power += f * f;
                power_x += x * x * f * f;
                for (int k = 0; k < 5; k++) { /* odd parts cancel: cosine for the sum, sine for x times it */
                    const double phase = reach * (x * at[k][0] + y * at[k][1]);
                    sum[k] += f * cos(phase);
                    difference[k] += x * f * sin(phase);
                }
            }
        const double peak = sqrt(antenna_peak_gain(&a)), unit = sum[0] / sqrt(power);
        for (int k = 0; k < 5; k++) {
            const AntennaGain g = antenna_gain(&a, at[k][0], at[k][1]);
            CHECK_NEAR(g.sum / peak, sum[k] / sqrt(power) / unit, 1e-3);
            CHECK_NEAR(g.right / peak, difference[k] / sqrt(power_x) / unit, 1e-3);
            const AntennaGain turned = antenna_gain(&a, at[k][1], at[k][0]);
            CHECK(turned.down == g.right && turned.sum == g.sum);
        }
    }
}

static void angles_come_back(void **state)
{
    (void)state;
    for (int n = 0; n < 3; n++) {
        const Antenna a = {.diameter_m = 0.2, .taper = n, .wavelength_m = 0.003189};
        const double  width = antenna_width_rad(&a);
        for (double at = -width; at <= width; at += width / 16) {
            const double      down = 0.4 * at - 0.1 * width;
            const AntennaGain g = antenna_gain(&a, at, down);
            double            got[2];
            antenna_direction(&got[0], &got[1], &a, g.right / g.sum, g.down / g.sum);
            CHECK_NEAR(got[0], at, 1e-9 * width);
            CHECK_NEAR(got[1], down, 1e-9 * width);
        }
    }
    const Antenna a = {.diameter_m = 0.2, .taper = 1, .wavelength_m = 0.003189};
    double        far[2];
    antenna_direction(&far[0], &far[1], &a, 1e9, -1e9);
    CHECK(hypot(far[0], far[1]) < 0.03 && far[0] == -far[1] && antenna_gain(&a, 0.8, 0.7).sum == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(widths_and_lobes_are_published_ones),
        cmocka_unit_test(patterns_are_sums_over_the_aperture),
        cmocka_unit_test(angles_come_back),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
