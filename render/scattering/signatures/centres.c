/* render/scattering/signatures/centres.c: brings the centres of a signature to the antennas as they are now, and
 * judges them. */
#include "render/scattering/signatures/centres.h"

#include <stdlib.h>

static void see(ScatterCentre *out, const Signature *s, const SignatureCentre *c, double k, const ScatterAntenna *tx,
                const ScatterAntenna *rx)
{
    double way[2][2][3], first[3], last[3], slope[3];
    for (int x = 0; x < 3; x++) {
        out->p[x] = (double)c->p[x];
        first[x] = out->p[x] - (double)c->half[x];
        last[x] = out->p[x] + (double)c->half[x];
    }
    out->path_m = (c->path + (double)c->path_share) * s->path_step_m +
                  (scatter_path(way[0][0], tx, first) - scatter_path(way[0][1], &s->tx, first)) +
                  (scatter_path(way[1][0], rx, last) - scatter_path(way[1][1], &s->rx, last));
    /* how the change of path grows from the mean point */
    for (int x = 0; x < 3; x++) slope[x] = way[0][1][x] - way[0][0][x] + way[1][1][x] - way[1][0][x];
    const double          scale = (double)c->scale / 32767, finer = k * (double)c->moment_scale / 127;
    const double          right = finer * v3_dot(slope, s->right), up = finer * v3_dot(slope, s->up);
    double complex *const to[4] = {&out->s.hh, &out->s.hv, &out->s.vh, &out->s.vv};
    for (int q = 0; q < 4; q++) { /* less j k slope . moment */
        const double re = right * c->moment[0][2 * q] + up * c->moment[1][2 * q];
        const double im = right * c->moment[0][2 * q + 1] + up * c->moment[1][2 * q + 1];
        *to[q] = CMPLX(scale * c->s[2 * q] + im, scale * c->s[2 * q + 1] - re);
    }
    out->weight = (double)c->weight;
    out->strongest = (double)c->strongest;
    out->bounce = c->bounce;
    out->part = c->part;
}

enum { block = 1024 };

typedef struct Job {
    Centres              *out;
    const Signature      *signature;
    const ScatterAntenna *tx, *rx;
    double                k;
} Job;

static void see_block(void *user, int worker, int task)
{
    const Job *job = user;
    const int  end = (task + 1) * block < job->out->count ? (task + 1) * block : job->out->count;
    (void)worker;
    for (int i = task * block; i < end; i++)
        see(&job->out->centre[i], job->signature, &job->signature->centre[i], job->k, job->tx, job->rx);
}

Status centres_make(Centres *out, const Signature *s, const ScatterAntenna *tx, const ScatterAntenna *rx, Pool *pool)
{
    const double k = 2 * pi_rad * s->frequency_hz / light_mps;
    if (s->count > out->capacity) {
        ScatterCentre *larger = realloc(out->centre, (size_t)s->count * sizeof *larger);
        if (!larger) return STATUS_NO_MEMORY;
        out->centre = larger;
        out->capacity = s->count;
    }
    out->count = s->count;
    out->tubes_same_m2 = s->tubes_same_m2;
    out->tubes_cross_m2 = s->tubes_cross_m2;
    Job       job = {out, s, tx, rx, k};
    const int blocks = (s->count + block - 1) / block;
    if (pool) pool_run(pool, blocks, see_block, &job);
    else
        for (int b = 0; b < blocks; b++) see_block(&job, 0, b);
    return STATUS_OK;
}

void centres_field(ScatterMatrix *out, const Centres *centres, double frequency_hz)
{
    const double k = 2 * pi_rad * frequency_hz / light_mps;
    *out = (ScatterMatrix){0};
    for (int i = 0; i < centres->count; i++) {
        const ScatterCentre *c = &centres->centre[i];
        const double complex wave = CMPLX(cos(k * c->path_m), -sin(k * c->path_m));
        out->hh += c->s.hh * wave, out->hv += c->s.hv * wave, out->vh += c->s.vh * wave, out->vv += c->s.vv * wave;
    }
}

void centres_free(Centres *c)
{
    free(c->centre);
    *c = (Centres){0};
}

/* ---- error -------------------------------------------------------------------------------------- */

/* Share of a tube's power that is error, fitted to a tank at 10 and 35 GHz. Co-polarised fields come mostly from whole
 * faces, whose tubes are wrong at their edges alone; cross-polarised fields come from edges and corners. */
static const double same_share = 0.25, cross_share = 0.9;

void signature_error(SignatureError *out, const Centres *centres)
{
    *out = (SignatureError){same_share * centres->tubes_same_m2, cross_share * centres->tubes_cross_m2};
}

double signature_error_db(double complex s, double error_m2)
{
    const double amplitude = cabs(s);
    return amplitude > 0 ? 10 * log10(1 + sqrt(2 * error_m2) / amplitude) : NAN;
}
