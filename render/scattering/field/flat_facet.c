/* render/scattering/field/flat_facet.c: a square metre of a flat surface by physical optics. */
#include "render/scattering/field/flat_facet.h"

#include "render/scattering/field/currents_private.h"

void flat_facet_field(ScatterMatrix *per_m2, const RadarSurface *surface, double k, const double n[3],
                      const ScatterAntenna *tx, const ScatterAntenna *rx)
{
    double         d[3], e[2][3], out[8];
    Field          field[2];
    double complex te = -1, tm = 1;
    *per_m2 = (ScatterMatrix){0};
    const double cosine = v3_dot(n, tx->u);
    if (!(cosine > 0 && v3_dot(n, rx->u) > 0)) return;
    v3_scale(d, -1, tx->u);
    scatter_basis(e[0], e[1], tx->u);
    for (int p = 0; p < 2; p++) {
        memcpy(field[p].re, e[p], sizeof e[p]);
        memset(field[p].im, 0, sizeof field[p].im);
    }
    fresnel_surface(&te, &tm, surface, k, fmin(1, cosine));
    const ScatterAntenna far = {{rx->u[0], rx->u[1], rx->u[2]}, INFINITY};
    facet_radiates(out, field, surface, te, tm, n, d, rx->u, &far);
    const double complex unit = -I * k / (4 * pi_rad);
    per_m2->hh = unit * CMPLX(out[0], out[1]);
    per_m2->hv = unit * CMPLX(out[2], out[3]);
    per_m2->vh = unit * CMPLX(out[4], out[5]);
    per_m2->vv = unit * CMPLX(out[6], out[7]);
}
