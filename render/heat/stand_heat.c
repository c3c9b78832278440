/* render/heat/stand_heat.c: shadows of standing boxes in the ground's heat, soft by the sun's path and by conduction.
 */
#include "render/heat/stand_heat_private.h"

static const double sun_radius_rad = 0.00465; /* of its disc; the deviation of an even disc is half of that */

static double below(double z) { return 0.5 * erfc(-z * 0.70710678118654752); } /* of the normal distribution */

/* ---- one shadow ---------------------------------------------------------------------------------- */

/* The box's shadow on level ground, seen from a place: a hexagon about a centre, spanned by the box's half edges. */
typedef struct Shadow {
    double x_m[2];       /* the place, from the shadow's centre */
    double half_m[3][2]; /* the half edges' shadows */
    double away_m;       /* distance of the box's centre */
    bool   behind;       /* the box is on the other side of the sun's */
} Shadow;

static Shadow shadow_of(const StandBox *s, const double p_enu[3], const double d_enu[3])
{
    Shadow       out = {.behind = false};
    double       to[3], reach_m = 0, along_m;
    const double east = d_enu[0] / d_enu[2], north = d_enu[1] / d_enu[2];
    v3_sub(to, s->p_enu, p_enu);
    for (int a = 0; a < 3; a++) {
        const double half_m = 0.5 * (s->high_m[a] - s->low_m[a]);
        v3_add_scaled(to, to, 0.5 * (s->high_m[a] + s->low_m[a]), s->axis[a]);
        out.half_m[a][0] = half_m * (s->axis[a][0] - east * s->axis[a][2]);
        out.half_m[a][1] = half_m * (s->axis[a][1] - north * s->axis[a][2]);
        reach_m += fabs(half_m * v3_dot(s->axis[a], d_enu));
    }
    along_m = v3_dot(to, d_enu);
    out.behind = along_m + reach_m < 0;
    out.away_m = fmax(along_m, 0);
    out.x_m[0] = -(to[0] - east * to[2]), out.x_m[1] = -(to[1] - north * to[2]);
    return out;
}

/* Share of the sun that the box takes, in a shadow that moves from one place to another meanwhile; flows_m: deviation
 * of what conduction smears. A hexagon is where three strips meet; each takes its share with soft edges. */
static double covered(const Shadow *from, const Shadow *to, const double d_enu[3], double flows_m)
{
    static const double far = 4; /* deviations beyond which nothing is left */
    const double        disc_m = 0.5 * sun_radius_rad * to->away_m / d_enu[2];
    double              x_m[2], moved_m[2], share = 1;
    if (from->behind || to->behind) return 0;
    for (int k = 0; k < 2; k++) x_m[k] = 0.5 * (from->x_m[k] + to->x_m[k]), moved_m[k] = to->x_m[k] - from->x_m[k];
    for (int a = 0; a < 3 && share > 0; a++) {
        double       half[3][2];
        const double length_m = hypot(to->half_m[a][0], to->half_m[a][1]);
        if (!(length_m > 1e-6)) continue; /* seen along this edge: the other two make the outline */
        for (int b = 0; b < 3; b++)
            for (int k = 0; k < 2; k++) half[b][k] = 0.5 * (from->half_m[b][k] + to->half_m[b][k]);
        const double m[2] = {-to->half_m[a][1] / length_m, to->half_m[a][0] / length_m};
        double       wide_m = 0;
        for (int b = 0; b < 3; b++) wide_m += fabs(half[b][0] * m[0] + half[b][1] * m[1]);
        const double at_m = fabs(x_m[0] * m[0] + x_m[1] * m[1]), moves_m = moved_m[0] * m[0] + moved_m[1] * m[1];
        const double soft_m = sqrt(flows_m * flows_m + disc_m * disc_m + moves_m * moves_m / 12) + 1e-4;
        if (at_m - wide_m > far * soft_m) return 0;
        if (wide_m - at_m > far * soft_m) continue;
        share *= below((wide_m - at_m) / soft_m) - below((-wide_m - at_m) / soft_m);
    }
    return share;
}

/* ---- the sun's path ------------------------------------------------------------------------------ */

/* Towards the sun at a time near interval i of the past: straight between the middles of two intervals. */
static void sun_then(double d_enu[3], const HeatPast *p, int i, double unix_s)
{
    const int    to = unix_s > p->unix_s[i] ? i - 1 : i + 1;
    const int    other = to >= 0 && to < p->count ? to : to < 0 && i + 1 < p->count ? i + 1 : i;
    const double gap_s = p->unix_s[other] - p->unix_s[i], share = gap_s != 0 ? (unix_s - p->unix_s[i]) / gap_s : 0;
    double       d[3];
    for (int k = 0; k < 3; k++) d[k] = p->sun_d_enu[i][k] + share * (p->sun_d_enu[other][k] - p->sun_d_enu[i][k]);
    if (!v3_normalize(d_enu, d)) memcpy(d_enu, p->sun_d_enu[i], sizeof p->sun_d_enu[i]);
}

/* Parts of an interval: of the newest one, whose first seconds count most, and whose edges are sharpest, more. */
static int parts_of(int i, double span_s)
{
    static const double each_s = 200;
    const int           parts = (int)fmin(fmax(ceil(span_s / each_s - 1e-6), 1), 8);
    return i == 0 ? 8 : parts;
}

/* Mean of cosine times share taken over the ages [young_s, old_s] of interval i. What an hour ago took counts as long
 * as what is left of it does: within the newest interval by the root of age, as in a body without end. */
static double taken_along(const StandBox *s, const HeatPast *p, int i, double unix_s, double young_s, double old_s,
                          double diffusivity_m2_s, const double p_enu[3], const double n_enu[3])
{
    const int parts = parts_of(i, old_s - young_s);
    double    sum = 0, last_d[3] = {0, 0, 1};
    Shadow    last = {.behind = true};
    bool      any = false; /* last is there */
    for (int k = 0; k <= parts; k++) {
        const double u = (double)k / parts, age_s = i ? young_s + u * (old_s - young_s)
                                                      : pow(sqrt(young_s) + u * (sqrt(old_s) - sqrt(young_s)), 2);
        double       d[3];
        sun_then(d, p, i, unix_s - age_s);
        const bool up = d[2] > 1e-3;
        Shadow     here = {.behind = true};
        if (up) here = shadow_of(s, p_enu, d);
        if (k > 0 && up && any) {
            const double middle_s = i ? age_s - 0.5 * (old_s - young_s) / parts
                                      : pow(sqrt(young_s) + (u - 0.5 / parts) * (sqrt(old_s) - sqrt(young_s)), 2);
            const double cosine = 0.5 * (fmax(v3_dot(d, n_enu), 0) + fmax(v3_dot(last_d, n_enu), 0));
            if (cosine > 0) sum += cosine * covered(&last, &here, d, sqrt(2 * diffusivity_m2_s * fmax(middle_s, 0)));
        }
        last = here, any = up;
        memcpy(last_d, d, sizeof last_d);
    }
    return sum / parts;
}

double stand_taken_k(const StandBox *s, const HeatNow *now, double unix_s, int kind, const double p_enu[3],
                     const double n_enu[3], double lit, double sun_scale, double sky_scale)
{
    const HeatPast *p = &now->past[1], *before = &now->past[0];
    const double    newest_s = p->count > 0 ? p->unix_s[0] + 0.5 * p->span_s[0] : 0;
    const double    flows_m2_s = (double)p->diffusivity[kind];
    double          sun_k = 0, sky_k = 0, stood_s = 0;
    for (int i = 0; i < p->count; i++) {
        const double young_s = newest_s - p->unix_s[i] - 0.5 * p->span_s[i], old_s = young_s + p->span_s[i];
        const double from_s = fmax(young_s, unix_s - s->to_s), end_s = fmin(old_s, unix_s - s->from_s);
        if (unix_s - s->from_s <= young_s) break; /* newest first */
        const double share = (end_s - from_s) / p->span_s[i];
        if (!(share > 0)) continue;
        const bool   both = i < before->count;
        const double sun = both ? (double)before->sun_k[kind][i] : 0, sky = both ? (double)before->sky_k[kind][i] : 0;
        const double weight_k = sun + now->share * ((double)p->sun_k[kind][i] - sun);
        sky_k += share * (sky + now->share * ((double)p->sky_k[kind][i] - sky));
        stood_s = end_s;
        if (weight_k != 0)
            sun_k += share * weight_k * taken_along(s, p, i, unix_s, from_s, end_s, flows_m2_s, p_enu, n_enu);
    }
    /* the sky was hidden for hours: its edge is as soft as heat of half that age */
    const double soft_m = sqrt(flows_m2_s * fmin(stood_s, 6 * 3600)) + 1e-3;
    return lit * sun_scale * sun_k + (sky_k != 0 ? sky_scale * sky_k * stand_hidden_share(s, p_enu, soft_m) : 0);
}

/* ---- the sky ------------------------------------------------------------------------------------- */

/* Contour integral of a polygon over the hemisphere about up, seen from the origin; twice pi times its share. */
static double contour(double (*v)[3], int count, const double up[3])
{
    double sum = 0;
    for (int k = 0; k < count; k++) {
        const double *a = v[k], *b = v[(k + 1) % count];
        double        c[3];
        v3_cross(c, a, b);
        const double sine = v3_length(c);
        if (sine > 1e-12) sum += atan2(sine, v3_dot(a, b)) * v3_dot(c, up) / sine;
    }
    return fabs(sum);
}

/* The part of a face over the horizon. */
static int clip(double (*out)[3], double (*v)[3], int count, const double up[3])
{
    int n = 0;
    for (int k = 0; k < count; k++) {
        const double *a = v[k], *b = v[(k + 1) % count], za = v3_dot(a, up), zb = v3_dot(b, up);
        if (za >= 0) memcpy(out[n++], a, sizeof out[0]);
        if ((za < 0) == (zb < 0)) continue;
        for (int c = 0; c < 3; c++) out[n][c] = a[c] + za / (za - zb) * (b[c] - a[c]);
        n++;
    }
    return n;
}

/* From a place outside of the box, in its axes. */
static double seen_share(const StandBox *s, const double q[3], const double up[3])
{
    double sum = 0;
    for (int a = 0; a < 3; a++)
        for (int side = 0; side < 2; side++) {
            const double at = side ? s->high_m[a] : s->low_m[a];
            if (side ? q[a] <= at : q[a] >= at) continue; /* the place is behind this face */
            double    v[4][3], over[8][3];
            const int b = (a + 1) % 3, c = (a + 2) % 3;
            for (int k = 0; k < 4; k++) {
                v[k][a] = at - q[a];
                v[k][b] = (k == 1 || k == 2 ? s->high_m[b] : s->low_m[b]) - q[b];
                v[k][c] = (k >= 2 ? s->high_m[c] : s->low_m[c]) - q[c];
            }
            sum += contour(over, clip(over, v, 4, up), up);
        }
    return fmin(sum / (2 * pi_rad), 1);
}

double stand_hidden_share(const StandBox *s, const double p_enu[3], double soft_m)
{
    static const double edge_m = 1e-3;
    double              from[3], q[3], up[3], inside_m = INFINITY;
    int                 nearest = 0;
    v3_sub(from, p_enu, s->p_enu);
    for (int a = 0; a < 3; a++) q[a] = v3_dot(from, s->axis[a]), up[a] = s->axis[a][2];
    for (int a = 0; a < 2; a++) {
        const double in_m = fmin(q[a] - s->low_m[a], s->high_m[a] - q[a]);
        if (in_m < inside_m) inside_m = in_m, nearest = a;
    }
    if (!(q[2] >= s->low_m[2] && q[2] <= s->high_m[2]))
        return seen_share(s, q, up); /* over or under its whole height */
    const double under = below(inside_m / soft_m);
    if (inside_m > -edge_m) /* on the outline, or within it: as from just outside of the nearest side */
        q[nearest] = q[nearest] - s->low_m[nearest] < s->high_m[nearest] - q[nearest] ? s->low_m[nearest] - edge_m
                                                                                      : s->high_m[nearest] + edge_m;
    return under + (1 - under) * (under < 1 ? seen_share(s, q, up) : 0);
}
