/* sensor/detector/transform.c: FFTW's plans. */
#include "sensor/detector/transform.h"

#include <fftw3.h>
#include <pthread.h>
#include <stdlib.h>

/* FFTW's planner is not safe for threads; executing is. */
static pthread_mutex_t planner = PTHREAD_MUTEX_INITIALIZER;

struct Transform {
    fftw_plan plan;
};

Status transform_create(Transform **out, TransformKind kind, int rows, int columns, double *from, double *to)
{
    /* no vector code, whatever the processor has: the same bits on every one */
    static const unsigned      flags = FFTW_ESTIMATE | FFTW_NO_SIMD;
    static const fftw_r2r_kind real[] = {FFTW_REDFT10, FFTW_REDFT01, FFTW_RODFT01};
    Transform                 *t = calloc(1, sizeof *t);
    if (!t) return STATUS_NO_MEMORY;
    pthread_mutex_lock(&planner);
    if (kind == TRANSFORM_WAVES_BACK) {
        t->plan = fftw_plan_dft_c2r_2d(rows, columns, (fftw_complex *)from, to, flags);
    } else if (kind == TRANSFORM_ROWS || kind == TRANSFORM_ROWS_BACK) {
        t->plan = fftw_plan_many_dft(1, &columns, rows, (fftw_complex *)from, NULL, 1, columns, (fftw_complex *)to,
                                     NULL, 1, columns, kind == TRANSFORM_ROWS ? FFTW_FORWARD : FFTW_BACKWARD, flags);
    } else {
        t->plan = fftw_plan_r2r_2d(rows, columns, from, to, real[kind], real[kind], flags);
    }
    pthread_mutex_unlock(&planner);
    if (!t->plan) {
        free(t);
        return STATUS_NO_MEMORY;
    }
    *out = t;
    return STATUS_OK;
}

void transform_destroy(Transform *t)
{
    if (!t) return;
    pthread_mutex_lock(&planner);
    fftw_destroy_plan(t->plan);
    pthread_mutex_unlock(&planner);
    free(t);
}

void transform_run(const Transform *t) { fftw_execute(t->plan); }

double *transform_alloc(size_t count) { return fftw_alloc_real(count); }
void    transform_free(double *values) { fftw_free(values); }
