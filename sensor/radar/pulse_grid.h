/* sensor/radar/pulse_grid.h: sums of many complex exponentials over the pulses and samples of an interval, by gridding.
 *
 * With u = -1 .. 1 over the samples and v = -1 .. 1 over the pulses, both 0 in the middle, a point adds to sample m of
 * pulse p
 *
 *     amplitude exp(-j 2 pi (per_sample (m - samples / 2) + per_pulse (p - (pulses - 1) / 2))) s(growth t),
 *     t = u ((1 - bend) v + bend u)
 *
 * where s is the first `terms` terms of the power series of exp(-j growth t): delay that grows over the pulses and
 * within one. A point is spread over 8 x 8 points of a grid of twice the pulses and samples, one for each term, which
 * is transformed and divided by the kernel's transform (gridding.h): a cost that does not grow with the pulses. Error
 * below 1e-6 of the sum of amplitudes, besides the series' (tests/sensor/test_echo.c). Each channel's sums are in the
 * order of the points, whatever the threads. */
#ifndef SENSOR_RADAR_PULSE_GRID_H
#define SENSOR_RADAR_PULSE_GRID_H

#include "sensor/radar/interval.h"

enum { pulse_terms_most = 8 };

typedef struct PulsePoint {
    double         per_sample, per_pulse; /* turns; whole ones do not count */
    double         growth_rad;
    int            terms;                 /* 0: it is left out; up to pulse_terms_most */
    double complex amplitude[interval_channels];
} PulsePoint;

typedef struct PulseGrid PulseGrid;

/* samples even, from 8; pulses from 1; bend 0 .. 1. */
Status pulse_grid_create(PulseGrid **out, int samples, int pulses, double bend);
void   pulse_grid_destroy(PulseGrid *grid); /* accepts NULL */
/* Adds to those of earlier calls. pool may be NULL. STATUS_NO_MEMORY: sums are wrong until it is made to forget. */
Status pulse_grid_add(PulseGrid *grid, const PulsePoint *point, int count, Pool *pool);
/* sample[channels][pulses][samples] of all that were added; forgets them. */
void   pulse_grid_sum(double complex *sample, PulseGrid *grid, Pool *pool);
void   pulse_grid_forget(PulseGrid *grid);

#endif
