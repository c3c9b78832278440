/* render/scattering/scatter.h: conventions of a target's scattered field, shared by all that computes a part of it.
 *
 * Time convention exp(+j w t). In the target's own frame (double, m), with the phase centre at its origin, a
 * transmitter at a_t and a receiver at a_r (a direction from the target where they are at infinity):
 *
 *     E_receiver = S E_incident exp(-j k R_r) / R_r,      E_incident: at the phase centre, were the target not there
 *     sigma_qp   = 4 pi |S_qp|^2                          m^2
 *
 * Paths are differences to that over the phase centre: a point p contributes exp(-j k path), path = (|p - a_t| -
 * |a_t|) + (|p - a_r| - |a_r|), which is -p.(u_t + u_r) at infinity. A positive path is farther away.
 *
 * Polarisation (backscatter alignment): u is the unit direction from the target to an antenna; h = z x u / |z x u|,
 * v = u x h. Transmitter and receiver each have this basis at their own u, so a sphere has S_hh = S_vv, S_hv = S_vh
 * = 0. h is the spherical phi, v is minus theta. Straight above and below, h is y. */
#ifndef RENDER_SCATTERING_SCATTER_H
#define RENDER_SCATTERING_SCATTER_H

#include "pitviper.h"

#include <complex.h>

static const double light_mps = 299792458.0;

typedef struct ScatterMatrix {
    double complex hh, hv, vh, vv; /* m; first index: received polarisation, second: transmitted */
} ScatterMatrix;

/* One antenna, seen from the target: the unit direction to it and its distance. A distance of INFINITY means a plane
 * wave. */
typedef struct ScatterAntenna {
    double u[3];
    double range_m;
} ScatterAntenna;

/* Whether an antenna is one: a unit direction, and a distance above 0. */
static inline bool scatter_antenna_is_good(const ScatterAntenna *a)
{
    return v3_is_finite(a->u) && fabs(v3_dot(a->u, a->u) - 1) < 1e-9 && a->range_m > 0;
}

/* The polarisation basis of an antenna in direction u. */
static inline void scatter_basis(double h[3], double v[3], const double u[3])
{
    const double across = sqrt(u[0] * u[0] + u[1] * u[1]);
    if (across > 1e-12) {
        h[0] = -u[1] / across, h[1] = u[0] / across, h[2] = 0;
    } else {
        h[0] = 0, h[1] = 1, h[2] = 0;
    }
    v3_cross(v, u, h);
}

/* Turns a matrix from a basis h, v to one whose first axis is along `right`, as far as that is across the line of
 * sight: for an antenna that is rolled. All are in one frame; right must not lie along the line of sight. */
static inline void scatter_turn(ScatterMatrix *s, const double h[3], const double v[3], const double right[3])
{
    const double along_h = v3_dot(right, h), along_v = v3_dot(right, v);
    const double n = sqrt(along_h * along_h + along_v * along_v);
    if (!(n > 0)) return;
    const double         c = along_h / n, w = along_v / n;
    const double complex hh = s->hh, hv = s->hv, vh = s->vh, vv = s->vv;
    s->hh = c * c * hh + c * w * (hv + vh) + w * w * vv;
    s->vv = w * w * hh - c * w * (hv + vh) + c * c * vv;
    s->hv = -c * w * hh + c * c * hv - w * w * vh + c * w * vv;
    s->vh = -c * w * hh - w * w * hv + c * c * vh + c * w * vv;
}

static inline double scatter_power(double complex s) { return creal(s) * creal(s) + cimag(s) * cimag(s); }

/* Share of the field that is left where its phase varies evenly over a stretch, by x from the middle to an end. */
static inline double scatter_sinc(double x) { return fabs(x) < 1e-4 ? 1 - x * x / 6 : sin(x) / x; }

/* |p - a| - |a| of an antenna at a, m, and the unit direction from p to it. To a rounding of |p|, at any range: the
 * difference of squares over the sum of lengths, where lengths alone would lose |a|'s rounding. */
static inline double scatter_path(double u_p[3], const ScatterAntenna *antenna, const double p[3])
{
    const double r_m = antenna->range_m, along_m = v3_dot(p, antenna->u);
    if (isinf(r_m)) {
        memcpy(u_p, antenna->u, 3 * sizeof *u_p);
        return -along_m;
    }
    double to[3];
    for (int i = 0; i < 3; i++) to[i] = antenna->u[i] * r_m - p[i];
    const double d_m = v3_length(to);
    for (int i = 0; i < 3; i++) u_p[i] = to[i] / d_m;
    return (v3_dot(p, p) - 2 * along_m * r_m) / (d_m + r_m);
}

#endif
