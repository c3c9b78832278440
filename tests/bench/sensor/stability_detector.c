/* tests/bench/sensor/stability_detector.c: detectors of 1 to 16 bits in the dark, in the sun and with values that are
 * not numbers; displays of images without contrast; and whether every thread treats denormal numbers alike. */
#include "tests/bench/suites.h"

#include "tests/bench/stress.h"
#include "render/materials/planck.h"
#include "sensor/detector/chain.h"
#include "sensor/detector/display_values.h"

#include <stdlib.h>
#include <xmmintrin.h>

enum { width = 64, height = 48, pixels = width * height };

static const char *const preset_name[] = {"staring_lwir", "staring_mwir", "scanning_flir", "tv"};
enum { presets = sizeof preset_name / sizeof *preset_name };

static bool read_preset(SensorPreset *out, int which)
{
    char path[512];
    return etc_path(path, sizeof path, "sensors.csv") && preset_read(out, path, preset_name[which]) == STATUS_OK;
}

/* Planes beyond any scene: dark, far beyond the well, below 0, NaN, the smallest and the largest numbers. */
enum { plane_kinds = 9 };
static void fill_plane(float *plane, int kind, Dice *dice)
{
    static const float odd[] = {0, 1e-40f, 1e-30f, 30, 1e30f, 3e38f, -1, -3e38f, INFINITY, -INFINITY, NAN};
    for (int i = 0; i < pixels; i++) {
        const int any = (int)stress_uniform(dice, 0, sizeof odd / sizeof *odd);
        plane[i] = kind < 6 ? odd[kind] : kind == 6 ? NAN : kind == 7 ? odd[any] : i % 37 == 0 ? odd[any] : 30;
    }
}

/* Runs every preset with 1 to 16 bits, and noise from none to a million times its own: counts must be within the
 * converter's scale, and values must be those counts. */
static double counts_in_scale(void *user, bool quick)
{
    static float plane[3][pixels];
    Dice         dice = {.stream = 70};
    double       wrong = 0;
    (void)user;
    for (int k = 0; k < presets; k++)
        for (int bits = 1; bits <= 16; bits += quick ? 7 : 1) {
            static const double noise[] = {0, 1, 1e6};
            SensorPreset        preset;
            Chain              *chain = NULL;
            if (!read_preset(&preset, k)) return INFINITY;
            preset.bits = bits;
            preset.noise_scale = noise[bits % 3];
            preset.bad_share = bits % 2 ? 0.2 : 0;
            if (bits % 4 == 1) preset.photons.well_e = 1e12;
            if (bits % 4 == 2) preset.photons.well_e = 100;
            preset_refresh(&preset);
            if (chain_create(&chain, &preset, width, height, 16, 1) != STATUS_OK) return INFINITY;
            const int channels = preset.band == BAND_OPTICAL && preset.optical == OPTICAL_RGB ? 3 : 1;
            for (int kind = 0; kind < plane_kinds; kind++) {
                const float *const in[3] = {plane[0], plane[1], plane[2]};
                const double       rate_px_s[2] = {kind % 2 ? 0 : 100, kind % 3 ? 0 : -1e4};
                for (int c = 0; c < 3; c++) fill_plane(plane[c], kind, &dice);
                chain_expose(chain, in);
                chain_run(chain, in, NULL, kind, rate_px_s);
                for (int c = 0; c < channels; c++)
                    for (int i = 0; i < pixels; i++)
                        wrong += chain_counts(chain, c)[i] >= 1 << bits ||
                                 !(chain_values(chain, c)[i] == (float)chain_counts(chain, c)[i]);
            }
            chain_destroy(chain);
        }
    return wrong;
}

/* No noise, a uniform plane: the converter's own formula, (electrons + dark) / step, rounded, held at full scale.
 * Electrons by Planck's photons; from the dark to well beyond the well. Without lines, whose start is charged to the
 * mean. */
static double even_planes(void *user, bool quick)
{
    static float plane[pixels];
    double       worst = 0;
    (void)user;
    for (int k = 0; k < 2; k++)
        for (int bits = 1; bits <= 16; bits += quick ? 5 : 1) {
            SensorPreset preset;
            Chain       *chain = NULL;
            if (!read_preset(&preset, k)) return INFINITY;
            preset.bits = bits;
            preset.noise_scale = preset.bad_share = preset.prnu = preset.line_noise = preset.ac_per_line = 0;
            memset(preset.ratio.sigma, 0, sizeof preset.ratio.sigma);
            if (chain_create(&chain, &preset, width, height, 16, 1) != STATUS_OK) return INFINITY;
            for (int step = 0; step <= 16; step++) {
                const PhotonDetector *d = &preset.photons;
                const double          temp_k = 180 + 40 * step, full = (1 << bits) - 1, still[2] = {0, 0};
                const double          radiance = planck_band(d->low_m, d->high_m, temp_k, NULL);
                const double          exact = (photon_electrons(d, temp_k, NULL) + d->dark_e) / (d->well_e / full);
                const float *const    in[1] = {plane};
                for (int i = 0; i < pixels; i++) plane[i] = (float)radiance;
                chain_expose(chain, in);
                chain_run(chain, in, NULL, 0, still);
                for (int i = 0; i < pixels; i++)
                    worst = fmax(worst, fabs(chain_counts(chain, 0)[i] - fmin(exact, full)));
            }
            chain_destroy(chain);
        }
    return worst;
}

/* Counts the pixels that one NaN pixel changes, against the same image with a 0 there; without noise and patches, on a
 * static scene. */
static double one_bad_pixel(void *user, bool quick)
{
    static float       plane[pixels];
    static uint16_t    kept[pixels];
    static const float odd[3] = {NAN, INFINITY, -INFINITY};
    const double       still[2] = {0, 0};
    double             changed = 0;
    (void)user, (void)quick;
    for (int k = 0; k < 3; k++) {
        SensorPreset preset;
        Chain       *chain = NULL;
        const int    at = 20 * width + 30;
        if (!read_preset(&preset, k)) return INFINITY;
        preset.noise_scale = preset.bad_share = preset.ac_per_line = 0;
        if (chain_create(&chain, &preset, width, height, 16, 1) != STATUS_OK) return INFINITY;
        const float *const in[1] = {plane};
        for (int o = -1; o < 3; o++) {
            for (int i = 0; i < pixels; i++) plane[i] = 20 + (float)(i % width);
            plane[at] = o < 0 ? 0 : odd[o];
            chain_expose(chain, in);
            chain_run(chain, in, NULL, 0, still);
            if (o < 0) memcpy(kept, chain_counts(chain, 0), sizeof kept);
            for (int i = 0; i < pixels; i++) changed += i != at && chain_counts(chain, 0)[i] != kept[i];
            /* NaN gives 0 counts, infinity full scale, negative values dark */
            const unsigned want[3] = {0, (1u << (int)preset.bits) - 1, kept[at]};
            if (o >= 0) changed += chain_counts(chain, 0)[at] != want[o];
        }
        chain_destroy(chain);
    }
    return changed;
}

/* ---- displays -------------------------------------------------------------------------------------- */

/* An image of one value, from zero to the largest float, is displayed at the middle of the scale: never black by a
 * division. */
static double no_contrast(void *user, bool quick)
{
    static float    plane[pixels];
    static uint16_t shown[pixels];
    double          worst = 0;
    (void)user;
    for (int k = 0; k <= (quick ? 20 : 400); k++) {
        DetectorConfig     config = detector_default_config();
        const float *const in[1] = {plane};
        const float        value = (float)pow(10, -45 + 83.0 * k / (quick ? 20 : 400)) * (k % 3 ? 1 : -1);
        config.bits = 16;
        for (int i = 0; i < pixels; i++) plane[i] = value;
        const DetectorLevel level = detector_level(&config, in, 1, pixels);
        detector_display(shown, plane, pixels, &config, level);
        if (!(level.high > level.low)) return INFINITY;
        for (int i = 0; i < pixels; i++) worst = fmax(worst, fabs(shown[i] - 32767.5));
    }
    return worst;
}

static double clamped(double x) { return fmin(fmax(x, 0), 1); }

/* Gains of 1e-6 to 1e6, values of all magnitudes and NaN: levels in order, the code within a step of the formula;
 * NaN and -infinity are black, infinity white. */
static double display_ends(void *user, bool quick)
{
    static float    plane[pixels];
    static uint16_t shown[3 * pixels];
    static uint8_t  shown8[3 * pixels];
    Dice            dice = {.stream = 71};
    double          wrong = 0;
    (void)user;
    for (int n = quick ? 40 : 1000; n > 0; n--) {
        DetectorConfig     config = detector_default_config();
        const float *const in[3] = {plane, plane, plane};
        config.bits = 16;
        config.gain = stress_log_uniform(&dice, 1e-6, 1e6);
        config.offset = stress_uniform(&dice, -10, 10);
        config.percentile_low = n % 3 ? 0.01 : 0;
        config.percentile_high = n % 3 ? 0.99 : 1;
        fill_plane(plane, 8, &dice);
        for (int i = 0; i < pixels; i += 2) plane[i] = (float)stress_log_uniform(&dice, 1e-30, n % 2 ? 1e3 : 1e38);
        const DetectorLevel level = detector_level(&config, in, 1, pixels);
        detector_display(shown, plane, pixels, &config, level);
        wrong += !(level.high > level.low) || !isfinite(level.high - level.low);
        const double scale = config.gain / (level.high - level.low), middle = 0.5 * (level.low + level.high);
        for (int i = 0; i < pixels; i++) {
            const double x = ((double)plane[i] - middle) * scale + 0.5 + config.offset;
            /* roundings of the folded form are of middle x scale */
            const double room = 0.51 + 65535 * 4e-16 * (fabs(middle * scale) + 11);
            if (isnan(plane[i])) wrong += shown[i] != 0;
            else wrong += !(fabs(shown[i] - 65535 * clamped(x)) <= room);
        }
        detector_display_rgb(shown, in, pixels, &config, level);
        for (int i = 0; i < pixels; i++)
            wrong += isnan(plane[i]) && (shown[3 * i] | shown[3 * i + 1] | shown[3 * i + 2]) != 0;
        config.bits = 8;
        config.display_gamma = true;
        detector_display_rgb(shown8, in, pixels, &config, level);
        for (int i = 0; i < pixels; i++)
            wrong += isnan(plane[i]) && (shown8[3 * i] | shown8[3 * i + 1] | shown8[3 * i + 2]) != 0;
        detector_display_db(shown, plane, pixels, 60, 16);
        for (int i = 0; i < pixels; i++) {
            wrong += !(plane[i] > 0) && shown[i] != 0;
            wrong += plane[i] == INFINITY && shown[i] != 65535;
        }
    }
    return wrong;
}

/* ---- threads ---------------------------------------------------------------------------------------- */

enum { threads = 4 };

typedef struct Denormals {
    volatile double tiny;
    volatile float  tiny_f;
    int             arrived;
    double          product[threads];
    float           product_f[threads];
    unsigned        modes[threads];
} Denormals;

/* Waits for the others, so that each thread runs one. */
static void multiply(void *user, int worker, int task)
{
    Denormals *d = user;
    (void)worker;
    __atomic_add_fetch(&d->arrived, 1, __ATOMIC_SEQ_CST);
    while (__atomic_load_n(&d->arrived, __ATOMIC_SEQ_CST) < threads) _mm_pause();
    d->product[task] = d->tiny * 0.5;
    d->product_f[task] = d->tiny_f * 0.5f;
    d->modes[task] = _mm_getcsr() & 0xffc0; /* all flags except those already raised */
}

/* Lets the main thread and the pool's halve the smallest normal numbers, and counts the threads that get another
 * number, flush denormals differently, or round differently. */
static double threads_agree(void *user, bool quick)
{
    Denormals d = {.tiny = 2.2250738585072014e-308, .tiny_f = 1.17549435e-38f};
    Pool     *pool = NULL;
    double    wrong = 0;
    (void)user, (void)quick;
    if (pool_create(&pool, threads) != STATUS_OK) return INFINITY;
    pool_run(pool, threads, multiply, &d);
    pool_destroy(pool);
    for (int k = 0; k < threads; k++)
        wrong += d.product[k] != 0 || d.product_f[k] != 0 || d.modes[k] != (_mm_getcsr() & 0xffc0);
    return wrong;
}

Status bench_stability_detector(Bench *bench)
{
    static const StressCase cases[] = {
        {"detector: 1 .. 16 bits, any noise, any plane", counts_in_scale, 0, "counts", "0 .. full scale"},
        {"detector: even planes, 180 .. 820 K, to beyond the well", even_planes, 0.51, "counts",
         "photons by Planck, dark current, rounding"},
        {"detector: one pixel not a number", one_bad_pixel, 0, "counts", "the same with a 0 there"},
        {"display: one value all over, 1e-45 .. 1e38", no_contrast, 1, "of 65535", "the middle"},
        {"display: gains of 1e-6 .. 1e6, values that are none", display_ends, 0, "values", "its formula; NaN is black"},
        {"threads: numbers too small, by each", threads_agree, 0, "threads", "the main thread"},
    };
    stress_cases(bench, cases, sizeof cases / sizeof *cases, NULL);
    return STATUS_OK;
}
