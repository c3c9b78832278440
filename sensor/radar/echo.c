/* sensor/radar/echo.c: adds echoes to the grid over delay and Doppler, in tasks by rows, and sums what the tasks
 * have. */
#include "sensor/radar/echo.h"

#include "render/scattering/scatter.h"
#include "sensor/radar/echo_private.h"

#include <stdlib.h>

enum { chunk = 4096, block = 256, pulses_a_term = 8 };
static const double part = 2e-3; /* of an amplitude, at the ends of band and interval, that a series may leave out */

struct EchoGrid {
    Waveform    wave;
    PulseGrid  *even;         /* of slow echoes, by delay and Doppler */
    RowGrid    *rows;         /* of fast echoes, row by row */
    double      wave_rad_m;   /* of a metre of path, at the centre */
    double      turns_m;      /* a sample, of a metre of path */
    double      growth_rad_m; /* of the phase that delay and Doppler leave, at its most, over the growth a row */
    double      fold_m;       /* of two-way path */
    double      coupled;      /* path by which an echo appears farther, over its growth a row */
    double      within_s;     /* time over which one frequency is taken, over the time from row to row */
    double      unfollowed_m;
    Status      status;
    PulsePoint *point; /* [chunk] */
    Echo       *echo;  /* [chunk] */
    Pool       *pool;  /* of the echoes that were added last */
};

void echo_forget(EchoGrid *g)
{
    pulse_grid_forget(g->even);
    row_grid_forget(g->rows);
    g->status = STATUS_OK;
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
    const double share = waveform_share_of_row(wave), most = pulses - 1 + share;
    g->wave = *wave;
    g->wave_rad_m = 2 * pi_rad * wave->centre_hz / light_mps;
    g->turns_m = step_hz / light_mps;
    g->growth_rad_m = pi_rad * wave->bandwidth_hz / light_mps * most / 2;
    g->fold_m = 2 * waveform_fold_m(wave);
    g->coupled = wave->centre_hz / wave->bandwidth_hz * share;
    if (share == 0 || wave->kind == WAVEFORM_STEPPED) g->within_s = wave->pulse_s * wave->repeat_hz;
    g->point = malloc(chunk * sizeof *g->point);
    g->echo = malloc(chunk * sizeof *g->echo);
    if (!g->point || !g->echo || row_grid_create(&g->rows, wave) != STATUS_OK ||
        pulse_grid_create(&g->even, samples, pulses, most > 0 ? share / most : 0) != STATUS_OK) {
        echo_grid_destroy(g);
        return STATUS_NO_MEMORY;
    }
    *out = g;
    return STATUS_OK;
}

void echo_grid_destroy(EchoGrid *g)
{
    if (!g) return;
    pulse_grid_destroy(g->even);
    row_grid_destroy(g->rows);
    free(g->point);
    free(g->echo);
    free(g);
}

/* The first term left out is the error: |x|^terms / terms!. */
int echo_terms(const EchoGrid *g, double path_per_pulse_m)
{
    const double x = fabs(g->growth_rad_m * path_per_pulse_m);
    const int    worth = g->wave.pulses / pulses_a_term, most = worth < pulse_terms_most ? worth : pulse_terms_most;
    double       left = x;
    for (int terms = 1; terms <= most; terms++) {
        if (left <= part) return terms;
        left *= x / (terms + 1);
    }
    return 0;
}

typedef struct Job {
    EchoGrid   *grid;
    const Echo *echo;
    int         count;
} Job;

static double sinc_of(double x) { return fabs(x) > 1e-9 ? sin(x) / x : 1; }

static void prepare(PulsePoint *p, Echo *left_over, const EchoGrid *g, const Echo *e)
{
    const double growth_m = e->path_per_pulse_m;
    const double left = sinc_of(0.5 * g->wave_rad_m * (growth_m + g->unfollowed_m) * g->within_s);
    double       path_m = e->path_m + g->coupled * growth_m;
    *left_over = *e;
    for (int c = 0; c < interval_channels; c++) left_over->amplitude[c] *= left;
    p->terms = echo_terms(g, growth_m);
    if (isfinite(g->fold_m)) {
        path_m -= g->fold_m * nearbyint(path_m / g->fold_m);
        /* the echo folds over within the interval */
        if (fabs(path_m) + 0.5 * g->wave.pulses * fabs(growth_m) > 0.5 * g->fold_m) p->terms = 0;
    }
    if (p->terms == 0) return;
    const double phase = -g->wave_rad_m * e->path_m, re = cos(phase), im = sin(phase);
    p->per_sample = path_m * g->turns_m;
    p->per_pulse = g->wave_rad_m / (2 * pi_rad) * growth_m;
    p->growth_rad = g->growth_rad_m * growth_m;
    for (int c = 0; c < interval_channels; c++) {
        const double a = creal(left_over->amplitude[c]), b = cimag(left_over->amplitude[c]);
        p->amplitude[c] = CMPLX(a * re - b * im, a * im + b * re);
    }
}

static void prepare_block(void *user, int worker, int task)
{
    const Job *job = user;
    const int  end = (task + 1) * block < job->count ? (task + 1) * block : job->count;
    (void)worker;
    EchoGrid *g = job->grid;
    for (int k = task * block; k < end; k++) prepare(&g->point[k], &g->echo[k], g, &job->echo[k]);
}

void echo_add(EchoGrid *g, const Echo *echo, int count, Pool *pool)
{
    g->pool = pool;
    for (int first = 0; first < count && g->status == STATUS_OK; first += chunk) {
        Job       job = {g, echo + first, count - first < chunk ? count - first : chunk};
        const int tasks = (job.count + block - 1) / block;
        int       others = 0;
        if (pool) pool_run(pool, tasks, prepare_block, &job);
        else
            for (int t = 0; t < tasks; t++) prepare_block(&job, 0, t);
        g->status = pulse_grid_add(g->even, g->point, job.count, pool);
        for (int k = 0; k < job.count; k++)
            if (g->point[k].terms == 0) g->echo[others++] = g->echo[k];
        if (g->status == STATUS_OK) g->status = row_grid_add(g->rows, g->echo, others, pool);
    }
}

void   echo_unfollowed(EchoGrid *g, double path_per_pulse_m) { g->unfollowed_m = path_per_pulse_m; }
Status echo_status(const EchoGrid *g) { return g->status; }

/* What the reference's own path does to a sample. */
static double complex reference_turn(const EchoGrid *g, int m, int n)
{
    const double path_m = g->unfollowed_m * g->wave.repeat_hz * waveform_time_s(&g->wave, m, n);
    return cexp(-2 * pi_rad * I * waveform_frequency_hz(&g->wave, m) / light_mps * path_m);
}

void echo_sum(double complex *sample, EchoGrid *g)
{
    const int samples = g->wave.samples, pulses = g->wave.pulses;
    pulse_grid_sum(sample, g->even, g->pool);
    row_grid_sum(sample, g->rows);
    for (int n = 0; n < pulses && g->unfollowed_m != 0; n++)
        for (int m = 0; m < samples; m++) {
            const double complex turn = reference_turn(g, m, n);
            for (size_t c = 0; c < interval_channels; c++)
                sample[(c * (size_t)pulses + (size_t)n) * (size_t)samples + (size_t)m] *= turn;
        }
    echo_forget(g);
}
