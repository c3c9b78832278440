/* render/radar/wedge_diffraction.c: fringe currents of a wedge's two faces, integrated in closed form.
 *
 * In face axes (x along the face, y its normal, z along the edge) let the incident wave travel along d, c = d.z, s =
 * sqrt(1 - c^2), and come from the angle f about the edge; N = exterior_pi. Fields vary as exp(-j k c z), and E_z, H_z
 * obey the two-dimensional wave equation with k s. On the face the current is K_x = H_z, K_z = -H_x, with H_x = (j / (k
 * s^2)) (dE_z/dy / Z - c dH_z/dx). The strip runs along g = s x + c z, so its far field in direction u needs integrals
 * of the two-dimensional solutions times exp(j k s m x), m = (u.g - c^2) / s^2 <= 1. Put m = -cos a (a real in 0 .. pi,
 * or imaginary below -1). Sommerfeld's integral for the wedge, integrated over x, is the difference of one integrand on
 * two lines 2 pi apart: the residues at a and -a between them are all that is left,
 *
 *     integral dE_z/dy = -(2/N) sin(f/N) / (cos(f/N) - cos(a/N)) = -2 (w(a - f) - w(a + f)),   w(x) = cot(x/2N) / 2N
 *     integral H_z     = -(2 / (j k s sin a)) (w(a - f) + w(a + f))
 *
 * Physical optics is the same with N = 1: on a lit face (f < pi) w becomes g(x) = cot(x / 2N) / 2N - cot(x / 2) / 2,
 * which is regular at x = 0, where the boundaries are. H_z at the edge is 2 / N, for physical optics 2. */
#include "render/radar/wedge_diffraction.h"

static const double pi = 3.14159265358979323846;

/* w of a shadowed face, g of a lit one; x between -2 pi and 2 pi, real part. */
static double complex kernel(double complex x, double n, bool lit)
{
    if (!lit) return 1 / (2 * n * ctan(x / (2 * n)));
    if (cabs(x) < 0.1) { /* the difference of two poles; the next term is 2e-8 x^9 */
        const double complex x2 = x * x;
        const double m2 = 1 / (n * n), m4 = m2 * m2;
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

/* below: 1 + m, above: 1 - m, both without cancellation. */
static Strip strip_integrals(double f, double n, bool lit, double below, double above)
{
    static const double h = 1e-30, pole = 1e-9, small = 1e-3;
    if (below < 0) { /* a = j b: w(a - f) is minus the conjugate of w(a + f) */
        const double b = 2 * asinh(sqrt(-below / 2));
        const double complex w = kernel(f + I * b, n, lit);
        return (Strip){-2 * creal(w), 2 * cimag(w) / sinh(b)};
    }
    const double a = 2 * atan2(sqrt(below), sqrt(above));
    /* the poles that are left: lit, a + f = 2 pi; shadowed, a = f = pi */
    const double plus = creal(kernel(lit ? fmin(f + a, 2 * pi - pole) : f + a, n, lit));
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
    const bool   lit = f < pi;
    const double c = v3_dot(d, z), s2 = fmax(1 - c * c, 1e-14), s = sqrt(s2);
    double graze[3], to[3];
    for (int i = 0; i < 3; i++) graze[i] = s * x[i] + c * z[i];
    v3_sub(to, graze, u_r);
    const double above = v3_dot(to, to) / (2 * s2), m = 1 - above;
    const Strip strip = strip_integrals(f, n, lit, 2 - above, above);

    v3_add_scaled(out_e, out_e, 2 / s2 * strip.difference, z);
    /* K along the grazing ray does not radiate along it: take u_r from it before the product is taken, not after */
    const double along = above > 1e-24 ? 2 / s2 * strip.sum_over_sin : 0;
    const double edge = lit ? 2 - 2 / n : -2 / n;
    v3_add_scaled(out_h, out_h, along, to);
    v3_add_scaled(out_h, out_h, along * c * (m - 1) + c / s2 * edge, z);
}

double wedge_angle(const WedgeFrame *wedge, const double u[3])
{
    static const double rounding = 1e-9;
    const double opening = wedge->exterior_pi * pi, at = atan2(v3_dot(u, wedge->y), v3_dot(u, wedge->x));
    const double f = at < 0 ? at + 2 * pi : at;
    if (f <= opening) return f;
    if (f > 2 * pi - rounding) return 0;
    return f < opening + rounding ? opening : f;
}

void wedge_fringe(double out[2][2], const WedgeFrame *wedge, const double u_t[3], const double t[2][3],
                  const double u_r[3], const double r[2][3])
{
    memset(out, 0, 4 * sizeof **out);
    const double n = wedge->exterior_pi, opening = n * pi, f = wedge_angle(wedge, u_t), c_t = v3_dot(u_t, wedge->z);
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
            const double value = v3_dot(r[q], vector) / (4 * pi);
            out[q][p] = fmin(fmax(value, -wedge_fringe_limit), wedge_fringe_limit);
        }
    }
}
