/* tests/bench/sensor/precision_detector.c: from radiance to stored values: blur, photons, counts, displays. */
#include "tests/bench/sensor/precision.h"

#include "render/materials/planck.h"
#include "sensor/detector/blur_private.h"
#include "sensor/detector/photons.h"
#include "sensor/detector/display_values.h"
#include "tests/sensor/colorimetry.h"

#include <stdlib.h>

/* ---- blur -------------------------------------------------------------------------------------- */

enum { wide = 96, high = 64, blur_px = wide * high, most_radius = 16 };

/* Random patches of several sizes: edges, points and smooth ground. */
static void make_plane(float *plane, double low, double span)
{
    for (int i = 0; i < blur_px; i++) {
        const int    x = i % wide, y = i / wide;
        const double coarse = random_uniform(3, 0, 0, (uint64_t)(y / 16 * 64 + x / 16));
        const double middle = random_uniform(3, 1, 0, (uint64_t)(y / 5 * 64 + x / 5));
        const double fine = random_uniform(3, 2, 0, (uint64_t)i);
        plane[i] = (float)(low + span * (0.6 * coarse + 0.3 * middle + 0.1 * fine));
    }
}

/* Applies the chain's product in the cosine transform of both axes, by direct sums, up to Nyquist and without taper. */
static void blur_by_sums(double *out, const float *in, const MtfChain *chain)
{
    static double across[wide][wide], down[high][high], half[high][wide], value[high][wide];
    for (int k = 0; k < wide; k++)
        for (int x = 0; x < wide; x++) across[k][x] = sqrt((k ? 2.0 : 1.0) / wide) * cos(pi_rad * k * (x + 0.5) / wide);
    for (int k = 0; k < high; k++)
        for (int y = 0; y < high; y++) down[k][y] = sqrt((k ? 2.0 : 1.0) / high) * cos(pi_rad * k * (y + 0.5) / high);
    for (int y = 0; y < high; y++)
        for (int k = 0; k < wide; k++) {
            half[y][k] = 0;
            for (int x = 0; x < wide; x++) half[y][k] += across[k][x] * (double)in[y * wide + x];
        }
    for (int k = 0; k < wide; k++)
        for (int j = 0; j < high; j++) {
            double sum = 0;
            for (int y = 0; y < high; y++) sum += down[j][y] * half[y][k];
            value[j][k] = sum * mtf_chain(chain, 0.5 * k / wide, 0.5 * j / high);
        }
    for (int y = 0; y < high; y++)
        for (int k = 0; k < wide; k++) {
            half[y][k] = 0;
            for (int j = 0; j < high; j++) half[y][k] += down[j][y] * value[j][k];
        }
    for (int y = 0; y < high; y++)
        for (int x = 0; x < wide; x++) {
            out[y * wide + x] = 0;
            for (int k = 0; k < wide; k++) out[y * wide + x] += across[k][x] * half[y][k];
        }
}

typedef struct Blurring {
    Blur        *blur; /* NULL: by the kernel */
    int          radius;
    float        kernel[2 * most_radius + 1][2 * most_radius + 1];
    const float *in;
    float       *out;
} Blurring;

/* Computes the point spread within a radius, scaled to the sum 1: the inverse transform of the chain's product on 64 x
 * 64 frequencies. */
static void make_kernel(Blurring *b, const MtfChain *chain)
{
    enum { n = 64 };
    static double pass[n][n];
    double        sum = 0;
    for (int j = 0; j < n; j++)
        for (int k = 0; k < n; k++) pass[j][k] = mtf_chain(chain, (k - n / 2 + 0.5) / n, (j - n / 2 + 0.5) / n);
    for (int y = 0; y <= b->radius; y++)
        for (int x = 0; x <= b->radius; x++) {
            double value = 0;
            for (int j = 0; j < n; j++)
                for (int k = 0; k < n; k++)
                    value += pass[j][k] * cos(2 * pi_rad * x * (k - n / 2 + 0.5) / n) *
                             cos(2 * pi_rad * y * (j - n / 2 + 0.5) / n);
            const int r = b->radius;
            b->kernel[r + y][r + x] = b->kernel[r - y][r + x] = b->kernel[r + y][r - x] = b->kernel[r - y][r - x] =
                (float)(value / (n * n));
            sum += value / (n * n) * (x ? 2 : 1) * (y ? 2 : 1);
        }
    for (int y = 0; y <= 2 * b->radius; y++)
        for (int x = 0; x <= 2 * b->radius; x++) b->kernel[y][x] /= (float)sum;
}

static void run_blur(void *user)
{
    static const double still[2] = {0, 0};
    enum { margin = most_radius, row = wide + 2 * margin };
    static float padded[(high + 2 * margin) * row];
    Blurring    *b = user;
    if (b->blur) {
        blur_apply(b->blur, b->out, b->in, still);
        return;
    }
    for (int y = -margin; y < high + margin; y++)
        for (int x = -margin; x < wide + margin; x++) {
            const int u = x < 0 ? -1 - x : x >= wide ? 2 * wide - 1 - x : x;
            const int v = y < 0 ? -1 - y : y >= high ? 2 * high - 1 - y : y;
            padded[(y + margin) * row + x + margin] = b->in[v * wide + u];
        }
    for (int y = 0; y < high; y++) {
        float *out = b->out + y * wide;
        memset(out, 0, wide * sizeof *out);
        for (int j = -b->radius; j <= b->radius; j++)
            for (int i = -b->radius; i <= b->radius; i++) {
                const float  weight = b->kernel[b->radius + j][b->radius + i];
                const float *from = padded + (y + j + margin) * row + margin + i;
                for (int x = 0; x < wide; x++) out[x] += weight * from[x];
            }
    }
    bench_keep(b->out);
}

static Status tunable_blur(Bench *bench)
{
    enum { settings = 5 };
    static const char *const name[settings] = {"kernel of 5 x 5", "kernel of 9 x 9", "kernel of 17 x 17",
                                               "kernel of 33 x 33", "cosine transform"};
    static const int         radius[settings - 1] = {2, 4, 8, 16};
    /* f/2, 10 um, pitch 15 um; central obscuration, jitter */
    const MtfChain chain = {
        .cutoff_cyc_px = 15e-6 / (10e-6 * 2), .obscuration = 0.3, .footprint_px = 0.9, .places = 1, .jitter_px = 0.2};
    static float    in[blur_px], out[blur_px];
    static double   want[blur_px];
    static Blurring set[settings];
    BenchWork       work[settings];
    BenchSetting    point[settings] = {0};
    memset(set, 0, sizeof set);
    make_plane(in, 30, 20);
    blur_by_sums(want, in, &chain);
    const Status status = blur_create(&set[settings - 1].blur, wide, high, &chain);
    if (status != STATUS_OK) return status;
    for (int k = 0; k < settings; k++) {
        double square = 0;
        set[k].in = in, set[k].out = out;
        if (k < settings - 1) {
            set[k].radius = radius[k];
            make_kernel(&set[k], &chain);
        }
        run_blur(&set[k]);
        for (int i = 0; i < blur_px; i++) square += ((double)out[i] - want[i]) * ((double)out[i] - want[i]);
        work[k] = (BenchWork){run_blur, &set[k], blur_px};
        point[k] = (BenchSetting){
            .setting = name[k], .error = 100 * sqrt(square / blur_px) / 20, .is_default = k == settings - 1};
    }
    bench_tunable(bench,
                  &(BenchTunable){"optics' blur", "sensor/detector/blur.c", "a pixel", "%",
                                  "rms over contrast, the chain to Nyquist by sums", 0.2},
                  work, point, settings);
    blur_destroy(set[settings - 1].blur);
    return STATUS_OK;
}

/* ---- photons ------------------------------------------------------------------------------------ */

enum { photon_count = 512 };

typedef struct Photons {
    const PhotonTable    *table; /* NULL and ratio NULL: computed for each */
    const PhotonDetector *detector;
    int                   knots;
    double               *ratio, low, per_log; /* a table of the bench's own */
    float                 radiance[photon_count];
    double                electrons[photon_count];
} Photons;

static double photons_exactly(const PhotonDetector *d, double radiance)
{
    return photon_etendue(d) *
           photon_band(d->low_m, d->high_m, planck_band_inverse(d->low_m, d->high_m, radiance), NULL);
}

static void count_photons(void *user)
{
    Photons *p = user;
    for (int i = 0; i < photon_count; i++) {
        const double radiance = (double)p->radiance[i];
        if (p->table) {
            p->electrons[i] = photon_table_electrons(p->table, radiance);
        } else if (p->ratio) {
            const double at = clamp((log(radiance) - p->low) * p->per_log, 0, p->knots - 1);
            const int    k = at < p->knots - 2 ? (int)at : p->knots - 2;
            p->electrons[i] = radiance * (p->ratio[k] + (at - k) * (p->ratio[k + 1] - p->ratio[k]));
        } else {
            p->electrons[i] = photons_exactly(p->detector, radiance);
        }
    }
    bench_keep(p->electrons);
}

static Status tunable_photons(Bench *bench)
{
    enum { settings = 5 };
    static const char *const name[settings] = {"64 knots", "256 knots", "1024 knots", "4096 knots",
                                               "integrated each time"};
    static const int         knots[settings - 2] = {64, 256, 1024};
    const PhotonDetector     d = {.low_m = 3.4e-6,
                                  .high_m = 4.8e-6,
                                  .f_number = 2.5,
                                  .transmission = 0.8,
                                  .qe = 0.7,
                                  .pitch_m = 15e-6,
                                  .integration_s = 2e-3};
    static Photons           set[settings];
    static double            ratio[settings - 2][1024];
    BenchWork                work[settings];
    BenchSetting             point[settings] = {0};
    PhotonTable             *table;
    const double             low = log(planck_band(d.low_m, d.high_m, 180, NULL));
    const double             high_log = log(planck_band(d.low_m, d.high_m, 1500, NULL));
    const Status             status = photon_table_create(&table, &d, true);
    if (status != STATUS_OK) return status;
    for (int k = 0; k < settings; k++) {
        Photons *p = &set[k];
        *p = (Photons){.detector = &d, .table = k == 3 ? table : NULL, .low = low};
        if (k < 3) {
            p->knots = knots[k];
            p->per_log = (knots[k] - 1) / (high_log - low);
            p->ratio = ratio[k];
            for (int i = 0; i < knots[k]; i++) {
                const double radiance = exp(low + i / p->per_log);
                ratio[k][i] = photons_exactly(&d, radiance) / radiance;
            }
        }
        for (int i = 0; i < photon_count; i++)
            p->radiance[i] = (float)exp(low + 0.1 + (high_log - low - 0.2) * random_uniform(9, 0, 0, (uint64_t)i));
        count_photons(p);
        double worst = 0;
        for (int i = 0; i < photon_count; i++)
            bench_worst(&worst, 100 * fabs(p->electrons[i] / photons_exactly(&d, (double)p->radiance[i]) - 1));
        work[k] = (BenchWork){count_photons, p, photon_count};
        point[k] = (BenchSetting){.setting = name[k],
                                  .error = worst,
                                  .is_default = k == 3,
                                  .bytes = k < 3    ? knots[k] * 8.0
                                           : k == 3 ? 4096 * 8.0
                                                    : 0};
    }
    bench_tunable(bench,
                  &(BenchTunable){"electrons of a radiance", "sensor/detector/photons.c", "a pixel, 3.4-4.8 um", "%",
                                  "largest, the integral over the band, 180 .. 1500 K", 1e-4},
                  work, point, settings);
    photon_table_destroy(table);
    return STATUS_OK;
}

/* ---- counts ------------------------------------------------------------------------------------- */

typedef struct Converter {
    const float *in, *true_in; /* in has the noise, true_in has none */
    int          bits;
    bool         display;
    double       low, high;
    uint16_t     out[blur_px];
} Converter;

static void convert(void *user)
{
    Converter *c = user;
    if (c->display) {
        DetectorConfig config = detector_default_config();
        config.bits = c->bits;
        detector_display(c->out, c->in, blur_px, &config, (DetectorLevel){c->low, c->high});
    } else {
        detector_counts(c->out, c->in, blur_px, (c->high - c->low) / ((1 << c->bits) - 1),
                        (uint16_t)((1 << c->bits) - 1));
    }
    bench_keep(c->out);
}

/* Rms difference between the values that the counts represent and the true ones. */
static double convert_rms(const Converter *c)
{
    double       square = 0;
    const double step = (c->high - c->low) / ((1 << c->bits) - 1);
    for (int i = 0; i < blur_px; i++) {
        const int    count = c->display && c->bits == 8 ? ((const uint8_t *)c->out)[i] : c->out[i];
        const double off = (c->display ? c->low : 0) + count * step - (double)c->true_in[i];
        square += off * off;
    }
    return sqrt(square / blur_px);
}

static void tunable_counts(Bench *bench, bool display)
{
    enum { settings = 5 };
    static const int display_bits[] = {8, 16}, converter_bits[] = {8, 10, 12, 14, 16};
    static float     in[blur_px], noisy[blur_px];
    static Converter set[settings];
    char             name[settings][16];
    BenchWork        work[settings];
    BenchSetting     point[settings] = {0};
    const int        count = display ? 2 : settings;
    make_plane(in, display ? 280 : 5, 30);
    /* A converter follows a detector: steps far finer than its noise bring nothing. 20 mK is that of a good cooled
     * camera. */
    for (int i = 0; i < blur_px; i++)
        noisy[i] = in[i] + (float)(display ? 0 : 0.02 * random_normal(8, 0, 0, (uint64_t)i));
    for (int k = 0; k < count; k++) {
        const int bits = display ? display_bits[k] : converter_bits[k];
        set[k] = (Converter){.in = noisy,
                             .true_in = in,
                             .bits = bits,
                             .display = display,
                             .low = display ? 280 : 0,
                             .high = display ? 320 : 40};
        snprintf(name[k], sizeof name[k], "%d bits", bits);
        convert(&set[k]);
        work[k] = (BenchWork){convert, &set[k], blur_px};
        point[k] = (BenchSetting){.setting = name[k],
                                  .is_default = bits == (display ? 8 : 14),
                                  .error = convert_rms(&set[k]),
                                  .bytes = (display ? bits : 8 * ((bits + 7) / 8)) / 8.0 * blur_px};
    }
    if (display)
        bench_tunable(
            bench,
            &(BenchTunable){"display", "detector.bits", "a pixel", "K", "rms, a plane of 280 .. 320 K before it", 0.05},
            work, point, count);
    else
        bench_tunable(bench,
                      &(BenchTunable){"converter", "etc/sensors.csv", "a pixel", "K",
                                      "rms, what is seen; 20 mK of noise, a span of 40 K", 0.0205},
                      work, point, count);
}

/* ---- the display's curve ------------------------------------------------------------------------ */

enum { curve_px = 720 * 486 }; /* the display computes its table anew for each image */

typedef struct CurveSet {
    int          intervals; /* 0: the display's own; -1: the formula */
    const float *in;
    float        table[4097];
    uint16_t     out[curve_px];
} CurveSet;

/* IEC 61966-2-1 */
static double srgb(double linear)
{
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * pow(linear, 1 / 2.4) - 0.055;
}

static void run_curve(void *user)
{
    CurveSet *c = user;
    if (c->intervals == 0) {
        DetectorConfig config = detector_default_config();
        config.bits = 16, config.display_gamma = true;
        detector_display(c->out, c->in, curve_px, &config, (DetectorLevel){0, 1});
    }
    for (int i = 0; c->intervals != 0 && i < curve_px; i++) {
        double x = clamp((double)c->in[i], 0, 1);
        if (c->intervals > 0) {
            const int k = x * c->intervals < c->intervals - 1 ? (int)(x * c->intervals) : c->intervals - 1;
            x = c->table[k] + (x * c->intervals - k) * (double)(c->table[k + 1] - c->table[k]);
        } else {
            x = srgb(x);
        }
        c->out[i] = (uint16_t)(x * 65535 + 0.5);
    }
    bench_keep(c->out);
}

static void tunable_curve(Bench *bench)
{
    enum { settings = 4 };
    static const char *const name[settings] = {"256 intervals", "1024 intervals", "4096 intervals", "the formula"};
    static const int         intervals[settings] = {256, 1024, 0, -1};
    static CurveSet          set[settings];
    static float             in[curve_px];
    BenchWork                work[settings];
    BenchSetting             point[settings] = {0};
    for (int i = 0; i < curve_px; i++) in[i] = (float)pow(random_uniform(5, 0, 0, (uint64_t)i), 2);
    for (int k = 0; k < settings; k++) {
        double worst = 0;
        set[k] = (CurveSet){.intervals = intervals[k], .in = in};
        for (int i = 0; i <= intervals[k]; i++) set[k].table[i] = (float)srgb((double)i / intervals[k]);
        run_curve(&set[k]);
        for (int i = 0; i < curve_px; i++)
            bench_worst(&worst, 255 * fabs(set[k].out[i] / 65535.0 - srgb((double)in[i])));
        work[k] = (BenchWork){run_curve, &set[k], curve_px};
        point[k] = (BenchSetting){.setting = name[k],
                                  .error = worst,
                                  .is_default = k == 2,
                                  .bytes = k == 2             ? 4098 * 4
                                           : intervals[k] > 0 ? intervals[k] * 4.0
                                                              : 0};
    }
    bench_tunable(bench,
                  &(BenchTunable){"display's curve", "sensor/detector/display_values.c", "a pixel", "8-bit steps",
                                  "largest, IEC 61966-2-1", 0.03},
                  work, point, settings);
}

/* ---- the display's colours ---------------------------------------------------------------------- */

typedef struct ColourSet {
    int kind; /* 0: white balance alone; 1: the best matrix that etc/colour/make/correction.py finds; 2: the display's
                 own */
    DisplayColour colour;
    const float  *in[3];
    float        *out[3];
    size_t        count;
} ColourSet;

static void run_colours(void *user)
{
    static const double matrix[3][3] = {
        {0.8967, 0.2737, -0.1704}, {-0.0968, 1.1286, -0.0318}, {-0.0018, -0.1399, 1.1417}};
    const ColourSet *s = user;
    if (s->kind == 2) display_colour_apply(s->out, s->in, s->count, &s->colour);
    for (size_t i = 0; s->kind < 2 && i < s->count; i++) {
        double v[3];
        for (int c = 0; c < 3; c++) v[c] = (double)s->in[c][i] * s->colour.gain[c];
        for (int c = 0; c < 3; c++)
            s->out[c][i] =
                (float)(s->kind == 0 ? v[c] : fmax(0, matrix[c][0] * v[0] + matrix[c][1] * v[1] + matrix[c][2] * v[2]));
    }
    bench_keep(s->out[0]);
}

/* Mean CIEDE2000 of the ColorChecker's patches as shown, to those an eye sees. */
static double colours_apart(ColourSet set)
{
    static float r[patch_count], g[patch_count], b[patch_count];
    double       mean = 0;
    set.in[0] = set.out[0] = r, set.in[1] = set.out[1] = g, set.in[2] = set.out[2] = b;
    set.count = patch_count;
    for (int i = 0; i < patch_count; i++) {
        double w[3];
        bands_see(w, patch[i].reflectance);
        r[i] = (float)w[0], g[i] = (float)w[1], b[i] = (float)w[2];
    }
    run_colours(&set);
    for (int i = 0; i < patch_count; i++) {
        double seen[3], want[3], got[3];
        eye_sees(seen, patch[i].reflectance);
        lab_of(want, seen);
        lab_of_rgb(got, (const double[3]){r[i] / set.colour.white, g[i] / set.colour.white, b[i] / set.colour.white});
        mean += ciede2000(want, got) / patch_count;
    }
    return mean;
}

static void tunable_colours(Bench *bench)
{
    enum { settings = 3 };
    static const char *const name[settings] = {"white balance alone", "and a matrix", "and a root polynomial"};
    static ColourSet         set[settings];
    static float             in[3][curve_px], out[3][curve_px];
    BenchWork                work[settings];
    BenchSetting             point[settings] = {0};
    double                   white[3];
    for (int c = 0; c < 3; c++) {
        white[c] = sum_of(daylight_spectrum, NULL, NULL, 20 - 10 * c, 11, true);
        for (int i = 0; i < curve_px; i++)
            in[c][i] = (float)(white[c] * random_uniform(5, 1, (uint32_t)c, (uint64_t)i));
    }
    for (int k = 0; k < settings; k++) {
        set[k] =
            (ColourSet){.kind = k, .in = {in[0], in[1], in[2]}, .out = {out[0], out[1], out[2]}, .count = curve_px};
        display_colour(&set[k].colour, white, 0, INFINITY);
        work[k] = (BenchWork){run_colours, &set[k], curve_px};
        point[k] =
            (BenchSetting){.setting = name[k], .error = colours_apart(set[k]), .is_default = k == 2, .bytes = 144};
    }
    bench_tunable(bench,
                  &(BenchTunable){"display's colours", "sensor/detector/display_values.c", "a pixel", "CIEDE2000",
                                  "mean of the ColorChecker, CIE 1931 under D65", 2.5},
                  work, point, settings);
}

Status precision_detectors(Bench *bench)
{
    Status status = tunable_blur(bench);
    if (status == STATUS_OK) status = precision_small_target(bench);
    if (status == STATUS_OK) status = tunable_photons(bench);
    if (status != STATUS_OK) return status;
    tunable_counts(bench, true);
    tunable_counts(bench, false);
    tunable_curve(bench);
    tunable_colours(bench);
    return STATUS_OK;
}
