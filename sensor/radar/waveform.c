/* sensor/radar/waveform.c: times, frequencies and limits of each kind of waveform. */
#include "sensor/radar/waveform.h"

#include "render/scattering/scatter.h"

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
