/* entities/scenery/scenery_outline.c: outlines of buildings: cut into triangles, moved outwards. */
#include "entities/scenery/scenery_buildings_private.h"

#include <stdlib.h>

/* Twice the signed area of a triangle, positive when it turns left. */
static double turn_m2(const double a[2], const double b[2], const double c[2])
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static double square_m2(const double a[2], const double b[2])
{
    return (b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1]);
}

/* How far a triangle is from a line: twice its area over the square of its longest side; negative: turned over. */
static double fullness(const double a[2], const double b[2], const double c[2])
{
    const double longest = fmax(square_m2(a, b), fmax(square_m2(b, c), square_m2(c, a)));
    return longest > 0 ? turn_m2(a, b, c) / longest : 0;
}

typedef struct Clip {
    const double (*p)[2];
    int *before, *after; /* ring of what is left */
} Clip;

/* Whether no other corner of the ring lies in or on a triangle; one within a tenth of a micrometre of the cut (from b
 * to a) lies on it, so that what is left does not end as a line. */
static bool is_free(const Clip *c, int a, int v, int b)
{
    const double(*p)[2] = c->p;
    const double near_m2 = -1e-7 * sqrt(square_m2(p[a], p[b]));
    const double low_x = fmin(p[a][0], fmin(p[v][0], p[b][0])), high_x = fmax(p[a][0], fmax(p[v][0], p[b][0]));
    const double low_y = fmin(p[a][1], fmin(p[v][1], p[b][1])), high_y = fmax(p[a][1], fmax(p[v][1], p[b][1]));
    for (int o = c->after[b]; o != a; o = c->after[o]) {
        const double *q = p[o];
        if (q[0] < low_x - 1e-7 || q[0] > high_x + 1e-7 || q[1] < low_y - 1e-7 || q[1] > high_y + 1e-7) continue;
        if (square_m2(q, p[a]) == 0 || square_m2(q, p[v]) == 0 || square_m2(q, p[b]) == 0) continue;
        if (turn_m2(p[a], p[v], q) >= 0 && turn_m2(p[v], p[b], q) >= 0 && turn_m2(p[b], p[a], q) >= near_m2)
            return false;
    }
    return true;
}

/* The corner to cut off next: the first that is full enough, else the fullest (of many corners: of those looked at
 * until there was one); without an ear, the fullest corner. */
static int next_ear(const Clip *c, int from, int left, bool *clean)
{
    static const double enough = 0.15;
    enum { look_most = 64 };
    int    best = -1, fallback = from;
    double best_full = 0, fallback_full = -INFINITY;
    for (int k = 0, v = from; k < left; k++, v = c->after[v]) {
        const int    a = c->before[v], b = c->after[v];
        const double full = fullness(c->p[a], c->p[v], c->p[b]);
        if (full > fallback_full) fallback = v, fallback_full = full;
        if (full <= best_full || !is_free(c, a, v, b)) continue;
        best = v, best_full = full;
        if (full > enough || k > look_most) break;
    }
    if (best < 0) *clean = false;
    return best < 0 ? fallback : best;
}

bool outline_triangulate(int (*triangle)[3], Status *status, const double (*p)[2], int n)
{
    int  own[2][64];
    int *large = n > 64 ? malloc(2 * (size_t)n * sizeof *large) : NULL;
    Clip c = {p, n > 64 ? large : own[0], n > 64 ? large + n : own[1]};
    bool clean = true;
    int  made = 0;
    if (n < 3) return false;
    if (n > 64 && !large) {
        *status = STATUS_NO_MEMORY;
        return false;
    }
    for (int k = 0; k < n; k++) c.before[k] = (k + n - 1) % n, c.after[k] = (k + 1) % n;
    for (int left = n, at = 0; left > 3; left--) {
        const int v = next_ear(&c, at, left, &clean), a = c.before[v], b = c.after[v];
        triangle[made][0] = a, triangle[made][1] = v, triangle[made++][2] = b;
        c.after[a] = b, c.before[b] = a;
        at = c.after[b];
    }
    const int last = n > 3 ? triangle[made - 1][0] : 0;
    triangle[made][0] = last, triangle[made][1] = c.after[last], triangle[made][2] = c.after[c.after[last]];
    clean = clean && turn_m2(p[triangle[made][0]], p[triangle[made][1]], p[triangle[made][2]]) > 0;
    free(large);
    return clean;
}

/* ---- moving edges --------------------------------------------------------------------------------- */

static bool direction(double d[2], const double a[2], const double b[2])
{
    const double length_m = hypot(b[0] - a[0], b[1] - a[1]);
    d[0] = (b[0] - a[0]) / length_m, d[1] = (b[1] - a[1]) / length_m;
    return length_m > 0;
}

/* Where a corner goes when both its edges move outwards by 1; false: the edges turn back on themselves. */
static bool mitre(double out[2], const double before[2], const double at[2], const double after[2])
{
    double u[2], v[2];
    if (!direction(u, before, at) || !direction(v, at, after)) return false;
    const double whole = 1 + u[0] * v[0] + u[1] * v[1]; /* of the outward normals (y, -x) */
    out[0] = (u[1] + v[1]) / whole, out[1] = -(u[0] + v[0]) / whole;
    return whole > 1e-6;
}

double outline_longest_mitre(const double (*p)[2], int n)
{
    double longest = 1;
    for (int k = 0; k < n; k++) {
        double m[2];
        longest = fmax(longest, mitre(m, p[(k + n - 1) % n], p[k], p[(k + 1) % n]) ? hypot(m[0], m[1]) : INFINITY);
    }
    return longest;
}

static bool they_meet(const double a[2], const double b[2], const double c[2], const double d[2])
{
    for (int k = 0; k < 2; k++)
        if (fmax(a[k], b[k]) < fmin(c[k], d[k]) || fmax(c[k], d[k]) < fmin(a[k], b[k])) return false;
    const double abc = turn_m2(a, b, c), abd = turn_m2(a, b, d), cda = turn_m2(c, d, a), cdb = turn_m2(c, d, b);
    return !((abc > 0 && abd > 0) || (abc < 0 && abd < 0) || (cda > 0 && cdb > 0) || (cda < 0 && cdb < 0));
}

/* Where a corner goes when of its edges only some move outwards by 1; false: the edges are in one line. */
static bool half_mitre(double out[2], const double before[2], const double at[2], const double after[2], bool first,
                       bool second)
{
    double u[2], v[2];
    if (!direction(u, before, at) || !direction(v, at, after)) return false;
    const double turn = u[0] * v[1] - u[1] * v[0];
    if (!(fabs(turn) > 0.1)) return false;
    /* along the edge that stays, so far that the other is 1 farther out */
    for (int c = 0; c < 2; c++) out[c] = first ? -v[c] / turn : second ? u[c] / turn : 0;
    return true;
}

bool outline_offset(double (*to)[2], const double (*p)[2], int n, double out_m, const bool *still)
{
    for (int k = 0; k < n; k++) {
        double     m[2];
        const bool first = !still || !still[(k + n - 1) % n], second = !still || !still[k];
        const bool is_mitre = first && second ? mitre(m, p[(k + n - 1) % n], p[k], p[(k + 1) % n])
                                              : half_mitre(m, p[(k + n - 1) % n], p[k], p[(k + 1) % n], first, second);
        if (!is_mitre) return false;
        for (int c = 0; c < 2; c++) to[k][c] = p[k][c] + out_m * m[c];
    }
    for (int k = 0; k < n; k++) {
        const int l = (k + 1) % n;
        /* an edge that has turned round, or nearly gone */
        const double was = hypot(p[l][0] - p[k][0], p[l][1] - p[k][1]);
        if ((to[l][0] - to[k][0]) * (p[l][0] - p[k][0]) + (to[l][1] - to[k][1]) * (p[l][1] - p[k][1]) < 0.02 * was)
            return false;
    }
    for (int i = 0; i < n; i++)
        for (int k = i + 2; k < n; k++)
            if ((i > 0 || k + 1 < n) && they_meet(to[i], to[i + 1], to[k], to[(k + 1) % n])) return false;
    return true;
}
