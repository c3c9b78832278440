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

/* The patterns against the C library's Bessel functions, over the main lobe and the first side lobes, where series and
 * recurrence meet at u = 5: 2^m m! J_m(u) / u^m is known to some 1e-15 from u = 1 on. */
static void patterns_are_bessel_functions(void **state)
{
    (void)state;
    for (int n = 0; n < 3; n++) {
        const Antenna a = {.diameter_m = 1, .taper = n, .wavelength_m = 0.01};
        const double  reach = pi_rad * 100, peak = reach * sqrt((2 * n + 1) / ((n + 1.0) * (n + 1)));
        for (double u = 1; u < 12; u += 0.09) {
            const AntennaGain g = antenna_gain(&a, 0.6 * u / reach, 0.8 * u / reach);
            const double      sum = tgamma(n + 2) * pow(2 / u, n + 1) * jn(n + 1, u);
            const double      slope = sqrt(n + 1) / (n + 2) * tgamma(n + 3) * pow(2 / u, n + 2) * jn(n + 2, u);
            CHECK_NEAR(g.sum / peak, sum, 3e-15);
            CHECK_NEAR(g.right / peak, slope * 0.6 * u, 3e-15 * u);
            CHECK_NEAR(g.down / peak, slope * 0.8 * u, 3e-15 * u);
        }
    }
}

/* Both ways' half-power width is one way's width at 3 dB / 2: Bessel's functions at the directions that come back. */
static void widths_are_where_the_power_is_half(void **state)
{
    (void)state;
    for (int n = 0; n < 3; n++) {
        const Antenna a = {.diameter_m = 0.7, .taper = n, .wavelength_m = 0.02};
        for (int ways = 1; ways <= 2; ways++) {
            const double width = ways == 1 ? antenna_width_rad(&a) : antenna_two_way_width_rad(&a);
            const double u = pi_rad * 35 * sin(0.5 * width);
            CHECK_NEAR(pow(tgamma(n + 2) * pow(2 / u, n + 1) * jn(n + 1, u), 2 * ways), 0.5, 1e-12);
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
    /* the greatest ratio is at the first zero of the sum, of J_2: pi d / lambda sine = 5.135622301840683 */
    antenna_direction(&far[0], &far[1], &a, 1e15, 0);
    CHECK_NEAR(far[0] * pi_rad * 0.2 / 0.003189, 5.135622301840683, 1e-10);
    antenna_direction(&far[0], &far[1], &a, 1e9, -1e9);
    CHECK(hypot(far[0], far[1]) < 0.03 && far[0] == -far[1] && antenna_gain(&a, 0.8, 0.7).sum == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(widths_and_lobes_are_published_ones),
        cmocka_unit_test(patterns_are_sums_over_the_aperture),
        cmocka_unit_test(patterns_are_bessel_functions),
        cmocka_unit_test(widths_are_where_the_power_is_half),
        cmocka_unit_test(angles_come_back),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
