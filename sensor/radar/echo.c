/* sensor/radar/echo.c: see echo.h. */
#include "sensor/radar/echo.h"

#include "render/radar/scatter.h"
#include "sensor/detector/transform.h"

#include <stdlib.h>

enum { width = 8, oversampling = 2, ranks_most = 64 };
static const double beta = 2.30 * width; /* Barnett et al., equation 1.14, for twice the points */
static const double part_rad = 2e-3;     /* of phase at the band's ends that a delay may be off, or a bend left out */
static const double term_least = 1e-5;   /* of an amplitude: smaller terms are left out */
static const double bend_most_rad = 70;  /* Bessel functions of half of it vanish before ranks_most */

struct EchoGrid {
    Waveform   wave;
    int        samples, points, pulses;
    double     wave_rad_m;              /* of a metre of path, at the centre */
    double     points_per_m;
    double     edge_rad_m;              /* of a metre of path, at the band's ends against its centre */
    double     fold_m;                  /* of two-way path */
    double     coupled;                 /* path by which an echo appears farther, over its growth a row */
    double     bend_rad_m;              /* q, over the growth a row */
    double     within_s;                /* of one frequency, over that from row to row */
    double     unfollowed_m;
    int        ranks;                   /* grids that were added to */
    Status     status;
    double    *grid[ranks_most];        /* [channels][pulses][points] complex; NULL: not needed yet */
    Transform *transform[ranks_most];
    double    *correction;              /* [samples]: over the kernel's transform */
    double    *factor;                  /* [samples]: scratch */
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

void echo_forget(EchoGrid *g)
{
    for (int r = 0; r < g->ranks; r++) memset(g->grid[r], 0, grid_size(g) * sizeof *g->grid[r]);
    g->ranks = 0;
    g->status = STATUS_OK;
}

/* Grids up to `ranks`, empty. */
static Status have_ranks(EchoGrid *g, int ranks)
{
    for (int r = 0; r < ranks; r++) {
        if (g->transform[r]) continue;
        if (!g->grid[r]) g->grid[r] = transform_alloc(grid_size(g));
        if (!g->grid[r] || transform_create(&g->transform[r], TRANSFORM_ROWS, interval_channels * g->pulses, g->points,
                                            g->grid[r], g->grid[r]) != STATUS_OK)
            return STATUS_NO_MEMORY;
        memset(g->grid[r], 0, grid_size(g) * sizeof *g->grid[r]);
    }
    if (ranks > g->ranks) g->ranks = ranks;
    return STATUS_OK;
}

Status echo_grid_create(EchoGrid **out, const Waveform *wave)
{
    const int    samples = wave->samples, pulses = wave->pulses;
    const double step_hz = wave->bandwidth_hz / samples;
    if (samples < 8 || samples > 65536 || samples % 2 || pulses < 1 || pulses > 4096 || samples > (1 << 22) / pulses ||
        !(wave->centre_hz > 0) || !(step_hz > 0))
        return STATUS_BAD_VALUE;
    EchoGrid *g = calloc(1, sizeof *g);
    if (!g) return STATUS_NO_MEMORY;
    g->wave = *wave;
    g->samples = samples;
    g->points = oversampling * samples;
    g->pulses = pulses;
    g->wave_rad_m = 2 * pi_rad * wave->centre_hz / light_mps;
    g->points_per_m = step_hz * g->points / light_mps;
    g->edge_rad_m = pi_rad * wave->bandwidth_hz / light_mps;
    g->fold_m = 2 * waveform_fold_m(wave);
    const double share = waveform_step_s(wave) * wave->repeat_hz * samples; /* of a row that its samples take */
    g->coupled = wave->centre_hz / wave->bandwidth_hz * share;
    g->bend_rad_m = g->edge_rad_m / 2 * share;
    if (share == 0 || wave->kind == WAVEFORM_STEPPED) g->within_s = wave->pulse_s * wave->repeat_hz;
    g->correction = malloc((size_t)samples * sizeof *g->correction);
    g->factor = malloc((size_t)samples * sizeof *g->factor);
    if (!g->correction || !g->factor || have_ranks(g, 1) != STATUS_OK) {
        echo_grid_destroy(g);
        return STATUS_NO_MEMORY;
    }
    for (int m = 0; m < samples; m++)
        g->correction[m] = 1 / kernel_transform(2 * pi_rad * (m - samples / 2) / g->points);
    *out = g;
    return STATUS_OK;
}

void echo_grid_destroy(EchoGrid *g)
{
    if (!g) return;
    for (int r = 0; r < ranks_most; r++) {
        transform_destroy(g->transform[r]);
        transform_free(g->grid[r]);
    }
    free(g->correction);
    free(g->factor);
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

/* J_0 .. J_(most - 1) of x > 0: recurrence downwards from an order where they vanish, scaled so that J_0 + 2 J_2 +
 * 2 J_4 + ... = 1 (Miller; Abramowitz & Stegun 9.12). */
static void bessel(double *j, int most, double x)
{
    double after = 0, here = 1e-30, sum = 0;
    for (int k = most + 20 + (int)x; k >= 0; k--) { /* here: J_k */
        if (k < most) j[k] = here;
        sum += k % 2 ? 0 : k ? 2 * here : here;
        const double before = 2 * k / x * here - after;
        after = here, here = before;
        if (fabs(here) > 1e100) { /* of order up to most at hand: scaled with it */
            here *= 1e-100, after *= 1e-100, sum *= 1e-100;
            for (int i = k; i < most; i++) j[i] *= 1e-100;
        }
    }
    for (int k = 0; k < most; k++) j[k] /= sum;
}

/* Factors of the grids for an echo that bends by q: exp(-j q u^2) = sum of them times T_r(2 u^2 - 1). Returns how many
 * count. */
static int bends(double complex factor[ranks_most], double q)
{
    const double x = fmin(fabs(q), bend_most_rad) / 2;
    factor[0] = 1;
    if (x < part_rad / 2) return 1;
    static const double complex turns[4] = {1, -I, -1, I};
    const double complex        half = cexp(-I * copysign(x, q));
    double                      j[ranks_most];
    int                         ranks = 1;
    bessel(j, ranks_most, x);
    for (int r = 0; r < ranks_most; r++) {
        if (2 * fabs(j[r]) > term_least) ranks = r + 1;
        factor[r] = (r ? 2 : 1) * j[r] * half * (q > 0 ? turns[r % 4] : conj(turns[r % 4]));
    }
    return ranks;
}

typedef struct Job {
    EchoGrid   *grid;
    const Echo *echo;
    int         count;
} Job;

enum { block_pulses = 8 }; /* of a task, which has them to itself */

/* Rows in a block, 1, 2, 4 or 8, that share one delay. */
static int sharing(const EchoGrid *g, double path_per_pulse_m)
{
    int rows = block_pulses;
    while (rows > 1 && 0.5 * (rows - 1) * g->edge_rad_m * fabs(path_per_pulse_m) > part_rad) rows /= 2;
    return rows;
}

static double sinc_of(double x) { return fabs(x) > 1e-9 ? sin(x) / x : 1; }

static double *row_of(EchoGrid *g, int rank, int channel, int pulse)
{
    return g->grid[rank] + 2 * ((size_t)channel * (size_t)g->pulses + (size_t)pulse) * (size_t)g->points;
}

static void add_echo(EchoGrid *g, const Echo *e, int first_pulse, int end)
{
    double               weight[width];
    double complex       factor[ranks_most];
    const double         growth = e->path_per_pulse_m, middle = 0.5 * (g->pulses - 1);
    const int            rows = sharing(g, growth), asked = bends(factor, g->bend_rad_m * growth);
    const int            ranks = asked < g->ranks ? asked : g->ranks;
    const double         left = sinc_of(0.5 * g->wave_rad_m * (growth + g->unfollowed_m) * g->within_s);
    const double complex turn = cexp(-I * g->wave_rad_m * growth);
    double complex       phase = left * cexp(-I * g->wave_rad_m * (e->path_m + (first_pulse - middle) * growth));
    for (int base = first_pulse; base < end; base += rows) {
        double path_m = e->path_m + (base + 0.5 * (rows - 1) - middle + g->coupled) * growth;
        if (isfinite(g->fold_m)) path_m -= g->fold_m * nearbyint(path_m / g->fold_m);
        const int first = spread(weight, g, path_m);
        for (int p = base; p < base + rows && p < end; p++) {
            for (int r = 0; r < ranks; r++) {
                const double complex here = factor[r] * phase;
                for (int c = 0; c < interval_channels; c++)
                    if (e->amplitude[c] != 0) deposit(row_of(g, r, c, p), g->points, first, weight, e->amplitude[c] * here);
            }
            phase *= turn;
        }
    }
}

static void add_block(void *user, int worker, int task)
{
    const Job *job = user;
    const int  first = task * block_pulses, end = first + block_pulses;
    (void)worker;
    for (int k = 0; k < job->count; k++)
        add_echo(job->grid, &job->echo[k], first, end < job->grid->pulses ? end : job->grid->pulses);
}

void echo_add(EchoGrid *g, const Echo *echo, int count, Pool *pool)
{
    Job            job = {g, echo, count};
    const int      tasks = (g->pulses + block_pulses - 1) / block_pulses;
    double         most = 0;
    double complex factor[ranks_most];
    for (int k = 0; k < count; k++) most = fmax(most, fabs(echo[k].path_per_pulse_m));
    if (g->status == STATUS_OK) g->status = have_ranks(g, bends(factor, g->bend_rad_m * most));
    if (g->status != STATUS_OK) return;
    if (pool) pool_run(pool, tasks, add_block, &job);
    else for (int t = 0; t < tasks; t++) add_block(&job, 0, t);
}

void echo_unfollowed(EchoGrid *g, double path_per_pulse_m) { g->unfollowed_m = path_per_pulse_m; }
Status echo_status(const EchoGrid *g) { return g->status; }

/* What the reference's own path does to a sample. */
static double complex reference_turn(const EchoGrid *g, int m, int n)
{
    const double path_m = g->unfollowed_m * g->wave.repeat_hz * waveform_time_s(&g->wave, m, n);
    return cexp(-2 * pi_rad * I * waveform_frequency_hz(&g->wave, m) / light_mps * path_m);
}

void echo_sum(double complex *sample, EchoGrid *g)
{
    const size_t rows = interval_channels * (size_t)g->pulses, count = rows * (size_t)g->samples;
    for (size_t i = 0; i < count; i++) sample[i] = 0;
    for (int r = 0; r < g->ranks; r++) {
        transform_run(g->transform[r]);
        for (int m = 0; m < g->samples; m++) {
            const double u = (m - g->samples / 2) / (0.5 * g->samples);
            g->factor[m] = g->correction[m] * cos(r * acos(clamp(2 * u * u - 1, -1, 1)));
        }
        for (size_t row = 0; row < rows; row++) {
            const double *from = g->grid[r] + 2 * row * (size_t)g->points;
            for (int m = 0; m < g->samples; m++) {
                const int at = (m - g->samples / 2 + g->points) % g->points;
                sample[row * (size_t)g->samples + (size_t)m] += (from[2 * at] + I * from[2 * at + 1]) * g->factor[m];
            }
        }
    }
    if (g->unfollowed_m != 0)
        for (int n = 0; n < g->pulses; n++)
            for (int m = 0; m < g->samples; m++) {
                const double complex turn = reference_turn(g, m, n);
                for (size_t c = 0; c < interval_channels; c++)
                    sample[(c * (size_t)g->pulses + (size_t)n) * (size_t)g->samples + (size_t)m] *= turn;
            }
    echo_forget(g);
}
