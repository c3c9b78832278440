/* Minimum resolvable temperature difference: the prediction against four-bar targets that go through the whole
 * detector, noise and converter on, and are looked at in raw counts by the observer that the formula assumes.
 *
 * A picture of 300 K holds as many targets as fit, each at a place of its own within a pixel; every pixel has its exact
 * share of bar. Frames are added up as counts, each bar's mean is taken over its own rectangle with the shares of the
 * pixels it lies over, less that of the gap beside it. Signal: the mean of these differences, less that of the same
 * frames without targets. Noise: their deviation over pictures without, of many detectors of a kind, over the root of
 * two: that of one bar's mean. The temperature difference at which the one is 2.5 times the other is looked for,
 * starting from half the prediction. labels: physics slow */
#include "tests/check.h"

#include "render/materials/planck.h"
#include "sensor/detector/chain.h"
#include "sensor/detector/mrtd.h"

enum { side = 256, pixels = side * side, added = 2, most_targets = 64, lots = 16, signal_lots = 2 };
static const double background_k = 300, threshold = 2.5;

static float plane[pixels], sum[pixels];

typedef struct Bars {
    double width_px;
    bool   lying; /* horizontal bars */
    int    count;
    double at_px[most_targets][2];
} Bars;

static double overlap(double low, double high, int pixel)
{
    const double length = fmin(high, pixel + 1) - fmax(low, pixel);
    return length > 0 ? length : 0;
}

/* visit each pixel that bar or gap k (0 .. 6, bars even) of a target lies over. */
typedef void Visit(double *value, int pixel, double share);

static double over_bar(const Bars *b, int target, int k, Visit *visit)
{
    const double w = b->width_px, *at = b->at_px[target];
    const double x0 = at[0] + (b->lying ? 0 : k * w), x1 = x0 + (b->lying ? 7 * w : w);
    const double y0 = at[1] + (b->lying ? k * w : 0), y1 = y0 + (b->lying ? w : 7 * w);
    double       value = 0;
    for (int y = (int)floor(y0); y < y1; y++)
        for (int x = (int)floor(x0); x < x1; x++) visit(&value, y * side + x, overlap(x0, x1, x) * overlap(y0, y1, y));
    return value / (7 * w * w);
}

static double rise;
static void   paint(double *value, int pixel, double share)
{
    (void)value;
    plane[pixel] = (float)(plane[pixel] + rise * share);
}
static void look(double *value, int pixel, double share) { *value += share * sum[pixel]; }

static void place(Bars *b, double width_px, bool lying, int lot)
{
    const double pitch = ceil(11 * width_px) + 1, room = 7 * width_px;
    *b = (Bars){.width_px = width_px, .lying = lying};
    for (double y = 6; y + pitch < side - 4; y += pitch)
        for (double x = 6; x + pitch < side - 4 && b->count < most_targets; x += pitch, b->count++)
            for (int c = 0; c < 2; c++)
                b->at_px[b->count][c] = (c ? y : x) + (pitch - room) * 0.5 +
                                        random_uniform(77, (uint32_t)lot, (uint32_t)b->count, (uint64_t)c) - 0.5;
}

static void expose(double dt_k, const Bars *b, Band band)
{
    double low_m, high_m;
    preset_band(&low_m, &high_m, band, OPTICAL_PAN, -1);
    const double ground = planck_band(low_m, high_m, background_k, NULL);
    rise = planck_band(low_m, high_m, background_k + dt_k, NULL) - ground;
    for (int i = 0; i < pixels; i++) plane[i] = (float)ground;
    for (int t = 0; t < b->count; t++)
        for (int k = 0; k < 7; k += 2) over_bar(b, t, k, paint);
}

static void run_chain(Chain *chain, int frame)
{
    static const double still[2] = {0, 0};
    const float        *in[1] = {plane};
    chain_expose(chain, in);
    chain_run(chain, in, NULL, frame, still);
}

static float flat[lots][pixels]; /* added frames without targets, of each detector */

/* Adds up the frames of a detector for what `plane` holds, into sum. */
static void add_frames(Chain *chain)
{
    memset(sum, 0, sizeof sum);
    for (int frame = 0; frame < added; frame++) {
        run_chain(chain, frame);
        const float *value = chain_values(chain, 0);
        for (int i = 0; i < pixels; i++) sum[i] += value[i] / added;
    }
}

/* Deviation of one bar's mean: bars and gaps side by side over all of every picture. */
static double noise_counts(double width_px, bool lying)
{
    Bars   b = {.width_px = width_px, .lying = lying, .count = 1};
    double n = 0, square = 0;
    for (int lot = 0; lot < lots; lot++) {
        memcpy(sum, flat[lot], sizeof sum);
        for (double y = 0.3; y + (lying ? 2 : 7) * width_px < side; y += (lying ? 2 : 7) * width_px)
            for (double x = 0.6; x + (lying ? 7 : 2) * width_px < side; x += (lying ? 7 : 2) * width_px, n++) {
                b.at_px[0][0] = x, b.at_px[0][1] = y;
                const double apart = over_bar(&b, 0, 0, look) - over_bar(&b, 0, 1, look);
                square += apart * apart;
            }
    }
    return sqrt(square / n / 2);
}

static double signal_counts(Chain *const chain[], const SensorPreset *p, double width_px, bool lying, double dt_k)
{
    double n = 0, mean = 0;
    for (int lot = 0; lot < signal_lots; lot++) {
        Bars bars;
        place(&bars, width_px, lying, lot);
        expose(dt_k, &bars, p->band);
        add_frames(chain[lot]);
        for (int i = 0; i < pixels; i++) sum[i] -= flat[lot][i];
        for (int t = 0; t < bars.count; t++)
            for (int k = 0; k < 6; k += 2, n++) mean += over_bar(&bars, t, k, look) - over_bar(&bars, t, k + 1, look);
    }
    return mean / n;
}

static void bars_are_resolved_where_the_formula_says(void **state)
{
    (void)state;
    static const char *const name[3] = {"staring_lwir", "scanning_flir", "scanning_flir2"};
    static const double      width_px[4] = {7.6, 4.4, 2.7, 1.6};
    for (int s = 0; s < 3; s++) {
        char         path[512];
        SensorPreset p;
        Chain       *chain[signal_lots];
        CHECK(etc_path(path, sizeof path, "sensors.csv"));
        assert_int_equal(preset_read(&p, path, name[s]), STATUS_OK);
        p.bad_share = 0;
        p.ac_per_line = 0;
        for (int lot = lots - 1; lot >= 0; lot--) {
            const Bars none = {.count = 0};
            Chain     *one;
            assert_int_equal(chain_create(&one, &p, side, side, 64, (uint64_t)(100 + lot)), STATUS_OK);
            expose(0, &none, p.band);
            add_frames(one);
            memcpy(flat[lot], sum, sizeof sum);
            if (lot < signal_lots) chain[lot] = one;
            else chain_destroy(one);
        }
        for (int i = 0; i < 4; i++)
            for (int lying = 0; lying < 2; lying++) {
                const MrtdObserver observer = {.snr = threshold, .frames = added, .temp_k = background_k};
                Mrtd               want;
                mrtd_predict(&want, &p, 0.5 / width_px[i], &observer);
                const double noise = noise_counts(width_px[i], lying);
                double       got_k = 0.5 * want.all_k[lying], snr = 0;
                for (int n = 0; n < 3 && !(fabs(snr / threshold - 1) < 0.01); n++) {
                    if (n > 0) got_k *= threshold / snr;
                    snr = signal_counts(chain, &p, width_px[i], lying, got_k) / noise;
                }
                CHECK_NEAR(snr / threshold, 1, 0.02);
                print_message(
                    "%-15s %.3f cycles a pixel, %s bars: %.4f K, predicted %.4f (%+.1f %%), first harmonic %.4f\n",
                    name[s], 0.5 / width_px[i], lying ? "horizontal" : "vertical", got_k, want.all_k[lying],
                    100 * (got_k / want.all_k[lying] - 1), want.first_k[lying]);
                CHECK_NEAR(got_k / want.all_k[lying], 1, 0.1);
            }
        for (int k = 0; k < signal_lots; k++) chain_destroy(chain[k]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bars_are_resolved_where_the_formula_says),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
