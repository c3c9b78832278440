/* render/radar/cloud_attenuation.c: P.840-9, eqs. 2 to 11, and the liquid water of fog. */
#include "render/radar/cloud_attenuation.h"

double complex water_permittivity(double f_ghz, double temp_k)
{
    if (!(f_ghz >= 1 && f_ghz <= 200 && temp_k >= 233.15 && temp_k <= 323.15)) return CMPLX(NAN, NAN);
    const double x = 300 / temp_k - 1;
    const double e0 = 77.66 + 103.3 * x, e1 = 0.0671 * e0, e2 = 3.52;
    const double fp = 20.20 - 146 * x + 316 * x * x, fs = 39.8 * fp; /* relaxation, GHz; least 3.3 */
    const double p = f_ghz / fp, s = f_ghz / fs;
    const double real = (e0 - e1) / (1 + p * p) + (e1 - e2) / (1 + s * s) + e2;
    const double imaginary = p * (e0 - e1) / (1 + p * p) + s * (e1 - e2) / (1 + s * s);
    return CMPLX(real, -imaginary);
}

double cloud_attenuation(double f_ghz, double temp_k)
{
    const double complex water = water_permittivity(f_ghz, temp_k);
    const double         eta = (2 + creal(water)) / -cimag(water);
    return 0.819 * f_ghz / (-cimag(water) * (1 + eta * eta));
}

double fog_liquid_g_m3(double visibility_m)
{
    if (!(visibility_m >= 10)) return NAN;
    if (visibility_m > 1000) return 0;
    const double extinction_per_km = log(50) / (1e-3 * visibility_m); /* ln 50: 2 % contrast */
    return pow(extinction_per_km / 144.7, 1 / 0.88);
}
