/* render/radar/mie_sphere.c: see mie_sphere.h. */
#include "render/radar/mie_sphere.h"

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
        const double next = (2 * n - 1) / x, psi_n = next * psi - psi_before, chi_n = next * chi - chi_before;
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
