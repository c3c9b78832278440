/* tests/bench/picture_statistics.c: how two ways of making a picture differ, in figures with a standard error. */
#include "tests/bench/picture_statistics.h"

/* ---- figures with their standard error ----------------------------------------------------------- */

Estimate group_estimate(GroupFigure *figure, const void *user, int groups)
{
    const Estimate all = {figure(user, -1), NAN};
    double         sum = 0, square = 0;
    if (groups < 2) return all;
    for (int k = 0; k < groups; k++) {
        const double off = figure(user, k) - all.value; /* from the whole, against cancellation */
        sum += off, square += off * off;
    }
    const double scatter = (square - sum * sum / groups) * (groups - 1) / groups;
    return (Estimate){all.value, scatter < 0 ? 0 : sqrt(scatter)}; /* rounding may take it below; NaN stays */
}

void group_sums(double *sums, const double *of, int groups, int count, int without)
{
    for (int k = 0; k < count; k++) sums[k] = 0;
    for (int g = 0; g < groups; g++)
        for (int k = 0; k < count && g != without; k++) sums[k] += of[(size_t)g * (size_t)count + (size_t)k];
}

/* ---- a tile of a plane ---------------------------------------------------------------------------- */

int plane_tiles(PlaneTile *tile, int most, int width, int height, int side)
{
    int count = 0;
    for (int y = 0; y + side <= height; y += side)
        for (int x = 0; x + side <= width && count < most; x += side) tile[count++] = (PlaneTile){width, x, y, side};
    return count;
}

static size_t pixel_of(const PlaneTile *tile, int x, int y)
{
    return (size_t)(tile->y0 + y) * (size_t)tile->width + (size_t)(tile->x0 + x);
}

double tile_mean(const PlaneTile *tile, const float *a)
{
    double sum = 0;
    for (int y = 0; y < tile->side; y++)
        for (int x = 0; x < tile->side; x++) sum += (double)a[pixel_of(tile, x, y)];
    return sum / tile->side / tile->side;
}

double tile_product(const PlaneTile *tile, int block, const float *a, const float *b, const float *c, const float *d)
{
    double    sum = 0;
    const int blocks = tile->side / block;
    for (int k = 0; k < blocks * blocks; k++) {
        double first = 0, second = 0;
        for (int i = 0; i < block * block; i++) {
            const size_t at = pixel_of(tile, k % blocks * block + i % block, k / blocks * block + i / block);
            first += (double)a[at] - (double)b[at];
            second += (double)c[at] - (double)d[at];
        }
        sum += first * second;
    }
    return sum / pow(block, 4) / (blocks * blocks);
}

void tile_lags(double *lag, int lags, const PlaneTile *tile, const float *a, const float *b)
{
    const double a_mean = tile_mean(tile, a), b_mean = tile_mean(tile, b);
    const int    side = tile->side;
    for (int k = 0; k < lags; k++) {
        double sum = 0;
        for (int i = 0; i < side; i++)
            for (int j = 0; j + k < side; j++)
                sum += ((double)a[pixel_of(tile, j, i)] - a_mean) * ((double)b[pixel_of(tile, j + k, i)] - b_mean) +
                       ((double)a[pixel_of(tile, i, j)] - a_mean) * ((double)b[pixel_of(tile, i, j + k)] - b_mean);
        lag[k] = sum / (2.0 * side * (side - k));
    }
}

double correlation_length(const double *lag, int lags)
{
    const double least = exp(-1) * lag[0];
    for (int k = 1; k < lags && lag[0] > 0; k++)
        if (lag[k] <= least) return k - 1 + (lag[k - 1] - least) / (lag[k - 1] - lag[k]);
    return NAN;
}

/* ---- a double-window contrast detector ------------------------------------------------------------ */

/* Sums of a plane over a square about a centre. */
typedef struct SquareSums {
    double count, sum, square;
} SquareSums;

static SquareSums sums_of(const float *plane, int width, size_t centre, int side)
{
    SquareSums s = {(double)side * side, 0, 0};
    for (int y = -side / 2; y <= side / 2; y++)
        for (int x = -side / 2; x <= side / 2; x++) {
            const double value = (double)plane[(ptrdiff_t)centre + (ptrdiff_t)y * width + x];
            s.sum += value, s.square += value * value;
        }
    return s;
}

static bool is_masked(const uint8_t *mask, int width, size_t centre, int side)
{
    for (int y = -side / 2; y <= side / 2; y++)
        for (int x = -side / 2; x <= side / 2; x++)
            if (mask[(ptrdiff_t)centre + (ptrdiff_t)y * width + x]) return true;
    return false;
}

static double contrast_at(const DoubleWindow *w, const float *plane, int width, size_t centre)
{
    const SquareSums inner = sums_of(plane, width, centre, w->inner), guard = sums_of(plane, width, centre, w->guard),
                     outer = sums_of(plane, width, centre, w->outer);
    const double count = outer.count - guard.count, mean = (outer.sum - guard.sum) / count;
    const double variance = fmax(0, (outer.square - guard.square) / count - mean * mean);
    const double off = fabs(inner.sum / inner.count - mean);
    return off > 0 ? off / sqrt(variance) : 0;
}

static int places_a_row(const DoubleWindow *w, int width)
{
    return width < w->outer ? 0 : (width - w->outer) / w->step + 1;
}

size_t double_window_centre(const DoubleWindow *w, int width, int place)
{
    const int columns = places_a_row(w, width), x = place % columns * w->step, y = place / columns * w->step;
    return (size_t)(y + w->outer / 2) * (size_t)width + (size_t)(x + w->outer / 2);
}

int double_window(float *contrast, const DoubleWindow *w, const float *plane, const uint8_t *mask, int width,
                  int height)
{
    const int places = places_a_row(w, width) * places_a_row(w, height);
    for (int k = 0; k < places && contrast; k++) {
        const size_t centre = double_window_centre(w, width, k);
        contrast[k] =
            mask && is_masked(mask, width, centre, w->outer) ? NAN : (float)contrast_at(w, plane, width, centre);
    }
    return places;
}

/* ---- a linear classifier -------------------------------------------------------------------------- */

enum { most_unknowns = most_features + 1 };

static bool is_used(const LabelledSamples *s, int i, int without_fold)
{
    return without_fold < 0 || s->fold[i] != without_fold;
}

static void standardize(Logistic *fit, const LabelledSamples *s, int without_fold)
{
    for (int f = 0; f < s->features; f++) {
        double n = 0, sum = 0, square = 0;
        for (int i = 0; i < s->count; i++)
            if (is_used(s, i, without_fold)) n++, sum += s->feature[(size_t)i * (size_t)s->features + (size_t)f];
        fit->mean[f] = n > 0 ? sum / n : 0;
        for (int i = 0; i < s->count; i++) {
            const double off = s->feature[(size_t)i * (size_t)s->features + (size_t)f] - fit->mean[f];
            if (is_used(s, i, without_fold)) square += off * off;
        }
        fit->per_spread[f] = square > 0 ? sqrt(n / square) : 0;
    }
}

/* Features of a sample in units of their spread, and a 1 for the constant. */
static void unknowns_of(double x[most_unknowns], const Logistic *fit, const double *feature)
{
    for (int f = 0; f < fit->features; f++) x[f] = (feature[f] - fit->mean[f]) * fit->per_spread[f];
    x[fit->features] = 1;
}

static double score_of(const Logistic *fit, const double x[most_unknowns])
{
    double score = 0;
    for (int f = 0; f <= fit->features; f++) score += fit->weight[f] * x[f];
    return score;
}

/* Solves a x = b for a symmetric positive definite a, by Cholesky's factors; x replaces b. */
static void solve(double a[most_unknowns][most_unknowns], double b[most_unknowns], int n)
{
    for (int i = 0; i < n; i++)
        for (int j = 0; j <= i; j++) {
            double sum = a[i][j];
            for (int k = 0; k < j; k++) sum -= a[i][k] * a[j][k];
            a[i][j] = i == j ? sqrt(fmax(sum, 1e-12)) : sum / a[j][j];
        }
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < i; k++) b[i] -= a[i][k] * b[k];
        b[i] /= a[i][i];
    }
    for (int i = n - 1; i >= 0; i--) {
        for (int k = i + 1; k < n; k++) b[i] -= a[k][i] * b[k];
        b[i] /= a[i][i];
    }
}

void logistic_fit(Logistic *out, const LabelledSamples *s, int without_fold)
{
    static const int    steps = 25;
    static const double ridge = 1;
    const int           n = s->features + 1;
    *out = (Logistic){.features = s->features};
    standardize(out, s, without_fold);
    for (int step = 0; step < steps; step++) {
        double curve[most_unknowns][most_unknowns] = {0}, slope[most_unknowns] = {0}, x[most_unknowns];
        for (int i = 0; i < s->count; i++) {
            if (!is_used(s, i, without_fold)) continue;
            unknowns_of(x, out, s->feature + (size_t)i * (size_t)s->features);
            const double p = 1 / (1 + exp(-score_of(out, x)));
            for (int f = 0; f < n; f++) {
                slope[f] += ((double)s->label[i] - p) * x[f];
                for (int g = 0; g <= f; g++) curve[f][g] += p * (1 - p) * x[f] * x[g];
            }
        }
        for (int f = 0; f < s->features; f++) curve[f][f] += ridge, slope[f] -= ridge * out->weight[f];
        curve[n - 1][n - 1] += 1e-9; /* where all is separated, p (1 - p) vanishes */
        solve(curve, slope, n);
        for (int f = 0; f < n; f++) out->weight[f] += fmax(-5, fmin(5, slope[f]));
    }
}

double logistic_score(const Logistic *fit, const double *feature)
{
    double x[most_unknowns];
    unknowns_of(x, fit, feature);
    return score_of(fit, x);
}

void logistic_cross(double *score, const LabelledSamples *s)
{
    for (int fold = 0; fold < 2; fold++) {
        Logistic fit;
        logistic_fit(&fit, s, fold);
        for (int i = 0; i < s->count; i++)
            if (s->fold[i] == fold) score[i] = logistic_score(&fit, s->feature + (size_t)i * (size_t)s->features);
    }
}

double auc_of(const double *score, const uint8_t *label, const int *group, int count, int without)
{
    double pairs = 0, won = 0;
    for (int i = 0; i < count; i++) {
        if (!label[i] || (group && group[i] == without)) continue;
        for (int j = 0; j < count; j++) {
            if (label[j] || (group && group[j] == without)) continue;
            pairs++, won += score[i] > score[j] ? 1 : score[i] == score[j] ? 0.5 : 0;
        }
    }
    return pairs > 0 ? won / pairs : NAN;
}
