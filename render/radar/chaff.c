/* render/radar/chaff.c: see chaff.h. */
#include "render/radar/chaff.h"

double chaff_radius_m(double age_s)
{
    static const double thrown_m = 1, bloomed_m = 8, bloom_s = 1, spread_mps = 0.3;
    const double        t_s = fmax(age_s, 0);
    return thrown_m + (bloomed_m - thrown_m) * -expm1(-t_s / bloom_s) + spread_mps * t_s;
}

/* hh = a + b, vv = a - b, hv = c: <|a|^2> = 2/3, <|b|^2> = <|c|^2> = 1/3 of sigma / 4 pi. */
void chaff_scatter(ScatterMatrix *out, double sigma_m2, const double n[6])
{
    const double         unit = sqrt(sigma_m2 / (8 * pi_rad)), large = unit * sqrt(2.0 / 3), small = unit * sqrt(1.0 / 3);
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
