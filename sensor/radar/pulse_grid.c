/* sensor/radar/pulse_grid.c: see pulse_grid.h. */
#include "sensor/radar/pulse_grid.h"

#include "sensor/detector/transform.h"

#include <stdlib.h>

enum { width = 8, oversampling = 2, rows_least = 16, chunk = 4096, block = 256 };
static const double beta = 2.30 * width; /* Barnett et al., equation 1.14, for twice the points */

/* Where a point goes: the first row and column of its patch, and their weights. */
typedef struct Spread {
    int    row, column;
    double down[width], along[width];
} Spread;

struct PulseGrid {
    int        samples, pulses, rows, columns, stride; /* rows, columns: of the grid; stride: columns and a margin */
    double    *grid[interval_channels];   /* [rows][stride] complex; columns beyond the last are the first again */
    double    *turned[interval_channels]; /* [columns][rows] complex */
    double    *lines[interval_channels];  /* [pulses][columns] complex */
    Transform *over_rows[interval_channels], *over_columns[interval_channels];
    double    *of_sample, *of_pulse;      /* over the kernel's transform */
    Spread    *spread;                    /* [chunk] */
    bool       used;
};

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

static double *corrections(int count, int points)
{
    double *of = malloc((size_t)count * sizeof *of);
    for (int i = 0; i < count && of; i++) of[i] = 1 / kernel_transform(2 * pi_rad * (i - count / 2) / points);
    return of;
}

static size_t plane(const PulseGrid *g) { return 2 * (size_t)g->rows * (size_t)g->stride; }

void pulse_grid_forget(PulseGrid *g)
{
    for (int c = 0; c < interval_channels && g->used; c++) memset(g->grid[c], 0, plane(g) * sizeof *g->grid[c]);
    g->used = false;
}

Status pulse_grid_create(PulseGrid **out, int samples, int pulses)
{
    PulseGrid *g = calloc(1, sizeof *g);
    if (!g) return STATUS_NO_MEMORY;
    g->samples = samples, g->pulses = pulses;
    g->rows = oversampling * pulses < rows_least ? rows_least : oversampling * pulses;
    g->columns = oversampling * samples;
    g->stride = g->columns + width;
    g->of_sample = corrections(samples, g->columns);
    g->of_pulse = corrections(pulses, g->rows);
    g->spread = malloc(chunk * sizeof *g->spread);
    Status status = g->of_sample && g->of_pulse && g->spread ? STATUS_OK : STATUS_NO_MEMORY;
    for (int c = 0; c < interval_channels && status == STATUS_OK; c++) {
        g->grid[c] = transform_alloc(plane(g));
        g->turned[c] = transform_alloc(2 * (size_t)g->rows * (size_t)g->columns);
        g->lines[c] = transform_alloc(2 * (size_t)g->pulses * (size_t)g->columns);
        if (!g->grid[c] || !g->turned[c] || !g->lines[c]) status = STATUS_NO_MEMORY;
        if (status == STATUS_OK) status = transform_create(&g->over_rows[c], TRANSFORM_ROWS, g->columns, g->rows, g->turned[c], g->turned[c]);
        if (status == STATUS_OK) status = transform_create(&g->over_columns[c], TRANSFORM_ROWS, g->pulses, g->columns, g->lines[c], g->lines[c]);
    }
    if (status != STATUS_OK) {
        pulse_grid_destroy(g);
        return status;
    }
    g->used = true;
    pulse_grid_forget(g);
    *out = g;
    return STATUS_OK;
}

void pulse_grid_destroy(PulseGrid *g)
{
    if (!g) return;
    for (int c = 0; c < interval_channels; c++) {
        transform_destroy(g->over_rows[c]);
        transform_destroy(g->over_columns[c]);
        transform_free(g->grid[c]);
        transform_free(g->turned[c]);
        transform_free(g->lines[c]);
    }
    free(g->of_sample);
    free(g->of_pulse);
    free(g->spread);
    free(g);
}

/* ---- adding ----------------------------------------------------------------------------------------- */

static int spread(double weight[width], double turns, int points)
{
    const double at = turns * points;
    const double first = ceil(at - width / 2.0);
    for (int i = 0; i < width; i++) weight[i] = kernel((first + i - at) / (width / 2.0));
    const double round = first - points * floor(first / points);
    return round < points ? (int)round : 0;
}

typedef struct Job {
    PulseGrid        *grid;
    const PulsePoint *point;
    int               count;
} Job;

static void spread_block(void *user, int worker, int task)
{
    const Job *job = user;
    PulseGrid *g = job->grid;
    const int  end = (task + 1) * block < job->count ? (task + 1) * block : job->count;
    (void)worker;
    for (int i = task * block; i < end; i++) {
        g->spread[i].row = spread(g->spread[i].down, job->point[i].per_pulse, g->rows);
        g->spread[i].column = spread(g->spread[i].along, job->point[i].per_sample, g->columns);
    }
}

/* A channel has its grid to itself. */
static void add_channel(void *user, int worker, int channel)
{
    const Job *job = user;
    PulseGrid *g = job->grid;
    double    *grid = g->grid[channel];
    (void)worker;
    for (int i = 0; i < job->count; i++) {
        const PulsePoint *p = &job->point[i];
        const Spread     *s = &g->spread[i];
        if (p->amplitude[channel] == 0) continue;
        /* the middle of the pulses is half a one before that of their count */
        const double   half = -pi_rad * p->per_pulse, re = cos(half), im = sin(half);
        const double   a = creal(p->amplitude[channel]), b = cimag(p->amplitude[channel]);
        const double   turned[2] = {a * re - b * im, a * im + b * re};
        double         wave[2 * width];
        for (int k = 0; k < width; k++) wave[2 * k] = turned[0] * s->along[k], wave[2 * k + 1] = turned[1] * s->along[k];
        for (int y = 0; y < width; y++) {
            const int    row = s->row + y < g->rows ? s->row + y : (s->row + y) % g->rows;
            double      *to = grid + 2 * ((size_t)row * (size_t)g->stride + (size_t)s->column);
            const double w = s->down[y];
            for (int k = 0; k < 2 * width; k++) to[k] += w * wave[k];
        }
    }
}

static void run(Pool *pool, int tasks, void (*task)(void *user, int worker, int number), void *user)
{
    if (pool) pool_run(pool, tasks, task, user);
    else for (int t = 0; t < tasks; t++) task(user, 0, t);
}

void pulse_grid_add(PulseGrid *g, const PulsePoint *point, int count, Pool *pool)
{
    g->used = g->used || count > 0;
    for (int first = 0; first < count; first += chunk) {
        Job job = {g, point + first, count - first < chunk ? count - first : chunk};
        run(pool, (job.count + block - 1) / block, spread_block, &job);
        run(pool, interval_channels, add_channel, &job);
    }
}

/* ---- the sum ---------------------------------------------------------------------------------------- */

typedef struct Sum {
    PulseGrid      *grid;
    double complex *sample;
} Sum;

static void sum_channel(void *user, int worker, int channel)
{
    enum { tile = 16 };
    const Sum *sum = user;
    PulseGrid *g = sum->grid;
    double    *grid = g->grid[channel], *turned = g->turned[channel], *lines = g->lines[channel];
    (void)worker;
    for (int y = 0; y < g->rows; y++) {
        double *row = grid + 2 * (size_t)y * (size_t)g->stride;
        for (int k = 0; k < 2 * width; k++) row[k] += row[2 * g->columns + k];
    }
    for (int x0 = 0; x0 < g->columns; x0 += tile) /* columns is even, from 16 */
        for (int y = 0; y < g->rows; y++)
            for (int x = x0; x < x0 + tile && x < g->columns; x++) {
                const double *from = grid + 2 * ((size_t)y * (size_t)g->stride + (size_t)x);
                double       *to = turned + 2 * ((size_t)x * (size_t)g->rows + (size_t)y);
                to[0] = from[0], to[1] = from[1];
            }
    transform_run(g->over_rows[channel]);
    for (int x0 = 0; x0 < g->columns; x0 += tile)
        for (int p = 0; p < g->pulses; p++) {
            const int at = (p - g->pulses / 2 + g->rows) % g->rows;
            for (int x = x0; x < x0 + tile && x < g->columns; x++) {
                const double *from = turned + 2 * ((size_t)x * (size_t)g->rows + (size_t)at);
                double       *to = lines + 2 * ((size_t)p * (size_t)g->columns + (size_t)x);
                to[0] = from[0] * g->of_pulse[p], to[1] = from[1] * g->of_pulse[p];
            }
        }
    transform_run(g->over_columns[channel]);
    for (int p = 0; p < g->pulses; p++) {
        const double   *from = lines + 2 * (size_t)p * (size_t)g->columns;
        double complex *to = sum->sample + ((size_t)channel * (size_t)g->pulses + (size_t)p) * (size_t)g->samples;
        for (int m = 0; m < g->samples; m++) {
            const int at = (m - g->samples / 2 + g->columns) % g->columns;
            to[m] = CMPLX(from[2 * at] * g->of_sample[m], from[2 * at + 1] * g->of_sample[m]);
        }
    }
}

void pulse_grid_sum(double complex *sample, PulseGrid *g, Pool *pool)
{
    Sum sum = {g, sample};
    run(pool, interval_channels, sum_channel, &sum);
    pulse_grid_forget(g);
}
