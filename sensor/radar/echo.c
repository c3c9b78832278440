/* sensor/radar/echo.c: see echo.h. */
#include "sensor/radar/echo.h"

#include "sensor/detector/transform.h"

#include <stdlib.h>

static const double light_mps = 299792458.0;

enum { width = 8, oversampling = 2 };
static const double beta = 2.30 * width; /* Barnett et al., equation 1.14, for twice the points */

struct EchoGrid {
    int        samples, points, pulses;
    double     wave_rad_m, step_rad_m;  /* of a metre of path: at the centre; a sample further */
    double     points_per_m;
    double    *grid;                    /* [pulses][points] complex */
    double    *correction;              /* [samples]: over the kernel's transform */
    Transform *transform;
};

/* |x| <= 1 is its support. */
static double kernel(double x)
{
    const double inside = 1 - x * x;
    return inside > 0 ? exp(beta * (sqrt(inside) - 1)) : 0;
}

/* Transform of the kernel at an angle of phase a grid point, by the midpoint rule: the kernel and its transform vanish at both ends to
 * e^-beta, so that 400 points leave 1e-9. */
static double kernel_transform(double rad_per_point)
{
    enum { points = 400 };
    double sum = 0;
    for (int i = 0; i < points; i++) {
        const double x = (i + 0.5) / points;
        sum += kernel(x) * cos(rad_per_point * x * width / 2);
    }
    return sum / points * width;
}

Status echo_grid_create(EchoGrid **out, int samples, int pulses, double centre_hz, double step_hz)
{
    if (samples < 8 || samples > 65536 || samples % 2 || pulses < 1 || pulses > 4096 || samples > (1 << 24) / pulses ||
        !(centre_hz > 0) || !(step_hz > 0))
        return STATUS_BAD_VALUE;
    EchoGrid *g = calloc(1, sizeof *g);
    if (!g) return STATUS_NO_MEMORY;
    g->samples = samples;
    g->points = oversampling * samples;
    g->pulses = pulses;
    g->wave_rad_m = 2 * pi_rad * centre_hz / light_mps;
    g->step_rad_m = 2 * pi_rad * step_hz / light_mps;
    g->points_per_m = step_hz * g->points / light_mps;
    g->grid = transform_alloc(2 * (size_t)pulses * (size_t)g->points);
    g->correction = malloc((size_t)samples * sizeof *g->correction);
    if (!g->grid || !g->correction ||
        transform_create(&g->transform, TRANSFORM_ROWS, pulses, g->points, g->grid, g->grid) != STATUS_OK) {
        echo_grid_destroy(g);
        return STATUS_NO_MEMORY;
    }
    for (int m = 0; m < samples; m++)
        g->correction[m] = 1 / kernel_transform(2 * pi_rad * (m - samples / 2) / g->points);
    echo_grid_clear(g);
    *out = g;
    return STATUS_OK;
}

void echo_grid_destroy(EchoGrid *g)
{
    if (!g) return;
    transform_destroy(g->transform);
    transform_free(g->grid);
    free(g->correction);
    free(g);
}

void echo_grid_clear(EchoGrid *g) { memset(g->grid, 0, 2 * (size_t)g->pulses * (size_t)g->points * sizeof *g->grid); }

/* Weights of the points from the first on that a path is spread over. */
static int spread(double weight[width], const EchoGrid *g, double path_m)
{
    const double at = path_m * g->points_per_m;
    const double first = ceil(at - width / 2.0);
    for (int i = 0; i < width; i++) weight[i] = kernel((first + i - at) / (width / 2.0));
    const double round = first - g->points * floor(first / g->points);
    return round < g->points ? (int)round : 0;
}

static void deposit(EchoGrid *g, int pulse, int first, const double weight[width], double complex a)
{
    double *row = g->grid + 2 * (size_t)pulse * (size_t)g->points;
    const double re = creal(a), im = cimag(a);
    for (int i = 0; i < width; i++) {
        int at = first + i;
        if (at >= g->points) at -= g->points;
        row[2 * at] += re * weight[i];
        row[2 * at + 1] += im * weight[i];
    }
}

void echo_add(EchoGrid *g, int pulse, double path_m, double complex amplitude)
{
    double    weight[width];
    const int first = spread(weight, g, path_m);
    deposit(g, pulse, first, weight, amplitude * cexp(-I * g->wave_rad_m * path_m));
}

void echo_add_train(EchoGrid *g, double path_m, double path_per_pulse_m, double complex amplitude)
{
    enum { restart = 64 }; /* phasors are turned by products, and made anew after so many: 1e-14 */
    double               weight[width];
    const int            first = spread(weight, g, path_m + 0.5 * (g->pulses - 1) * path_per_pulse_m);
    const double complex turn = cexp(-I * g->wave_rad_m * path_per_pulse_m);
    double complex       a = 0;
    for (int p = 0; p < g->pulses; p++) {
        a = p % restart ? a * turn : amplitude * cexp(-I * g->wave_rad_m * (path_m + p * path_per_pulse_m));
        deposit(g, p, first, weight, a);
    }
}

void echo_voltages(double complex *out, EchoGrid *g)
{
    transform_run(g->transform);
    for (int p = 0; p < g->pulses; p++) {
        const double *row = g->grid + 2 * (size_t)p * (size_t)g->points;
        for (int m = 0; m < g->samples; m++) {
            const int at = (m - g->samples / 2 + g->points) % g->points;
            out[(size_t)p * (size_t)g->samples + (size_t)m] = (row[2 * at] + I * row[2 * at + 1]) * g->correction[m];
        }
    }
    echo_grid_clear(g);
}
