/* sensor/detector/plateau.c: grey levels by a summed histogram whose bins count for at most a plateau. */
#include "sensor/detector/plateau.h"

/* 1/64 of the 2 K that are least shown: 0.03 K, the noise of a good detector */
enum { plateau_bins = 16384, bins_a_span = 64 };

static bool extremes(double out[2], const float *plane, size_t count)
{
    float low = INFINITY, high = -INFINITY;
    for (size_t i = 0; i < count; i++) {
        if (!isfinite(plane[i])) continue;
        low  = plane[i] < low ? plane[i] : low;
        high = plane[i] > high ? plane[i] : high;
    }
    out[0] = low;
    out[1] = high;
    return low <= high;
}

void detector_plateau(DetectorCurve *out, const DetectorConfig *config, const float *plane, size_t count)
{
    uint32_t histogram[plateau_bins] = {0};
    double   range[2] = {0, 1};
    uint64_t all = 0;
    const bool   any   = extremes(range, plane, count);
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
    int    k     = 0;
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
    const double span  = (now->value[last] - now->value[first]) * curve_steps / (last - first);
    double       off   = 0;
    for (int k = first; k <= last; k++) off = fmax(off, fabs(state->value[k] - now->value[k]));
    const double keep = detector_follow_keep(quick, off / span, step_s, time_s);
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
            if (config->bits == 16)
                ((uint16_t *)out)[first + i] = (uint16_t)(full * shown + 0.5);
            else
                ((uint8_t *)out)[first + i] = (uint8_t)(full * shown + 0.5);
        }
    }
}
