/* sensor/radar/echo.c: see echo.h. */
#include "sensor/radar/echo.h"

#include "render/radar/scatter.h"
#include "sensor/radar/pulse_grid.h"

#include <stdlib.h>

enum { chunk = 4096, block = 256 };

struct EchoGrid {
    PulseGrid  *grid;
    double      wave_rad_m;    /* of a metre of path, at the centre */
    double      sample_per_m;  /* turns a sample, of a metre of path */
    PulsePoint *point;         /* [chunk] */
    Pool       *pool;          /* of the last that were added */
};

void echo_forget(EchoGrid *g) { pulse_grid_forget(g->grid); }

Status echo_grid_create(EchoGrid **out, const Waveform *wave)
{
    const int    samples = wave->samples, pulses = wave->pulses;
    const double step_hz = wave->bandwidth_hz / samples;
    if (samples < 8 || samples > 65536 || samples % 2 || pulses < 1 || pulses > 4096 || samples > (1 << 22) / pulses ||
        !(wave->centre_hz > 0) || !(step_hz > 0))
        return STATUS_BAD_VALUE;
    EchoGrid *g = calloc(1, sizeof *g);
    if (!g) return STATUS_NO_MEMORY;
    g->wave_rad_m = 2 * pi_rad * wave->centre_hz / light_mps;
    g->sample_per_m = step_hz / light_mps;
    g->point = malloc(chunk * sizeof *g->point);
    if (!g->point || pulse_grid_create(&g->grid, samples, pulses) != STATUS_OK) {
        echo_grid_destroy(g);
        return STATUS_NO_MEMORY;
    }
    *out = g;
    return STATUS_OK;
}

void echo_grid_destroy(EchoGrid *g)
{
    if (!g) return;
    pulse_grid_destroy(g->grid);
    free(g->point);
    free(g);
}

typedef struct Job {
    EchoGrid   *grid;
    const Echo *echo;
    int         count;
} Job;

static void turn_block(void *user, int worker, int task)
{
    const Job *job = user;
    EchoGrid  *g = job->grid;
    const int  end = (task + 1) * block < job->count ? (task + 1) * block : job->count;
    (void)worker;
    for (int k = task * block; k < end; k++) {
        const Echo  *e = &job->echo[k];
        PulsePoint  *p = &g->point[k];
        const double phase = -g->wave_rad_m * e->path_m, re = cos(phase), im = sin(phase);
        p->per_sample = e->path_m * g->sample_per_m;
        p->per_pulse = g->wave_rad_m / (2 * pi_rad) * e->path_per_pulse_m;
        for (int c = 0; c < interval_channels; c++) {
            const double a = creal(e->amplitude[c]), b = cimag(e->amplitude[c]);
            p->amplitude[c] = CMPLX(a * re - b * im, a * im + b * re);
        }
    }
}

void echo_add(EchoGrid *g, const Echo *echo, int count, Pool *pool)
{
    g->pool = pool;
    for (int first = 0; first < count; first += chunk) {
        Job       job = {g, echo + first, count - first < chunk ? count - first : chunk};
        const int tasks = (job.count + block - 1) / block;
        if (pool) pool_run(pool, tasks, turn_block, &job);
        else for (int t = 0; t < tasks; t++) turn_block(&job, 0, t);
        pulse_grid_add(g->grid, g->point, job.count, pool);
    }
}

void echo_sum(double complex *sample, EchoGrid *g) { pulse_grid_sum(sample, g->grid, g->pool); }
