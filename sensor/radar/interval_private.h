/* sensor/radar/interval_private.h: one coherent interval of a radar: pulses sampled over frequency in four channels,
 * its waveform, and its map of range and Doppler.
 *
 * Samples are in units of sqrt(W) at the antenna's port: a steady echo of received power p has |sample| = sqrt(p)
 * everywhere. The map is scaled alike: a point echo peaks at sqrt(p), whatever the windows. The receiver follows the
 * reference path, so range and Doppler are relative to it. Rows are pulses, sweeps or bursts (Waveform). */
#ifndef SENSOR_RADAR_INTERVAL_PRIVATE_H
#define SENSOR_RADAR_INTERVAL_PRIVATE_H

#include "pitviper.h"
#include "sensor/radar/window_private.h"

#include <complex.h>

/* ---- waveforms ------------------------------------------------------------------------------- */

/* When and at which frequency a radar takes each sample of a coherent interval.
 *
 * Sample m = 0 .. samples - 1 of row n = 0 .. pulses - 1 lies at
 *
 *     f(m)    = centre + (m - samples / 2) bandwidth / samples
 *     t(m, n) = (n - (pulses - 1) / 2) / repeat + (m - samples / 2) step
 *
 * from the middle of the interval. An echo whose two-way path is longer by path + rate t than that to the reference,
 * which the receiver follows, adds a exp(-j 2 pi f(m) (path + rate t(m, n)) / c) to it (echo.h). What follows from
 * the times: a rate moves an echo in range by centre step samples / bandwidth times itself (range-Doppler coupling),
 * and smears it by the term in m^2.
 *
 *   lfm            a pulse swept over the band, a row each: step = pulse / samples. Deramped or by matched filter;
 *                  the residual video phase of a deramped echo is taken out
 *   stepped        a row is a burst of `samples` pulses, one frequency each, `repeat * samples` pulses a second:
 *                  step = 1 / (repeat samples). Echoes of earlier pulses are at other frequencies: not received
 *   pulse_doppler  coded or plain pulses, all frequencies at once: step = 0. bandwidth = samples repeat: the range
 *                  window is the unambiguous range. The receiver is blanked while the radar transmits
 *   fmcw           a continuous sweep, a row each, mixed with what is transmitted: step = sweep / samples. The range
 *                  window begins at 0; what beats faster than samples / sweep is cut off. An echo mixes with its own
 *                  sweep only after its delay
 *
 * Sources: D. R. Wehner, High-Resolution Radar, 2nd ed. 1995 (stepped frequency, coupling); M. I. Skolnik,
 * Introduction to Radar Systems, 3rd ed. 2001, ch. 3 (pulse Doppler, eclipsing, blind speeds); A. G. Stove, IEE Proc. F
 * 139(5), 1992 (FMCW). */
typedef enum WaveformKind {
    WAVEFORM_LFM,
    WAVEFORM_STEPPED,
    WAVEFORM_PULSE_DOPPLER,
    WAVEFORM_FMCW,
    waveform_kinds
} WaveformKind;
extern const char *const waveform_name[waveform_kinds];

typedef struct Waveform {
    WaveformKind kind;
    double       centre_hz, bandwidth_hz; /* step between samples: bandwidth / samples */
    double       pulse_s;                 /* that is transmitted: fmcw, the sweep; stepped, each of a burst's pulses */
    double       repeat_hz;               /* of rows: of pulses, sweeps or bursts */
    int          samples, pulses;         /* of a row; rows. Both even */
    bool         uncompensated; /* the receiver does not follow the rate of the reference's path, but its middle */
} Waveform;

/* Time from one sample of a row to the next, s. */
double waveform_step_s(const Waveform *wave);
/* Share of a row, 0 .. 1, over which its samples are taken. */
double waveform_share_of_row(const Waveform *wave);
/* t(m, n), s; f(m), Hz. */
double waveform_time_s(const Waveform *wave, int m, int n);
double waveform_frequency_hz(const Waveform *wave, int m);
/* Noise bandwidth of a sample, Hz, for which a matched filter has the signal to noise P pulse / (k T F) a pulse. */
double waveform_noise_hz(const Waveform *wave);
/* Amplitude that is left of an echo by what its receiver misses of it: pulse_doppler, the share of the pulse that
 * arrives while nothing is transmitted; fmcw, the share of the sweep that overlaps its echo. 1 for others. A share
 * that arrives is as wide in range as the whole. */
double waveform_share(const Waveform *wave, double range_m);
/* Range by which echoes fold over, m: c / (2 repeat) of lfm and pulse_doppler; INFINITY: those of earlier pulses
 * are not received. */
double waveform_fold_m(const Waveform *wave);

/* Where on the range window an echo appears, from its middle: off_m beyond the reference, with a range rate that the
 * receiver does not follow: folded over and coupled. */
double waveform_appears_m(const Waveform *wave, double off_m, double rate_mps);

/* The times and limits that follow from a waveform. */
typedef struct WaveformTiming {
    double sample_s;      /* from one sample to the next */
    double profile_s;     /* over which the samples of a range profile are taken; 0: at once */
    double row_s;         /* from one profile to the next */
    double interval_s;    /* coherent interval: rows times row_s */
    double window_m;      /* range window: of samples, c samples / (2 bandwidth) */
    double unambiguous_m; /* c / (2 pulse repetition frequency); stepped: the window; fmcw: of the greatest beat */
    double blind_mps;  /* range rates apart by it look alike: wavelength / 2 row_s. Multiples are the canceller's blind
                          speeds */
    double coupling_s; /* an echo appears farther by it times its range rate */
    double smear_s;    /* and is smeared in range over it times its range rate: twice profile_s */
    double beat_hz_m;  /* of beat frequency a metre of range: lfm and fmcw, else 0 */
} WaveformTiming;
void waveform_timing(WaveformTiming *out, const Waveform *wave);

/* Of the sum beam, the two difference beams, and of the sum beam in the polarisation that is not transmitted. */
enum { CHANNEL_SUM, CHANNEL_RIGHT, CHANNEL_DOWN, CHANNEL_CROSS, interval_channels };

typedef struct Interval {
    Waveform        wave;
    double complex *sample; /* [channels][pulses][samples] */
    Pool           *pool;   /* of the receiver; NULL: one thread */
} Interval;

/* Windowed and transformed: rows of Doppler, from approaching (negative rate of path) to receding, columns of range,
 * nearest first; the reference is at row pulses / 2, column samples / 2. */
typedef struct RangeDoppler {
    int             rows, columns;
    double          metre_per_column, mps_per_row; /* of range (half the path) and its rate */
    double          noise_share;                   /* of a sample's noise power that is in a cell */
    double complex *cell;                          /* [channels][rows][columns] */
} RangeDoppler;

/* The plan by which intervals are processed into maps; it holds the compressed pulses of one interval at a time. */
typedef struct IntervalPlan IntervalPlan;
Status interval_plan_create(IntervalPlan **out, const Waveform *wave, const Window *range, const Window *doppler);
void   interval_plan_destroy(IntervalPlan *plan); /* accepts NULL */
/* Compresses the pulses of the first so many channels in range. pool may be NULL. */
void interval_compress(IntervalPlan *plan, const Interval *in, int channels, Pool *pool);
/* Compresses all channels, and transforms them over the pulses. out->cell: [channels][pulses][samples]; the rest is
 * filled. */
void interval_process(RangeDoppler *out, IntervalPlan *plan, const Interval *in, Pool *pool);
/* RangeDoppler.noise_share of the maps that the plan makes. */
double interval_noise_share(const IntervalPlan *plan);
/* Amplitude at an offset of up to 1.5 cells of the response to a point, 1 at 0, over range or over Doppler; to 1e-7. */
double interval_lobe(const IntervalPlan *plan, bool doppler, double cells);
/* Of a channel that was compressed: all pulses, [pulses][samples] complex. */
const double *interval_pulses(const IntervalPlan *plan, int channel);
/* Gives the complex range profile of one pulse: out[samples]. */
void interval_pulse(double complex *out, const IntervalPlan *plan, int channel, int pulse);
/* Gives the range profile over all pulses, without Doppler: profile[samples], the mean power over pulses. */
void interval_profile(double *profile, const IntervalPlan *plan, int channel);

/* ---- the receiver ------------------------------------------------------------------------------- */

/* What a radar's receiver does to the voltages at its antenna: thermal noise, phase noise of its oscillator, errors
 * between its I and Q channels, and conversion to counts.
 *
 * Noise power in a sample: k 290 K F waveform_noise_hz, so that a pulse compressed from all its samples has the
 * signal to noise of a matched filter, P pulse / (k 290 K F). The antenna is taken to look at 290 K. Phase noise:
 * one normal phase a pulse (a sweep; each pulse of a burst), common to all channels and ranges: what stays of the
 * oscillator's noise after the echo's delay, which nearer echoes have less of in truth. The converter's gain puts
 * the noise at noise_counts, or less where the interval's largest I or Q would pass nine tenths of its range: a
 * gain control that acts within the interval. Samples go back to sqrt(W) by that gain. Draws are functions of seed,
 * stream and interval number (pitviper_random). */
typedef struct Receiver {
    double noise_figure;    /* as a factor, at least 1 */
    double phase_noise_rad; /* rms, from pulse to pulse */
    double iq_gain,
        iq_phase_rad;    /* Q over I, less 1; Q's axis beyond a right angle: an image at (gain + j phase) / 2 */
    int    bits;         /* of a converter, sign included, 2 .. 24; 0: none */
    double noise_counts; /* rms of I and of Q that noise fills where nothing is large; 1 */
} Receiver;

typedef struct ReceiverReport {
    double noise_w; /* of a sample, I and Q together */
    double counts_per_sqrt_w;
    long   saturated; /* I or Q values at the end of the converter's range */
} ReceiverReport;

/* Changes the samples in place. number: that of the interval, so that each has noise of its own. */
void interval_receive(ReceiverReport *report, Interval *interval, const Receiver *receiver, uint64_t seed,
                      uint32_t stream, uint32_t number);
/* Noise power of a sample, W. */
double interval_receiver_noise_w(const Receiver *receiver, const Waveform *wave);

#endif
