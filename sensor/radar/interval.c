/* sensor/radar/interval.c: waveforms; a receiver's errors; pulses compressed and transformed over the rows. */
#include "sensor/radar/interval_private.h"
#include "render/scattering/scatter.h"
#include "sensor/detector/transform.h"
#include "render/scattering/paths/radar_path.h"

#include <pthread.h>
#include <stdlib.h>

/* ---- waveforms ------------------------------------------------------------------------------- */

/* Times, frequencies and limits of each kind of waveform. */
const char *const waveform_name[waveform_kinds] = {"lfm", "stepped", "pulse_doppler", "fmcw"};

double waveform_step_s(const Waveform *w)
{
    switch (w->kind) {
    case WAVEFORM_STEPPED:
        return 1 / (w->repeat_hz * w->samples);
    case WAVEFORM_PULSE_DOPPLER:
        return 0;
    default:
        return w->pulse_s / w->samples;
    }
}

double waveform_share_of_row(const Waveform *w) { return waveform_step_s(w) * w->repeat_hz * w->samples; }

double waveform_time_s(const Waveform *w, int m, int n)
{
    return (n - 0.5 * (w->pulses - 1)) / w->repeat_hz + (m - w->samples / 2) * waveform_step_s(w);
}

double waveform_frequency_hz(const Waveform *w, int m)
{
    return w->centre_hz + (m - w->samples / 2) * w->bandwidth_hz / w->samples;
}

double waveform_noise_hz(const Waveform *w) { return (w->kind == WAVEFORM_STEPPED ? 1 : w->samples) / w->pulse_s; }

double waveform_fold_m(const Waveform *w)
{
    const bool folds = w->kind == WAVEFORM_LFM || w->kind == WAVEFORM_PULSE_DOPPLER;
    return folds ? light_mps / (2 * w->repeat_hz) : INFINITY;
}

double waveform_share(const Waveform *w, double range_m)
{
    const double delay_s = 2 * range_m / light_mps, row_s = 1 / w->repeat_hz;
    if (w->kind == WAVEFORM_FMCW) return clamp(1 - delay_s / w->pulse_s, 0, 1);
    if (w->kind != WAVEFORM_PULSE_DOPPLER) return 1;
    /* what arrives from the end of one transmission to the beginning of the next */
    const double begins_s = fmod(delay_s, row_s);
    return fmax(0, fmin(begins_s + w->pulse_s, row_s) - fmax(begins_s, w->pulse_s)) / w->pulse_s;
}

void waveform_timing(WaveformTiming *out, const Waveform *w)
{
    const double wave_m = light_mps / w->centre_hz;
    *out = (WaveformTiming){.sample_s = waveform_step_s(w), .row_s = 1 / w->repeat_hz};
    out->profile_s = out->sample_s * w->samples;
    out->interval_s = w->pulses * out->row_s;
    out->window_m = light_mps * w->samples / (2 * w->bandwidth_hz);
    out->unambiguous_m = isfinite(waveform_fold_m(w)) ? waveform_fold_m(w) : out->window_m;
    out->blind_mps = wave_m / 2 * w->repeat_hz;
    out->coupling_s = w->centre_hz * out->profile_s / w->bandwidth_hz;
    out->smear_s = 2 * out->profile_s;
    if (w->kind == WAVEFORM_LFM || w->kind == WAVEFORM_FMCW)
        out->beat_hz_m = 2 * w->bandwidth_hz / (light_mps * w->pulse_s);
}

double waveform_appears_m(const Waveform *w, double off_m, double rate_mps)
{
    WaveformTiming t;
    waveform_timing(&t, w);
    const double fold_m = waveform_fold_m(w);
    if (isfinite(fold_m)) off_m -= fold_m * nearbyint(off_m / fold_m);
    off_m += t.coupling_s * rate_mps;
    return off_m - t.window_m * nearbyint(off_m / t.window_m);
}

enum { lobe_steps = 64, lobe_points = 3 * lobe_steps / 2 + 4 }; /* a cell; from one step before 0 to two beyond 1.5 */

struct IntervalPlan {
    int        samples, pulses;
    double    *range, *doppler; /* weights, each over its sum */
    double     noise_share;
    double     lobe[2][lobe_points];       /* over range, over Doppler */
    double    *rows[interval_channels];    /* complex: [pulses][samples], compressed */
    double    *columns[interval_channels]; /* scratch: [samples][pulses] */
    Transform *over_samples[interval_channels], *over_pulses[interval_channels];
};

static double lobe_at(const double *weight, int count, double cells)
{
    const double middle = 0.5 * (count - 1), turn = 2 * pi_rad * cells / count;
    double       sum = 0;
    for (int i = 0; i < count; i++) sum += weight[i] * cos(turn * (i - middle));
    return sum;
}

static Status make_weights(IntervalPlan *p, const Window *range, const Window *doppler)
{
    Status status = window_weights(p->range, p->samples, range);
    if (status == STATUS_OK) status = window_weights(p->doppler, p->pulses, doppler);
    if (status != STATUS_OK) return status;
    p->noise_share = 1;
    double *const weights[] = {p->range, p->doppler};
    const int     counts[] = {p->samples, p->pulses};
    for (int k = 0; k < 2; k++) {
        double sum = 0, squares = 0;
        for (int i = 0; i < counts[k]; i++) sum += weights[k][i], squares += weights[k][i] * weights[k][i];
        p->noise_share *= squares / (sum * sum);
        for (int i = 0; i < counts[k]; i++) weights[k][i] /= sum;
        for (int i = 0; i < lobe_points; i++) p->lobe[k][i] = lobe_at(weights[k], counts[k], (i - 1.0) / lobe_steps);
    }
    return STATUS_OK;
}

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
    Status status = p->range && p->doppler ? make_weights(p, range, doppler) : STATUS_NO_MEMORY;
    for (int c = 0; c < interval_channels && status == STATUS_OK; c++) {
        double *rows = p->rows[c] = transform_alloc(count), *columns = p->columns[c] = transform_alloc(count);
        if (!rows || !columns) status = STATUS_NO_MEMORY;
        /* a longer path turns samples backwards: exp(-j): undone forwards */
        if (status == STATUS_OK) status = transform_create(&p->over_samples[c], TRANSFORM_ROWS_BACK, n, m, rows, rows);
        if (status == STATUS_OK)
            status = transform_create(&p->over_pulses[c], TRANSFORM_ROWS_BACK, m, n, columns, columns);
    }
    if (status == STATUS_OK) *out = p;
    else interval_plan_destroy(p);
    return status;
}

void interval_plan_destroy(IntervalPlan *p)
{
    if (!p) return;
    for (int c = 0; c < interval_channels; c++) {
        transform_destroy(p->over_samples[c]);
        transform_destroy(p->over_pulses[c]);
        transform_free(p->rows[c]);
        transform_free(p->columns[c]);
    }
    free(p->range);
    free(p->doppler);
    free(p);
}

typedef struct Job {
    IntervalPlan   *plan;
    const Interval *in;
    double complex *cell; /* NULL: compressed only */
} Job;

/* Zero range is in the middle: every second sample turns its sign. */
static void compress(IntervalPlan *p, const double complex *sample, int channel)
{
    double *rows = p->rows[channel];
    for (int n = 0; n < p->pulses; n++)
        for (int m = 0; m < p->samples; m++) {
            const size_t         at = (size_t)n * (size_t)p->samples + (size_t)m;
            const double complex v = sample[at] * (m % 2 ? -p->range[m] : p->range[m]);
            rows[2 * at] = creal(v);
            rows[2 * at + 1] = cimag(v);
        }
    transform_run(p->over_samples[channel]);
}

static void over_pulses(double complex *cell, IntervalPlan *p, int channel)
{
    enum { tile = 8 };
    const int     m = p->samples, n = p->pulses;
    const double *rows = p->rows[channel];
    double       *columns = p->columns[channel];
    for (int i0 = 0; i0 < m; i0 += tile)
        for (int k = 0; k < n; k++)
            for (int i = i0; i < i0 + tile && i < m; i++) {
                const size_t from = (size_t)k * (size_t)m + (size_t)i, to = (size_t)i * (size_t)n + (size_t)k;
                const double w = k % 2 ? -p->doppler[k] : p->doppler[k];
                columns[2 * to] = rows[2 * from] * w;
                columns[2 * to + 1] = rows[2 * from + 1] * w;
            }
    transform_run(p->over_pulses[channel]);
    for (int i0 = 0; i0 < m; i0 += tile)
        for (int k = 0; k < n; k++)
            for (int i = i0; i < i0 + tile && i < m; i++) {
                const size_t from = (size_t)i * (size_t)n + (size_t)k;
                cell[(size_t)k * (size_t)m + (size_t)i] = CMPLX(columns[2 * from], columns[2 * from + 1]);
            }
}

static void process_channel(void *user, int worker, int channel)
{
    const Job   *job = user;
    const size_t plane = (size_t)channel * (size_t)job->plan->samples * (size_t)job->plan->pulses;
    (void)worker;
    compress(job->plan, job->in->sample + plane, channel);
    if (job->cell) over_pulses(job->cell + plane, job->plan, channel);
}

static void run(Job *job, int channels, Pool *pool)
{
    if (pool) pool_run(pool, channels, process_channel, job);
    else
        for (int c = 0; c < channels; c++) process_channel(job, 0, c);
}

void interval_compress(IntervalPlan *p, const Interval *in, int channels, Pool *pool)
{
    run(&(Job){p, in, NULL}, channels, pool);
}

void interval_process(RangeDoppler *out, IntervalPlan *p, const Interval *in, Pool *pool)
{
    out->rows = p->pulses, out->columns = p->samples;
    out->metre_per_column = light_mps / (2 * in->wave.bandwidth_hz);
    out->mps_per_row = light_mps / in->wave.centre_hz / 2 * in->wave.repeat_hz / p->pulses;
    out->noise_share = p->noise_share;
    run(&(Job){p, in, out->cell}, interval_channels, pool);
}

double interval_noise_share(const IntervalPlan *p) { return p->noise_share; }

/* Interpolates by the cubic through four neighbours. */
double interval_lobe(const IntervalPlan *p, bool doppler, double cells)
{
    const double  at = fmin(fabs(cells), 1.5) * lobe_steps;
    const int     first = (int)at;
    const double *of = p->lobe[doppler] + first, t = at - first; /* of[1] lies at first */
    return of[0] * t * (t - 1) * (2 - t) / 6 + of[1] * (t + 1) * (t - 1) * (t - 2) / 2 +
           of[2] * (t + 1) * t * (2 - t) / 2 + of[3] * (t + 1) * t * (t - 1) / 6;
}

const double *interval_pulses(const IntervalPlan *p, int channel) { return p->rows[channel]; }

void interval_pulse(double complex *out, const IntervalPlan *p, int channel, int pulse)
{
    const double *row = p->rows[channel] + 2 * (size_t)pulse * (size_t)p->samples;
    for (int m = 0; m < p->samples; m++) out[m] = CMPLX(row[2 * m], row[2 * m + 1]);
}

void interval_profile(double *profile, const IntervalPlan *p, int channel)
{
    const double *row = p->rows[channel];
    for (int m = 0; m < p->samples; m++) profile[m] = 0;
    for (int n = 0; n < p->pulses; n++, row += 2 * (size_t)p->samples)
        for (int m = 0; m < p->samples; m++)
            profile[m] += (row[2 * m] * row[2 * m] + row[2 * m + 1] * row[2 * m + 1]) / p->pulses;
}

/* ---- the receiver ------------------------------------------------------------------------------- */

double interval_receiver_noise_w(const Receiver *receiver, const Waveform *wave)
{
    return radar_noise_w(waveform_noise_hz(wave), receiver->noise_figure);
}

/* A row of one channel, a pulse or burst, after another. */
typedef struct Reception {
    Interval       *interval;
    const Receiver *receiver;
    double          sigma; /* of noise, in I and in Q */
    uint64_t        seed;
    uint32_t        stream, number;
    double          last, gain; /* of the converter: its greatest count, counts per sqrt(W) */
    pthread_mutex_t lock;       /* of what follows */
    double          peak;
    long            saturated;
} Reception;

static void run_rows(Reception *r, PoolTask *row)
{
    const int rows = interval_channels * r->interval->wave.pulses;
    if (r->interval->pool) pool_run(r->interval->pool, rows, row, r);
    else
        for (int i = 0; i < rows; i++) row(r, 0, i);
}

static void add_noise(double complex *row, const Reception *r, size_t first, size_t count)
{
    enum { block = 512 };
    double draw[2 * block];
    for (size_t done = 0; done < count; done += block) {
        const size_t n = count - done < block ? count - done : block;
        random_normals(draw, 2 * n, r->seed, r->stream, r->number, 2 * (first + done));
        for (size_t i = 0; i < n; i++) row[done + i] += r->sigma * (draw[2 * i] + I * draw[2 * i + 1]);
    }
}

/* From pulse to pulse, the same in all channels; of a stepped burst each sample is a pulse. */
static void add_phase_noise(double complex *row, const Reception *r, int pulse)
{
    const Waveform *wave = &r->interval->wave;
    const int       length = wave->kind == WAVEFORM_STEPPED ? 1 : wave->samples;
    const size_t    first = (size_t)pulse * (size_t)wave->samples;
    for (int at = 0; at < wave->samples; at += length) {
        const double phase = r->receiver->phase_noise_rad *
                             random_normal(r->seed, r->stream + 1, r->number, (first + (size_t)at) / (size_t)length);
        const double complex turn = cos(phase) + I * sin(phase);
        for (int i = 0; i < length; i++) row[at + i] *= turn;
    }
}

static void receive_row(void *user, int worker, int task)
{
    Reception      *r = user;
    const Receiver *of = r->receiver;
    const size_t    samples = (size_t)r->interval->wave.samples, first = (size_t)task * samples;
    double complex *v = r->interval->sample + first;
    double          peak = 0;
    (void)worker;
    if (of->phase_noise_rad > 0) add_phase_noise(v, r, task % r->interval->wave.pulses);
    add_noise(v, r, first, samples);
    if (of->iq_gain != 0 || of->iq_phase_rad != 0) {
        const double across = (1 + of->iq_gain) * sin(of->iq_phase_rad),
                     along = (1 + of->iq_gain) * cos(of->iq_phase_rad);
        for (size_t i = 0; i < samples; i++) v[i] = creal(v[i]) + I * (along * cimag(v[i]) - across * creal(v[i]));
    }
    for (size_t i = 0; i < samples; i++) peak = fmax(peak, fmax(fabs(creal(v[i])), fabs(cimag(v[i]))));
    pthread_mutex_lock(&r->lock);
    r->peak = fmax(r->peak, peak);
    pthread_mutex_unlock(&r->lock);
}

static double to_counts(double x, double last, long *saturated)
{
    const double count = nearbyint(x);
    if (count < last && count > -last - 1) return count;
    ++*saturated;
    return clamp(count, -last - 1, last);
}

static void convert_row(void *user, int worker, int task)
{
    Reception      *r = user;
    const int       samples = r->interval->wave.samples;
    const double    gain = r->gain, last = r->last;
    double complex *v = r->interval->sample + (size_t)task * (size_t)samples;
    long            saturated = 0;
    (void)worker;
    for (int i = 0; i < samples; i++)
        v[i] = to_counts(gain * creal(v[i]), last, &saturated) / gain +
               I * (to_counts(gain * cimag(v[i]), last, &saturated) / gain);
    if (saturated == 0) return;
    pthread_mutex_lock(&r->lock);
    r->saturated += saturated;
    pthread_mutex_unlock(&r->lock);
}

void interval_receive(ReceiverReport *report, Interval *interval, const Receiver *receiver, uint64_t seed,
                      uint32_t stream, uint32_t number)
{
    *report = (ReceiverReport){.noise_w = interval_receiver_noise_w(receiver, &interval->wave), .counts_per_sqrt_w = 1};
    Reception r = {.interval = interval,
                   .receiver = receiver,
                   .sigma = sqrt(report->noise_w / 2),
                   .seed = seed,
                   .stream = stream,
                   .number = number,
                   .lock = PTHREAD_MUTEX_INITIALIZER};
    run_rows(&r, receive_row);
    if (receiver->bits > 0) {
        r.last = ldexp(1, receiver->bits - 1) - 1;
        r.gain = fmin(receiver->noise_counts / r.sigma, r.peak > 0 ? 0.9 * r.last / r.peak : INFINITY);
        run_rows(&r, convert_row);
        report->saturated = r.saturated;
        report->counts_per_sqrt_w = r.gain;
    }
    pthread_mutex_destroy(&r.lock);
}
