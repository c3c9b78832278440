/* terrain/culture/courtyards.c: slits from courtyards to the outside of their building. */
#include "terrain/culture/courtyards.h"

static const double least_edge_m = 0.6; /* from whose middle a slit goes */
enum { tried_edges = 24 };              /* of a courtyard: its longest */

/* An inner ring, clockwise, so that the building is on its left as it is of the outline. */
typedef struct Ring {
    const double (*p)[2];
    int    n;
    bool   turned; /* p goes round the other way */
    double area_m2;
} Ring;

static const double *corner_of(const Ring *r, int k)
{
    k %= r->n;
    return r->p[r->turned ? (r->n - k) % r->n : k];
}

/* How far a ray from o along d (unit) meets the edge from a to b, and where on it (0 .. 1); INFINITY: it does not. */
static double meets_m(double *share, const double o[2], const double d[2], const double a[2], const double b[2])
{
    const double e[2] = {b[0] - a[0], b[1] - a[1]}, q[2] = {a[0] - o[0], a[1] - o[1]};
    const double det = e[0] * d[1] - e[1] * d[0];
    if (det == 0) return INFINITY;
    const double at = (e[0] * q[1] - e[1] * q[0]) / det;
    *share = (d[0] * q[1] - d[1] * q[0]) / det;
    return at > 0 && *share >= 0 && *share <= 1 ? at : INFINITY;
}

/* The shortest way of a ring to the outline: from the middle of its edge, square to it. */
typedef struct Slit {
    double length_m, o[2], d[2];
    int    ring, from, to; /* the edge of the ring, and of the outline */
} Slit;

static bool is_tried(const Ring *r, int k)
{
    const double *a = corner_of(r, k), *b = corner_of(r, k + 1), length_m = hypot(b[0] - a[0], b[1] - a[1]);
    int           longer = 0;
    if (length_m < least_edge_m) return false;
    for (int o = 0; o < r->n && longer < tried_edges; o++) {
        const double *c = corner_of(r, o), *e = corner_of(r, o + 1);
        longer += hypot(e[0] - c[0], e[1] - c[1]) > length_m;
    }
    return longer < tried_edges;
}

static void look_from(Slit *best, const Ring *ring, int rings, int r, int k, const double (*p)[2], int corners)
{
    const double *a = corner_of(&ring[r], k), *b = corner_of(&ring[r], k + 1);
    const double  length_m = hypot(b[0] - a[0], b[1] - a[1]), ends_m = 2 * courtyard_slit_m;
    Slit          s = {best->length_m, {0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])}, {0}, r, k, -1};
    s.d[0] = -(b[1] - a[1]) / length_m, s.d[1] = (b[0] - a[0]) / length_m;
    double share = 0;
    for (int n = 0; n < corners; n++) {
        const double *c = p[n], *e = p[(n + 1) % corners], m = meets_m(&share, s.o, s.d, c, e);
        if (m >= s.length_m) continue;
        const double edge_m = hypot(e[0] - c[0], e[1] - c[1]);
        /* not so near a corner that the slit has no room, nor so aslant that its sides end far apart */
        const double facing = ((e[1] - c[1]) * s.d[0] - (e[0] - c[0]) * s.d[1]) / edge_m;
        const bool   fits = share * edge_m > ends_m && (1 - share) * edge_m > ends_m && facing > 0.7;
        s.length_m = m, s.to = fits ? n : -1;
    }
    for (int o = 0; o < rings && s.to >= 0; o++)
        for (int n = 0; n < ring[o].n; n++)
            if ((o != r || n != k) &&
                meets_m(&share, s.o, s.d, corner_of(&ring[o], n), corner_of(&ring[o], n + 1)) <= s.length_m)
                s.to = -1;
    if (s.to >= 0) *best = s;
}

/* Puts a ring into the outline by its slit. */
static int join(double (*p)[2], int corners, const Ring *ring, const Slit *s)
{
    const int     more = ring->n + 4, at = s->to + 1;
    const double *c = p[s->to], *e = p[(s->to + 1) % corners], edge_m = hypot(e[0] - c[0], e[1] - c[1]);
    const double  side[2] = {-s->d[1], s->d[0]}; /* the outline goes to the left of the slit's way: along side */
    const double  along[2] = {(e[0] - c[0]) / edge_m, (e[1] - c[1]) / edge_m};
    const double  half_m = 0.5 * courtyard_slit_m, per = half_m / (along[0] * side[0] + along[1] * side[1]);
    double        end[2], first[2], last[2];
    for (int k = 0; k < 2; k++) {
        end[k] = s->o[k] + s->length_m * s->d[k];
        first[k] = end[k] - per * along[k], last[k] = end[k] + per * along[k];
    }
    memmove(p + at + more, p + at, (size_t)(corners - at) * sizeof *p);
    double(*to)[2] = p + at;
    int n = 0;
    memcpy(to[n++], first, sizeof first);
    for (int k = 0; k < 2; k++) to[n][k] = s->o[k] - half_m * side[k];
    n++;
    for (int k = 1; k <= ring->n; k++) memcpy(to[n++], corner_of(ring, s->from + k), sizeof *p);
    for (int k = 0; k < 2; k++) to[n][k] = s->o[k] + half_m * side[k];
    n++;
    memcpy(to[n++], last, sizeof last);
    return corners + more;
}

/* The largest rings, as they have to go round. */
static int gather(Ring out[courtyards_most], const double (*ring_m)[2], const int *first, int rings)
{
    int count = 0;
    for (int k = 0; k < rings; k++) {
        Ring         r = {.p = ring_m + first[k], .n = first[k + 1] - first[k]};
        const double of_m2 = r.n >= 3 ? culture_area_m2(r.p, r.n) : 0;
        int          at;
        r.turned = of_m2 > 0, r.area_m2 = fabs(of_m2);
        if (!(r.area_m2 >= courtyard_least_m2)) continue;
        if (count == courtyards_most && r.area_m2 <= out[count - 1].area_m2) continue;
        for (at = count < courtyards_most ? count++ : count - 1; at > 0 && out[at - 1].area_m2 < r.area_m2; at--)
            out[at] = out[at - 1];
        out[at] = r;
    }
    return count;
}

int courtyards_join(double (*p)[2], int corners, const double (*ring_m)[2], const int *first, int rings, int *joined)
{
    Ring ring[courtyards_most];
    int  count = gather(ring, ring_m, first, rings);
    *joined = 0;
    if (corners < 3) return corners;
    const bool turned = culture_area_m2((const double(*)[2])p, corners) < 0;
    for (int i = 1, k = corners - 1; turned && i < k; i++, k--)
        for (int c = 0; c < 2; c++) {
            const double swap = p[i][c];
            p[i][c] = p[k][c], p[k][c] = swap;
        }
    while (count > 0) {
        Slit best = {.length_m = INFINITY, .to = -1};
        for (int r = 0; r < count; r++)
            for (int k = 0; k < ring[r].n && corners + ring[r].n + 4 <= culture_outline_most; k++)
                if (is_tried(&ring[r], k)) look_from(&best, ring, count, r, k, (const double(*)[2])p, corners);
        if (best.to < 0) break;
        corners = join(p, corners, &ring[best.ring], &best);
        ++*joined;
        ring[best.ring] = ring[--count];
    }
    return corners;
}

int courtyards_slits(bool *slit, const double (*p)[2], int n)
{
    static const double wide_m = 1.5 * courtyard_slit_m;
    int                 count = 0;
    for (int k = 0; k < n; k++) slit[k] = false;
    for (int k = 0; k < n && n >= 10; k++) /* of the smallest: two triangles and a slit */
        for (int o = 0; o < k && !slit[k]; o++) {
            const double *a = p[k], *b = p[(k + 1) % n], *c = p[o], *d = p[(o + 1) % n];
            if (slit[o] ||
                !(fabs(a[0] - d[0]) < wide_m && fabs(a[1] - d[1]) < wide_m && fabs(b[0] - c[0]) < wide_m &&
                  fabs(b[1] - c[1]) < wide_m) ||
                hypot(b[0] - a[0], b[1] - a[1]) < 5 * wide_m)
                continue;
            slit[k] = slit[o] = true;
            count += 2;
        }
    return count;
}
