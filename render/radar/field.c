/* render/radar/field.c: sums a list of hits over many frequencies. */
#include "render/radar/field.h"

#include <stdlib.h>

enum { chunk_hits = 8192, restart = 64 };

typedef struct Sweep {
    int             count;
    double          first_k, step_k;
    const TubeHits *hits;
    bool            moved;
    ScatterAntenna  tx, rx;
    double         *sum; /* [chunks][count][8] */
} Sweep;

/* Change of a hit's path when the antennas move: that of its first point to the transmitter and of its last to the receiver;
 * what lies between changes by the second order (Fermat). */
static double moved_by(const Sweep *sweep, size_t i)
{
    const TubeHits *h = sweep->hits;
    const double    first[3] = {(double)h->first[0][i], (double)h->first[1][i], (double)h->first[2][i]};
    const double    last[3] = {(double)h->last[0][i], (double)h->last[1][i], (double)h->last[2][i]};
    double          way[3];
    return scatter_path(way, &sweep->tx, first) - scatter_path(way, &h->tx, first) +
           (scatter_path(way, &sweep->rx, last) - scatter_path(way, &h->rx, last));
}

static double sinc(double x) { return fabs(x) < 1e-4 ? 1 - x * x / 6 : sin(x) / x; }

static void add_hit(double *sum, const Sweep *sweep, size_t i)
{
    const TubeHits *h = sweep->hits;
    const double    path_m = h->path_m[i] + (sweep->moved ? moved_by(sweep, i) : 0);
    const double    slope_m[2] = {(double)h->slope_m[0][i], (double)h->slope_m[1][i]};
    double          a[8];
    for (int c = 0; c < 8; c++) a[c] = (double)h->amplitude[c][i];
    for (int start = 0; start < sweep->count; start += restart) {
        const double k0 = sweep->first_k + start * sweep->step_k;
        const double turn_re = cos(sweep->step_k * path_m), turn_im = -sin(sweep->step_k * path_m);
        double       re = cos(k0 * path_m), im = -sin(k0 * path_m);
        const int    end = start + restart < sweep->count ? start + restart : sweep->count;
        for (int f = start; f < end; f++) {
            const double k = sweep->first_k + f * sweep->step_k, share = sinc(k * slope_m[0]) * sinc(k * slope_m[1]);
            const double x = share * re, y = share * im, next = re * turn_re - im * turn_im;
            double      *at = sum + 8 * f;
            for (int p = 0; p < 8; p += 2) {
                at[p] += a[p] * x - a[p + 1] * y;
                at[p + 1] += a[p] * y + a[p + 1] * x;
            }
            im = re * turn_im + im * turn_re;
            re = next;
        }
    }
}

static void sum_chunk(void *user, int worker, int task)
{
    const Sweep *sweep = user;
    const size_t first = (size_t)task * chunk_hits;
    const size_t end = first + chunk_hits < sweep->hits->count ? first + chunk_hits : sweep->hits->count;
    (void)worker;
    for (size_t i = first; i < end; i++) add_hit(sweep->sum + 8 * (size_t)sweep->count * (size_t)task, sweep, i);
}

Status field_sweep(ScatterMatrix *s, int count, double first_hz, double step_hz, const TubeHits *hits,
                   const ScatterAntenna *tx, const ScatterAntenna *rx, Pool *pool)
{
    const double k_per_hz = 2 * pi_rad / light_mps;
    const int    chunks = (int)((hits->count + chunk_hits - 1) / chunk_hits);
    Sweep        sweep = {.count = count, .first_k = first_hz * k_per_hz, .step_k = step_hz * k_per_hz, .hits = hits,
                          .moved = tx || rx, .tx = tx ? *tx : hits->tx, .rx = rx ? *rx : hits->rx};
    sweep.sum = calloc(8 * (size_t)count * (size_t)chunks + 1, sizeof *sweep.sum);
    if (!sweep.sum) return STATUS_NO_MEMORY;
    if (pool) pool_run(pool, chunks, sum_chunk, &sweep);
    else for (int t = 0; t < chunks; t++) sum_chunk(&sweep, 0, t);
    for (int f = 0; f < count; f++) {
        double       whole[8] = {0};
        const double scale = -(sweep.first_k + f * sweep.step_k) / (2 * pi_rad); /* times j */
        for (int t = 0; t < chunks; t++)
            for (int c = 0; c < 8; c++) whole[c] += sweep.sum[8 * ((size_t)count * (size_t)t + (size_t)f) + (size_t)c];
        double complex *const to[4] = {&s[f].hh, &s[f].hv, &s[f].vh, &s[f].vv};
        for (int p = 0; p < 4; p++) *to[p] = CMPLX(-scale * whole[2 * p + 1], scale * whole[2 * p]);
    }
    free(sweep.sum);
    return STATUS_OK;
}

Status field_at(ScatterMatrix *s, double frequency_hz, const TubeHits *hits, Pool *pool)
{
    return field_sweep(s, 1, frequency_hz, 0, hits, NULL, NULL, pool);
}

double rcs_dbsm(double complex s)
{
    const double sigma_m2 = 4 * pi_rad * (creal(s) * creal(s) + cimag(s) * cimag(s));
    return 10 * log10(sigma_m2);
}
