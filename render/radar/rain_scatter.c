/* render/radar/rain_scatter.c: see rain_scatter.h. */
#include "render/radar/rain_scatter.h"

#include "render/radar/cloud_attenuation.h"
#include "render/radar/mie_sphere.h"
#include "render/radar/scatter.h"

static const double largest_mm = 8;

bool rain_scatter(RainScatter *out, double f_ghz, double temp_k, double rain_mm_h)
{
    *out = (RainScatter){0};
    if (!(f_ghz >= 1 && f_ghz <= 200 && temp_k >= 273.15 && temp_k <= 323.15 && rain_mm_h >= 0 && rain_mm_h <= 300))
        return false;
    if (rain_mm_h == 0) return true;
    const double complex water = water_permittivity(f_ghz, temp_k);
    const double wavelength_m = 1e-9 * light_mps / f_ghz, slope = 4.1 * pow(rain_mm_h, -0.21);
    const double step_mm = largest_mm / rain_sizes;
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
