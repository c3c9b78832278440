/* Coarse signatures: the mean of a cross section over their wide bin against laws of optics, and how
 * they are made. labels: physics */
#include "tests/render/radar_stage.h"

#include "render/scattering/signatures/coarse.h"
#include "render/scattering/signatures/signatures.h"

static const double radar_hz = 94e9;

/* Mean of the cross section over looks within the bin that a look is in, m2, by the coarse signature of a shape. */
static double mean_over_bin(const char *shape, double az_deg, double el_deg)
{
    enum { looks = 400 };
    const double   hz = coarse_hz();
    SignatureCells cells = signature_default_cells(hz, 500e6, 0.3 * rad_per_deg, 0);
    RadarStage     s;
    TotalField     field = {0};
    Signature      signature = {0};
    Centres        centres = {0};
    ScatterAntenna look = antenna_at(az_deg, el_deg, INFINITY), middle;
    double         sum = 0;
    stage_open(&s, shape, hz);
    s.config.rays_per_wavelength = 0.5;
    coarse_tubes(&s.config, &cells);
    coarse_bin(&middle, &look);
    CHECK(total_field_trace(&field, s.target, &middle, &middle, &s.config, false, s.pool) == STATUS_OK);
    CHECK(signature_make(&signature, &field, s.target, &cells) == STATUS_OK);
    coarse_widen(&signature, hz, radar_hz);
    for (int i = 0, n = 0; i < looks; n++) {
        const double   az = az_deg + 30 * (random_uniform(1, 0, 0, (uint64_t)n) - 0.5);
        const double   el = el_deg + 30 * (random_uniform(1, 1, 0, (uint64_t)n) - 0.5);
        ScatterAntenna one = antenna_at(az, el, INFINITY), of;
        ScatterMatrix  m;
        coarse_bin(&of, &one);
        if (memcmp(&of, &middle, sizeof of) != 0) continue;
        one.range_m = 2000;
        CHECK(centres_make(&centres, &signature, &one, &one, NULL) == STATUS_OK);
        centres_field(&m, &centres, radar_hz);
        sum += 4 * pi_rad * scatter_power(m.vv) / looks;
        i++;
    }
    centres_free(&centres);
    signature_free(&signature);
    total_field_free(&field);
    stage_close(&s);
    return sum;
}

/* A sphere scatters pi r^2 everywhere, at any frequency. */
static void a_sphere(void **state)
{
    (void)state;
    double off = 0;
    for (int i = 0; i < 6; i++) {
        const double db = decibels(mean_over_bin("sphere:1", 55 * i + 7.0, 10 * i - 20.0) / pi_rad);
        off += db * db / 6;
    }
    print_message("sphere: %.1f dB rms\n", sqrt(off));
    CHECK(sqrt(off) < 3);
}

/* A flat plate of area A scatters 4 pi A^2 / lambda^2 within lambda / 2 over its sides: pi A over all directions, at
 * any frequency. Its mean over a bin that holds the whole of that is pi A over the bin's solid angle. */
static void a_plate(void **state)
{
    (void)state;
    const double bin_sr = 15 * rad_per_deg * 2 * sin(7.5 * rad_per_deg);
    double       want[2];
    for (int i = 0; i < 2; i++) {
        char shape[40];
        snprintf(shape, sizeof shape, i ? "plate:1x0.6" : "plate:0.7x0.7");
        want[i] = pi_rad * (i ? 0.6 : 0.49) / bin_sr;
        const double db = decibels(mean_over_bin(shape, 0, 0) / want[i]);
        print_message("plate: %.1f dB of %.1f dBsm\n", db, decibels(want[i]));
        CHECK(fabs(db) < coarse_error_db());
    }
}

/* Every aspect that a target near the ground is seen in has its bin, once. */
static void bins_cover(void **state)
{
    (void)state;
    static ScatterAntenna bin[coarse_most_bins];
    const int             count = coarse_bins(bin);
    CHECK(count > 60 && count < coarse_most_bins);
    for (int i = 0; i < count; i++)
        for (int k = 0; k < i; k++) CHECK(memcmp(&bin[i], &bin[k], sizeof bin[i]) != 0);
    for (int i = 0; i < 5000; i++) {
        const ScatterAntenna a = antenna_at(360 * random_uniform(2, 0, 0, (uint64_t)i),
                                            -14.9 + 59.8 * random_uniform(2, 1, 0, (uint64_t)i), INFINITY);
        ScatterAntenna       middle;
        bool                 there = false;
        coarse_bin(&middle, &a);
        for (int k = 0; k < count && !there; k++) there = memcmp(&bin[k], &middle, sizeof middle) == 0;
        CHECK(there);
    }
}

/* What coarse.h says that they are made with: by one mirror the centres keep their strength, by more it grows as the
 * frequency to the power 0.3, and sums alone are left. */
static void they_are_made_as_stated(void **state)
{
    (void)state;
    SignatureCentre centre[3] = {{.bounce = 1, .scale = 2}, {.bounce = 2, .scale = 3}, {.bounce = 5, .scale = 1}};
    Signature       signature = {.count = 3, .centre = centre};
    SignatureCells  cells = {.turn_rad = 0.1};
    TubeConfig      tubes = {.rays_per_radius = 1};
    for (int i = 0; i < 3; i++) centre[i].moment_scale = 1, memset(centre[i].moment, 7, sizeof centre[i].moment);
    coarse_widen(&signature, 8e9, 94e9);
    const double grown = exp(0.3 * log(11.75));
    CHECK_NEAR((double)centre[0].scale, 2, 0);
    CHECK_NEAR((double)centre[1].scale, 3 * grown, 1e-6);
    CHECK_NEAR((double)centre[2].scale, grown, 1e-6);
    for (int i = 0; i < 3; i++) {
        CHECK(centre[i].moment_scale == 0);
        for (size_t k = 0; k < sizeof centre[i].moment; k++) CHECK(((const uint8_t *)centre[i].moment)[k] == 0);
    }
    coarse_tubes(&tubes, &cells);
    CHECK(tubes.rays_per_radius == 48 && cells.turn_rad == 0);
    CHECK(tubes.curve_m >= 100); /* lambda curve / 16 is wider than any tube over the radius: curvature sets none */
    CHECK(coarse_hz() == 8e9 && coarse_sag_m() == 0.01 && coarse_error_db() == 8);
}

/* Rows of bins are 15 degrees high; a row at elevation e has the multiple of 4 nearest to 24 cos e, so that sides shine
 * in the middle of one: 24, 24, 20, 16, 12, 8 and at the poles 1. */
static void bins_are_of_15_degrees(void **state)
{
    (void)state;
    static const int of_row[] = {24, 24, 20, 16, 12, 8, 1};
    for (int row = -6; row <= 6; row++) {
        const int    bins = of_row[abs(row)];
        const double width_deg = 360.0 / bins;
        for (int i = 0; i < bins; i++)
            for (int k = 0; k < 9; k++) { /* anywhere in it, and its middle */
                const double   el_deg = 15 * row + 7.4 * (k / 3 - 1), az_deg = width_deg * (i + 0.49 * (k % 3 - 1));
                const double   el = el_deg * rad_per_deg, az = az_deg * rad_per_deg, middle_el = 15 * row * rad_per_deg;
                const double   middle_az = bins == 1 ? 0 : width_deg * i * rad_per_deg;
                ScatterAntenna middle, a = {{cos(el) * cos(az), cos(el) * sin(az), sin(el)}, 500};
                if (fabs(el_deg) > 90) continue;
                coarse_bin(&middle, &a);
                CHECK(isinf(middle.range_m));
                CHECK_NEAR(middle.u[0], cos(middle_el) * cos(middle_az), 1e-12);
                CHECK_NEAR(middle.u[1], cos(middle_el) * sin(middle_az), 1e-12);
                CHECK_NEAR(middle.u[2], sin(middle_el), 1e-12);
            }
    }
    static ScatterAntenna bin[coarse_most_bins];
    static const double   row_deg[] = {0, -15, -30, 15, -45}; /* z down: the level first, then from above */
    int                   at = 0;
    CHECK(coarse_bins(bin) == 24 + 24 + 20 + 24 + 16);
    for (int row = 0; row < 5; row++)
        for (int i = 0; i < (const int[]){24, 24, 20, 24, 16}[row]; i++)
            CHECK_NEAR(bin[at++].u[2], sin(row_deg[row] * rad_per_deg), 1e-12);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(they_are_made_as_stated),
        cmocka_unit_test(bins_are_of_15_degrees),
        cmocka_unit_test(a_sphere),
        cmocka_unit_test(a_plate),
        cmocka_unit_test(bins_cover),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
