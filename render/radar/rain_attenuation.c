/* render/radar/rain_attenuation.c: the fits of P.838-3, Tables 1 to 4. */
#include "render/radar/rain_attenuation.h"

/* Sum of a exp(-((x - b) / c)^2) over its terms, plus m x + n; x is the logarithm to 10 of the frequency in GHz. */
typedef struct RainFit {
    int terms;
    double a[5], b[5], c[5], m, n;
} RainFit;

static const RainFit k_h = {4,
                            {-5.33980, -0.35351, -0.23789, -0.94158},
                            {-0.10008, 1.26970, 0.86036, 0.64552},
                            {1.13098, 0.45400, 0.15354, 0.16817},
                            -0.18961,
                            0.71147};
static const RainFit k_v = {4,
                            {-3.80595, -3.44965, -0.39902, 0.50167},
                            {0.56934, -0.22911, 0.73042, 1.07319},
                            {0.81061, 0.51059, 0.11899, 0.27195},
                            -0.16398,
                            0.63297};
static const RainFit alpha_h = {5,
                                {-0.14318, 0.29591, 0.32177, -5.37610, 16.1721},
                                {1.82442, 0.77564, 0.63773, -0.96230, -3.29980},
                                {-0.55187, 0.19822, 0.13164, 1.47828, 3.43990},
                                0.67849,
                                -1.95537};
static const RainFit alpha_v = {5,
                                {-0.07771, 0.56727, -0.20238, -48.2991, 48.5833},
                                {2.33840, 0.95545, 1.14520, 0.791669, 0.791459},
                                {-0.76284, 0.54039, 0.26809, 0.116226, 0.116479},
                                -0.053739,
                                0.83433};

static double fit_at(const RainFit *fit, double x)
{
    double sum = fit->m * x + fit->n;
    for (int i = 0; i < fit->terms; i++) {
        const double u = (x - fit->b[i]) / fit->c[i];
        sum += fit->a[i] * exp(-u * u);
    }
    return sum;
}

bool rain_coefficients(double *k, double *alpha, double f_ghz, double elevation_rad, double tilt_rad)
{
    *k = *alpha = NAN;
    if (!(f_ghz >= 1 && f_ghz <= 1000 && fabs(elevation_rad) <= 0.5 * pi_rad && isfinite(tilt_rad))) return false;
    const double x = log10(f_ghz), kh = pow(10, fit_at(&k_h, x)), kv = pow(10, fit_at(&k_v, x));
    const double ah = fit_at(&alpha_h, x), av = fit_at(&alpha_v, x);
    const double level = cos(elevation_rad), mix = level * level * cos(2 * tilt_rad);
    *k = 0.5 * (kh + kv + (kh - kv) * mix);
    *alpha = (kh * ah + kv * av + (kh * ah - kv * av) * mix) / (2 * *k);
    return true;
}

double rain_attenuation(double f_ghz, double rain_mm_h, double elevation_rad, double tilt_rad)
{
    double k, alpha;
    if (!(rain_mm_h >= 0 && rain_mm_h <= 300) || !rain_coefficients(&k, &alpha, f_ghz, elevation_rad, tilt_rad))
        return NAN;
    return k * pow(rain_mm_h, alpha);
}
