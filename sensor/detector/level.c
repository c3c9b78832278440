/* sensor/detector/level.c: gain and level of display images, and grey levels by plateau equalisation. */
#include "sensor/detector/level.h"

/* ---- configuration ------------------------------------------------------------------------ */

DetectorConfig detector_default_config(void)
{
    return (DetectorConfig){.gain = 1,
                            .bits = 8,
                            .auto_level = true,
                            .percentile_low = 0.01,
                            .percentile_high = 0.99,
                            .margin = 0.05,
                            .fire_from = INFINITY,
                            .level_low = 0,
                            .level_high = 1};
}

static bool in_range(const char *field, double value, double low, double high)
{
    if (value >= low && value <= high) return true;
    log_error("detector: bad value: %s=%g (%g .. %g)", field, value, low, high);
    return false;
}

Status detector_check_config(const DetectorConfig *c)
{
    static const double most = 1e30;
    bool                ok = in_range("gain", c->gain, 1e-6, 1e6) & in_range("offset", c->offset, -10, 10) &
              in_range("noise_sigma", c->noise_sigma, 0, most) & in_range("percentile_low", c->percentile_low, 0, 1) &
              in_range("percentile_high", c->percentile_high, c->percentile_low, 1) &
              in_range("margin", c->margin, 0, 10) & in_range("min_span", c->min_span, 0, most) &
              in_range("plateau", c->plateau, 0, 1) & in_range("level_low", c->level_low, -most, most);
    if (c->bits != 8 && c->bits != 16) {
        log_error("detector: bad value: bits=%d (8 or 16)", c->bits);
        ok = false;
    }
    if (!c->auto_level && !(c->level_high > c->level_low && c->level_high <= most)) {
        log_error("detector: bad value: level_high=%g (above level_low=%g, to %g)", c->level_high, c->level_low, most);
        ok = false;
    }
    return ok ? STATUS_OK : STATUS_BAD_VALUE;
}

/* ---- gain and level ----------------------------------------------------------------------- */

static uint32_t float_bits(float x)
{
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

/* Unsigned numbers in the order of the floats they come from: the usual trick of flipping the sign bit, or
 * every bit of a negative. Without a branch, so that loops over pixels use vectors. */
static inline uint32_t ordered(uint32_t bits) { return bits ^ ((uint32_t)((int32_t)bits >> 31) | 0x80000000u); }

static float from_ordered(uint32_t key)
{
    const uint32_t bits = key & 0x80000000u ? key & 0x7fffffffu : ~key;
    float          x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* All values of some planes, sought for order statistics. */
typedef struct Values {
    const float *const *plane;
    int                 planes;
    size_t              count; /* of each plane */
} Values;

/* The finite values below a limit, as keys in the order of ordered(): least, most and number. */
typedef struct Extent {
    uint32_t least, most;
    uint64_t count;
} Extent;

static inline uint32_t key_of(const float *plane, size_t i) { return ordered(float_bits(plane[i])); }

static Extent extent_below(const Values *v, double limit)
{
    const uint32_t above = ordered(float_bits(-INFINITY));
    const uint32_t below = ordered(float_bits(limit < INFINITY ? (float)limit : INFINITY));
    Extent         e = {UINT32_MAX, 0, 0};
    for (int p = 0; p < v->planes; p++) {
        uint32_t least = UINT32_MAX, most = 0, here = 0;
        for (size_t i = 0; i < v->count; i++) {
            const uint32_t key = key_of(v->plane[p], i), in = key > above && key < below ? UINT32_MAX : 0;
            const uint32_t low = key | ~in, high = key & in; /* NaN is beyond both ends */
            least = low < least ? low : least;
            most = high > most ? high : most;
            here -= in;
        }
        e.least = least < e.least ? least : e.least;
        e.most = most > e.most ? most : e.most;
        e.count += here;
    }
    return e;
}

enum { digit_bits = 12, digits = 1 << digit_bits, sought_most = 4 };

/* One value that is sought: it is among the 1 << bits keys from `from` on, at this rank among those that occur. */
typedef struct Sought {
    uint32_t from;
    uint64_t rank;
} Sought;

/* Takes the histogram of the next digit, of keys from sought->from in steps of 1 << shift. */
static void take_digit(Sought *s, const uint32_t histogram[digits], int shift)
{
    uint32_t digit = 0;
    while (s->rank >= histogram[digit]) s->rank -= histogram[digit++];
    s->from += digit << shift;
}

/* The first digit of all values of an extent. Neighbours are often alike, so they are counted apart. */
static void count_first_digits(uint32_t histogram[digits], const Values *v, const Extent *of, int shift)
{
    uint32_t       apart[4][digits] = {{0}};
    const uint32_t span = of->most - of->least;
    for (int p = 0; p < v->planes; p++)
        for (size_t i = 0; i < v->count; i++) {
            const uint32_t at = key_of(v->plane[p], i) - of->least;
            if (at <= span) apart[i % 4][at >> shift]++;
        }
    for (int d = 0; d < digits; d++) histogram[d] = apart[0][d] + apart[1][d] + apart[2][d] + apart[3][d];
}

/* A further digit, among the keys that begin as each of those sought does. Few pixels of a picture do, so eight are
 * looked at together. */
static void count_digits(uint32_t histogram[sought_most][digits], const Values *v, const Sought *sought, int count,
                         int bits, int shift)
{
    enum { together = 8 };
    const uint32_t span = (uint32_t)(((uint64_t)1 << bits) - 1);
    memset(histogram, 0, sizeof(uint32_t[digits]) * (size_t)count);
    for (int p = 0; p < v->planes; p++)
        for (size_t first = 0; first < v->count; first += together) {
            const size_t here = v->count - first < together ? v->count - first : together;
            uint32_t     key[together] = {0}, any = 0;
            for (size_t i = 0; i < here; i++) key[i] = key_of(v->plane[p], first + i);
            for (int k = 0; k < count; k++)
                for (int i = 0; i < together; i++) any |= key[i] - sought[k].from <= span;
            for (size_t i = 0; any && i < here; i++)
                for (int k = 0; k < count; k++) {
                    const uint32_t at = key[i] - sought[k].from;
                    if (at <= span) histogram[k][at >> shift]++;
                }
        }
}

/* Finds the values at some shares of those of an extent in order (share 0: the least), digit by digit from the top of
 * what tells them apart: 12 bits at a time. This is exact, takes one to three passes and no copy of the plane, and NaN
 * cannot upset it as it would a sort. */
static void order_statistics(double out[], const Values *v, const Extent *of, const double share[], int count)
{
    static const int bits_all = 32;
    uint32_t         histogram[sought_most][digits];
    Sought           sought[sought_most];
    const uint32_t   span = of->most - of->least;
    int bits = span ? bits_all - __builtin_clz(span) : 0, shift = bits > digit_bits ? bits - digit_bits : 0;
    count_first_digits(histogram[0], v, of, shift);
    for (int k = 0; k < count; k++) {
        sought[k] = (Sought){of->least, (uint64_t)(share[k] * (double)(of->count - 1) + 0.5)};
        take_digit(&sought[k], histogram[0], shift);
    }
    while (shift > 0) {
        bits = shift;
        shift = bits > digit_bits ? bits - digit_bits : 0;
        count_digits(histogram, v, sought, count, bits, shift);
        for (int k = 0; k < count; k++) take_digit(&sought[k], histogram[k], shift);
    }
    for (int k = 0; k < count; k++) out[k] = from_ordered(sought[k].from);
}

/* White where fires and plumes take no grey levels from the rest. all: finite values; body: those at body_share of
 * them. */
static const double body_share[2] = {0.1, 0.9};

static double highlight_white(const DetectorConfig *c, const Values *v, const Extent *all, const double body_of_all[2])
{
    double       body[2] = {body_of_all[0], body_of_all[1]};
    const Extent cool = c->fire_from < INFINITY ? extent_below(v, c->fire_from) : *all;
    if (cool.count < all->count && cool.count >= all->count / 2 + 1) order_statistics(body, v, &cool, body_share, 2);
    return body[1] + c->highlight * (body[1] - body[0]);
}

DetectorLevel detector_level(const DetectorConfig *config, const float *const *plane, int plane_count, size_t count)
{
    /* A span below this part of the level is rounding of a constant, not an image: 80 steps of a float. */
    static const double relative_floor = 1e-5, absolute_floor = 1e-30;

    DetectorLevel level = {config->level_low, config->level_high};
    if (config->auto_level) {
        const double share[4] = {config->percentile_low, config->percentile_high, body_share[0], body_share[1]};
        const Values values = {plane, plane_count, count};
        const Extent all = extent_below(&values, INFINITY);
        double       value[4];
        if (all.count == 0) return (DetectorLevel){0, 1};
        order_statistics(value, &values, &all, share, config->highlight > 0 ? 4 : 2);
        level = (DetectorLevel){value[0], value[1]};
        if (config->highlight > 0 && level.high > level.low)
            level.high = fmax(level.low, fmin(level.high, highlight_white(config, &values, &all, value + 2)));

        const double middle = 0.5 * (level.low + level.high);
        double       span = (level.high - level.low) * (1 + 2 * config->margin);
        span = fmax(fmax(span, config->min_span), fmax(relative_floor * fabs(middle), absolute_floor));
        level.low = middle - 0.5 * span;
        level.high = middle + 0.5 * span;
        if (span == config->min_span && level.low < 0 && middle >= 0)
            level = (DetectorLevel){0, span}; /* a dark image is displayed dark */
    }
    return level;
}

/* Share of the difference to `now` that remains after step_s. left: the difference, in spans. */
static double follow_keep(bool *quick, double left, double step_s, double time_s)
{
    /* spans; of time_s. 1.8 spans are what comes when sky leaves a picture (tests/system/test_level.sh): averaged */
    static const double lost = 2, near = 0.03, faster = 0.1;
    double              keep = 1;
    if (!(time_s > 0) || !isfinite(left)) {
        *quick = false;
        return 0;
    }
    step_s = fmax(0, step_s);
    *quick = left > near && (*quick || left > lost);
    if (left > lost && step_s > 0) {
        keep = lost / left;
        left = lost;
    }
    if (*quick) { /* as long as it takes, or the whole step */
        const double quick_s = fmin(step_s, faster * time_s * log(left / near));
        keep *= exp(-quick_s / (faster * time_s));
        step_s -= quick_s;
    }
    return keep * exp(-step_s / time_s);
}

void detector_level_follow(DetectorLevel *state, bool *quick, DetectorLevel now, double step_s, double time_s)
{
    const double span = now.high - now.low;
    const double left = fmax(fabs(state->low - now.low), fabs(state->high - now.high)) / span;
    const double keep = follow_keep(quick, left, step_s, time_s);
    if (keep == 0) *state = now; /* also where it is not finite */
    state->low = now.low + keep * (state->low - now.low);
    state->high = now.high + keep * (state->high - now.high);
}

/* ---- plateau equalisation: a summed histogram whose bins count for at most a plateau ------------ */

/* 1/64 of the 2 K that are least shown: 0.03 K, the noise of a good detector */
enum { plateau_bins = 16384, bins_a_span = 64 };

static bool extremes(double out[2], const float *plane, size_t count)
{
    float low = INFINITY, high = -INFINITY;
    for (size_t i = 0; i < count; i++) {
        if (!isfinite(plane[i])) continue;
        low = plane[i] < low ? plane[i] : low;
        high = plane[i] > high ? plane[i] : high;
    }
    out[0] = low;
    out[1] = high;
    return low <= high;
}

void detector_plateau(DetectorCurve *out, const DetectorConfig *config, const float *plane, size_t count)
{
    uint32_t   histogram[plateau_bins] = {0};
    double     range[2] = {0, 1};
    uint64_t   all = 0;
    const bool any = extremes(range, plane, count);
    /* a span of rounding alone is no image: detector_level */
    const double least = fmax(fmax(config->min_span, 1e-5 * fmax(fabs(range[0]), fabs(range[1]))), 1e-30);
    const double width = fmax(least / bins_a_span, config->step);
    if (!any) {
        for (int k = 0; k <= curve_steps; k++) out->value[k] = (double)k / curve_steps;
        return;
    }
    const double low = range[0] - 0.5 * width;
    for (size_t i = 0; i < count; i++) {
        if (!isfinite(plane[i])) continue;
        const double bin = (plane[i] - low) / width;
        histogram[bin < plateau_bins ? (int)bin : plateau_bins - 1]++;
        all++;
    }

    /* grey level gained over each bin; the slope is bounded */
    const double plateau = fmax(1, config->plateau * (double)all), steepest = width / least;
    double       sum = 0, used = 0;
    for (int b = 0; b < plateau_bins; b++) sum += fmin(histogram[b], plateau);
    for (int b = 0; b < plateau_bins; b++) used += fmin(fmin(histogram[b], plateau) / sum, steepest);

    double level = 0.5 * (1 - used), from = low; /* grey level at `from` */
    int    k = 0;
    for (; k <= curve_steps && (double)k / curve_steps <= level; k++)
        out->value[k] = low - (level - (double)k / curve_steps) * least;
    for (int b = 0; b < plateau_bins; b++, from = low + b * width) {
        const double gained = fmin(fmin(histogram[b], plateau) / sum, steepest);
        for (; k <= curve_steps && (double)k / curve_steps <= level + gained; k++)
            out->value[k] = from + width * (((double)k / curve_steps - level) / gained);
        level += gained;
        if (gained > 0) range[1] = from + width;
    }
    for (; k <= curve_steps; k++) out->value[k] = range[1] + ((double)k / curve_steps - level) * least;
}

void detector_plateau_follow(DetectorCurve *state, bool *quick, const DetectorCurve *now, double step_s, double time_s)
{
    const int    first = curve_steps / 10, last = curve_steps - curve_steps / 10;
    const double span = (now->value[last] - now->value[first]) * curve_steps / (last - first);
    double       off = 0;
    for (int k = first; k <= last; k++) off = fmax(off, fabs(state->value[k] - now->value[k]));
    const double keep = follow_keep(quick, off / span, step_s, time_s);
    for (int k = 0; k <= curve_steps; k++)
        state->value[k] = keep == 0 ? now->value[k] : now->value[k] + keep * (state->value[k] - now->value[k]);
}

/* Pixels that are sought together: each step of one search waits for the step before. */
enum { together = 8 };

/* Grey levels 0 .. 1; NaN: 0. */
static void curve_levels(double level[together], const DetectorCurve *c, const float x[together])
{
    double at[together];
    int    k[together] = {0};
    for (int i = 0; i < together; i++) {
        at[i] = x[i] > c->value[0] ? (double)x[i] : c->value[0]; /* NaN: the first */
        at[i] = at[i] < c->value[curve_steps] ? at[i] : c->value[curve_steps];
    }
    for (int step = curve_steps / 2; step; step /= 2)
        for (int i = 0; i < together; i++) k[i] += step * (c->value[k[i] + step] <= at[i]); /* without a branch */
    for (int i = 0; i < together; i++)
        level[i] = (k[i] + (at[i] - c->value[k[i]]) / (c->value[k[i] + 1] - c->value[k[i]])) / curve_steps;
}

void detector_display_curve(void *out, const float *in, size_t count, const DetectorConfig *config,
                            const DetectorCurve *curve)
{
    const double full = config->bits == 16 ? 65535 : 255;
    for (size_t first = 0; first < count; first += together) {
        const size_t n = count - first < together ? count - first : together;
        float        x[together] = {0};
        double       level[together];
        memcpy(x, in + first, n * sizeof *x);
        curve_levels(level, curve, x);
        for (size_t i = 0; i < n; i++) {
            const double shown = isnan(x[i]) ? 0 : clamp(0.5 + (level[i] - 0.5) * config->gain + config->offset, 0, 1);
            if (config->bits == 16) ((uint16_t *)out)[first + i] = (uint16_t)(full * shown + 0.5);
            else ((uint8_t *)out)[first + i] = (uint8_t)(full * shown + 0.5);
        }
    }
}
