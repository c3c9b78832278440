/* What an observer makes of a sensor's pictures, by its curves: against closed forms of a sensor whose terms are known,
 * and against direct sums over many frequencies. The eye, the noise and the whole of it against other programs:
 * tests/system/test_range_judge.sh. labels: physics */
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

/* The integral of the header, by rectangles over so many frequencies evenly in their logarithm. */
static double ttp_directly(const MrtdNoise *noise, double contrast, int steps)
{
    const double c = fmin(contrast / (2 * curves.observer.scene), 1), step = log(0.5 / 1e-3) / steps;
    double       sum[2] = {0, 0};
    for (int i = 0; i < steps; i++) {
        AcquisitionNode n;
        double          ctf[2];
        acquisition_node(&n, &curves, 1e-3 * exp((i + 0.5) * step));
        acquisition_threshold(ctf, &curves, &n, noise);
        for (int axis = 0; axis < 2; axis++)
            if (c > ctf[axis]) sum[axis] += sqrt(c / ctf[axis]) * n.f_cyc_px * step;
    }
    return sqrt(sum[0] * sum[1]);
}

/* The highest frequency at which bars are resolved, by halving between neighbours of a fine grid. */
static double cycles_directly(const MrtdNoise *noise, double contrast)
{
    enum { steps = 4000 };
    const MrtdObserver observer = {.snr = curves.observer.snr,
                                   .frames = curves.observer.frame_hz * curves.observer.eye_s};
    double             cycles[2] = {0, 0};
    for (int axis = 0; axis < 2; axis++)
        for (int i = steps; i > 0 && !(cycles[axis] > 0); i--) {
            const double f = 0.5 * i / steps;
            MrtdBars     bars;
            Mrtd         at;
            mrtd_bars(&bars, &curves.preset, f);
            mrtd_at(&at, &bars, noise, &observer);
            if (at.all_k[axis] <= contrast) cycles[axis] = i == steps ? f : f + 0.25 / steps;
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
        mrtd_noise_emitted(&noise, &p, 288);
        for (double contrast = 0.02; contrast < 30; contrast *= 1.7) {
            const double ttp = acquisition_ttp_px(&curves, &noise, contrast);
            const double want = ttp_directly(&noise, contrast, 2000);
            const double cycles = acquisition_cycles_px(&curves, &noise, -contrast);
            const double want_cycles = cycles_directly(&noise, contrast);
            if (getenv("SHOW"))
                printf("%s %g K: %.5f %.5f (%.4f %%); %.5f %.5f (%.4f %%)\n", names[k], contrast, ttp, want,
                       100 * (ttp / want - 1), cycles, want_cycles, 100 * (cycles / want_cycles - 1));
            if (want > 1e-3) worst_ttp = fmax(worst_ttp, fabs(ttp / want - 1));
            if (want_cycles > 0.02) worst_cycles = fmax(worst_cycles, fabs(cycles / want_cycles - 1));
        }
    }
    printf("interpolated curves against direct evaluation: TTP within %.3f %%, cycles within %.3f %%\n",
           100 * worst_ttp, 100 * worst_cycles);
    assert_true(worst_ttp < 0.002 && worst_cycles < 0.002);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(by_direct_sums)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
