/* render/scattering/field/currents_private.h: what the physical-optics currents of a flat facet radiate; for ray
 * tubes and for whole faces, which add up to one field. */
#ifndef RENDER_SCATTERING_FIELD_CURRENTS_PRIVATE_H
#define RENDER_SCATTERING_FIELD_CURRENTS_PRIVATE_H

#include "render/scattering/radar_surfaces.h"
#include "render/scattering/scatter.h"

typedef struct Field {
    double re[3], im[3];
} Field;

static inline void field_scale(Field *e, double s)
{
    v3_scale(e->re, s, e->re);
    v3_scale(e->im, s, e->im);
}

/* times j */
static inline void field_quarter(Field *e)
{
    const Field was = *e;
    v3_scale(e->re, -1, was.im);
    v3_scale(e->im, 1, was.re);
}

/* 2 (n.E) n - E: the field that a perfect mirror returns. */
static inline void mirror_vector(double out[3], const double e[3], const double n[3])
{
    const double along = 2 * v3_dot(n, e);
    for (int c = 0; c < 3; c++) out[c] = along * n[c] - e[c];
}

/* a += g (e . from) to */
static inline void add_part(Field *a, double complex g, const Field *e, const double from[3], const double to[3])
{
    const double re = v3_dot(e->re, from), im = v3_dot(e->im, from);
    const double x = creal(g) * re - cimag(g) * im, y = creal(g) * im + cimag(g) * re;
    v3_add_scaled(a->re, a->re, x, to);
    v3_add_scaled(a->im, a->im, y, to);
}

/* Computes the field that a surface of normal n mirrors from direction d into d_out. */
static inline void reflect_field(Field *out, const Field *e, const RadarSurface *surface, double complex te,
                                 double complex tm, const double n[3], const double d[3], const double d_out[3])
{
    double across[3], in[3], away[3];
    if (surface->kind == RADAR_METAL) {
        mirror_vector(out->re, e->re, n);
        mirror_vector(out->im, e->im, n);
        if (surface->rough_m > 0) field_scale(out, creal(tm));
        return;
    }
    v3_cross(across, d, n);
    if (v3_length(across) < 1e-9) { /* any direction across */
        const double aside[3] = {fabs(d[0]) < 0.5, fabs(d[0]) >= 0.5, 0};
        v3_cross(across, d, aside);
    }
    v3_normalize(across, across);
    v3_cross(in, d, across);
    v3_cross(away, d_out, across);
    *out = (Field){{0}, {0}};
    add_part(out, te, e, across, across);
    add_part(out, tm, e, in, away);
}

/* Computes the far field of the currents towards s, twice, over -jk/4pi, without its component along s: n x (d x E +
 * d_out x E') - (n x (E + E')) x s. */
static inline void radiate(double out[3], const double e[3], const double e_out[3], const double n[3],
                           const double d[3], const double d_out[3], const double s[3])
{
    double h[3], h_out[3], j[3], whole[3], m[3], ms[3];
    v3_cross(h, d, e);
    v3_cross(h_out, d_out, e_out);
    v3_add(h, h, h_out);
    v3_cross(j, n, h);
    v3_add(whole, e, e_out);
    v3_cross(m, n, whole);
    v3_cross(ms, m, s);
    v3_sub(out, j, ms);
}

static inline void mirror_direction(double out[3], const double d[3], const double n[3])
{
    v3_add_scaled(out, d, -2 * v3_dot(n, d), n);
    v3_normalize(out, out);
}

/* Gives the polarisation of the antenna across a ray of direction d. */
static inline void polarise(double out[2][3], const ScatterAntenna *antenna, const double d[3])
{
    scatter_basis(out[0], out[1], antenna->u);
    if (isinf(antenna->range_m)) return;
    for (int q = 0; q < 2; q++) {
        v3_add_scaled(out[q], out[q], -v3_dot(out[q], d), d);
        v3_normalize(out[q], out[q]);
    }
}

/* Twice the far field of a facet's currents towards s, per area and over -jk/4pi, as the receiver takes it: real and
 * imaginary of hh, hv, vh, vv. e: incident, of transmitted h and v; n: against d. */
static inline void facet_radiates(double out[8], const Field e[2], const RadarSurface *surface, double complex te,
                                  double complex tm, const double n[3], const double d[3], const double s[3],
                                  const ScatterAntenna *rx)
{
    double d_out[3], q[2][3], away[3];
    mirror_direction(d_out, d, n);
    v3_scale(away, -1, s);
    polarise(q, rx, away);
    for (int p = 0; p < 2; p++) {
        Field  e_out;
        double re[3], im[3];
        reflect_field(&e_out, &e[p], surface, te, tm, n, d, d_out);
        radiate(re, e[p].re, e_out.re, n, d, d_out, s);
        radiate(im, e[p].im, e_out.im, n, d, d_out, s);
        for (int r = 0; r < 2; r++) {
            out[4 * r + 2 * p] = v3_dot(q[r], re);
            out[4 * r + 2 * p + 1] = v3_dot(q[r], im);
        }
    }
}

#endif
