/* sensor/radar/receiver.h: what a radar's receiver does to the voltages at its antenna: thermal noise, phase noise
 * of its oscillator, errors between its I and Q channels, and conversion to counts.
 *
 * Noise power in a sample: k 290 K F waveform_noise_hz, so that a pulse compressed from all its samples has the signal
 * to noise of a matched filter, P pulse / (k 290 K F). The antenna is taken to look at 290 K. Phase noise: one normal
 * phase a pulse (a sweep; each pulse of a burst), common to all channels and ranges: what stays of the oscillator's noise
 * after the echo's delay, which nearer echoes have less of in truth.
 * The converter's gain puts the noise at noise_counts, or less where the interval's largest I or Q would pass nine
 * tenths of its range: a gain control that acts within the interval. Samples go back to sqrt(W) by that gain. Draws
 * are functions of seed, stream and interval number (pitviper_random). */
#ifndef SENSOR_RADAR_RECEIVER_H
#define SENSOR_RADAR_RECEIVER_H

#include "sensor/radar/interval.h"

typedef struct Receiver {
    double noise_figure;           /* as a factor, at least 1 */
    double phase_noise_rad;        /* rms, from pulse to pulse */
    double iq_gain, iq_phase_rad;  /* Q over I, less 1; Q's axis beyond a right angle: an image at (gain + j phase) / 2 */
    int    bits;                   /* of a converter, sign included, 2 .. 24; 0: none */
    double noise_counts;           /* rms of I and of Q that noise fills where nothing is large; 1 */
} Receiver;

typedef struct ReceiverReport {
    double noise_w;      /* of a sample, I and Q together */
    double counts_per_sqrt_w;
    long   saturated;    /* I or Q values at the end of the converter's range */
} ReceiverReport;

/* In place. number: of the interval, so that each has noise of its own. */
void receiver_apply(ReceiverReport *report, Interval *interval, const Receiver *receiver, uint64_t seed, uint32_t stream,
                    uint32_t number);
/* Noise power of a sample, W. */
double receiver_noise_w(const Receiver *receiver, const Waveform *wave);

#endif
