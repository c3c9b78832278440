/* The chain applied to planes: measured from a slanted edge as a laboratory would, and held against the closed
 * forms. labels: physics */
#include "tests/check.h"

#include "sensor/detector/blur_private.h"

enum { width = 200, height = 160 };
static float        edge[width * height], out[width * height];
static const double still[2] = {0, 0};

/* Area of the unit square (centred at 0) where u cos a + v sin a < d, cos a > sin a > 0: exact, by its trapezium. */
static double covered(double d, double cos_a, double sin_a)
{
    const double corner = 0.5 * (cos_a + sin_a), knee = 0.5 * (cos_a - sin_a);
    if (d <= -corner) return 0;
    if (d >= corner) return 1;
    if (d > knee) return 1 - covered(-d, cos_a, sin_a);
    if (d < -knee) return (d + corner) * (d + corner) / (2 * cos_a * sin_a);
    return 0.5 + d / cos_a;
}

/* An edge 5 degrees off the columns, through the middle; samples 0: exact area of each pixel; n: n x n points. */
static void slanted_edge(double angle_rad, int samples)
{
    const double c = cos(angle_rad), s = sin(angle_rad);
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            const double d = (0.5 * width - x - 0.5) * c + (0.5 * height - y - 0.5) * s;
            double       light = 0;
            if (samples == 0) light = covered(d, c, s);
            for (int k = 0; k < samples * samples; k++) {
                const double u = (k % samples + 0.5) / samples - 0.5, v = ((double)(k / samples) + 0.5) / samples - 0.5;
                light += (u * c + v * s < d) / (double)(samples * samples);
            }
            edge[y * width + x] = (float)(10 + 20 * light);
        }
}

/* A laboratory's way (ISO 12233): distances to the known edge in `per_px` bins a pixel, differences, transform, no
 * window. A bin's mean and the difference of two bins each pass sinc(f / per_px), and both are divided out. 80
 * rows: seven turns of an edge of 5 degrees through a pixel, so that the bins fill evenly. Along the edge's
 * normal, f in cycles a pixel. */
static double measured_mtf(const float *plane, double angle_rad, double f, int per_px)
{
    enum { most_bins = 32 * 120, reach = 60 };
    static double sum[most_bins], n[most_bins];
    const int     bins = 2 * reach * per_px;
    const double  c = cos(angle_rad), s = sin(angle_rad);
    memset(sum, 0, sizeof sum);
    memset(n, 0, sizeof n);
    for (int y = 40; y < height - 40; y++)
        for (int x = 0; x < width; x++) {
            const double d = (x + 0.5 - 0.5 * width) * c + (y + 0.5 - 0.5 * height) * s;
            const int    bin = (int)floor(per_px * (d + reach));
            if (bin < 0 || bin >= bins) continue;
            sum[bin] += plane[y * width + x];
            n[bin]++;
        }
    double re = 0, im = 0, all = 0, last = sum[0] / n[0];
    for (int k = 1; k < bins; k++) {
        if (n[k] == 0) continue; /* a fine bin that no pixel fell in */
        const double slope = sum[k] / n[k] - last, phase = 2 * pi_rad * f * k / per_px;
        last = sum[k] / n[k];
        re += slope * cos(phase);
        im += slope * sin(phase);
        all += slope;
    }
    return sqrt(re * re + im * im) / fabs(all) / (mtf_sinc(f / per_px) * mtf_sinc(f / per_px));
}

static const MtfChain chains[] = {
    {.cutoff_cyc_px = INFINITY, .footprint_px = 1, .places = 1},
    {.cutoff_cyc_px = 1.5, .footprint_px = 1, .places = 1},
    {.cutoff_cyc_px = 0.75, .obscuration = 0.3, .footprint_px = 1, .places = 1, .jitter_px = 0.1},
    {.cutoff_cyc_px = 0.9, .footprint_px = 0.9, .places = 1, .jitter_px = 0.3, .smear_px = {0.8, 0}},
    {.cutoff_cyc_px = 2, .footprint_px = 1, .places = 1, .smear_px = {1.2, 0.9}},
    {.cutoff_cyc_px = 2, .footprint_px = 1, .places = 1, .smear_px = {1.2, -0.9}},
};

/* 1 % to 0.4 cycles a pixel, the house's bar. Four bins a pixel where each pixel has the edge's exact area; a
 * picture of few rays is a staircase whose steps would lie on the edges of four bins a pixel, so it is measured in
 * 32. */
static void slanted_edge_shows_the_product(void **state)
{
    (void)state;
    const double a = 5 * rad_per_deg;
    for (size_t k = 0; k < sizeof chains / sizeof *chains; k++)
        for (int rays = 0; rays < 3; rays++) { /* a point a pixel; the exact area; 4 x 4 points */
            MtfChain chain = chains[k];
            chain.places = rays == 0 ? 1 : rays == 1 ? 1 << 20 : 4;
            Blur *blur;
            assert_int_equal(blur_create(&blur, width, height, &chain), STATUS_OK);
            slanted_edge(a, rays == 0 ? 1 : rays == 1 ? 0 : 4);
            blur_apply(blur, out, edge, chain.smear_px);
            for (double f = 0.05; f < 0.401; f += 0.05) {
                const double fx = f * cos(a), fy = f * sin(a);
                const double want =
                    fabs(mtf_optics(&chain, fx, fy) * mtf_jitter(&chain, fx, fy) * mtf_smear(&chain, fx, fy) *
                         mtf_sinc(chain.footprint_px * fx) * mtf_sinc(chain.footprint_px * fy));
                const double got = measured_mtf(out, a, f, rays == 1 ? 4 : 32);
                if (!(fabs(got - want) <= 0.01))
                    fail_msg("chain %zu, rays %d, f %.2f: measured %.4f, product %.4f", k, rays, f, got, want);
            }
            blur_destroy(blur);
        }
}

/* A cosine that the mirrored plane holds comes back with the chain's value as its amplitude, oblique smear and all. */
static void waves_come_back_with_their_amplitude(void **state)
{
    (void)state;
    const MtfChain chain = chains[4];
    Blur          *blur;
    assert_int_equal(blur_create(&blur, width, height, &chain), STATUS_OK);
    for (int kx = 0; kx < width; kx += 23)
        for (int ky = 0; ky < height; ky += 31) {
            const double fx = 0.5 * kx / width, fy = 0.5 * ky / height;
            if (fx > 0.4 || fy > 0.4) continue; /* from there on the chain bends */
            for (int i = 0; i < width * height; i++)
                edge[i] =
                    (float)(100 + cos(2 * pi_rad * fx * (i % width + 0.5)) * cos(2 * pi_rad * fy * (i / width + 0.5)));
            blur_apply(blur, out, edge, chain.smear_px);
            /* cos cos is half cos(x + y) and half cos(x - y), each with its own amplitude */
            for (int i = 0; i < width * height; i += 97) {
                const double x = 2 * pi_rad * fx * (i % width + 0.5), y = 2 * pi_rad * fy * (i / width + 0.5);
                const double want =
                    100 + 0.5 * cos(x + y) * mtf_chain(&chain, fx, fy) + 0.5 * cos(x - y) * mtf_chain(&chain, fx, -fy);
                CHECK_NEAR(out[i], kx || ky ? want : 101, 2e-5); /* floats at 100 step by 8e-6 */
            }
        }
    blur_destroy(blur);
}

/* Constants stay, means stay, nothing turns negative; an edge overshoots by 1.0 % where nothing but the footprint
 * is there to end the band, and not at all behind optics (floats about 1). */
static void mean_kept_and_nothing_rings_beyond(void **state)
{
    (void)state;
    for (size_t k = 0; k < sizeof chains / sizeof *chains; k++) {
        Blur *blur;
        assert_int_equal(blur_create(&blur, width, height, &chains[k]), STATUS_OK);
        for (int i = 0; i < width * height; i++) edge[i] = 38.5f;
        blur_apply(blur, out, edge, chains[k].smear_px);
        for (int i = 0; i < width * height; i++) CHECK_NEAR(out[i], 38.5, 8e-6);

        double before = 0, after = 0;
        for (int i = 0; i < width * height; i++) {
            edge[i] = (float)(20 + 10 * random_uniform(1, 2, 3, (uint64_t)i));
            before += edge[i];
        }
        edge[width * 30] = 400; /* hot, on the rim */
        before += 400 - (double)(float)(20 + 10 * random_uniform(1, 2, 3, width * 30));
        blur_apply(blur, out, edge, chains[k].smear_px);
        for (int i = 0; i < width * height; i++) after += out[i];
        /* roundings of 32000 floats, 3e-8 each, by chance. Oblique: at the corners what leaves over one edge does not
         * come back over the other; four of 32000 pixels */
        const bool oblique = chains[k].smear_px[0] != 0 && chains[k].smear_px[1] != 0;
        CHECK_NEAR(after / before, 1, oblique ? 1e-5 : 1e-9);

        for (int i = 0; i < width * height; i++) edge[i] = i % width < width / 2 ? 0 : 1;
        blur_apply(blur, out, edge, chains[k].smear_px);
        double most = 0;
        for (int i = 0; i < width * height; i++) {
            most = fmax(most, out[i]);
            CHECK(out[i] >= 0);
        }
        CHECK(most < (isinf(chains[k].cutoff_cyc_px) ? 1.011 : 1.0001));
        blur_destroy(blur);
    }
}

/* A thing of a hundred times the contrast, as an exhaust in 3.4-4.8 um: behind optics its surroundings fall off
 * without stripes: within 0.05 % of it from 4 pixels on off the axes, and never darker by more than that from
 * there on; the dark ring closer by is 0.8 % at most. (A chain that breaks off at Nyquist has 0.4 % bright and
 * dark by turns at 4 pixels.) */
static void hot_things_do_not_ring(void **state)
{
    (void)state;
    for (size_t k = 1; k < 4; k++) { /* oblique smears have lobes of their own */
        Blur *blur;
        assert_int_equal(blur_create(&blur, width, height, &chains[k]), STATUS_OK);
        for (int i = 0; i < width * height; i++) edge[i] = 100;
        edge[80 * width + 100] += 10000;
        blur_apply(blur, out, edge, still);
        for (int i = 0; i < width * height; i++) {
            const int x = abs(i % width - 100), y = abs(i / width - 80);
            CHECK(out[i] > 100 - 80);
            if (x >= 4 && y >= 4) CHECK(fabsf(out[i] - 100) < 5);
            if (x >= 4 || y >= 4) CHECK(out[i] > 100 - 5);
        }
        blur_destroy(blur);
    }
}

/* What is not finite neither spreads nor vanishes; in place is the same as not. */
static void odd_values_stay_where_they_are(void **state)
{
    (void)state;
    Blur *blur;
    assert_int_equal(blur_create(&blur, width, height, &chains[4]), STATUS_OK);
    for (int i = 0; i < width * height; i++) edge[i] = (float)(i % 17);
    edge[777] = NAN, edge[778] = INFINITY;
    blur_apply(blur, out, edge, chains[4].smear_px);
    blur_apply(blur, edge, edge, chains[4].smear_px);
    CHECK(memcmp(out, edge, sizeof out) == 0);
    for (int i = 0; i < width * height; i++)
        CHECK(i == 777 ? isnan(out[i]) : i == 778 ? isinf(out[i]) : isfinite(out[i]));
    blur_apply(blur, out, out, still);
    blur_destroy(blur);
}

int main(void)
{
    thread_flush_denormals();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(slanted_edge_shows_the_product),     cmocka_unit_test(waves_come_back_with_their_amplitude),
        cmocka_unit_test(mean_kept_and_nothing_rings_beyond), cmocka_unit_test(hot_things_do_not_ring),
        cmocka_unit_test(odd_values_stay_where_they_are),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
