/* sensor/radar/mti.h: moving-target indication: a delay-line canceller over the rows of an interval, and whether a
 * detection moves against the ground.
 *
 * The canceller of 2 or 3 rows takes the differences of range-compressed rows, with the binomial weights 1, -1 or 1, -2,
 * 1, after the ground's own phase from row to row is taken out (clutter lock: the radar knows its own velocity). Of
 * clutter with autocorrelation rho over a row it improves the ratio of signal to clutter, the signal averaged over all
 * Doppler frequencies, by 1 / (1 - rho(1)) and 3 / (3 - 4 rho(1) + rho(2)) (Skolnik, Radar Handbook, 3rd ed., ch. 2;
 * Barton, Modern Radar System Analysis, 1988, ch. 5). Targets at multiples of the blind speed go with it. */
#ifndef SENSOR_RADAR_MTI_H
#define SENSOR_RADAR_MTI_H

#include "sensor/radar/interval.h"

enum { mti_rows_most = 3 };

/* Mean power over rows behind the canceller of `rows` 2 or 3: out[samples] from `pulse` of interval_pulses. So scaled that
 * white noise keeps its power. clutter_path_m: growth of the ground's two-way path from row to row, against the
 * reference's. */
void mti_profile(double *out, const double *pulse, const Waveform *wave, int rows, double clutter_path_m);
/* Power gain of the canceller for a target whose path grows by path_m more than the clutter's, white noise's being 1. */
double mti_gain(const Waveform *wave, int rows, double path_m);
/* A range rate is clear of the ground's: farther than notch_mps from it and all that look alike, every blind_mps. */
bool mti_moves(double rate_mps, double ground_mps, double notch_mps, double blind_mps);

#endif
