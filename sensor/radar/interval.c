/* sensor/radar/interval.c: see interval.h. */
#include "sensor/radar/interval.h"

#include "render/radar/scatter.h"
#include "sensor/detector/transform.h"

#include <stdlib.h>

struct IntervalPlan {
    int        samples, pulses;
    double    *range, *doppler;       /* weights, each over its sum */
    double     noise_share;
    double    *rows, *columns;        /* scratch, complex: [pulses][samples], [samples][pulses] */
    Transform *over_samples, *over_pulses;
};

Status interval_plan_create(IntervalPlan **out, const Waveform *wave, const Window *range, const Window *doppler)
{
    const int m = wave->samples, n = wave->pulses;
    if (m < 8 || m % 2 || n < 2 || n % 2) return STATUS_BAD_VALUE;
    IntervalPlan *p = calloc(1, sizeof *p);
    const size_t  count = 2 * (size_t)m * (size_t)n;
    if (!p) return STATUS_NO_MEMORY;
    p->samples = m, p->pulses = n;
    p->range = malloc((size_t)m * sizeof *p->range);
    p->doppler = malloc((size_t)n * sizeof *p->doppler);
    p->rows = transform_alloc(count);
    p->columns = transform_alloc(count);
    Status status = p->range && p->doppler && p->rows && p->columns ? STATUS_OK : STATUS_NO_MEMORY;
    /* a longer path turns samples backwards: exp(-j): undone forwards */
    if (status == STATUS_OK) status = transform_create(&p->over_samples, TRANSFORM_ROWS_BACK, n, m, p->rows, p->rows);
    if (status == STATUS_OK) status = transform_create(&p->over_pulses, TRANSFORM_ROWS_BACK, m, n, p->columns, p->columns);
    if (status == STATUS_OK) status = window_weights(p->range, m, range);
    if (status == STATUS_OK) status = window_weights(p->doppler, n, doppler);
    if (status != STATUS_OK) {
        interval_plan_destroy(p);
        return status;
    }
    p->noise_share = 1;
    double *const weights[] = {p->range, p->doppler};
    const int     counts[] = {m, n};
    for (int k = 0; k < 2; k++) {
        double sum = 0, squares = 0;
        for (int i = 0; i < counts[k]; i++) sum += weights[k][i], squares += weights[k][i] * weights[k][i];
        p->noise_share *= squares / (sum * sum);
        for (int i = 0; i < counts[k]; i++) weights[k][i] /= sum;
    }
    *out = p;
    return STATUS_OK;
}

void interval_plan_destroy(IntervalPlan *p)
{
    if (!p) return;
    transform_destroy(p->over_samples);
    transform_destroy(p->over_pulses);
    transform_free(p->rows);
    transform_free(p->columns);
    free(p->range);
    free(p->doppler);
    free(p);
}

/* Compressed in range, in p->rows; zero range is in the middle: every second sample turns its sign. */
static void compress(IntervalPlan *p, const double complex *sample)
{
    for (int n = 0; n < p->pulses; n++)
        for (int m = 0; m < p->samples; m++) {
            const size_t         at = (size_t)n * (size_t)p->samples + (size_t)m;
            const double complex v = sample[at] * (m % 2 ? -p->range[m] : p->range[m]);
            p->rows[2 * at] = creal(v);
            p->rows[2 * at + 1] = cimag(v);
        }
    transform_run(p->over_samples);
}

void interval_process(RangeDoppler *out, IntervalPlan *p, const Interval *in)
{
    const int m = p->samples, n = p->pulses;
    out->rows = n, out->columns = m;
    out->metre_per_column = light_mps / (2 * in->wave.bandwidth_hz);
    out->mps_per_row = light_mps / in->wave.centre_hz / 2 * in->wave.repeat_hz / n;
    out->noise_share = p->noise_share;
    for (int channel = 0; channel < interval_channels; channel++) {
        const size_t   plane = (size_t)channel * (size_t)m * (size_t)n;
        double complex *cell = out->cell + plane;
        compress(p, in->sample + plane);
        for (int k = 0; k < n; k++)
            for (int i = 0; i < m; i++) {
                const size_t from = (size_t)k * (size_t)m + (size_t)i, to = (size_t)i * (size_t)n + (size_t)k;
                const double w = k % 2 ? -p->doppler[k] : p->doppler[k];
                p->columns[2 * to] = p->rows[2 * from] * w;
                p->columns[2 * to + 1] = p->rows[2 * from + 1] * w;
            }
        transform_run(p->over_pulses);
        for (int i = 0; i < m; i++)
            for (int k = 0; k < n; k++) {
                const size_t from = (size_t)i * (size_t)n + (size_t)k;
                cell[(size_t)k * (size_t)m + (size_t)i] = p->columns[2 * from] + I * p->columns[2 * from + 1];
            }
    }
}

double interval_noise_share(const IntervalPlan *p) { return p->noise_share; }

double interval_lobe(const IntervalPlan *p, bool doppler, double cells)
{
    const int     count = doppler ? p->pulses : p->samples;
    const double *weight = doppler ? p->doppler : p->range, middle = 0.5 * (count - 1), turn = 2 * pi_rad * cells / count;
    double        sum = 0;
    for (int i = 0; i < count; i++) sum += weight[i] * cos(turn * (i - middle));
    return sum;
}

void interval_compress(double complex *out, IntervalPlan *p, const Interval *in, int channel)
{
    const size_t count = (size_t)p->samples * (size_t)p->pulses;
    compress(p, in->sample + (size_t)channel * count);
    for (size_t i = 0; i < count; i++) out[i] = p->rows[2 * i] + I * p->rows[2 * i + 1];
}

void interval_pulse(double complex *out, IntervalPlan *p, const Interval *in, int channel, int pulse)
{
    compress(p, in->sample + (size_t)channel * (size_t)p->samples * (size_t)p->pulses);
    const double *row = p->rows + 2 * (size_t)pulse * (size_t)p->samples;
    for (int m = 0; m < p->samples; m++) out[m] = row[2 * m] + I * row[2 * m + 1];
}

const double *interval_pulses(IntervalPlan *p, const Interval *in, int channel)
{
    compress(p, in->sample + (size_t)channel * (size_t)p->samples * (size_t)p->pulses);
    return p->rows;
}

void interval_profile(double *profile, IntervalPlan *p, const Interval *in, int channel)
{
    compress(p, in->sample + (size_t)channel * (size_t)p->samples * (size_t)p->pulses);
    for (int m = 0; m < p->samples; m++) {
        double power = 0;
        for (int n = 0; n < p->pulses; n++) {
            const size_t at = (size_t)n * (size_t)p->samples + (size_t)m;
            power += p->rows[2 * at] * p->rows[2 * at] + p->rows[2 * at + 1] * p->rows[2 * at + 1];
        }
        profile[m] = power / p->pulses;
    }
}
