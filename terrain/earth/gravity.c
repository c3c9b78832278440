/* terrain/earth/gravity.c: gravitation by zonal harmonics, and the accelerations of turning axes. */
#include "terrain/earth/gravity.h"

static const double mu_m3_s2 = 3.986004418e14, radius_m = 6378137;
/* of the level ellipsoid: they follow from its flattening and J2 */
static const double j2 = 1.08262982131e-3, j4 = -2.37091120053e-6, j6 = 6.08346498882e-9;

void earth_gravitation(double g_ecef_mps2[3], const double p_ecef[3])
{
    const double r2 = v3_dot(p_ecef, p_ecef), r = sqrt(r2), s = p_ecef[2] / r, s2 = s * s;
    const double q2 = radius_m * radius_m / r2, q4 = q2 * q2, q6 = q4 * q2;
    /* Legendre's P_n(s), its derivative, and (n + 1) P_n + s P_n' of the radial part */
    const double p2 = 0.5 * (3 * s2 - 1), d2 = 3 * s;
    const double p4 = ((35 * s2 - 30) * s2 + 3) / 8, d4 = s * (140 * s2 - 60) / 8;
    const double p6 = (((231 * s2 - 315) * s2 + 105) * s2 - 5) / 16, d6 = s * ((1386 * s2 - 1260) * s2 + 210) / 16;
    const double radial = j2 * q2 * (3 * p2 + s * d2) + j4 * q4 * (5 * p4 + s * d4) + j6 * q6 * (7 * p6 + s * d6);
    const double axial = j2 * q2 * d2 + j4 * q4 * d4 + j6 * q6 * d6;
    const double whole = mu_m3_s2 / r2;
    for (int k = 0; k < 3; k++) g_ecef_mps2[k] = whole * (radial - 1) * p_ecef[k] / r;
    g_ecef_mps2[2] -= whole * axial;
}

void earth_turning(double a_ecef_mps2[3], const double p_ecef[3], const double v_ecef_mps[3], double turn_rps)
{
    a_ecef_mps2[0] += turn_rps * (turn_rps * p_ecef[0] + 2 * v_ecef_mps[1]);
    a_ecef_mps2[1] += turn_rps * (turn_rps * p_ecef[1] - 2 * v_ecef_mps[0]);
}
