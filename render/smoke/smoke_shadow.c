/* render/smoke/smoke_shadow.c: the shadow of smoke and dust: what of the sun's direct light they let pass to places. */
#include "render/smoke/smoke.h"

/* A ball about the places that there are; false: there is none. */
static bool ball_about(double centre_enu[3], double *radius_m, const Hits *hits)
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (int i = 0; i < hits->count; i++)
        for (int k = 0; k < 3 && hits->range_m[i] < INFINITY; k++)
            low[k] = fmin(low[k], hits->p_enu[k][i]), high[k] = fmax(high[k], hits->p_enu[k][i]);
    if (!(low[0] <= high[0])) return false;
    for (int k = 0; k < 3; k++) centre_enu[k] = 0.5 * (low[k] + high[k]), high[k] = 0.5 * (high[k] - low[k]);
    *radius_m = v3_length(high);
    return true;
}

void smoke_shadow(float *sun, const SmokeVolume *volume, int count, const Hits *hits, const double sun_d_enu[3])
{
    enum { most = 512 };
    static const double least = 1e-6; /* some is left: nothing but solid shade is all dark */
    int                 near[most], nears = 0;
    double              centre_enu[3], radius_m;
    if (count == 0 || !(sun_d_enu[2] > 0) || !ball_about(centre_enu, &radius_m, hits)) return;
    for (int n = 0; n < count && nears < most; n++) { /* those nearest the eye come first */
        const SmokeVolume *v = &volume[n];
        const double       reach_m = fmax(v->along_m, v->across_m) + radius_m;
        double             off[3];
        if (!(v->shades_per_m > 0)) continue;
        v3_sub(off, v->p_enu, centre_enu);
        const double along_m = v3_dot(off, sun_d_enu);
        if (along_m > -reach_m && v3_dot(off, off) - along_m * along_m < reach_m * reach_m) near[nears++] = n;
    }
    for (int i = 0; i < hits->count && nears > 0; i++) {
        const double p_enu[3] = {hits->p_enu[0][i], hits->p_enu[1][i], hits->p_enu[2][i]};
        double       depth = 0;
        if (!(hits->range_m[i] < INFINITY) || !(sun[i] > 0)) continue;
        for (int n = 0; n < nears; n++)
            depth += volume[near[n]].shades_per_m * smoke_column_m(&volume[near[n]], p_enu, sun_d_enu, 0, INFINITY);
        if (depth > 0) sun[i] *= (float)fmax(exp(-depth), least);
    }
}
