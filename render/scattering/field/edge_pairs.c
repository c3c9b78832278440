/* render/scattering/field/edge_pairs.c: finds edges that face one another across a flat face, and what waves
 * between them add. */
#include "render/scattering/field/edge_field_private.h"

#include <assert.h>
#include <stdlib.h>

static const double pi = 3.14159265358979323846;
static const double same_rad = 1e-3, same_m = 2e-4; /* directions and planes that count as one */
enum { pieces_most = 4096 };

/* --- which face one another --- */

typedef struct Face {
    int    wedge, face, part;
    double offset_m;   /* of its plane from the origin */
    double n[3], x[3]; /* outward normal; in the face, away from the edge */
} Face;

static void face_of(Face *out, const Wedge *w, int index, int face)
{
    const WedgeFrame *f = &w->frame;
    const double      opening = f->exterior_pi * pi;
    *out = (Face){.wedge = index, .face = face, .part = w->part};
    if (face == 0) {
        memcpy(out->x, f->x, sizeof out->x);
        memcpy(out->n, f->y, sizeof out->n);
    } else {
        v3_scale(out->x, cos(opening), f->x);
        v3_add_scaled(out->x, out->x, sin(opening), f->y);
        v3_scale(out->n, sin(opening), f->x);
        v3_add_scaled(out->n, out->n, -cos(opening), f->y);
    }
    double middle[3];
    for (int c = 0; c < 3; c++) middle[c] = 0.5 * (w->p[0][c] + w->p[1][c]);
    out->offset_m = v3_dot(middle, out->n);
}

static int by_plane(const void *a, const void *b)
{
    const Face *s = a, *t = b;
    if (s->part != t->part) return s->part < t->part ? -1 : 1;
    if (s->offset_m != t->offset_m) return s->offset_m < t->offset_m ? -1 : 1;
    if (s->wedge != t->wedge) return s->wedge < t->wedge ? -1 : 1;
    return s->face - t->face;
}

static int by_wedges(const void *a, const void *b)
{
    const EdgePair *s = a, *t = b;
    for (int i = 0; i < 2; i++) {
        if (s->wedge[i] != t->wedge[i]) return s->wedge[i] < t->wedge[i] ? -1 : 1;
        if (s->face[i] != t->face[i]) return s->face[i] < t->face[i] ? -1 : 1;
    }
    return 0;
}

/* Whether two faces are the same face, and their edges lie opposite each other on it. */
static bool opposite(EdgePair *out, const Face *a, const Face *b, const Wedge *wedge)
{
    if (v3_dot(a->n, b->n) < cos(same_rad) || v3_dot(a->x, b->x) > -cos(same_rad)) return false;
    if (a->wedge > b->wedge) {
        const Face *swap = a;
        a = b, b = swap;
    }
    const Wedge *first = &wedge[a->wedge], *other = &wedge[b->wedge];
    double       to[3], along_m[2], edge[3];
    v3_sub(edge, first->p[1], first->p[0]);
    const double length_m = v3_length(edge);
    for (int e = 0; e < 2; e++) {
        v3_sub(to, other->p[e], first->p[0]);
        along_m[e] = v3_dot(to, first->frame.z);
    }
    const double low_m = fmax(0, fmin(along_m[0], along_m[1])), high_m = fmin(length_m, fmax(along_m[0], along_m[1]));
    *out = (EdgePair){.wedge = {a->wedge, b->wedge},
                      .face = {a->face, b->face},
                      .along_m = {low_m, high_m},
                      .width_m = v3_dot(to, a->x)};
    return high_m > low_m && out->width_m > same_m && fabs(v3_dot(to, a->n)) < same_m;
}

static bool add_pair(EdgePairs *out, const EdgePair *pair)
{
    if (out->count == out->capacity) {
        const int capacity = out->capacity ? 2 * out->capacity : 64;
        EdgePair *larger = realloc(out->pair, (size_t)capacity * sizeof *larger);
        if (!larger) return false;
        out->pair = larger;
        out->capacity = capacity;
    }
    out->pair[out->count++] = *pair;
    return true;
}

Status edge_pairs_find(EdgePairs *out, const Wedge *wedge, int count)
{
    Face *face = malloc((2 * (size_t)count + 1) * sizeof *face);
    bool  good = face != NULL;
    *out = (EdgePairs){0};
    for (int i = 0; i < 2 * count && good; i++) face_of(&face[i], &wedge[i / 2], i / 2, i % 2);
    if (good) qsort(face, 2 * (size_t)count, sizeof *face, by_plane);
    for (int i = 0; i < 2 * count && good; i++)
        for (int k = i + 1;
             k < 2 * count && face[k].part == face[i].part && face[k].offset_m - face[i].offset_m < same_m && good;
             k++) {
            EdgePair pair;
            if (face[k].wedge != face[i].wedge && opposite(&pair, &face[i], &face[k], wedge))
                good = add_pair(out, &pair);
        }
    free(face);
    if (good && out->count > 1) qsort(out->pair, (size_t)out->count, sizeof *out->pair, by_wedges);
    if (!good) edge_pairs_destroy(out);
    return good ? STATUS_OK : STATUS_NO_MEMORY;
}

void edge_pairs_destroy(EdgePairs *pairs)
{
    free(pairs->pair);
    *pairs = (EdgePairs){0};
}

/* --- the wave between them --- */

double complex edge_transition(double x)
{
    if (x > 12) { /* the asymptotic series; its next term is 945 / 32 x^5 */
        const double complex y = 1 / (2 * I * x);
        return 1 + y * (-1 + y * (3 + y * (-15 + y * 105)));
    }
    /* the power series of the integral from 0 */
    const double   root = sqrt(x);
    double complex term = root, sum = root;
    for (int n = 1; n < 80; n++) {
        term *= -I * x / n;
        sum += term / (2 * n + 1);
    }
    const double complex rest = 0.5 * sqrt(pi) * cexp(-0.25 * I * pi) - sum;
    return 2 * I * root * cexp(I * x) * rest;
}

/* Coefficient of a wedge between an antenna at `angle` from a face and a point at distance `width` along that face,
 * divided by -exp(-j pi / 4) / sqrt(2 pi k). */
static double complex along_face(double angle, double exterior_pi, double k_width)
{
    const double         n = exterior_pi, c = cos(0.5 * angle), x = 2 * k_width * c * c;
    const double complex far = 1 / tan((pi + angle) / (2 * n));
    const double         off = pi - angle;
    /* at the boundary the cotangent grows as the function falls: their product there is a step, its middle 0 */
    const double complex near = fabs(off) < 1e-9 ? 0 : edge_transition(x) / tan(off / (2 * n));
    return (far + near) / n;
}

static double face_angle(const Wedge *w, int face, const double u[3])
{
    const double angle = edge_angle(&w->frame, u), opening = w->frame.exterior_pi * pi;
    return face == 0 ? angle : opening - angle;
}

/* How waves cross a face: they come in at edge a and go out at edge b after one crossing from a to b, or after two
 * crossings from a and back. */
typedef struct Crossing {
    const Wedge *a, *b;
    int          face_a, face_b, index;
    int          order;
    double       width_m;
    const Wedge *beyond; /* order 2: the edge in between */
} Crossing;

/* What an edge sends back along its face, over the wave that arrives along this face, at the distance `width` from the
 * edge. A half plane sends as much along its other face, which has the same effect. */
static double complex sent_back(const Wedge *w, double k_width)
{
    const double n = w->frame.exterior_pi, sides = n > 1.999 ? 2 : 1;
    return -sides / (n * tan(pi / (2 * n))) * cexp(-0.25 * I * pi) / sqrt(2 * pi * k_width);
}

/* The part of each polarisation that is a magnetic field along z, over the sine of its angle to that. */
static void along_edge(double out[2], const ScatterAntenna *antenna, const double u[3], const double z[3])
{
    double       e[2][3], h[3];
    const double along = v3_dot(u, z), sine = sqrt(fmax(1 - along * along, 1e-12));
    scatter_basis(e[0], e[1], antenna->u);
    for (int q = 0; q < 2; q++) {
        v3_add_scaled(e[q], e[q], -v3_dot(e[q], u), u);
        v3_normalize(e[q], e[q]);
        v3_cross(h, u, e[q]);
        out[q] = v3_dot(h, z) / sine;
    }
}

/* Fills the segment of a piece of a crossing, length_m long, with p and q on its two edges. False: no wave of either
 * antenna crosses here. */
static bool piece(EdgeSegment *s, const Crossing *c, const double p[3], const double q[3], double length_m,
                  const ScatterAntenna *tx, const ScatterAntenna *rx, double k)
{
    double        in[2], out[2];
    const double  path_m[2] = {scatter_path(s->u[0], tx, p), scatter_path(s->u[1], rx, q)};
    const double  angle[2] = {face_angle(c->a, c->face_a, s->u[0]), face_angle(c->b, c->face_b, s->u[1])};
    const double *z = c->a->frame.z;
    for (int i = 0; i < 2; i++)
        if (angle[i] < 0 || angle[i] > (i ? c->b : c->a)->frame.exterior_pi * pi) return false;
    /* on the cone both are one; elsewhere the mean */
    const double   along = 0.5 * (v3_dot(s->u[1], z) - v3_dot(s->u[0], z)), sine = sqrt(fmax(1 - along * along, 1e-6));
    const double   k_width = k * sine * c->width_m;
    double complex share = cexp(-0.25 * I * pi) / (4 * pi * sqrt(2 * pi * k_width)) *
                           along_face(angle[0], c->a->frame.exterior_pi, k_width) *
                           along_face(angle[1], c->b->frame.exterior_pi, k_width);
    if (c->order == 2) share *= sent_back(c->beyond, k_width);
    double spread = length_m;
    for (int i = 0; i < 2; i++) spread /= 1 + path_m[i] / (i ? rx : tx)->range_m;
    along_edge(in, tx, s->u[0], z);
    along_edge(out, rx, s->u[1], z);
    /* the incident wave runs against its u: a minus, as between a field and its mirror image */
    for (int r = 0; r < 2; r++)
        for (int t = 0; t < 2; t++) s->amplitude[r][t] = -share * spread * out[r] * in[t];
    for (int i = 0; i < 3; i++) s->p[i] = 0.5 * (p[i] + q[i]);
    s->wedge = c->index, s->part = c->a->part;
    s->length_m = length_m;
    s->path_m = path_m[0] + path_m[1] + c->order * sine * c->width_m;
    s->slope = -v3_dot(s->u[0], z) - v3_dot(s->u[1], z);
    s->order = c->order, s->order_k = k;
    return true;
}

/* Gives a point beside an edge that is clear of its faces. */
static void beside(double out[3], const Wedge *w, const double p[3], double clear_m)
{
    const double half = w->frame.exterior_pi * pi / 2;
    v3_add_scaled(out, p, clear_m * cos(half), w->frame.x);
    v3_add_scaled(out, out, clear_m * sin(half), w->frame.y);
}

static bool seen(const Crossing *c, const double p[3], const double q[3], const EdgePairConfig *config)
{
    double near[3];
    if (!config->edge.visible) return true;
    beside(near, c->a, p, config->edge.clear_m);
    if (!config->edge.visible(config->edge.user, near, 0)) return false;
    beside(near, c->b, q, config->edge.clear_m);
    return config->edge.visible(config->edge.user, near, 1);
}

static bool add_segment(EdgeSegments *out, const EdgeSegment *s)
{
    if (out->count == out->capacity) {
        const int    capacity = out->capacity ? 2 * out->capacity : 64;
        EdgeSegment *larger = realloc(out->segment, (size_t)capacity * sizeof *larger);
        if (!larger) return false;
        out->segment = larger;
        out->capacity = capacity;
    }
    out->segment[out->count++] = *s;
    return true;
}

/* Number of pieces, so short that the path to either antenna is linear along each. */
static int pieces_of(double length_m, const ScatterAntenna *tx, const ScatterAntenna *rx, const EdgePairConfig *config,
                     const double p[3])
{
    double u[3], bend_per_m = 0;
    bend_per_m += 1 / (tx->range_m + scatter_path(u, tx, p));
    bend_per_m += 1 / (rx->range_m + scatter_path(u, rx, p));
    const double longest_m =
        fmin(config->edge.sample_m, fmin(0.02 / bend_per_m, sqrt(0.16 / (config->edge.k_per_m * bend_per_m))));
    return (int)fmin(fmax(ceil(length_m / longest_m), 1), pieces_most);
}

/* Lists the four ways across a pair of edges: from a to b, from b to a, and from each edge to the other and back. */
static void ways_of(Crossing way[4], const EdgePair *of, const Wedge *wedge)
{
    const Wedge *a = &wedge[of->wedge[0]], *b = &wedge[of->wedge[1]];
    const int    f = of->face[0], g = of->face[1];
    way[0] = (Crossing){a, b, f, g, of->wedge[0], 1, of->width_m, NULL};
    way[1] = (Crossing){b, a, g, f, of->wedge[1], 1, of->width_m, NULL};
    way[2] = (Crossing){a, a, f, f, of->wedge[0], 2, of->width_m, b};
    way[3] = (Crossing){b, b, g, g, of->wedge[1], 2, of->width_m, a};
}

/* The most that a pair may add in second order: that of its whole length, by its middle, or of a period where its path
 * runs off. */
static double most_m(const Crossing way[4], const double start[3], const double across[3], double length_m,
                     const ScatterAntenna *tx, const ScatterAntenna *rx, const EdgePairConfig *config)
{
    const double *z = way[0].a->frame.z;
    double        most = 0, slope[2], p[3], q[3], u[2][3];
    EdgeSegment   s;
    for (int end = 0; end < 2; end++) {
        v3_add_scaled(p, start, end * length_m, z);
        scatter_path(u[0], tx, p);
        scatter_path(u[1], rx, p);
        slope[end] = v3_dot(u[0], z) + v3_dot(u[1], z);
    }
    const double slowest = slope[0] * slope[1] < 0 ? 0 : fmin(fabs(slope[0]), fabs(slope[1]));
    v3_add_scaled(p, start, 0.5 * length_m, z);
    v3_add_scaled(q, p, way[0].width_m, across);
    for (int w = 0; w < 2; w++) {
        if (!piece(&s, &way[w], w ? q : p, w ? p : q, length_m, tx, rx, config->k_per_m)) continue;
        for (int e = 0; e < 4; e++) most = fmax(most, cabs(s.amplitude[e / 2][e % 2]));
    }
    return most * fmin(1, 2 / (config->k_per_m * slowest * length_m));
}

Status edge_pair_segments(EdgeSegments *out, const EdgePair *pair, int count, const Wedge *wedge,
                          const ScatterAntenna *tx, const ScatterAntenna *rx, const EdgePairConfig *config)
{
    const int before = out->count;
    bool      good = true;
    assert(config->k_per_m > 0 && config->edge.sample_m > 0);
    for (int i = 0; i < count && good; i++) {
        const EdgePair *of = &pair[i];
        const double    length_m = of->along_m[1] - of->along_m[0];
        if (length_m * length_m < 2 * pi / config->k_per_m * of->width_m) continue;
        const Wedge *a = &wedge[of->wedge[0]];
        Face         face;
        double       start[3];
        face_of(&face, a, 0, of->face[0]);
        v3_add_scaled(start, a->p[0], of->along_m[0], a->frame.z);
        Crossing way[4];
        ways_of(way, of, wedge);
        if (most_m(way, start, face.x, length_m, tx, rx, config) < config->least_m) continue;
        const int n = pieces_of(length_m, tx, rx, config, start);
        for (int k = 0; k < n && good; k++) {
            double p[3], q[3];
            v3_add_scaled(p, start, (k + 0.5) * length_m / n, a->frame.z);
            v3_add_scaled(q, p, of->width_m, face.x);
            if (config->clear && !config->clear(config->edge.user, p, q, face.n)) continue;
            const double *const from[4] = {p, q, p, q}, *const to[4] = {q, p, p, q};
            for (int w = 0; w < 4 && good; w++) {
                EdgeSegment s = {0};
                if (piece(&s, &way[w], from[w], to[w], length_m / n, tx, rx, config->k_per_m) &&
                    seen(&way[w], from[w], to[w], config))
                    good = add_segment(out, &s);
            }
        }
    }
    if (good) return STATUS_OK;
    out->count = before;
    return STATUS_NO_MEMORY;
}
