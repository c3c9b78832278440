/* render/scattering/clutter/volume_scatter.c: spheres by Mie's series, rain as a sum over drops, and clouds of chaff.
 */
#include "render/scattering/clutter/volume_scatter.h"
#include "render/scattering/paths/attenuation.h"
#include "render/scattering/scatter.h"

enum { inner_most = 2160 };

MieSphere mie_sphere(double radius_m, double complex permittivity, double wavelength_m)
{
    const MieSphere      none = {NAN, NAN, NAN};
    const double         x = 2 * pi_rad * radius_m / wavelength_m;
    const double complex m = csqrt(conj(permittivity)), mx = m * x; /* the series is in exp(-j w t) */
    if (!(x > 0 && x <= 200 && cabs(mx) <= 2000)) return none;

    const int      terms = (int)(x + 4 * cbrt(x) + 2), beyond = (int)(8 * cbrt(cabs(mx)));
    const int      first = (int)fmax(terms, cabs(mx)) + 16 + beyond;
    double complex within[inner_most];
    within[first] = 0;
    for (int n = first; n > 0; n--) within[n - 1] = n / mx - 1 / (within[n] + n / mx);

    double         psi_before = cos(x), psi = sin(x), chi_before = -sin(x), chi = cos(x); /* orders -1 and 0 */
    double complex back = 0;
    double         scattered = 0, taken = 0;
    for (int n = 1; n <= terms; n++) {
        const double         next = (2 * n - 1) / x, psi_n = next * psi - psi_before, chi_n = next * chi - chi_before;
        const double complex xi = CMPLX(psi, -chi), xi_n = CMPLX(psi_n, -chi_n);
        const double complex electric = within[n] / m + n / x, magnetic = within[n] * m + n / x;
        const double complex a = (electric * psi_n - psi) / (electric * xi_n - xi);
        const double complex b = (magnetic * psi_n - psi) / (magnetic * xi_n - xi);
        const double         weight = 2 * n + 1;
        back += (n % 2 ? -weight : weight) * (a - b);
        scattered += weight * (creal(a * conj(a)) + creal(b * conj(b)));
        taken += weight * creal(a + b);
        psi_before = psi, psi = psi_n;
        chi_before = chi, chi = chi_n;
    }
    const double unit_m2 = wavelength_m * wavelength_m / (2 * pi_rad);
    return (MieSphere){0.5 * unit_m2 * creal(back * conj(back)), unit_m2 * scattered, unit_m2 * taken};
}

/* ---- rain --------------------------------------------------------------------------------------- */

static const double largest_mm = 8;

bool rain_scatter(RainScatter *out, double f_ghz, double temp_k, double rain_mm_h)
{
    *out = (RainScatter){0};
    if (!(f_ghz >= 1 && f_ghz <= 200 && temp_k >= 273.15 && temp_k <= 323.15 && rain_mm_h >= 0 && rain_mm_h <= 300))
        return false;
    if (rain_mm_h == 0) return true;
    const double complex water = water_permittivity(f_ghz, temp_k);
    const double         wavelength_m = 1e-9 * light_mps / f_ghz, slope = 4.1 * pow(rain_mm_h, -0.21);
    const double         step_mm = largest_mm / rain_sizes;
    for (int i = 0; i < rain_sizes; i++) {
        const double    mm = (i + 0.5) * step_mm, drops = 8000 * exp(-slope * mm) * step_mm;
        const MieSphere one = mie_sphere(0.5e-3 * mm, water, wavelength_m);
        out->back_1_m += drops * one.back_m2;
        out->extinction_1_m += drops * one.extinction_m2;
        out->z_mm6_m3 += drops * pow(mm, 6);
        out->share[i] = out->back_1_m;
    }
    for (int i = 0; i < rain_sizes; i++) out->share[i] /= out->back_1_m;
    return true;
}

double rain_fall_mps(const RainScatter *rain, double u)
{
    int low = 0, high = rain_sizes - 1;
    while (low < high) {
        const int middle = (low + high) / 2;
        if (rain->share[middle] < u) low = middle + 1;
        else high = middle;
    }
    const double before = low > 0 ? rain->share[low - 1] : 0, own = rain->share[low] - before;
    const double mm = (low + (own > 0 ? clamp((u - before) / own, 0, 1) : 0.5)) * largest_mm / rain_sizes;
    return fmax(9.65 - 10.3 * exp(-0.6 * mm), 0);
}

/* ---- chaff -------------------------------------------------------------------------------------- */

double chaff_radius_m(double age_s)
{
    static const double thrown_m = 1, bloomed_m = 8, bloom_s = 1, spread_mps = 0.3;
    const double        t_s = fmax(age_s, 0);
    return thrown_m + (bloomed_m - thrown_m) * -expm1(-t_s / bloom_s) + spread_mps * t_s;
}

/* The matrix is drawn as hh = a + b, vv = a - b, hv = c, with <|a|^2> = 2/3 and <|b|^2> = <|c|^2> = 1/3 of sigma / 4
 * pi. */
void chaff_scatter(ScatterMatrix *out, double sigma_m2, const double n[6])
{
    const double unit = sqrt(sigma_m2 / (8 * pi_rad)), large = unit * sqrt(2.0 / 3), small = unit * sqrt(1.0 / 3);
    const double complex a = large * CMPLX(n[0], n[1]), b = small * CMPLX(n[2], n[3]), c = small * CMPLX(n[4], n[5]);
    *out = (ScatterMatrix){.hh = a + b, .vv = a - b, .hv = c, .vh = c};
}

double chaff_column_1_m2(double dipoles, double radius_m, const double centre_m[3], const double d[3], double range_m)
{
    const double nearest_m = v3_dot(centre_m, d), scale = 1 / (radius_m * sqrt(2));
    const double away2 = fmax(v3_dot(centre_m, centre_m) - nearest_m * nearest_m, 0);
    const double along = 0.5 * (erf((range_m - nearest_m) * scale) - erf(-nearest_m * scale));
    return dipoles / (2 * pi_rad * radius_m * radius_m) * exp(-away2 * scale * scale) * along;
}
