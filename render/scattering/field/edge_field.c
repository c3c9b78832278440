/* render/scattering/field/edge_field.c: what a wedge scatters per length of edge, and integrals along a target's edges.
 *
 * The fringe currents of a wedge's two faces are integrated in closed form. In face axes (x along the face, y its
 * normal, z along the edge) let the incident wave travel along d, c = d.z, s = sqrt(1 - c^2), and come from the
 * angle f about the edge; N = exterior_pi. Fields vary as exp(-j k c z), and E_z, H_z obey the two-dimensional wave
 * equation with k s. On the face the current is K_x = H_z, K_z = -H_x, with H_x = (j / (k s^2)) (dE_z/dy / Z - c
 * dH_z/dx). The strip runs along g = s x + c z, so its far field in direction u needs integrals of the
 * two-dimensional solutions times exp(j k s m x), m = (u.g - c^2) / s^2 <= 1. Put m = -cos a (a real in 0 .. pi, or
 * imaginary below -1). Sommerfeld's integral for the wedge, integrated over x, is the difference of one integrand
 * on two lines 2 pi apart: the residues at a and -a between them are all that is left,
 *
 *     integral dE_z/dy = -(2/N) sin(f/N) / (cos(f/N) - cos(a/N)) = -2 (w(a - f) - w(a + f)),   w(x) = cot(x/2N) / 2N
 *     integral H_z     = -(2 / (j k s sin a)) (w(a - f) + w(a + f))
 *
 * Physical optics is the same with N = 1: on a lit face (f < pi) w becomes g(x) = cot(x / 2N) / 2N - cot(x / 2) / 2,
 * which is regular at x = 0, where the boundaries are. H_z at the edge is 2 / N, for physical optics 2. */
#include "render/scattering/field/edge_field_private.h"

#include <assert.h>
#include <stdlib.h>

/* ---- what a wedge scatters per length ------------------------------------------------------------------ */

/* Real part of the kernel: w of a shadowed face, g of a lit one. x is between -2 pi_rad and 2 pi_rad. */
static double complex kernel(double complex x, double n, bool lit)
{
    if (!lit) return 1 / (2 * n * ctan(x / (2 * n)));
    if (cabs(x) < 0.1) { /* the difference of two poles; the next term is 2e-8 x^9 */
        const double complex x2 = x * x;
        const double         m2 = 1 / (n * n), m4 = m2 * m2;
        const double complex high = (1 - m4 * m2) / 30240 + x2 * (1 - m4 * m4) / 1209600;
        return x * ((1 - m2) / 12 + x2 * ((1 - m4) / 720 + x2 * high));
    }
    return 1 / (2 * n * ctan(x / (2 * n))) - 1 / (2 * ctan(x / 2));
}

/* Sum and difference of w(a + f) and w(a - f); the sum over sin a too, which is regular at a = 0. */
typedef struct Strip {
    double difference;   /* w(a - f) - w(a + f) */
    double sum_over_sin; /* (w(a - f) + w(a + f)) / sin a */
} Strip;

/* below is 1 + m and above is 1 - m, both computed without cancellation. */
static Strip strip_integrals(double f, double n, bool lit, double below, double above)
{
    static const double h = 1e-30, pole = 1e-9, small = 1e-3;
    if (below < 0) { /* a = j b: w(a - f) is minus the conjugate of w(a + f) */
        const double         b = 2 * asinh(sqrt(-below / 2));
        const double complex w = kernel(f + I * b, n, lit);
        return (Strip){-2 * creal(w), 2 * cimag(w) / sinh(b)};
    }
    const double a = 2 * atan2(sqrt(below), sqrt(above));
    /* the poles that are left: lit, a + f = 2 pi; shadowed, a = f = pi */
    const double plus = creal(kernel(lit ? fmin(f + a, 2 * pi_rad - pole) : f + a, n, lit));
    const double minus = creal(kernel(lit ? f - a : fmax(f - a, pole), n, lit));
    if (a < small) {
        /* an even function of a: its value at 0 (a derivative by the complex step) and at j a give that at a to a^4 */
        const double at_0 = 2 * cimag(kernel(f + I * h, n, lit)) / h;
        const double at_ja = a > 0 ? 2 * cimag(kernel(f + I * a, n, lit)) / sinh(a) : at_0;
        return (Strip){-plus - minus, 2 * at_0 - at_ja};
    }
    return (Strip){-plus - minus, (plus - minus) / sqrt(below * above)};
}

/* Adds 4 pi D's vector per unit E_z and Z H_z of one face, before the parts along u_r are taken off. */
static void add_face(double out_e[3], double out_h[3], const double x[3], const double z[3], double f, double n,
                     const double d[3], const double u_r[3])
{
    const bool   lit = f < pi_rad;
    const double c = v3_dot(d, z), s2 = fmax(1 - c * c, 1e-14), s = sqrt(s2);
    double       graze[3], to[3];
    for (int i = 0; i < 3; i++) graze[i] = s * x[i] + c * z[i];
    v3_sub(to, graze, u_r);
    const double above = v3_dot(to, to) / (2 * s2), m = 1 - above;
    const Strip  strip = strip_integrals(f, n, lit, 2 - above, above);

    v3_add_scaled(out_e, out_e, 2 / s2 * strip.difference, z);
    /* K along the grazing ray does not radiate along it: take u_r from it before the product is taken, not after */
    const double along = above > 1e-24 ? 2 / s2 * strip.sum_over_sin : 0;
    const double edge = lit ? 2 - 2 / n : -2 / n;
    v3_add_scaled(out_h, out_h, along, to);
    v3_add_scaled(out_h, out_h, along * c * (m - 1) + c / s2 * edge, z);
}

double edge_angle(const WedgeFrame *wedge, const double u[3])
{
    static const double rounding = 1e-9;
    const double        opening = wedge->exterior_pi * pi_rad, at = atan2(v3_dot(u, wedge->y), v3_dot(u, wedge->x));
    const double        f = at < 0 ? at + 2 * pi_rad : at;
    if (f <= opening) return f;
    if (f > 2 * pi_rad - rounding) return 0;
    return f < opening + rounding ? opening : f;
}

void edge_fringe(double out[2][2], const WedgeFrame *wedge, const double u_t[3], const double t[2][3],
                 const double u_r[3], const double r[2][3])
{
    memset(out, 0, 4 * sizeof **out);
    const double n = wedge->exterior_pi, opening = n * pi_rad, f = edge_angle(wedge, u_t), c_t = v3_dot(u_t, wedge->z);
    if (f > opening || 1 - c_t * c_t < 1e-14) return;

    double d[3], x_2[3], z_2[3], by_e[2][3] = {{0}}, by_h[2][3] = {{0}};
    v3_scale(d, -1, u_t);
    v3_scale(x_2, cos(opening), wedge->x);
    v3_add_scaled(x_2, x_2, sin(opening), wedge->y);
    v3_scale(z_2, -1, wedge->z);
    add_face(by_e[0], by_h[0], wedge->x, wedge->z, f, n, d, u_r);
    add_face(by_e[1], by_h[1], x_2, z_2, opening - f, n, d, u_r);

    for (int p = 0; p < 2; p++) {
        double h[3], vector[3];
        v3_cross(h, d, t[p]);
        const double e_z = v3_dot(t[p], wedge->z), h_z = v3_dot(h, wedge->z);
        for (int i = 0; i < 3; i++) vector[i] = e_z * (by_e[0][i] - by_e[1][i]) + h_z * (by_h[0][i] - by_h[1][i]);
        for (int q = 0; q < 2; q++) {
            const double value = v3_dot(r[q], vector) / (4 * pi_rad);
            out[q][p] = fmin(fmax(value, -edge_fringe_limit), edge_fringe_limit);
        }
    }
}

/* ---- segments of edges: what antennas see of them, with linear paths ------------------------------------- */

static const double bend_rad = 0.02;  /* largest change of the sum of directions along a segment */
static const double curve_rad = 0.02; /* largest departure of k path from a line, at a segment's ends */
enum { samples_most = 4096, segments_most = 65536 };

/* What one pair of antennas sees. */
typedef struct View {
    const ScatterAntenna *antenna[2];
    double                basis[2][2][3]; /* h, v of each */
    const EdgeConfig     *config;
    void (*emit)(void *user, const EdgeSegment *segment);
    void *user;
} View;

static void point_along(double out[3], const Wedge *w, double share)
{
    for (int i = 0; i < 3; i++) out[i] = w->p[0][i] + share * (w->p[1][i] - w->p[0][i]);
}

/* Ratio of an antenna's distance from a point to its distance from the phase centre; path is as in scatter.h. */
static double distance_ratio(const ScatterAntenna *a, double path_m) { return 1 + path_m / a->range_m; }

static bool seen(const View *view, const Wedge *w, double share)
{
    double p[3], u[2][3];
    point_along(p, w, share);
    for (int a = 0; a < 2; a++) {
        scatter_path(u[a], view->antenna[a], p);
        if (edge_angle(&w->frame, u[a]) > w->frame.exterior_pi * pi_rad) return false;
    }
    if (!view->config->visible) return true;
    /* u is halfway between the faces, so that none of them hides anything that the edge sees */
    const double half = w->frame.exterior_pi * pi_rad / 2, clear_m = view->config->clear_m;
    v3_add_scaled(p, p, clear_m * cos(half), w->frame.x);
    v3_add_scaled(p, p, clear_m * sin(half), w->frame.y);
    return view->config->visible(view->config->user, p, 0) && view->config->visible(view->config->user, p, 1);
}

static void emit_segment(const View *view, const Wedge *w, int index, double middle, double length_m)
{
    EdgeSegment s = {.wedge = index, .part = w->part, .length_m = length_m};
    point_along(s.p, w, middle);
    double basis[2][2][3], spread = length_m;
    for (int a = 0; a < 2; a++) {
        const double path_m = scatter_path(s.u[a], view->antenna[a], s.p);
        s.path_m += path_m;
        const double along = v3_dot(s.u[a], w->frame.z), ratio = distance_ratio(view->antenna[a], path_m);
        s.slope -= along;
        spread /= ratio;
        /* the mean over the segment of what the path adds to its tangent */
        s.path_m += (1 - along * along) / (ratio * view->antenna[a]->range_m) * length_m * length_m / 24;
        for (int q = 0; q < 2; q++) { /* the antenna's own polarisation, across the direction from here */
            const double *e = view->basis[a][q];
            v3_add_scaled(basis[a][q], e, -v3_dot(e, s.u[a]), s.u[a]);
            v3_normalize(basis[a][q], basis[a][q]);
        }
    }
    double fringe[2][2];
    edge_fringe(fringe, &w->frame, s.u[0], basis[0], s.u[1], basis[1]);
    for (int q = 0; q < 2; q++)
        for (int p = 0; p < 2; p++) s.amplitude[q][p] = fringe[q][p] * spread;
    view->emit(view->user, &s);
}

/* Appends the stretch from .. to, which are shares of the length, as equal segments. */
static void emit_stretch(const View *view, const Wedge *w, int index, double from, double to, double edge_m)
{
    double p[3], u[3], bend_per_m = 0;
    for (int end = 0; end < 2; end++) { /* directions turn fastest at the end that is nearest */
        point_along(p, w, end ? to : from);
        double bend = 0;
        for (int a = 0; a < 2; a++) {
            const ScatterAntenna *antenna = view->antenna[a];
            const double          path_m = scatter_path(u, antenna, p);
            bend += 1 / (antenna->range_m + path_m);
        }
        bend_per_m = fmax(bend_per_m, bend);
    }
    const double length_m = (to - from) * edge_m;
    const double longest_m = fmin(bend_rad / bend_per_m, sqrt(8 * curve_rad / (view->config->k_per_m * bend_per_m)));
    const int    n = (int)fmin(fmax(ceil(length_m / longest_m), 1), segments_most);
    for (int i = 0; i < n; i++) emit_segment(view, w, index, from + (to - from) * (i + 0.5) / n, length_m / n);
}

static void each_segment(View *view, const Wedge *wedge, int count)
{
    assert(view->config->k_per_m > 0 && view->config->sample_m > 0);
    for (int a = 0; a < 2; a++) scatter_basis(view->basis[a][0], view->basis[a][1], view->antenna[a]->u);
    for (int i = 0; i < count; i++) {
        const Wedge *w = &wedge[i];
        double       along[3];
        v3_sub(along, w->p[1], w->p[0]);
        const double edge_m = v3_length(along);
        const int    samples = (int)fmin(fmax(ceil(edge_m / view->config->sample_m), 1), samples_most);
        int          first = -1; /* of the stretch that is seen */
        for (int k = 0; k <= samples; k++) {
            const bool now = k < samples && seen(view, w, (k + 0.5) / samples);
            if (now && first < 0) first = k;
            if (!now && first >= 0) {
                emit_stretch(view, w, i, (double)first / samples, (double)k / samples, edge_m);
                first = -1;
            }
        }
    }
}

static void add_segment(ScatterMatrix *out, const EdgeSegment *s, double k_per_m)
{
    const double         half = k_per_m * s->slope * s->length_m / 2;
    const double complex wave = edge_fade(s, k_per_m) * scatter_sinc(half) * cexp(-I * k_per_m * s->path_m);
    out->hh += s->amplitude[0][0] * wave;
    out->hv += s->amplitude[0][1] * wave;
    out->vh += s->amplitude[1][0] * wave;
    out->vv += s->amplitude[1][1] * wave;
}

void edge_segments_field(ScatterMatrix *out, const EdgeSegments *segments, double k_per_m)
{
    for (int i = 0; i < segments->count; i++) add_segment(out, &segments->segment[i], k_per_m);
}

typedef struct Sum {
    ScatterMatrix *out;
    double         k_per_m;
} Sum;

static void emit_sum(void *user, const EdgeSegment *s)
{
    Sum *sum = user;
    add_segment(sum->out, s, sum->k_per_m);
}

void edge_field(ScatterMatrix *out, const Wedge *wedge, int count, const ScatterAntenna *transmitter,
                const ScatterAntenna *receiver, const EdgeConfig *config)
{
    Sum  sum = {out, config->k_per_m};
    View view = {.antenna = {transmitter, receiver}, .config = config, .emit = emit_sum, .user = &sum};
    each_segment(&view, wedge, count);
}

typedef struct Keep {
    EdgeSegments *out;
    bool          full; /* memory ran out */
} Keep;

static void emit_keep(void *user, const EdgeSegment *s)
{
    Keep         *keep = user;
    EdgeSegments *out = keep->out;
    if (keep->full) return;
    assert(out->count < 1 << 30);
    if (out->count == out->capacity) {
        const int    capacity = out->capacity ? 2 * out->capacity : 64;
        EdgeSegment *more = realloc(out->segment, (size_t)capacity * sizeof *more);
        if (!more) {
            keep->full = true;
            return;
        }
        out->segment = more;
        out->capacity = capacity;
    }
    out->segment[out->count++] = *s;
}

Status edge_segments(EdgeSegments *out, const Wedge *wedge, int count, const ScatterAntenna *transmitter,
                     const ScatterAntenna *receiver, const EdgeConfig *config)
{
    const int before = out->count;
    Keep      keep = {.out = out};
    View      view = {.antenna = {transmitter, receiver}, .config = config, .emit = emit_keep, .user = &keep};
    each_segment(&view, wedge, count);
    if (!keep.full) return STATUS_OK;
    out->count = before;
    return STATUS_NO_MEMORY;
}

void edge_segments_destroy(EdgeSegments *segments)
{
    free(segments->segment);
    memset(segments, 0, sizeof *segments);
}
