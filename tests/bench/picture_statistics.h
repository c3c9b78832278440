/* tests/bench/picture_statistics.h: how two ways of making a picture differ: products of differences, correlation
 * lengths, a contrast detector, a classifier; each figure with its standard error.
 *
 * Planes are row by row, `width` pixels a row. Figures are functions of sums over groups of pixels (tiles, frames,
 * targets), so that the delete-one jackknife gives a standard error that knows how pixels of one group go together. */
#ifndef TESTS_BENCH_PICTURE_STATISTICS_H
#define TESTS_BENCH_PICTURE_STATISTICS_H

#include "pitviper.h"

/* ---- figures with their standard error ----------------------------------------------------------- */

typedef struct Estimate {
    double value, se; /* se: NaN with fewer than two groups */
} Estimate;

/* A figure of what is in all groups but one; without = -1: of all. */
typedef double GroupFigure(const void *user, int without);
/* Delete-one jackknife: se^2 = (g - 1) / g sum (f_k - mean f)^2, f_k without group k of g. For a mean it is the usual
 * standard error. Source: Efron, "The Jackknife, the Bootstrap and Other Resampling Plans", SIAM 1982, section 3. */
Estimate group_estimate(GroupFigure *figure, const void *user, int groups);

/* sums[k] over all groups of each of `count` columns but one group's; of: [groups][count]. */
void group_sums(double *sums, const double *of, int groups, int count, int without);

/* Root that keeps the sign: of a mean square from which noise was taken and that may have fallen below 0. */
static inline double signed_root(double square) { return copysign(sqrt(fabs(square)), square); }

/* ---- a tile of a plane ---------------------------------------------------------------------------- */

typedef struct PlaneTile {
    int width; /* of the plane */
    int x0, y0, side;
} PlaneTile;

/* `groups` (at most) whole tiles of a picture, in rows from its corner. Returns their number. */
int plane_tiles(PlaneTile *tile, int most, int width, int height, int side);

double tile_mean(const PlaneTile *tile, const float *a);

/* Mean over the tile's blocks of block x block pixels of (a - b)(c - d), of block means; block divides the side.
 *
 * With c = a and d = b it is the mean squared difference. With independent noise in the two differences (a and b by
 * some rays, c and d by others) it is without bias the squared difference of what a and b are without noise. */
double tile_product(const PlaneTile *tile, int block, const float *a, const float *b, const float *c, const float *d);

enum { most_lags = 24 };
/* lag[k], k = 0 .. lags - 1: mean of a(p) b(p + k) over pairs of pixels of the tile k apart in a row and those k apart
 * in a column, each plane less its mean over the tile. lag[0] of a with itself is its variance. */
void tile_lags(double *lag, int lags, const PlaneTile *tile, const float *a, const float *b);
/* The distance at which it has fallen to 1/e of lag[0], by linear interpolation; NaN: not within the lags. */
double correlation_length(const double *lag, int lags);

/* ---- a double-window contrast detector ------------------------------------------------------------ */

typedef struct DoubleWindow {
    int inner, guard, outer; /* sides of squares about one centre, odd, px */
    int step;                /* between centres */
} DoubleWindow;

/* The contrast of each place: |mean of the inner square - mean of the ring| over the standard deviation of the ring,
 * which is the outer square without the guard; 0 where both are 0, INFINITY where only the latter is. Places are those
 * whose outer square lies within the plane, row by row; NaN: mask is not 0 somewhere in it. mask: may be NULL.
 * contrast: room for all places, or NULL. Returns their number. */
int double_window(float *contrast, const DoubleWindow *window, const float *plane, const uint8_t *mask, int width,
                  int height);
/* Where each place is: the number of its centre's pixel. */
size_t double_window_centre(const DoubleWindow *window, int width, int place);

/* ---- a linear classifier -------------------------------------------------------------------------- */

enum { most_features = 12 };

/* Logistic regression on standardized features, by Newton's method with a ridge of 1 on all weights but the constant.
 */
typedef struct Logistic {
    int    features;
    double mean[most_features], per_spread[most_features], weight[most_features + 1]; /* the last: constant */
} Logistic;

typedef struct LabelledSamples {
    int            count, features;
    const double  *feature; /* [count][features] */
    const uint8_t *label;   /* [count] 0 or 1 */
    const uint8_t *fold;    /* [count] */
} LabelledSamples;

/* By the samples that are not of this fold; fold -1: by all. */
void   logistic_fit(Logistic *out, const LabelledSamples *samples, int without_fold);
double logistic_score(const Logistic *fit, const double *feature); /* log odds */
/* Scores of each sample by a fit that has not seen its fold (0 or 1). */
void logistic_cross(double *score, const LabelledSamples *samples);

/* Area under the receiver operating characteristic: the share of pairs of a 1 and a 0 in which the 1 scores higher,
 * equal ones counted as half. Samples of group `without` are left out; group NULL: none. NaN: a label is missing. */
double auc_of(const double *score, const uint8_t *label, const int *group, int count, int without);

#endif
