/* sensor/score/bins.c: the bins that rates are stated in. */
#include "sensor/score/judge.h"

const char *const score_against_name[AGAINST_COUNT] = {"range_m",          "pixels", "aspect_deg", "visible_fraction",
                                                       "foliage_fraction", "snr",    "hour"};

/* First values of the bins of each quantity; the last one is open, or ends as below. */
static const struct Edges {
    int    count;
    double from[score_bins_max], end;
} edges[AGAINST_COUNT] = {
    [AGAINST_RANGE] = {8, {0, 250, 500, 1000, 2000, 4000, 8000, 16000}, NAN},
    [AGAINST_PIXELS] = {9, {0, 3, 10, 30, 100, 300, 1000, 3000, 10000}, NAN},
    [AGAINST_ASPECT] = {8, {-22.5, 22.5, 67.5, 112.5, 157.5, 202.5, 247.5, 292.5}, 337.5},
    [AGAINST_VISIBLE] = {6, {0, 0.1, 0.25, 0.5, 0.75, 0.9}, 1},
    [AGAINST_FOLIAGE] = {6, {0, 0.05, 0.1, 0.25, 0.5, 0.75}, 1},
    [AGAINST_SNR] = {9, {0, 0.5, 1, 2, 3, 5, 10, 20, 50}, NAN},
    [AGAINST_HOUR] = {8, {0, 3, 6, 9, 12, 15, 18, 21}, 24},
};

int judge_bin(ScoreAgainst which, double value)
{
    const struct Edges *e = &edges[which];
    if (isnan(value)) return -1;
    if (which == AGAINST_ASPECT && value >= e->end) value -= 360;
    int bin = 0;
    while (bin + 1 < e->count && value >= e->from[bin + 1]) bin++;
    return bin;
}

void judge_bin_ends(double *from, double *to, ScoreAgainst which, int bin)
{
    const struct Edges *e = &edges[which];
    *from = e->from[bin];
    *to = bin + 1 < e->count ? e->from[bin + 1] : e->end;
}
