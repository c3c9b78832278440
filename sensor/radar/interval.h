/* sensor/radar/interval.h: one coherent interval of a radar: pulses sampled over frequency in four channels, and its
 * map of range and Doppler.
 *
 * Samples are in units of sqrt(W) at the antenna's port: a steady echo of received power p has |sample| = sqrt(p)
 * everywhere. The map is scaled alike: a point echo peaks at sqrt(p), whatever the windows. The receiver follows the
 * reference path, so range and Doppler are relative to it. Rows are pulses, sweeps or bursts (waveform.h). */
#ifndef SENSOR_RADAR_INTERVAL_H
#define SENSOR_RADAR_INTERVAL_H

#include "sensor/radar/waveform.h"
#include "sensor/radar/window.h"

#include <complex.h>

/* Of the sum beam, the two difference beams, and of the sum beam in the polarisation that is not transmitted. */
enum { CHANNEL_SUM, CHANNEL_RIGHT, CHANNEL_DOWN, CHANNEL_CROSS, interval_channels };

typedef struct Interval {
    Waveform        wave;
    double complex *sample; /* [channels][pulses][samples] */
} Interval;

/* Windowed and transformed: rows of Doppler, from approaching (negative rate of path) to receding, columns of range,
 * nearest first; the reference is at row pulses / 2, column samples / 2. */
typedef struct RangeDoppler {
    int             rows, columns;
    double          metre_per_column, mps_per_row; /* of range (half the path) and its rate */
    double          noise_share;                   /* of a sample's noise power that is in a cell */
    double complex *cell;                          /* [channels][rows][columns] */
} RangeDoppler;

/* The two maps for processing; holds the compressed pulses of one interval at a time. */
typedef struct IntervalPlan IntervalPlan;
Status interval_plan_create(IntervalPlan **out, const Waveform *wave, const Window *range, const Window *doppler);
void   interval_plan_destroy(IntervalPlan *plan); /* accepts NULL */
/* Compresses the pulses of the first so many channels in range. pool may be NULL. */
void interval_compress(IntervalPlan *plan, const Interval *in, int channels, Pool *pool);
/* Compresses all channels, and transforms them over the pulses. out->cell: [channels][pulses][samples]; the rest is
 * filled. */
void interval_process(RangeDoppler *out, IntervalPlan *plan, const Interval *in, Pool *pool);
/* Of a map: RangeDoppler.noise_share. */
double interval_noise_share(const IntervalPlan *plan);
/* Amplitude at an offset of up to 1.5 cells of the response to a point, 1 at 0, over range or over Doppler; to 1e-7. */
double interval_lobe(const IntervalPlan *plan, bool doppler, double cells);
/* Of a channel that was compressed: all pulses, [pulses][samples] complex. */
const double *interval_pulses(const IntervalPlan *plan, int channel);
/* Complex range profile of one pulse: out[samples]. */
void interval_pulse(double complex *out, const IntervalPlan *plan, int channel, int pulse);
/* Range profile over all pulses, without Doppler: profile[samples], mean power over pulses. */
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

/* In place. number: of the interval, so that each has noise of its own. */
void interval_receive(ReceiverReport *report, Interval *interval, const Receiver *receiver, uint64_t seed,
                      uint32_t stream, uint32_t number);
/* Noise power of a sample, W. */
double interval_receiver_noise_w(const Receiver *receiver, const Waveform *wave);

#endif
