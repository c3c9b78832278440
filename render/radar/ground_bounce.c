/* render/radar/ground_bounce.c: legs by way of the ground, and the sum of the four paths. */
#include "render/radar/ground_bounce.h"

const double ground_least_coherence = 1e-3;

/* The antenna's axes for a wave from it whose way back is u. */
static void antenna_axes(double axis[2][3], const double u[3], const double right[3])
{
    double h[3], v[3];
    v3_add_scaled(axis[0], right, -v3_dot(right, u), u);
    if (!v3_normalize(axis[0], axis[0])) {
        scatter_basis(h, v, u);
        memcpy(axis[0], h, sizeof h);
    }
    v3_cross(axis[1], u, axis[0]);
}

void ground_leg_direct(GroundLeg *out, const ScatterAntenna *antenna, const double right[3])
{
    double basis[2][3], axis[2][3];
    scatter_basis(basis[0], basis[1], antenna->u);
    antenna_axes(axis, antenna->u, right);
    *out = (GroundLeg){.spread = 1, .coherence = 1};
    for (int p = 0; p < 2; p++)
        for (int a = 0; a < 2; a++) out->m[p][a] = v3_dot(basis[p], axis[a]);
}

bool ground_leg_image(GroundLeg *out, const ScatterAntenna *antenna, const ScatterAntenna *image, double extra_m,
                      const GroundPlane *plane, const GroundSurface *surface, double k, const double right[3])
{
    double         u[3], basis[2][3], axis[2][3], d[3], across[3], before[3], after[3], d_out[3];
    double complex te, tm;
    ground_mirror(u, image->u, plane);
    const double sine = v3_dot(plane->n, u);
    if (!(sine > 0)) return false;
    ground_reflection(&te, &tm, surface, k, fmin(sine, 1));
    scatter_basis(basis[0], basis[1], image->u);
    antenna_axes(axis, u, right);
    v3_scale(d, -1, u);
    v3_scale(d_out, -1, image->u);
    v3_cross(across, d, plane->n);
    if (!(v3_length(across) > 1e-9)) memcpy(across, axis[0], sizeof across); /* straight down: any */
    v3_normalize(across, across);
    v3_cross(before, d, across);
    v3_cross(after, d_out, across);
    *out = (GroundLeg){.extra_m = extra_m, .spread = isinf(antenna->range_m) ? 1 : antenna->range_m / image->range_m,
                       .coherence = fmax(cabs(te), cabs(tm))};
    for (int p = 0; p < 2; p++)
        for (int a = 0; a < 2; a++)
            out->m[p][a] = te * (v3_dot(axis[a], across) * v3_dot(basis[p], across)) +
                           tm * (v3_dot(axis[a], before) * v3_dot(basis[p], after));
    return true;
}

void ground_through(ScatterMatrix *out, const ScatterMatrix *s, const GroundLeg *receive, const GroundLeg *transmit)
{
    const double complex in[2][2] = {{s->hh, s->hv}, {s->vh, s->vv}};
    double complex       half[2][2], through[2][2];
    for (int q = 0; q < 2; q++)
        for (int a = 0; a < 2; a++) half[q][a] = in[q][0] * transmit->m[0][a] + in[q][1] * transmit->m[1][a];
    for (int b = 0; b < 2; b++)
        for (int a = 0; a < 2; a++) through[b][a] = receive->m[0][b] * half[0][a] + receive->m[1][b] * half[1][a];
    *out = (ScatterMatrix){through[0][0], through[0][1], through[1][0], through[1][1]};
}

static void add(ScatterMatrix *to, const ScatterMatrix *s, double complex share)
{
    to->hh += share * s->hh, to->hv += share * s->hv, to->vh += share * s->vh, to->vv += share * s->vv;
}

void ground_sum(ScatterMatrix *out, const GroundFields *s, const GroundLeg *direct, const GroundLeg *image, double k)
{
    ScatterMatrix        sum, part;
    const double complex e = image->spread * cexp(-I * k * image->extra_m);
    ground_through(&sum, &s->direct, direct, direct);
    ground_through(&part, &s->once, image, direct);
    add(&sum, &part, e);
    add(&sum, &(ScatterMatrix){part.hh, part.vh, part.hv, part.vv}, e); /* the other way round: the transpose */
    ground_through(&part, &s->twice, image, image);
    add(&sum, &part, e * e);
    *out = sum;
}

void ground_reflection_point(double p[3], const ScatterAntenna *image, const GroundPlane *plane)
{
    v3_scale(p, plane->height_m / fmax(-v3_dot(plane->n, image->u), 1e-9), image->u);
}
