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
    double complex *sample;         /* [channels][pulses][samples] */
} Interval;

/* Windowed and transformed: rows of Doppler, from approaching (negative rate of path) to receding, columns of range,
 * nearest first; the reference is at row pulses / 2, column samples / 2. */
typedef struct RangeDoppler {
    int             rows, columns;
    double          metre_per_column, mps_per_row; /* of range (half the path) and its rate */
    double          noise_share;    /* of a sample's noise power that is in a cell */
    double complex *cell;           /* [channels][rows][columns] */
} RangeDoppler;

/* The two maps for processing; holds the compressed pulses of one interval at a time. */
typedef struct IntervalPlan IntervalPlan;
Status interval_plan_create(IntervalPlan **out, const Waveform *wave, const Window *range, const Window *doppler);
void   interval_plan_destroy(IntervalPlan *plan); /* accepts NULL */
/* Compresses the pulses of the first so many channels in range. pool may be NULL. */
void   interval_compress(IntervalPlan *plan, const Interval *in, int channels, Pool *pool);
/* Compresses all channels, and transforms them over the pulses. out->cell: [channels][pulses][samples]; the rest is
 * filled. */
void   interval_process(RangeDoppler *out, IntervalPlan *plan, const Interval *in, Pool *pool);
/* Of a map: RangeDoppler.noise_share. */
double interval_noise_share(const IntervalPlan *plan);
/* Amplitude at an offset of up to 1.5 cells of the response to a point, 1 at 0, over range or over Doppler; to 1e-7. */
double interval_lobe(const IntervalPlan *plan, bool doppler, double cells);
/* Of a channel that was compressed: all pulses, [pulses][samples] complex. */
const double *interval_pulses(const IntervalPlan *plan, int channel);
/* Complex range profile of one pulse: out[samples]. */
void   interval_pulse(double complex *out, const IntervalPlan *plan, int channel, int pulse);
/* Range profile over all pulses, without Doppler: profile[samples], mean power over pulses. */
void   interval_profile(double *profile, const IntervalPlan *plan, int channel);

#endif
