/* render/radar/edges.c: integrals along a target's edges: what is seen of them, in segments with linear paths. */
#include "render/radar/edges.h"

#include <assert.h>
#include <stdlib.h>

static const double pi = 3.14159265358979323846;
static const double bend_rad = 0.02;  /* largest change of the sum of directions along a segment */
static const double curve_rad = 0.02; /* largest departure of k path from a line, at a segment's ends */
enum { samples_most = 4096, segments_most = 65536 };

/* What one pair of antennas sees. */
typedef struct View {
    const ScatterAntenna *antenna[2];
    double                basis[2][2][3]; /* h, v of each */
    const EdgeConfig     *config;
    void                (*emit)(void *user, const EdgeSegment *segment);
    void                 *user;
} View;

static void point_along(double out[3], const Wedge *w, double share)
{
    for (int i = 0; i < 3; i++) out[i] = w->p[0][i] + share * (w->p[1][i] - w->p[0][i]);
}

/* Distance of an antenna from a point over that from the phase centre; path as in scatter.h. */
static double distance_ratio(const ScatterAntenna *a, double path_m)
{
    return 1 + path_m / a->range_m;
}

static bool seen(const View *view, const Wedge *w, double share)
{
    double p[3], u[2][3];
    point_along(p, w, share);
    for (int a = 0; a < 2; a++) {
        scatter_path(u[a], view->antenna[a], p);
        if (wedge_angle(&w->frame, u[a]) > w->frame.exterior_pi * pi) return false;
    }
    if (!view->config->visible) return true;
    /* halfway between the faces, whence none of them hides anything that the edge sees */
    const double half = w->frame.exterior_pi * pi / 2, clear_m = view->config->clear_m;
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
    wedge_fringe(fringe, &w->frame, s.u[0], basis[0], s.u[1], basis[1]);
    for (int q = 0; q < 2; q++)
        for (int p = 0; p < 2; p++) s.amplitude[q][p] = fringe[q][p] * spread;
    view->emit(view->user, &s);
}

/* The stretch from .. to (shares of the length) in equal segments. */
static void emit_stretch(const View *view, const Wedge *w, int index, double from, double to, double edge_m)
{
    double p[3], u[3], bend_per_m = 0;
    for (int end = 0; end < 2; end++) { /* directions turn fastest at the end that is nearest */
        point_along(p, w, end ? to : from);
        double bend = 0;
        for (int a = 0; a < 2; a++) {
            const ScatterAntenna *antenna = view->antenna[a];
            const double path_m = scatter_path(u, antenna, p);
            bend += 1 / (antenna->range_m + path_m);
        }
        bend_per_m = fmax(bend_per_m, bend);
    }
    const double length_m = (to - from) * edge_m;
    const double longest_m = fmin(bend_rad / bend_per_m, sqrt(8 * curve_rad / (view->config->k_per_m * bend_per_m)));
    const int n = (int)fmin(fmax(ceil(length_m / longest_m), 1), segments_most);
    for (int i = 0; i < n; i++) emit_segment(view, w, index, from + (to - from) * (i + 0.5) / n, length_m / n);
}

static void each_segment(View *view, const Wedge *wedge, int count)
{
    assert(view->config->k_per_m > 0 && view->config->sample_m > 0);
    for (int a = 0; a < 2; a++) scatter_basis(view->basis[a][0], view->basis[a][1], view->antenna[a]->u);
    for (int i = 0; i < count; i++) {
        const Wedge *w = &wedge[i];
        double along[3];
        v3_sub(along, w->p[1], w->p[0]);
        const double edge_m = v3_length(along);
        const int samples = (int)fmin(fmax(ceil(edge_m / view->config->sample_m), 1), samples_most);
        int first = -1; /* of the stretch that is seen */
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
    const double half = k_per_m * s->slope * s->length_m / 2;
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
    Keep *keep = user;
    EdgeSegments *out = keep->out;
    if (keep->full) return;
    assert(out->count < 1 << 30);
    if (out->count == out->capacity) {
        const int capacity = out->capacity ? 2 * out->capacity : 64;
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
    Keep keep = {.out = out};
    View view = {.antenna = {transmitter, receiver}, .config = config, .emit = emit_keep, .user = &keep};
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
