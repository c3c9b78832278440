/* sensor/radar/echo.c: see echo.h. */
#include "sensor/radar/echo.h"

#include "render/radar/scatter.h"
#include "sensor/detector/transform.h"

#include <stdlib.h>

enum { width = 8, oversampling = 2 };
static const double beta = 2.30 * width; /* Barnett et al., equation 1.14, for twice the points */

struct EchoGrid {
    int        samples, points, pulses;
    double     wave_rad_m;              /* of a metre of path, at the centre */
    double     points_per_m;
    double    *grid;                    /* [channels][pulses][points] complex */
    double    *correction;              /* [samples]: over the kernel's transform */
    Transform *transform;
};

static size_t grid_size(const EchoGrid *g) { return 2 * (size_t)interval_channels * (size_t)g->pulses * (size_t)g->points; }

/* |x| <= 1 is its support. */
static double kernel(double x)
{
    const double inside = 1 - x * x;
    return inside > 0 ? exp(beta * (sqrt(inside) - 1)) : 0;
}

/* Transform of the kernel at an angle of phase a grid point, by the midpoint rule: the kernel and its transform
 * vanish at both ends to e^-beta, so that 400 points leave 1e-9. */
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

void echo_forget(EchoGrid *g) { memset(g->grid, 0, grid_size(g) * sizeof *g->grid); }

Status echo_grid_create(EchoGrid **out, const Waveform *wave)
{
    const int    samples = wave->samples, pulses = wave->pulses;
    const double step_hz = wave->bandwidth_hz / samples;
    if (samples < 8 || samples > 65536 || samples % 2 || pulses < 1 || pulses > 4096 || samples > (1 << 22) / pulses ||
        !(wave->centre_hz > 0) || !(step_hz > 0))
        return STATUS_BAD_VALUE;
    EchoGrid *g = calloc(1, sizeof *g);
    if (!g) return STATUS_NO_MEMORY;
    g->samples = samples;
    g->points = oversampling * samples;
    g->pulses = pulses;
    g->wave_rad_m = 2 * pi_rad * wave->centre_hz / light_mps;
    g->points_per_m = step_hz * g->points / light_mps;
    g->grid = transform_alloc(grid_size(g));
    g->correction = malloc((size_t)samples * sizeof *g->correction);
    if (!g->grid || !g->correction ||
        transform_create(&g->transform, TRANSFORM_ROWS, interval_channels * pulses, g->points, g->grid, g->grid) != STATUS_OK) {
        echo_grid_destroy(g);
        return STATUS_NO_MEMORY;
    }
    for (int m = 0; m < samples; m++)
        g->correction[m] = 1 / kernel_transform(2 * pi_rad * (m - samples / 2) / g->points);
    echo_forget(g);
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

/* Weights of the points from the first on that a path is spread over. */
static int spread(double weight[width], const EchoGrid *g, double path_m)
{
    const double at = path_m * g->points_per_m;
    const double first = ceil(at - width / 2.0);
    for (int i = 0; i < width; i++) weight[i] = kernel((first + i - at) / (width / 2.0));
    const double round = first - g->points * floor(first / g->points);
    return round < g->points ? (int)round : 0;
}

static void deposit(double *row, int points, int first, const double weight[width], double complex a)
{
    const double re = creal(a), im = cimag(a);
    for (int i = 0; i < width; i++) {
        int at = first + i;
        if (at >= points) at -= points;
        row[2 * at] += re * weight[i];
        row[2 * at + 1] += im * weight[i];
    }
}

typedef struct Job {
    EchoGrid   *grid;
    const Echo *echo;
    int         count;
} Job;

enum { block_pulses = 8 }; /* of a task, which has them to itself */

static void add_block(void *user, int worker, int task)
{
    const Job *job = user;
    EchoGrid  *g = job->grid;
    const int  first_pulse = task * block_pulses, end = first_pulse + block_pulses < g->pulses ? first_pulse + block_pulses : g->pulses;
    const double middle = 0.5 * (g->pulses - 1);
    (void)worker;
    for (int k = 0; k < job->count; k++) {
        const Echo          *e = &job->echo[k];
        double               weight[width];
        const int            first = spread(weight, g, e->path_m);
        const double complex turn = cexp(-I * g->wave_rad_m * e->path_per_pulse_m);
        double complex       phase = cexp(-I * g->wave_rad_m * (e->path_m + (first_pulse - middle) * e->path_per_pulse_m));
        for (int p = first_pulse; p < end; p++) {
            for (int c = 0; c < interval_channels; c++)
                if (e->amplitude[c] != 0)
                    deposit(g->grid + 2 * ((size_t)c * (size_t)g->pulses + (size_t)p) * (size_t)g->points, g->points, first, weight,
                            e->amplitude[c] * phase);
            phase *= turn;
        }
    }
}

void echo_add(EchoGrid *g, const Echo *echo, int count, Pool *pool)
{
    Job       job = {g, echo, count};
    const int tasks = (g->pulses + block_pulses - 1) / block_pulses;
    if (pool) pool_run(pool, tasks, add_block, &job);
    else for (int t = 0; t < tasks; t++) add_block(&job, 0, t);
}

void echo_sum(double complex *sample, EchoGrid *g)
{
    transform_run(g->transform);
    for (int row = 0; row < interval_channels * g->pulses; row++) {
        const double *from = g->grid + 2 * (size_t)row * (size_t)g->points;
        for (int m = 0; m < g->samples; m++) {
            const int at = (m - g->samples / 2 + g->points) % g->points;
            sample[(size_t)row * (size_t)g->samples + (size_t)m] = (from[2 * at] + I * from[2 * at + 1]) * g->correction[m];
        }
    }
    echo_forget(g);
}
