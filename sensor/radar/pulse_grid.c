/* sensor/radar/pulse_grid.c: the kernel of gridding, and the grid over delay and Doppler. */
#include "sensor/radar/echo_private.h"
#include "sensor/detector/transform.h"

#include <pthread.h>
#include <stdlib.h>

/* ---- the kernel ------------------------------------------------------------------------------------ */

enum { width = gridding_width };
static const double beta = 2.30 * width; /* Barnett et al., equation 1.14, for twice the points */

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

double *gridding_corrections(int count, int points)
{
    double *of = malloc((size_t)count * sizeof *of);
    for (int i = 0; i < count && of; i++) of[i] = 1 / kernel_transform(2 * pi_rad * (i - count / 2) / points);
    return of;
}

/* ---- weights as polynomials --------------------------------------------------------------------------- */

/* Weight i as a function of where its grid point lies, t = 0 .. 1 from the start of its stretch of the kernel: a
 * polynomial in s = 2 t - 1 through the kernel at Chebyshev's points, off by up to 1.6e-8 (sixteen exponentials a point
 * would be most of a sum's time). */
enum { degree = 10 };
static double         coefficient[degree + 1][width]; /* of s^d */
static pthread_once_t fitted = PTHREAD_ONCE_INIT;

static void fit(void)
{
    enum { points = degree + 1 };
    for (int i = 0; i < width; i++) {
        double before[points] = {1}, here[points] = {0, 1}; /* Chebyshev's polynomials by powers of s: T_0, T_1 */
        for (int n = 0; n < points; n++) {
            double sum = 0;
            for (int k = 0; k < points; k++) {
                const double angle = pi_rad * (k + 0.5) / points, t = 0.5 * (cos(angle) + 1);
                sum += kernel((t + i - width / 2.0) / (width / 2.0)) * cos(n * angle);
            }
            const double *of = n == 0 ? before : here;
            for (int d = 0; d < points; d++) coefficient[d][i] += (n == 0 ? 1.0 : 2.0) / points * sum * of[d];
            if (n == 0) continue;
            double after[points] = {0};
            for (int d = 0; d < points; d++) after[d] = (d > 0 ? 2 * here[d - 1] : 0) - before[d];
            memcpy(before, here, sizeof before);
            memcpy(here, after, sizeof here);
        }
    }
}

int gridding_spread(double weight[gridding_width], double turns, int points)
{
    pthread_once(&fitted, fit);
    const double at = turns * points, first = ceil(at - width / 2.0);
    const double s = 2 * (first - (at - width / 2.0)) - 1;
    double       sum[width];
    for (int i = 0; i < width; i++) sum[i] = coefficient[degree][i];
    for (int d = degree - 1; d >= 0; d--)
        for (int i = 0; i < width; i++) sum[i] = sum[i] * s + coefficient[d][i];
    memcpy(weight, sum, sizeof sum);
    const double round = first - points * floor(first / points);
    return round < points ? (int)round : 0;
}

/* ---- the grid -------------------------------------------------------------------------------------- */

enum { rows_least = 16, chunk = 4096, block = 256 };

/* Where a point goes: the first row and column of its patch, their weights, and what its phase turns by between the
 * middle of the interval and pulse pulses / 2. */
typedef struct Spread {
    int    row, column;
    double down[width], along[width], turn[2];
} Spread;

struct PulseGrid {
    int     samples, pulses, rows, columns, stride; /* rows, columns: of the grid; stride: columns and a margin */
    double  bend;
    int     terms;                                     /* that were added to */
    double *grid[pulse_terms_most][interval_channels]; /* [rows][stride] complex, columns beyond the last being the
                                                          first again; NULL: not needed yet */
    double    *turned[interval_channels];              /* [columns][rows] complex */
    double    *lines[interval_channels];               /* [pulses][columns] complex */
    Transform *over_rows[interval_channels], *over_columns[interval_channels];
    double    *of_sample, *of_pulse; /* over the kernel's transform */
    Spread    *spread;               /* [chunk] */
};

static size_t plane(const PulseGrid *g) { return 2 * (size_t)g->rows * (size_t)g->stride; }

void pulse_grid_forget(PulseGrid *g)
{
    for (int r = 0; r < g->terms; r++)
        for (int c = 0; c < interval_channels; c++) memset(g->grid[r][c], 0, plane(g) * sizeof *g->grid[r][c]);
    g->terms = 0;
}

/* Grids of so many terms, empty if they are new. */
static Status have_terms(PulseGrid *g, int terms)
{
    for (int r = 0; r < terms; r++)
        for (int c = 0; c < interval_channels; c++) {
            if (g->grid[r][c]) continue;
            g->grid[r][c] = transform_alloc(plane(g));
            if (!g->grid[r][c]) return STATUS_NO_MEMORY;
            memset(g->grid[r][c], 0, plane(g) * sizeof *g->grid[r][c]);
        }
    if (terms > g->terms) g->terms = terms;
    return STATUS_OK;
}

Status pulse_grid_create(PulseGrid **out, int samples, int pulses, double bend)
{
    PulseGrid *g = calloc(1, sizeof *g);
    if (!g) return STATUS_NO_MEMORY;
    g->samples = samples, g->pulses = pulses, g->bend = bend;
    g->rows = gridding_oversampling * pulses < rows_least ? rows_least : gridding_oversampling * pulses;
    g->columns = gridding_oversampling * samples;
    g->stride = g->columns + width;
    g->of_sample = gridding_corrections(samples, g->columns);
    g->of_pulse = gridding_corrections(pulses, g->rows);
    g->spread = malloc(chunk * sizeof *g->spread);
    Status status = g->of_sample && g->of_pulse && g->spread ? have_terms(g, 1) : STATUS_NO_MEMORY;
    for (int c = 0; c < interval_channels && status == STATUS_OK; c++) {
        double *turned = g->turned[c] = transform_alloc(2 * (size_t)g->rows * (size_t)g->columns);
        double *lines = g->lines[c] = transform_alloc(2 * (size_t)g->pulses * (size_t)g->columns);
        if (!turned || !lines) status = STATUS_NO_MEMORY;
        if (status == STATUS_OK)
            status = transform_create(&g->over_rows[c], TRANSFORM_ROWS, g->columns, g->rows, turned, turned);
        if (status == STATUS_OK)
            status = transform_create(&g->over_columns[c], TRANSFORM_ROWS, g->pulses, g->columns, lines, lines);
    }
    if (status != STATUS_OK) {
        pulse_grid_destroy(g);
        return status;
    }
    g->terms = 0;
    *out = g;
    return STATUS_OK;
}

void pulse_grid_destroy(PulseGrid *g)
{
    if (!g) return;
    for (int c = 0; c < interval_channels; c++) {
        transform_destroy(g->over_rows[c]);
        transform_destroy(g->over_columns[c]);
        for (int r = 0; r < pulse_terms_most; r++) transform_free(g->grid[r][c]);
        transform_free(g->turned[c]);
        transform_free(g->lines[c]);
    }
    free(g->of_sample);
    free(g->of_pulse);
    free(g->spread);
    free(g);
}

/* ---- adding ----------------------------------------------------------------------------------------- */

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
        if (job->point[i].terms == 0) continue;
        /* of an even number of pulses the middle is half a one before */
        const double half = g->pulses % 2 ? 0 : -pi_rad * job->point[i].per_pulse;
        g->spread[i].turn[0] = cos(half), g->spread[i].turn[1] = sin(half);
        g->spread[i].row = gridding_spread(g->spread[i].down, job->point[i].per_pulse, g->rows);
        g->spread[i].column = gridding_spread(g->spread[i].along, job->point[i].per_sample, g->columns);
    }
}

/* A channel has its grid of a term to itself. */
static void add_channel(void *user, int worker, int task)
{
    const Job *job = user;
    PulseGrid *g = job->grid;
    const int  term = task / interval_channels, channel = task % interval_channels;
    double    *grid = g->grid[term][channel];
    (void)worker;
    for (int i = 0; i < job->count; i++) {
        const PulsePoint *p = &job->point[i];
        const Spread     *s = &g->spread[i];
        if (term >= p->terms || p->amplitude[channel] == 0) continue;
        const double re = s->turn[0], im = s->turn[1];
        double       a = creal(p->amplitude[channel]), b = cimag(p->amplitude[channel]);
        for (int r = 1; r <= term; r++) { /* times -j growth / r */
            const double by = p->growth_rad / r, was = a;
            a = b * by, b = -was * by;
        }
        const double turned[2] = {a * re - b * im, a * im + b * re};
        double       wave[2 * width];
        for (int k = 0; k < width; k++)
            wave[2 * k] = turned[0] * s->along[k], wave[2 * k + 1] = turned[1] * s->along[k];
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
    else
        for (int t = 0; t < tasks; t++) task(user, 0, t);
}

Status pulse_grid_add(PulseGrid *g, const PulsePoint *point, int count, Pool *pool)
{
    for (int first = 0; first < count; first += chunk) {
        Job job = {g, point + first, count - first < chunk ? count - first : chunk};
        int terms = 0;
        for (int i = 0; i < job.count; i++) terms = job.point[i].terms > terms ? job.point[i].terms : terms;
        if (have_terms(g, terms) != STATUS_OK) return STATUS_NO_MEMORY;
        run(pool, (job.count + block - 1) / block, spread_block, &job);
        run(pool, interval_channels * terms, add_channel, &job);
    }
    return STATUS_OK;
}

/* ---- the sum ---------------------------------------------------------------------------------------- */

typedef struct Sum {
    PulseGrid      *grid;
    double complex *sample;
} Sum;

/* Adds a term of a channel to its samples; leaves its grid changed. */
static void sum_term(double complex *sample, PulseGrid *g, int term, int channel)
{
    enum { tile = 16 };
    double *grid = g->grid[term][channel], *turned = g->turned[channel], *lines = g->lines[channel];
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
        double complex *to = sample + ((size_t)channel * (size_t)g->pulses + (size_t)p) * (size_t)g->samples;
        const double    v = g->pulses > 1 ? (2.0 * p - (g->pulses - 1)) / (g->pulses - 1) : 0;
        for (int m = 0; m < g->samples; m++) {
            const int    at = (m - g->samples / 2 + g->columns) % g->columns;
            const double u = (m - g->samples / 2) / (0.5 * g->samples), t = u * ((1 - g->bend) * v + g->bend * u);
            double       by = g->of_sample[m];
            for (int r = 0; r < term; r++) by *= t;
            to[m] += CMPLX(from[2 * at] * by, from[2 * at + 1] * by);
        }
    }
}

static void sum_channel(void *user, int worker, int channel)
{
    const Sum   *sum = user;
    PulseGrid   *g = sum->grid;
    const size_t count = (size_t)g->pulses * (size_t)g->samples;
    (void)worker;
    for (size_t i = 0; i < count; i++) sum->sample[(size_t)channel * count + i] = 0;
    for (int term = 0; term < g->terms; term++) sum_term(sum->sample, g, term, channel);
}

void pulse_grid_sum(double complex *sample, PulseGrid *g, Pool *pool)
{
    Sum sum = {g, sample};
    run(pool, interval_channels, sum_channel, &sum);
    pulse_grid_forget(g);
}
