/* Dipoles one by one, in all directions, against the figures of volume_scatter.h; bunches of them, and the cloud's
 * column. labels: physics */
#include "tests/check.h"

#include "render/scattering/clutter/volume_scatter.h"

/* Of half-wave dipoles of a sinusoidal current, of one wavelength^2: by quadrature over their directions. Everything
 * follows from the radiated field F / sin and the reciprocity of transmitting and receiving. */
static void one_dipole_over_all_directions(void **state)
{
    (void)state;
    double same = 0, other = 0, unlike = 0, taken = 0, radiated = 0;
    enum { steps = 400 };
    for (int i = 0; i < steps; i++) { /* over the cosine */
        const double c = (i + 0.5) / steps, f = cos(0.5 * pi_rad * c) / sqrt(1 - c * c);
        radiated += f * f / steps;
    }
    const double gain = 1 / radiated, peak = gain * gain / pi_rad;
    for (int i = 0; i < steps; i++)
        for (int k = 0; k < steps; k++) {
            const double c = (i + 0.5) / steps, f = cos(0.5 * pi_rad * c) / sqrt(1 - c * c),
                         b = 2 * pi_rad * (k + 0.5) / steps;
            const double hh = f * f * cos(b) * cos(b), hv = f * f * cos(b) * sin(b), vv = f * f * sin(b) * sin(b);
            same += hh * hh, other += hv * hv, unlike += hh * vv, taken += hh;
        }
    const double each = 1.0 / steps / steps;
    CHECK_NEAR(gain, 1.6409, 2e-4); /* 2.15 dBi */
    CHECK_NEAR(peak * same * each, chaff_same, 1e-3);
    CHECK_NEAR(other / same, 1.0 / 3, 1e-6);
    CHECK_NEAR(unlike / same, 1.0 / 3, 1e-6);
    CHECK_NEAR(gain / pi_rad * taken * each, chaff_taken, 1e-6);
    printf("a dipole: %.4f lambda^2 back, %.4f taken\n", peak * same * each, gain / pi_rad * taken * each);
}

static void bunches_have_the_same_moments(void **state)
{
    (void)state;
    enum { count = 200000 };
    double hh = 0, vv = 0, hv = 0, both = 0, turned = 0;
    for (int i = 0; i < count; i++) {
        double        n[6];
        ScatterMatrix s;
        random_normals(n, 6, 5, 1, 0, 6 * (uint64_t)i);
        chaff_scatter(&s, 7, n);
        CHECK(s.hv == s.vh);
        hh += creal(s.hh * conj(s.hh)), vv += creal(s.vv * conj(s.vv)), hv += creal(s.hv * conj(s.hv));
        both += creal(s.hh * conj(s.vv));
        const double h[3] = {1, 0, 0}, v[3] = {0, 1, 0}, right[3] = {cos(0.6), sin(0.6), 0};
        scatter_turn(&s, h, v, right);
        turned += creal(s.hh * conj(s.hh));
    }
    const double unit = 7 / (4 * pi_rad) * count, tolerance = 4 / sqrt(count);
    CHECK_NEAR(hh / unit, 1, tolerance);
    CHECK_NEAR(vv / unit, 1, tolerance);
    CHECK_NEAR(turned / unit, 1, tolerance);
    CHECK_NEAR(hv / unit, 1.0 / 3, tolerance);
    CHECK_NEAR(both / unit, 1.0 / 3, tolerance);
}

static void columns_are_sums(void **state)
{
    (void)state;
    const double n = 1e6, radius = 6, centre[3] = {40, 5, -3}, d[3] = {0.8, 0.6, 0}; /* from the origin */
    for (double range = 5; range < 80; range += 7) {
        double sum = 0;
        enum { steps = 20000 };
        for (int i = 0; i < steps; i++) {
            double p[3];
            v3_scale(p, (i + 0.5) * range / steps, d);
            v3_sub(p, p, centre);
            sum += n / pow(2 * pi_rad * radius * radius, 1.5) * exp(-0.5 * v3_dot(p, p) / (radius * radius)) * range /
                   steps;
        }
        CHECK_NEAR(chaff_column_1_m2(n, radius, centre, d, range), sum, 1e-6 * n / (2 * pi_rad * radius * radius));
    }
    CHECK_NEAR(chaff_radius_m(0), 1, 1e-12);
    CHECK(chaff_radius_m(1) > 5 && chaff_radius_m(10) > chaff_radius_m(5) && chaff_radius_m(-1) == chaff_radius_m(0));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_dipole_over_all_directions),
        cmocka_unit_test(bunches_have_the_same_moments),
        cmocka_unit_test(columns_are_sums),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
