/* Fringe coefficients of wedges against solutions of the wedge that do not share their derivation.
 *
 * On the diffraction cone: Keller's coefficients (J. Opt. Soc. Am. 52, 1962) less physical optics'. Off it: the face
 * currents as sums of Bessel functions (Bowman, Senior, Uslenghi, "Electromagnetic and Acoustic Scattering by Simple
 * Shapes", ch. 6), integrated term by term: integral of J_v(x) exp(-p x) dx = q^v / sqrt(p^2 + 1), of J_v(x) exp(-p x)
 * / x: q^v / v, with q = sqrt(p^2 + 1) - p. The sums are geometric series; for -1 < m < 1 they stand for their limit
 * without losses. labels: physics */
#include "tests/check.h"
#include "render/scattering/field/edge_field_private.h"

static const double pi = 3.14159265358979323846;

/* Wedge with its edge along z and face 1 along x. */
static WedgeFrame plain(double exterior_pi)
{
    return (WedgeFrame){.x = {1, 0, 0}, .y = {0, 1, 0}, .z = {0, 0, 1}, .exterior_pi = exterior_pi};
}

static void direction(double u[3], double angle, double cosine)
{
    const double s = sqrt(1 - cosine * cosine);
    u[0] = s * cos(angle), u[1] = s * sin(angle), u[2] = cosine;
}

/* Polarisations with no H_z (0) and no E_z (1); u: towards the antenna. Both fields' z components are positive. */
static void soft_hard(double e[2][3], const double u[3])
{
    const double z[3] = {0, 0, 1};
    v3_add_scaled(e[0], z, -u[2], u);
    v3_normalize(e[0], e[0]);
    v3_cross(e[1], u, e[0]); /* for a wave along -u: -u x e[1] = e[0] */
}

/* The same for a wave along u: u x e[1] = e[0]. */
static void soft_hard_out(double e[2][3], const double u[3])
{
    soft_hard(e, u);
    v3_scale(e[1], -1, e[1]);
}

static void fringe(double out[2][2], const WedgeFrame *w, const double u_t[3], const double u_r[3])
{
    double t[2][3], r[2][3];
    soft_hard(t, u_t);
    soft_hard_out(r, u_r);
    edge_fringe(out, w, u_t, t, u_r, r);
}

/* Keller's coefficients in the units of edge_fringe: soft, hard. */
static void keller(double out[2], double n, double f, double from)
{
    const double c = cos(pi / n), common = sin(pi / n) / (2 * pi * n);
    const double minus = 1 / (c - cos((f - from) / n)), plus = 1 / (c - cos((f + from) / n));
    out[0] = common * (minus - plus);
    out[1] = common * (minus + plus);
}

/* Physical optics of the lit faces, -(j k / 2 pi) r . (n x (d x t)) integrated over the strip that starts at the edge
 * and runs along the face as the diffracted ray does: x (1, c / s) in face axes. */
static void optics(double out[2][2], const WedgeFrame *w, const double u_t[3], const double u_r[3])
{
    double t[2][3], r[2][3], d[3], sum[3];
    soft_hard(t, u_t);
    soft_hard_out(r, u_r);
    v3_scale(d, -1, u_t);
    v3_add(sum, u_t, u_r);
    memset(out, 0, 4 * sizeof **out);
    const double opening = w->exterior_pi * pi;
    for (int face = 0; face < 2; face++) {
        const double at = face ? opening : 0, side = face ? -1 : 1;
        const double x[3] = {cos(at), sin(at), 0}, n[3] = {-side * sin(at), side * cos(at), 0};
        const double strip[3] = {x[0], x[1], d[2] / sqrt(1 - d[2] * d[2])};
        if (v3_dot(d, n) >= 0) continue;
        for (int p = 0; p < 2; p++) {
            double h[3], current[3];
            v3_cross(h, d, t[p]);
            v3_cross(current, n, h);
            for (int q = 0; q < 2; q++) out[q][p] += v3_dot(r[q], current) / (2 * pi * v3_dot(sum, strip));
        }
    }
}

/* In 0 .. 1, evenly spread over i in each of four streams together. */
static double uniform(uint32_t i, int stream)
{
    static const double step[] = {0.6180339887498949, 0.7548776662466927, 0.5698402909980532, 0.8191725133961645};
    return fmod(0.5 + i * step[stream], 1);
}

static void test_cone(void **state)
{
    (void)state;
    const double exterior_pi[] = {2, 1.5, 1.75, 1.1, 1.99, 4.0 / 3};
    double       worst = 0;
    int          checked = 0;
    for (int w = 0; w < 6; w++) {
        const double     n = exterior_pi[w];
        const WedgeFrame wedge = plain(n);
        for (uint32_t i = 0; i < 4000; i++) {
            const double from = n * pi * uniform(i, 0), f = n * pi * uniform(i, 1), c = 1.9 * uniform(i, 2) - 0.95;
            /* away from boundaries, where both references are large and their difference loses digits */
            if (fabs(cos(f) + cos(from)) < 0.02 || fabs(cos(n * pi - f) + cos(n * pi - from)) < 0.02 ||
                fabs(cos(pi / n) - cos((f - from) / n)) < 0.01 || fabs(cos(pi / n) - cos((f + from) / n)) < 0.01)
                continue;
            double u_t[3], u_r[3], exact[2], lit[2][2], got[2][2];
            direction(u_t, from, c);
            direction(u_r, f, -c);
            keller(exact, n, f, from);
            optics(lit, &wedge, u_t, u_r);
            fringe(got, &wedge, u_t, u_r);
            for (int q = 0; q < 2; q++)
                for (int p = 0; p < 2; p++) worst = fmax(worst, fabs(got[q][p] + lit[q][p] - (q == p ? exact[q] : 0)));
            checked++;
        }
    }
    printf("cone: %d directions, largest difference %.1e\n", checked, worst);
    CHECK(checked > 15000);
    CHECK_NEAR(worst, 0, 1e-11);
}

/* Integrals over a face of dE_z/dy and of j k_t H_z, times exp(j k_t m x): 4 / N times the sum of w^i sin(i f / N), and
 * 2 j / (N sqrt(p^2 + 1)) times 1 + 2 the sum of w^i cos(i f / N), p = -j m, w = (j q)^(1 / N); both sums are
 * geometric. */
static void bessel_integrals(double out[2], double n, double from, double m)
{
    const double complex root = m < -1 ? I * sqrt(m * m - 1) : sqrt(1 - m * m), w = cpow(I * (root + I * m), 1 / n);
    const double complex below = 1 - 2 * w * cos(from / n) + w * w;
    const double complex soft = 4 / n * w * sin(from / n) / below, hard = 2 * I / (n * root) * (1 - w * w) / below;
    out[0] = creal(soft);
    out[1] = creal(hard);
    CHECK_NEAR(cimag(soft), 0, 1e-9);
    CHECK_NEAR(cimag(hard), 0, 1e-9);
}

static void test_off_cone(void **state)
{
    (void)state;
    const double exterior_pi[] = {2, 1.5, 1.2};
    double       worst[2] = {0};
    int          checked[2] = {0};
    for (int w = 0; w < 3; w++) {
        const double     n = exterior_pi[w];
        const WedgeFrame wedge = plain(n);
        for (uint32_t i = 0; i < 4000; i++) {
            double       u_t[3], u_r[3], t[2][3], r[2][3], got[2][2];
            const double from = n * pi * uniform(i, 0);
            direction(u_t, from, 1.9 * uniform(i, 2) - 0.95);
            direction(u_r, 2 * pi * uniform(i, 1), 1.9 * uniform(i, 3) - 0.95);
            soft_hard(t, u_t);
            soft_hard_out(r, u_r);
            const double   s = sqrt(1 - u_t[2] * u_t[2]);
            double complex sum[2][2] = {{0}};
            bool           clear = true, steep = true;
            for (int face = 0; face < 2 && clear; face++) {
                const double f = face ? n * pi - from : from, side = face ? -1 : 1, c = -side * u_t[2];
                const double x[3] = {face ? cos(n * pi) : 1, face ? sin(n * pi) : 0, 0}, z[3] = {0, 0, side};
                const double m = (s * v3_dot(u_r, x) + c * (v3_dot(u_r, z) - c)) / (s * s);
                clear = fabs(m + cos(f)) > 0.05 && fabs(f - pi) > 0.1 && fabs(m + 1) > 0.02 && m < 0.97;
                steep = steep && m < -1;
                if (!clear) break;
                double total[2];
                bessel_integrals(total, n, f, m);
                const bool   lit = f < pi;
                const double fringe_e = total[0] + (lit ? 2 * sin(f) / (m + cos(f)) : 0);
                const double fringe_h = total[1] + (lit ? 2 / (m + cos(f)) : 0); /* times j k s */
                const double at_edge = 2 / n - (lit ? 2 : 0);
                for (int p = 0; p < 2; p++) {
                    const double e_z = p == 0 ? side * s : 0, h_z = p == 1 ? side * s : 0;
                    /* k K_x, k K_z; dH_z/dx by parts */
                    const double complex k_x = fringe_h / (I * s) * h_z;
                    const double complex k_z = -I / (s * s) * (fringe_e * e_z - c * (-at_edge - m * fringe_h) * h_z);
                    for (int q = 0; q < 2; q++)
                        sum[q][p] += -I / (4 * pi) * (v3_dot(r[q], x) * k_x + v3_dot(r[q], z) * k_z);
                }
            }
            if (!clear) continue;
            edge_fringe(got, &wedge, u_t, t, u_r, r);
            for (int q = 0; q < 2; q++)
                for (int p = 0; p < 2; p++) worst[steep] = fmax(worst[steep], cabs(got[q][p] - sum[q][p]));
            checked[steep]++;
        }
    }
    printf("off the cone: %d steep, largest difference %.1e; %d others, %.1e\n", checked[1], worst[1], checked[0],
           worst[0]);
    CHECK(checked[0] > 2000 && checked[1] > 200);
    CHECK_NEAR(worst[1], 0, 1e-11);
    CHECK_NEAR(worst[0], 0, 1e-11);
}

/* The whole coefficient on the cone, fringe and physical optics, is the same when transmitter and receiver change
 * places. */
static void test_reciprocity(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < 500; i++) {
        const double     n = 1.05 + 0.95 * uniform(i, 3), from = n * pi * uniform(i, 0), f = n * pi * uniform(i, 1);
        const WedgeFrame wedge = plain(n);
        double           u[2][3], got[2][2][2], lit[2][2][2];
        if (fabs(cos(f) + cos(from)) < 0.02 || fabs(cos(n * pi - f) + cos(n * pi - from)) < 0.02) continue;
        direction(u[0], from, 0.3);
        direction(u[1], f, -0.3);
        for (int k = 0; k < 2; k++) {
            fringe(got[k], &wedge, u[k], u[!k]);
            optics(lit[k], &wedge, u[k], u[!k]);
        }
        for (int q = 0; q < 2; q++) CHECK_NEAR(got[0][q][q] + lit[0][q][q], got[1][q][q] + lit[1][q][q], 1e-10);
    }
}

/* Edge-on from the front, electric field along the edge: sigma = L^2 / pi (Knott, Shaeffer, Tuley, "Radar Cross
 * Section"). */
static void test_knife_edge(void **state)
{
    (void)state;
    const WedgeFrame wedge = plain(2);
    double           u[3], got[2][2];
    direction(u, pi, 0);
    fringe(got, &wedge, u, u);
    CHECK_NEAR(4 * pi * got[0][0] * got[0][0], 1 / pi, 1e-12);
    CHECK_NEAR(got[1][1], 0, 1e-12); /* and nothing across it */
}

/* Through reflection and shadow boundaries, on them, and where the integral's variable turns imaginary. */
static void test_boundaries(void **state)
{
    (void)state;
    const double step[] = {1e-4, 1e-6, 1e-8, 1e-10, 1e-13, 0, -1e-13, -1e-10, -1e-8, -1e-6, -1e-4};
    const double exterior_pi[] = {2, 1.5, 1.3};
    for (int w = 0; w < 3; w++) {
        const double     n = exterior_pi[w];
        const WedgeFrame wedge = plain(n);
        for (uint32_t i = 0; i < 60; i++) {
            const double from = pi * (0.05 + 0.9 * uniform(i, 0));
            if (fabs(n * pi - from - pi) < 0.05) continue; /* along face 2, whose shadow boundary is singular */
            for (int which = 0; which < 4; which++) {
                double at[11][2][2], u_t[3], u_r[3];
                for (int k = 0; k < 11; k++) {
                    const double c = 0.4;
                    direction(u_t, from, c);
                    /* reflection, shadow, backscatter at m = -1, grazing away from the wedge on the cone */
                    const double f[] = {pi - from, pi + from, from, 0};
                    if (which == 2) { /* m = cos f - 2 c^2 / s^2 about -1: cos f = 2 c^2 / s^2 - 1 */
                        const double angle = acos(2 * c * c / (1 - c * c) - 1) + step[k];
                        direction(u_t, angle, c);
                        direction(u_r, angle, c);
                    } else {
                        direction(u_r, f[which] + step[k], -c);
                    }
                    fringe(at[k], &wedge, u_t, u_r);
                }
                if (which == 3) { /* H along the edge: bounded, two-sided limits differ; the mean at the middle */
                    CHECK_NEAR(at[5][1][1], (at[3][1][1] + at[7][1][1]) / 2, 1e-5);
                    CHECK_NEAR(at[3][1][1], at[1][1][1], 1e-4);
                    CHECK_NEAR(at[7][1][1], at[9][1][1], 1e-4);
                    continue;
                }
                for (int k = 0; k < 11; k++)
                    for (int q = 0; q < 2; q++) CHECK_NEAR(at[k][q][q], at[5][q][q], 60 * fabs(step[k]) + 1e-9);
            }
        }
    }
}

/* Faces exchanged: the same wedge. */
static void test_faces(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < 500; i++) {
        const double     n = 1.01 + 0.99 * uniform(i, 3);
        const WedgeFrame wedge = plain(n);
        WedgeFrame       turned = {.x = {cos(n * pi), sin(n * pi), 0}, .z = {0, 0, -1}, .exterior_pi = n};
        v3_cross(turned.y, turned.z, turned.x);
        double u_t[3], u_r[3], a[2][2], b[2][2];
        direction(u_t, n * pi * uniform(i, 0), 1.8 * uniform(i, 1) - 0.9);
        direction(u_r, 2 * pi * uniform(i, 2), 1.8 * uniform(i, 3) - 0.9);
        fringe(a, &wedge, u_t, u_r);
        fringe(b, &turned, u_t, u_r);
        for (int k = 0; k < 4; k++) CHECK_NEAR(a[k / 2][k % 2], b[k / 2][k % 2], 1e-9 * (1 + fabs(a[k / 2][k % 2])));
    }
}

/* Nearly flat: physical optics is nearly exact. Growth is as the turn of the surface. */
static void test_flat(void **state)
{
    (void)state;
    double u[3], got[2][2];
    for (int k = 1; k < 40; k++) {
        direction(u, pi * k / 40, 0.1);
        const WedgeFrame wedge = plain(1 + 1e-7);
        fringe(got, &wedge, u, u);
        CHECK_NEAR(got[0][0], 0, 1e-5);
        CHECK_NEAR(got[1][1], 0, 1e-5);
    }
}

/* Every combination of directions along faces, edges, boundaries and near them: finite, and within the limit that is
 * stated; in backscatter well within. */
static void test_finite(void **state)
{
    (void)state;
    const double exterior_pi[] = {1 + 1e-9, 1.25, 1.5, 2 - 1e-9, 2};
    const double off[] = {0, 1e-15, -1e-15, 1e-9, -1e-9, 1e-4, -1e-4};
    double       worst = 0;
    for (int w = 0; w < 5; w++) {
        const double     n = exterior_pi[w];
        const double     angle[] = {0, pi / 4, pi / 2, 3 * pi / 4, pi, n * pi - pi, n * pi / 2, n * pi, 2 * pi};
        const double     cosine[] = {0, 0.3, -0.3, 1, -1, 1 - 1e-15, 1 - 1e-12, 1e-9 - 1, 0.9999, -0.9999};
        const WedgeFrame wedge = plain(n);
        double           u[9 * 7 * 10][3], t[9 * 7 * 10][2][3], got[2][2];
        int              count = 0;
        for (int a = 0; a < 9 * 7; a++)
            for (int c = 0; c < 10; c++) {
                direction(u[count], angle[a / 7] + off[a % 7], cosine[c]);
                scatter_basis(t[count][0], t[count][1], u[count]);
                count++;
            }
        for (int i = 0; i < count; i++)
            for (int j = 0; j < count; j++) {
                edge_fringe(got, &wedge, u[i], t[i], u[j], t[j]);
                for (int k = 0; k < 4; k++) {
                    CHECK(fabs(got[k / 2][k % 2]) <= edge_fringe_limit);
                    if (i == j) worst = fmax(worst, fabs(got[k / 2][k % 2]));
                }
            }
    }
    printf("backscatter: largest coefficient %.6f\n", worst);
    CHECK_NEAR(worst, 1 / (2 * pi), 1e-6); /* the knife edge's */
}

/* Straight along either face, a rounding to either side: outside, with the value beside it. */
static void test_along_faces(void **state)
{
    (void)state;
    const WedgeFrame wedge = plain(1.5);
    for (int face = 0; face < 2; face++) {
        double       at[5][2][2], u[3];
        const double off[] = {-1e-12, 0, 1e-12, face ? -1e-6 : 1e-6, face ? 1e-3 : -1e-3};
        for (int k = 0; k < 5; k++) {
            direction(u, face * 1.5 * pi + off[k], 0.1);
            fringe(at[k], &wedge, u, u);
        }
        for (int k = 0; k < 3; k++) CHECK_NEAR(at[k][1][1], at[3][1][1], 1e-5);
        CHECK(fabs(at[3][1][1]) > 0.05 && at[4][1][1] == 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cone),       cmocka_unit_test(test_off_cone),   cmocka_unit_test(test_reciprocity),
        cmocka_unit_test(test_knife_edge), cmocka_unit_test(test_boundaries), cmocka_unit_test(test_faces),
        cmocka_unit_test(test_flat),       cmocka_unit_test(test_finite),     cmocka_unit_test(test_along_faces),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
