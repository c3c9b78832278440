/* sensor/radar/waveform.h: when and at which frequency a radar takes each sample of a coherent interval.
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
#ifndef SENSOR_RADAR_WAVEFORM_H
#define SENSOR_RADAR_WAVEFORM_H

#include "pitviper.h"

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

/* From one sample of a row to the next, s. */
double waveform_step_s(const Waveform *wave);
/* Of a row, that its samples take: 0 .. 1. */
double waveform_share_of_row(const Waveform *wave);
/* t(m, n), s; f(m), Hz. */
double waveform_time_s(const Waveform *wave, int m, int n);
double waveform_frequency_hz(const Waveform *wave, int m);
/* Noise bandwidth of a sample, Hz: that of the signal to noise of a matched filter, P pulse / (k T F) a pulse. */
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

/* Times and limits that follow. */
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

#endif
