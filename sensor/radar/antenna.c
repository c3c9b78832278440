/* sensor/radar/antenna.c: patterns in closed form, their widths, and directions from their ratios. */
#include "sensor/radar/antenna_private.h"

/* The series below about the main lobe: to the last term, below 1e-19. */
enum { terms = 20 };
static const double near_u = 5;
static const double over[terms + 5] = {0,        1.0,      1.0 / 2,  1.0 / 3,  1.0 / 4,  1.0 / 5,  1.0 / 6,
                                       1.0 / 7,  1.0 / 8,  1.0 / 9,  1.0 / 10, 1.0 / 11, 1.0 / 12, 1.0 / 13,
                                       1.0 / 14, 1.0 / 15, 1.0 / 16, 1.0 / 17, 1.0 / 18, 1.0 / 19, 1.0 / 20,
                                       1.0 / 21, 1.0 / 22, 1.0 / 23, 1.0 / 24};

/* 2^m m! J_m(u) / u^m, m up to 4: sum of (-u^2 / 4)^k m! / (k! (m + k)!), whose terms are small about the main lobe. */
static double lambda(int m, double u)
{
    if (fabs(u) < near_u) {
        const double x = -0.25 * u * u;
        double       sum = 1;
        for (int k = terms; k > 0; k--) sum = 1 + x * over[k] * over[m + k] * sum;
        return sum;
    }
    double scale = 1;
    for (int k = 1; k <= m; k++) scale *= 2 * k / u;
    return scale * jn(m, u);
}

/* Those of m and m + 1 side by side, since each term waits for the one before it. */
static void lambda_pair(double out[2], int m, double u)
{
    if (!(fabs(u) < near_u)) {
        out[0] = lambda(m, u), out[1] = lambda(m + 1, u);
        return;
    }
    const double x = -0.25 * u * u;
    double       first = 1, second = 1;
    for (int k = terms; k > 0; k--) {
        const double by = x * over[k];
        first = 1 + by * over[m + k] * first;
        second = 1 + by * over[m + 1 + k] * second;
    }
    out[0] = first, out[1] = second;
}

double antenna_u_per_sine(const Antenna *a) { return pi_rad * a->diameter_m / a->wavelength_m; }

double antenna_peak_gain(const Antenna *a)
{
    const double n = a->taper, reach = antenna_u_per_sine(a);
    return (2 * n + 1) / ((n + 1) * (n + 1)) * reach * reach;
}

AntennaGain antenna_gain(const Antenna *a, double cos_right, double cos_down)
{
    const int    n = a->taper;
    const double sine2 = cos_right * cos_right + cos_down * cos_down, reach = antenna_u_per_sine(a);
    if (!(sine2 < 1)) return (AntennaGain){0, 0, 0};
    const double u = reach * sqrt(sine2), peak = sqrt(antenna_peak_gain(a));
    double       of[2];
    lambda_pair(of, n + 1, u);
    const double slope = peak * sqrt(n + 1.0) / (n + 2) * of[1];
    return (AntennaGain){peak * of[0], slope * reach * cos_right, slope * reach * cos_down};
}

/* Finds where a function that falls with u passes value, between low and high. */
static double solve(int m, double scale, double low, double high, double value, double (*of)(int, double, double))
{
    for (int i = 0; i < 60; i++) {
        const double middle = 0.5 * (low + high);
        if (of(m, scale, middle) > value) low = middle;
        else high = middle;
    }
    return 0.5 * (low + high);
}

static double sum_power(int m, double scale, double u) { return scale * lambda(m, u) * lambda(m, u); }

static double width_rad(const Antenna *a, double power)
{
    return 2 * asin(fmin(solve(a->taper + 1, 1, 0, 3, power, sum_power) / antenna_u_per_sine(a), 1));
}

double antenna_width_rad(const Antenna *a) { return width_rad(a, 0.5); }

double antenna_two_way_width_rad(const Antenna *a) { return width_rad(a, sqrt(0.5)); }

/* Minus the ratio of the patterns, which falls as the ratio rises without bound up to the sum's first zero. */
static double minus_ratio(int n, double scale, double u) { return -scale * u * lambda(n + 2, u) / lambda(n + 1, u); }

void antenna_direction(double *cos_right, double *cos_down, const Antenna *a, double right, double down)
{
    static const double first_zero[] = {3.831705970207512, 5.135622301840683, 6.380161895923984}; /* of J_1, J_2, J_3 */
    const int           n = a->taper;
    const double        ratio = hypot(right, down);
    if (!(ratio > 0)) {
        *cos_right = *cos_down = 0;
        return;
    }
    const double u = solve(n, sqrt(n + 1.0) / (n + 2), 0, first_zero[n] * (1 - 1e-12), -ratio, minus_ratio);
    *cos_right = u / antenna_u_per_sine(a) * (right / ratio);
    *cos_down = u / antenna_u_per_sine(a) * (down / ratio);
}
