/* sensor/radar/row_grid.c: sums echoes over grids of delay, row by row. */
#include "sensor/radar/echo_private.h"

#include "render/scattering/scatter.h"
#include "sensor/detector/transform.h"

#include <stdlib.h>

enum { width = gridding_width, ranks_most = 64 };
static const double part_rad = 2e-3;    /* of phase at the band's ends that a delay may be off, or a bend left out */
static const double term_least = 1e-5;  /* of an amplitude: smaller terms are left out */
static const double bend_most_rad = 70; /* Bessel functions of half of it vanish before ranks_most */

struct RowGrid {
    int        samples, points, pulses;
    double     wave_rad_m;       /* of a metre of path, at the centre */
    double     turns_m;          /* of the grid, of a metre of path */
    double     edge_rad_m;       /* of a metre of path, at the band's ends against its centre */
    double     fold_m;           /* of two-way path */
    double     coupled;          /* path by which an echo appears farther, over its growth a row */
    double     bend_rad_m;       /* q, over the growth a row */
    int        ranks;            /* grids that were added to */
    double    *grid[ranks_most]; /* [channels][pulses][points] complex; NULL: not needed yet */
    Transform *transform[ranks_most];
    double    *correction; /* [samples]: over the kernel's transform */
    double    *factor;     /* [samples]: scratch */
};

static size_t grid_size(const RowGrid *g)
{
    return 2 * (size_t)interval_channels * (size_t)g->pulses * (size_t)g->points;
}

void row_grid_forget(RowGrid *g)
{
    for (int r = 0; r < g->ranks; r++) memset(g->grid[r], 0, grid_size(g) * sizeof *g->grid[r]);
    g->ranks = 0;
}

/* Makes empty grids up to `ranks`. */
static Status have_ranks(RowGrid *g, int ranks)
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

Status row_grid_create(RowGrid **out, const Waveform *wave)
{
    RowGrid *g = calloc(1, sizeof *g);
    if (!g) return STATUS_NO_MEMORY;
    g->samples = wave->samples;
    g->points = gridding_oversampling * wave->samples;
    g->pulses = wave->pulses;
    g->wave_rad_m = 2 * pi_rad * wave->centre_hz / light_mps;
    g->turns_m = wave->bandwidth_hz / wave->samples / light_mps;
    g->edge_rad_m = pi_rad * wave->bandwidth_hz / light_mps;
    g->fold_m = 2 * waveform_fold_m(wave);
    const double share = waveform_share_of_row(wave);
    g->coupled = wave->centre_hz / wave->bandwidth_hz * share;
    g->bend_rad_m = g->edge_rad_m / 2 * share;
    g->correction = gridding_corrections(g->samples, g->points);
    g->factor = malloc((size_t)g->samples * sizeof *g->factor);
    if (!g->correction || !g->factor) {
        row_grid_destroy(g);
        return STATUS_NO_MEMORY;
    }
    *out = g;
    return STATUS_OK;
}

void row_grid_destroy(RowGrid *g)
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

/* Computes J_0 .. J_(most - 1) of x > 0 by the recurrence downwards from an order where they vanish, scaled so that J_0
 * + 2 J_2 + 2 J_4 + ... = 1 (Miller; Abramowitz & Stegun 9.12). */
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
    RowGrid    *grid;
    const Echo *echo;
    int         count;
} Job;

enum { block_pulses = 8 }; /* of a task, which has them to itself */

/* Rows in a block, 1, 2, 4 or 8, that share one delay unless it folds over among them. */
static int sharing(const RowGrid *g, double path_per_pulse_m)
{
    int rows = block_pulses;
    while (rows > 1 && 0.5 * (rows - 1) * g->edge_rad_m * fabs(path_per_pulse_m) > part_rad) rows /= 2;
    return rows;
}

static double *row_of(RowGrid *g, int rank, int channel, int pulse)
{
    return g->grid[rank] + 2 * ((size_t)channel * (size_t)g->pulses + (size_t)pulse) * (size_t)g->points;
}

/* Whether rows whose paths lie so far about the middle one fold over by different multiples: they share no delay. */
static bool crosses_fold(const RowGrid *g, double path_m, double about_m)
{
    return nearbyint((path_m - about_m) / g->fold_m) != nearbyint((path_m + about_m) / g->fold_m);
}

static void add_echo(RowGrid *g, const Echo *e, int first_pulse, int end)
{
    double               weight[width];
    double complex       factor[ranks_most];
    const double         growth = e->path_per_pulse_m, middle = 0.5 * (g->pulses - 1);
    const int            rows = sharing(g, growth), asked = bends(factor, g->bend_rad_m * growth);
    const int            ranks = asked < g->ranks ? asked : g->ranks;
    const double complex turn = cexp(-I * g->wave_rad_m * growth);
    double complex       phase = cexp(-I * g->wave_rad_m * (e->path_m + (first_pulse - middle) * growth));
    for (int base = first_pulse, step; base < end; base += step) {
        double path_m = e->path_m + (base + 0.5 * (rows - 1) - middle + g->coupled) * growth;
        step = rows;
        if (isfinite(g->fold_m) && rows > 1 && crosses_fold(g, path_m, 0.5 * (rows - 1) * growth))
            step = 1, path_m = e->path_m + (base - middle + g->coupled) * growth;
        if (isfinite(g->fold_m)) path_m -= g->fold_m * nearbyint(path_m / g->fold_m);
        const int first = gridding_spread(weight, path_m * g->turns_m, g->points);
        for (int p = base; p < base + step && p < end; p++) {
            for (int r = 0; r < ranks; r++) {
                const double complex here = factor[r] * phase;
                for (int c = 0; c < interval_channels; c++)
                    if (e->amplitude[c] != 0)
                        deposit(row_of(g, r, c, p), g->points, first, weight, e->amplitude[c] * here);
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

Status row_grid_add(RowGrid *g, const Echo *echo, int count, Pool *pool)
{
    Job            job = {g, echo, count};
    const int      tasks = (g->pulses + block_pulses - 1) / block_pulses;
    double         most = 0;
    double complex factor[ranks_most];
    if (count == 0) return STATUS_OK;
    for (int k = 0; k < count; k++) most = fmax(most, fabs(echo[k].path_per_pulse_m));
    if (have_ranks(g, bends(factor, g->bend_rad_m * most)) != STATUS_OK) return STATUS_NO_MEMORY;
    if (pool) pool_run(pool, tasks, add_block, &job);
    else
        for (int t = 0; t < tasks; t++) add_block(&job, 0, t);
    return STATUS_OK;
}

void row_grid_sum(double complex *sample, RowGrid *g)
{
    const size_t rows = interval_channels * (size_t)g->pulses;
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
    row_grid_forget(g);
}
