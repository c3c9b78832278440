/* render/smoke/smoke_volume.c: what the smoke along a ray takes of its light and adds to it; the volumes that rays may
 * meet. */
#include "render/smoke/smoke_private.h"

#include <stdlib.h>

/* ---- a ray -------------------------------------------------------------------------------- */

/* By insertion: volumes come in order of range, so few lie far from their place. */
static void sort_m(double *at_m, int count)
{
    for (int i = 1; i < count; i++) {
        const double here = at_m[i];
        int          to = i;
        for (; to > 0 && at_m[to - 1] > here; to--) at_m[to] = at_m[to - 1];
        at_m[to] = here;
    }
}

/* Sorted boundaries, merged to at most smoke_segments_max by dropping some of the inner ones. */
static int cuts_of(double cut_m[smoke_segments_max], const Crossing *crossing, int count)
{
    double edge_m[2 * veil_together];
    int    edges = 0;
    for (int i = 0; i < count; i++) edge_m[edges++] = crossing[i].from_m, edge_m[edges++] = crossing[i].to_m;
    if (edges == 2) {
        cut_m[0] = edge_m[0], cut_m[1] = edge_m[1];
        return 2;
    }
    sort_m(edge_m, edges);
    const int cuts = edges < smoke_segments_max ? edges : smoke_segments_max;
    for (int i = 0; i < cuts; i++) cut_m[i] = edge_m[(int64_t)i * (edges - 1) / (cuts - 1)];
    return cuts;
}

/* 1 - exp(-depth) to 1e-12 of itself, in a quarter of expm1's time. */
static inline double absorbed(double depth)
{
    return depth > 1e-3 ? 1 - exp(-depth) : depth * (1 - depth * (0.5 - depth * (1.0 / 6 - depth * (1.0 / 24))));
}

/* What a ray has accumulated so far, front to back. */
typedef struct Passed {
    double    through[smoke_bands], added[smoke_bands];
    bool      goes_on;                              /* transmittance above 0 */
    bool      in_gas;                               /* the following hold */
    HotGasRay gas[2];                               /* [HotGasBand] */
    double    gas_depth[2];                         /* optical depth that it has made */
    double    co2_atm_m, air[hot_gas_passed_nodes]; /* column; times what the air lets pass */
} Passed;

/* Gas of one segment. */
typedef struct Segment {
    HotGasColumn column;
    double       weighed[2][2][hot_gas_terms], shown[2]; /* columns times weights; of both times sources */
} Segment;

static const int gas_band[2] = {smoke_bands - 2, smoke_bands - 1}; /* [HotGasBand] */

static void enter_gas(Passed *p)
{
    for (int which = 0; which < 2; which++) smoke_gas_start(&p->gas[which]), p->gas_depth[which] = 0;
    for (int k = 0; k < hot_gas_passed_nodes; k++) p->air[k] = 0;
    p->co2_atm_m = 0;
    p->in_gas = true;
}

static void cross_gas(Segment *s, Passed *p, const SmokeGas *g, double column_m, unsigned bands)
{
    if (!p->in_gas) enter_gas(p);
    const double co2 = g->co2_atm * column_m, h2o = g->h2o_atm * column_m;
    s->column.co2_atm_m += co2, s->column.h2o_atm_m += h2o;
    p->co2_atm_m += co2;
    for (int k = 0; k < hot_gas_passed_nodes; k++) p->air[k] += co2 * g->passed[k];
    for (int which = 0; which < 2; which++) {
        if (!(bands >> gas_band[which] & 1)) continue;
        for (int j = 0; j < hot_gas_terms; j++) {
            s->weighed[which][0][j] += co2 * g->weight[which][0][j];
            s->weighed[which][1][j] += h2o * g->weight[which][1][j];
        }
        s->shown[which] += (co2 + h2o) * g->source[which];
    }
}

/* What of the gas' own radiation of a band the air lets pass: of emission and absorption alike, so that gas as warm as
 * its background stays invisible. */
static double air_passes(const Passed *p, int which)
{
    double mean[hot_gas_passed_nodes];
    if (which == HOT_GAS_LWIR || !(p->co2_atm_m > 0)) return 1;
    for (int k = 0; k < hot_gas_passed_nodes; k++) mean[k] = p->air[k] / p->co2_atm_m;
    return smoke_gas_passed_of(mean, p->co2_atm_m);
}

/* Optical depth that the gas of a segment adds to that of the gas before it. */
static double gas_adds(Passed *p, Segment *s, int which)
{
    static const double most = 1 - 1e-12, least = 1e-300;
    const double        per[2] = {1 / fmax(s->column.co2_atm_m, least), 1 / fmax(s->column.h2o_atm_m, least)};
    for (int g = 0; g < 2; g++)
        for (int j = 0; j < hot_gas_terms; j++) s->weighed[which][g][j] *= per[g];
    const double emissivity = smoke_gas_through(&p->gas[which], (HotGasBand)which, s->column,
                                                (const double(*)[hot_gas_terms])s->weighed[which]);
    const double depth = -log1p(-fmin(emissivity * air_passes(p, which), most));
    const double adds = fmax(depth - p->gas_depth[which], 0);
    p->gas_depth[which] += adds;
    return adds;
}

/* What lets less pass is opaque. */
static const double through_least = 1e-7;

/* Composites the segments behind those already passed. */
static void compose(Passed *passed, const Crossing *crossing, int count, unsigned bands)
{
    double cut_m[smoke_segments_max], *const through = passed->through, *const added = passed->added;
    const int cuts = cuts_of(cut_m, crossing, count);

    for (int k = 0; k + 1 < cuts; k++) {
        double  depth[smoke_bands] = {0}, shown[smoke_bands] = {0};
        Segment gas;
        bool    any = false, any_gas = false;
        for (int i = 0; i < count; i++) {
            const Crossing *c = &crossing[i];
            if (!(c->from_m < cut_m[k + 1] && c->to_m > cut_m[k])) continue;
            const double column_m =
                c->factor *
                smoke_chord_column(&c->chord, c->volume->even, fmax(cut_m[k], c->from_m), fmin(cut_m[k + 1], c->to_m));
            any = true;
            for (int b = 0; b < smoke_bands; b++) {
                if (!(bands >> b & 1)) continue;
                const double depth_here = c->volume->extinction_per_m[b] * column_m;
                depth[b] += depth_here;
                shown[b] += depth_here * c->source[b];
            }
            if (!c->volume->gas || !(column_m > 0)) continue;
            if (!any_gas) gas = (Segment){0}, any_gas = true;
            cross_gas(&gas, passed, c->volume->gas, column_m, bands);
        }
        if (!any) continue;
        const double gas_atm_m = any_gas ? gas.column.co2_atm_m + gas.column.h2o_atm_m : 0;
        for (int which = 0; which < 2 && gas_atm_m > 0; which++) {
            const int b = gas_band[which];
            if (!(bands >> b & 1)) continue;
            const double depth_here = gas_adds(passed, &gas, which);
            depth[b] += depth_here;
            shown[b] += depth_here * (gas.shown[which] / gas_atm_m);
        }
        bool goes_on = false; /* a band ends by itself, whichever others there are */
        for (int b = 0; b < smoke_bands; b++) {
            if (!(bands >> b & 1) || !(through[b] > through_least)) continue;
            if (depth[b] > 0) {
                const double taken = absorbed(depth[b]);
                added[b] += through[b] * taken * (shown[b] / depth[b]);
                through[b] *= 1 - taken;
            }
            goes_on = goes_on || through[b] > through_least;
        }
        if (!goes_on) {
            passed->goes_on = false;
            break;
        }
    }
}

/* A ball about the volume. */
static inline double reach_m(const SmokeVolume *v) { return v->along_m > v->across_m ? v->along_m : v->across_m; }

enum { cone_rays = 16 };

/* The volumes that rays first .. first + many may meet, if those begin in one point: of others the balls lie off a cone
 * about the rays. -1: not so, or too many. */
static int list_of_cone(int near[smoke_set_most], const SmokeVolume *volume, const int *list, int count,
                        const Rays *rays, int first, int many)
{
    const double o[3] = {rays->o_enu[0][first], rays->o_enu[1][first], rays->o_enu[2][first]};
    double       axis[3] = {0, 0, 0}, cosine = 1;
    int          listed = 0;
    for (int r = first; r < first + many; r++)
        for (int c = 0; c < 3; c++) {
            if (rays->o_enu[c][r] != o[c]) return -1;
            axis[c] += rays->d_enu[c][r];
        }
    if (!v3_normalize(axis, axis)) return -1;
    for (int r = first; r < first + many; r++) {
        const double d[3] = {rays->d_enu[0][r], rays->d_enu[1][r], rays->d_enu[2][r]}, along = v3_dot(axis, d);
        cosine = along < cosine ? along : cosine;
    }
    if (!(cosine > 0)) return -1;
    cosine -= 1e-12; /* a rounding of 1 - cosine is 1e-6 rad */
    const double sine = sqrt(1 - cosine * cosine);
    for (int n = 0; n < count; n++) {
        const SmokeVolume *v = &volume[list[n]];
        const double       reach = reach_m(v) * 1.001 + 1e-6;
        double             off[3];
        v3_sub(off, v->p_enu, o);
        const double along = v3_dot(off, axis), square = v3_dot(off, off) - along * along;
        const double widest = (reach + along * sine) / cosine;
        if (!(along > -reach) || !(square <= widest * widest * (1 + 1e-9) + 1e-9 * (1 + along * along))) continue;
        if (listed == smoke_set_most) return -1;
        near[listed++] = list[n];
    }
    return listed;
}

typedef struct Candidates {
    const SmokeVolume *volume;
    const int         *list;
    int                count;
} Candidates;

/* One ray: what it passes, front to back; the number of volumes crossed. Those of the set, or where all are given,
 * which are too many for a set, these piece by piece. */
static int trace_ray(Passed *passed, SmokeSet *set, const Candidates *all, const SmokeRay *ray)
{
    Crossing crossing[veil_together + 4];
    int      near[smoke_set_most], crossed = 0, composed = 0, from = 0;
    for (int b = 0; b < smoke_bands; b++) passed->through[b] = 1, passed->added[b] = 0;
    passed->goes_on = true, passed->in_gas = false;
    do {
        const int piece = all && all->count - from > smoke_set_most ? smoke_set_most : all ? all->count - from : 0;
        if (all) smoke_set_fill(set, all->volume, all->list + from, piece);
        const int nears = smoke_set_near(near, set, ray->o_enu, ray->d_enu);
        for (int n = 0; n < nears && passed->goes_on; n += 4) {
            crossed += smoke_cross(&crossing[crossed], set, &near[n], nears - n < 4 ? nears - n : 4, ray);
            if (crossed < veil_together) continue;
            compose(passed, crossing, veil_together, ray->bands);
            composed += veil_together, crossed -= veil_together;
            memmove(crossing, crossing + veil_together, (size_t)crossed * sizeof *crossing);
            if (!passed->goes_on) crossed = 0;
        }
        from += piece;
    } while (all && from < all->count && passed->goes_on);
    if (crossed > 0) compose(passed, crossing, crossed, ray->bands);
    return composed + crossed;
}

void smoke_trace_rays(SmokeRays *out, const SmokeVolume *volume, const int *list, int count, const Rays *rays,
                      const double *far_m, unsigned bands)
{
    const Candidates all = {volume, list, count};
    SmokeSet         set;
    bool             in_set = false;

    out->any = false;
    for (int r = 0; count > 0 && r < rays->count; r++) {
        if (r % cone_rays == 0) {
            const int left = rays->count - r;
            int       near[smoke_set_most];
            const int nears = list_of_cone(near, volume, list, count, rays, r, left < cone_rays ? left : cone_rays);
            in_set = nears >= 0;
            if (in_set) smoke_set_fill(&set, volume, near, nears);
        }
        const double   o_enu[3] = {rays->o_enu[0][r], rays->o_enu[1][r], rays->o_enu[2][r]};
        const double   d_enu[3] = {rays->d_enu[0][r], rays->d_enu[1][r], rays->d_enu[2][r]};
        const SmokeRay ray = {o_enu, d_enu, far_m[r], bands};
        Passed         passed;
        if (in_set && set.count == 0) continue;
        if (trace_ray(&passed, &set, in_set ? NULL : &all, &ray) == 0) continue;
        if (!out->any)
            for (int b = 0; b < smoke_bands; b++)
                for (int i = 0; i < rays->count; i++) out->transmittance[b][i] = 1, out->added[b][i] = 0;
        out->any = true;
        for (int b = 0; b < smoke_bands; b++) {
            out->transmittance[b][r] = (float)passed.through[b];
            out->added[b][r] = (float)passed.added[b];
        }
    }
}

void smoke_apply(float *radiance, const SmokeRays *veil, int band, int count)
{
    if (!veil->any) return;
    const float *t = veil->transmittance[band], *a = veil->added[band];
    for (int i = 0; i < count; i++) radiance[i] = radiance[i] * t[i] + a[i];
}

/* ---- a block of pixels -------------------------------------------------------------------- */

int smoke_cull_block(int *list, const SmokeVolume *volume, int count, const View *view, double column0_px,
                     double row0_px, double column1_px, double row1_px)
{
    /* bounding cone of the block: its axis, and the widest of its corners */
    const double corner_px[4][2] = {
        {column0_px, row0_px}, {column1_px, row0_px}, {column0_px, row1_px}, {column1_px, row1_px}};
    double middle[3], cosine = 1, tangent[4];
    if (view_has_lens(view)) /* its sides are curved: the straight box about them */
        view_box_tangents(tangent, view, (const double[4]){column0_px, row0_px, column1_px, row1_px});
    view_ray(middle, view, 0.5 * (column0_px + column1_px), 0.5 * (row0_px + row1_px));
    for (int c = 0; c < 4; c++) {
        double d[3];
        if (view_has_lens(view)) {
            const double d_cam[3] = {tangent[c % 2 ? 2 : 0], tangent[c / 2 ? 3 : 1], 1};
            m3_mul_v3(d, view->r_enu_from_cam, d_cam);
            v3_scale(d, 1 / v3_length(d_cam), d);
        } else {
            view_ray(d, view, corner_px[c][0], corner_px[c][1]);
        }
        cosine = fmin(cosine, v3_dot(middle, d));
    }
    const double sine = sqrt(fmax(1 - cosine * cosine, 0));
    int          listed = 0;
    for (int n = 0; n < count; n++) {
        const SmokeVolume *v = &volume[n];
        const double       reach = fmax(v->along_m, v->across_m) * 1.001;
        double             off[3];
        v3_sub(off, v->p_enu, view->p_enu);
        const double along = v3_dot(off, middle), aside = sqrt(fmax(v3_dot(off, off) - along * along, 0));
        /* distance from the cone's surface; inside: negative. Behind the eye by more than its size: culled */
        if (along > -reach && aside * cosine - along * sine <= reach) list[listed++] = n;
    }
    return listed;
}
