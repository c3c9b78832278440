/* What an observer makes of a sensor's pictures: cycles, the TTP value and probabilities, against closed forms of a
 * sensor whose terms are known, against published examples, and the curves against direct sums over many frequencies.
 * The whole of it against a program of its own, MTF and noise against pyBSM: tests/system/test_range_judge.sh. labels:
 * physics */
#include "tests/check.h"

#include "sensor/acquisition/acquisition.h"
#include "sensor/acquisition/criteria.h"
#include "sensor/acquisition/observer_eye.h"

static Acquisition curves;

static SensorPreset preset_named(const char *name)
{
    SensorPreset p;
    assert_int_equal(preset_read(&p, "etc/sensors.csv", name), STATUS_OK);
    return p;
}

/* ---- probabilities ------------------------------------------------------------------------------- */

/* Ratches et al. (1975), as Holst and FLIR92's manual print it: probability by multiples of N50. */
static void johnson_as_published(void **state)
{
    static const double printed[][2] = {{3, 1.00},    {2, 0.95},   {1.5, 0.80},  {1, 0.50},
                                        {0.75, 0.30}, {0.5, 0.10}, {0.25, 0.02}, {0, 0}};
    (void)state;
    /* the table is rounded, and the formula is a fit to it: 0.05 */
    for (size_t i = 0; i < sizeof printed / sizeof *printed; i++)
        CHECK_NEAR(johnson_probability(printed[i][0]), printed[i][1], 0.05);
    /* by hand: 2^4.1 = 17.148, over 18.148; 0.5^3.05 = 0.12074, over 1.12074 */
    CHECK_NEAR(johnson_probability(2), 0.944898, 1e-6);
    CHECK_NEAR(johnson_probability(0.5), 0.107735, 1e-6);
    /* 2^1.99 = 3.97237, over 4.97237; 0.5^1.63 = 0.323088, over 1.323088 */
    CHECK_NEAR(ttp_probability(2), 0.798889, 1e-6);
    CHECK_NEAR(ttp_probability(0.5), 0.244193, 1e-6);
    assert_true(johnson_probability(1) == 0.5 && ttp_probability(1) == 0.5);
    assert_true(johnson_probability(0) == 0 && ttp_probability(-1) == 0);
    assert_true(johnson_probability(1e9) == 1 && ttp_probability(INFINITY) == 1);
    assert_true(isnan(johnson_probability(NAN)) && isnan(ttp_probability(NAN)));
    for (int i = 0; i < johnson_criteria_count; i++)
        for (int k = 1; k < acquisition_tasks; k++)
            assert_true(johnson_criteria[i].at50[k] > johnson_criteria[i].at50[k - 1] && *johnson_criteria[i].source);
}

/* ---- cycles --------------------------------------------------------------------------------------- */

/* Pixels of 1 without optics, and white noise of reading alone: MRTD(f) has a closed form, by both bars alike. */
static SensorPreset full_pixels(void)
{
    SensorPreset p = {
        .band = BAND_LWIR,
        .width_px = 500,
        .height_px = 500,
        .hfov_deg = 5,
        .footprint = 1,
        .bits = 16,
        .noise_scale = 1,
        .photons = {.f_number = 1e-9, .transmission = 1, .qe = 1, .pitch_m = 1, .integration_s = 1e-20, .well_e = 1}};
    preset_refresh(&p);
    p.photons.read_e = 1e3;
    return p;
}

/* Lloyd's MRTD of such a sensor, in the limit of long bars: where it equals the contrast is found on paper. With a bar
 * of 1 / (2 f) the share of white noise is (1 - 2 f / 3) 2 f, along it (1 - 2 f / 21) 2 f / 7. */
static void cycles_on_paper(void **state)
{
    (void)state;
    const SensorPreset        p = full_pixels();
    const AcquisitionObserver observer = acquisition_default_observer();
    MrtdNoise                 noise;
    acquisition_prepare(&curves, &p, &observer);
    mrtd_noise_emitted(&noise, &p, 300);
    for (double f = 0.03; f < 0.5; f *= 1.3) {
        const double left = (1 - 2 * f / 3) * 2 * f * (1 - 2 * f / 21) * 2 * f / 7;
        double       bars = 0;
        for (int n = 1; n <= 15; n += 2) {
            const double x = pi_rad * n * f, sinc = sin(x) / x;
            bars += 8 / (pi_rad * pi_rad) * sinc * sinc / (n * n); /* the pixel, and the observer's mean over it */
        }
        const double sigma_k = sqrt(noise.tvh_e2) / noise.per_unit_e;
        const double mrtd_k = 2.5 * sigma_k * sqrt(left / 6) / bars;
        CHECK_NEAR(acquisition_cycles_px(&curves, &noise, mrtd_k) / f, 1, 0.003);
    }
    assert_true(acquisition_cycles_px(&curves, &noise, 1e6) == 0.5);
    assert_true(acquisition_cycles_px(&curves, &noise, 0) == 0);
    assert_true(isnan(acquisition_cycles_px(&curves, &noise, NAN)));
}

/* ---- TTP ------------------------------------------------------------------------------------------ */

/* Without noise, and with contrast above threshold up to the last frequency, TTP goes with the root of the contrast;
 * with noise alone, with the root of contrast over noise. */
static void ttp_on_paper(void **state)
{
    (void)state;
    SensorPreset              p = full_pixels();
    const AcquisitionObserver observer = acquisition_default_observer();
    MrtdNoise                 noise = {.per_unit_e = 1}, more = {.tvh_e2 = 1e6, .per_unit_e = 1};
    acquisition_prepare(&curves, &p, &observer);
    CHECK_NEAR(acquisition_ttp_px(&curves, &noise, 8) / acquisition_ttp_px(&curves, &noise, 2), 2, 0.02);
    assert_true(acquisition_ttp_px(&curves, &noise, 10) ==
                acquisition_ttp_px(&curves, &noise, 100)); /* white at 10 K */
    assert_true(acquisition_ttp_px(&curves, &noise, 0) == 0 && isnan(acquisition_ttp_px(&curves, &noise, NAN)));
    for (int i = 5; i < acquisition_nodes; i += 11) {
        const AcquisitionNode *n = &curves.node[i];
        double                 ctf[2], twice[2];
        acquisition_threshold(ctf, &curves, n, &more);
        more.tvh_e2 *= 4;
        acquisition_threshold(twice, &curves, n, &more);
        more.tvh_e2 /= 4;
        CHECK_NEAR(twice[0] / ctf[0], 2, 1e-4);
        /* fixed noise counts as that of eye_s, moving noise of a frame: 6 times */
        MrtdNoise fixed = {.kind_e2 = {[NOISE_VH] = 1e6}, .per_unit_e = 1};
        acquisition_threshold(twice, &curves, n, &fixed);
        CHECK_NEAR(twice[1] / ctf[1], sqrt(6), 1e-4);
        /* noise of columns hides vertical bars, that of rows horizontal ones */
        MrtdNoise columns = {.kind_e2 = {[NOISE_H] = 1e6}, .per_unit_e = 1};
        acquisition_threshold(twice, &curves, n, &columns);
        assert_true(twice[1] == n->threshold[1] && twice[0] > 100 * n->threshold[0]);
        MrtdNoise rows = {.row_gain_e2 = 1e6, .per_unit_e = 1};
        acquisition_threshold(twice, &curves, n, &rows);
        assert_true(twice[0] == n->threshold[0] && twice[1] > 100 * n->threshold[1]);
    }
}

/* ---- the eye --------------------------------------------------------------------------------------- */

static void eyes(void **state)
{
    (void)state;
    /* Barten (1990) at 100 cd/m2, 12 degrees, by hand: a = 540 1.007^-0.2 / (1 + 12 / (12 (1 + 4/3)^2)) = 455.6 at 4
     * cycles a degree; b = 0.3 2^0.15 = 0.33287: 455.57 4 e^-1.3315 sqrt(1 + 0.06 e^1.3315) = 533.11 */
    CHECK_NEAR(1 / eye_threshold(4, 100, 12), 533.11, 0.01);
    /* most sensitive from 1.5 to 5 cycles a degree, and nothing is seen beyond 50 or 60 */
    double best = 1, at = 0;
    for (double f = 0.1; f < 100; f *= 1.02)
        if (eye_threshold(f, 34.26, 25) < best) best = eye_threshold(f, 34.26, 25), at = f;
    assert_true(at > 1.5 && at < 5 && best > 0.0015 && best < 0.004);
    assert_true(eye_threshold(60, 34.26, 25) > 0.9);
    assert_true(eye_transfer(0, 34.26) == 1 && eye_transfer(6, 34.26) < 1e-7);
    CHECK_NEAR(eye_channel(2, 1), exp(-2.2 * log(2) * log(2)), 1e-15);
}

/* ---- curves against direct sums ---------------------------------------------------------------------- */

enum { fine = 6000 };
static AcquisitionNode even_log[fine], even[fine]; /* of frequency */

/* The integral of the header, by rectangles evenly in the logarithm of frequency. */
static double ttp_directly(const MrtdNoise *noise, double contrast)
{
    const double c = fmin(contrast / (2 * curves.observer.scene), 1), step = log(500) / fine;
    double       sum[2] = {0, 0}, ctf[2];
    for (int i = 0; i < fine; i++) {
        acquisition_threshold(ctf, &curves, &even_log[i], noise);
        for (int axis = 0; axis < 2; axis++)
            if (c > ctf[axis]) sum[axis] += sqrt(c / ctf[axis]) * even_log[i].f_cyc_px * step;
    }
    return sqrt(sum[0] * sum[1]);
}

/* The highest frequency at which bars are resolved, to half a step. */
static double cycles_directly(const MrtdNoise *noise, double contrast)
{
    const MrtdObserver observer = {.snr = curves.observer.snr,
                                   .frames = curves.observer.frame_hz * curves.observer.eye_s};
    double             cycles[2] = {0, 0};
    for (int i = fine - 1; i >= 0; i--) {
        Mrtd at;
        mrtd_at(&at, &even[i].bars, noise, &observer);
        for (int axis = 0; axis < 2; axis++)
            if (!(cycles[axis] > 0) && at.all_k[axis] <= contrast)
                cycles[axis] = fmin(even[i].f_cyc_px + 0.25 / fine, 0.5);
    }
    return sqrt(cycles[0] * cycles[1]);
}

static void by_direct_sums(void **state)
{
    static const char *const names[] = {"staring_lwir", "staring_mwir", "scanning_flir", "scanning_flir2"};
    (void)state;
    double worst_ttp = 0, worst_cycles = 0;
    for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
        const SensorPreset        p = preset_named(names[k]);
        const AcquisitionObserver observer = acquisition_default_observer();
        MrtdNoise                 noise;
        acquisition_prepare(&curves, &p, &observer);
        for (int i = 0; i < fine; i++) {
            acquisition_node(&even_log[i], &curves, 1e-3 * exp((i + 0.5) / fine * log(500)));
            mrtd_bars(&even[i].bars, &p, even[i].f_cyc_px = 0.5 * (i + 1) / fine);
        }
        mrtd_noise_emitted(&noise, &p, 288);
        for (double contrast = 0.03; contrast < 30; contrast *= 1.7) {
            const double ttp = acquisition_ttp_px(&curves, &noise, contrast), want = ttp_directly(&noise, contrast);
            const double cycles = acquisition_cycles_px(&curves, &noise, -contrast),
                         want_cycles = cycles_directly(&noise, contrast);
            if (want > 1e-3) worst_ttp = fmax(worst_ttp, fabs(ttp / want - 1));
            if (want_cycles > 0.05) worst_cycles = fmax(worst_cycles, fabs(cycles / want_cycles - 1));
        }
    }
    printf("curves against direct evaluation: TTP within %.3f %%, cycles within %.3f %%\n", 100 * worst_ttp,
           100 * worst_cycles);
    assert_true(worst_ttp > 0 && worst_ttp < 0.0025 && worst_cycles < 0.0012);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(johnson_as_published), cmocka_unit_test(cycles_on_paper),
                                       cmocka_unit_test(ttp_on_paper), cmocka_unit_test(eyes),
                                       cmocka_unit_test(by_direct_sums)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
