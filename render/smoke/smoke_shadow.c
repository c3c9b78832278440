/* render/smoke/smoke_shadow.c: the shadow of smoke and dust: what of the sun's direct light they let pass to places. */
#include "render/smoke/smoke.h"

typedef struct Span {
    int first, end; /* of hits */
} Span;

/* A ball about the places that there are; false: there is none. */
static bool ball_about(double centre_enu[3], double *radius_m, const Hits *hits, Span at)
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (int i = at.first; i < at.end; i++)
        for (int k = 0; k < 3 && hits->range_m[i] < INFINITY; k++)
            low[k] = fmin(low[k], hits->p_enu[k][i]), high[k] = fmax(high[k], hits->p_enu[k][i]);
    if (!(low[0] <= high[0])) return false;
    for (int k = 0; k < 3; k++) centre_enu[k] = 0.5 * (low[k] + high[k]), high[k] = 0.5 * (high[k] - low[k]);
    *radius_m = v3_length(high);
    return true;
}

/* Volumes of a list, or with NULL of all, through whose balls the sun may come to places of a span; those nearest the
 * eye come first, at most `most`. */
static int find_near(int *near, int most, const SmokeVolume *volume, const int *list, int count, const Hits *hits,
                     Span at, const double d[3])
{
    double centre_enu[3], radius_m;
    int    nears = 0;
    if (!ball_about(centre_enu, &radius_m, hits, at)) return 0;
    for (int k = 0; k < count && nears < most; k++) {
        const int          n = list ? list[k] : k;
        const SmokeVolume *v = &volume[n];
        const double       reach_m = fmax(v->along_m, v->across_m) + radius_m;
        double             off[3];
        if (!(v->shades_per_m > 0)) continue;
        v3_sub(off, v->p_enu, centre_enu);
        const double along_m = v3_dot(off, d);
        if (along_m > -reach_m && v3_dot(off, off) - along_m * along_m < reach_m * reach_m) near[nears++] = n;
    }
    return nears;
}

void smoke_shadow(float *sun, const SmokeVolume *volume, int count, const Hits *hits, const double sun_d_enu[3])
{
    enum { most = 512, some = 24 };
    static const double least = 1e-6; /* some is left: nothing but solid shade is all dark */
    static const double enough = 14;  /* exp(-14) is less than that */
    int                 all[most], near[most];
    if (count == 0 || !(sun_d_enu[2] > 0)) return;
    const int alls = find_near(all, most, volume, NULL, count, hits, (Span){0, hits->count}, sun_d_enu);
    for (int first = 0; first < hits->count && alls > 0; first += some) { /* neighbours have few of them */
        const Span at = {first, first + some < hits->count ? first + some : hits->count};
        const int  nears = find_near(near, most, volume, all, alls, hits, at, sun_d_enu);
        for (int i = at.first; i < at.end && nears > 0; i++) {
            const double p_enu[3] = {hits->p_enu[0][i], hits->p_enu[1][i], hits->p_enu[2][i]};
            double       depth = 0;
            if (!(hits->range_m[i] < INFINITY) || !(sun[i] > 0)) continue;
            for (int n = 0; n < nears && depth < enough; n++)
                depth += volume[near[n]].shades_per_m * smoke_column_m(&volume[near[n]], p_enu, sun_d_enu, 0, INFINITY);
            if (depth > 0) sun[i] *= (float)fmax(exp(-depth), least);
        }
    }
}
