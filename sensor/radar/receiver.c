/* sensor/radar/receiver.c: see receiver.h. */
#include "sensor/radar/receiver.h"

#include "render/radar/radar_equation.h"

double receiver_noise_w(const Receiver *receiver, const Waveform *wave)
{
    return radar_noise_w(waveform_noise_hz(wave), receiver->noise_figure);
}

static void add_noise(Interval *interval, double sigma, uint64_t seed, uint32_t stream, uint32_t number)
{
    enum { block = 512 };
    const size_t count = interval_channels * (size_t)interval->wave.pulses * (size_t)interval->wave.samples;
    double       draw[2 * block];
    for (size_t first = 0; first < count; first += block) {
        const size_t n = count - first < block ? count - first : block;
        random_normals(draw, 2 * n, seed, stream, number, 2 * first);
        for (size_t i = 0; i < n; i++) interval->sample[first + i] += sigma * (draw[2 * i] + I * draw[2 * i + 1]);
    }
}

/* A pulse is a row, but of a stepped burst each sample. */
static void add_phase_noise(Interval *interval, double sigma, uint64_t seed, uint32_t stream, uint32_t number)
{
    const Waveform *wave = &interval->wave;
    const int       length = wave->kind == WAVEFORM_STEPPED ? 1 : wave->samples;
    const size_t    plane = (size_t)wave->pulses * (size_t)wave->samples;
    for (size_t first = 0; first < plane; first += (size_t)length) {
        const double         phase = sigma * random_normal(seed, stream, number, first / (size_t)length);
        const double complex turn = cos(phase) + I * sin(phase);
        for (int c = 0; c < interval_channels; c++)
            for (int i = 0; i < length; i++) interval->sample[(size_t)c * plane + first + (size_t)i] *= turn;
    }
}

static double to_counts(double x, double last, long *saturated)
{
    const double count = nearbyint(x);
    if (count < last && count > -last - 1) return count;
    ++*saturated;
    return clamp(count, -last - 1, last);
}

void receiver_apply(ReceiverReport *report, Interval *interval, const Receiver *r, uint64_t seed, uint32_t stream,
                    uint32_t number)
{
    const Waveform *wave = &interval->wave;
    const size_t    count = interval_channels * (size_t)wave->pulses * (size_t)wave->samples;
    double complex *v = interval->sample;
    *report = (ReceiverReport){.noise_w = receiver_noise_w(r, wave), .counts_per_sqrt_w = 1};
    const double sigma = sqrt(report->noise_w / 2); /* of I, and of Q */

    if (r->phase_noise_rad > 0) add_phase_noise(interval, r->phase_noise_rad, seed, stream + 1, number);
    add_noise(interval, sigma, seed, stream, number);
    if (r->iq_gain != 0 || r->iq_phase_rad != 0) {
        const double across = (1 + r->iq_gain) * sin(r->iq_phase_rad), along = (1 + r->iq_gain) * cos(r->iq_phase_rad);
        for (size_t i = 0; i < count; i++) v[i] = creal(v[i]) + I * (along * cimag(v[i]) - across * creal(v[i]));
    }
    if (r->bits == 0) return;

    const double last = ldexp(1, r->bits - 1) - 1;
    double       peak = 0;
    for (size_t i = 0; i < count; i++) peak = fmax(peak, fmax(fabs(creal(v[i])), fabs(cimag(v[i]))));
    const double gain = fmin(r->noise_counts / sigma, peak > 0 ? 0.9 * last / peak : INFINITY);
    for (size_t i = 0; i < count; i++)
        v[i] = to_counts(gain * creal(v[i]), last, &report->saturated) / gain +
               I * (to_counts(gain * cimag(v[i]), last, &report->saturated) / gain);
    report->counts_per_sqrt_w = gain;
}
