/* sensor/radar/pulse_grid.h: sums of many complex exponentials over the pulses and samples of an interval, by gridding.
 *
 * A point adds amplitude exp(-j 2 pi (per_sample (m - samples / 2) + per_pulse (p - (pulses - 1) / 2))) to sample m of
 * pulse p. It is spread over 8 x 8 points of a grid of twice the pulses and samples, which is transformed and divided
 * by the kernel's transform ("exponential of semicircle": Barnett, Magland & af Klinteberg, SIAM J. Sci. Comput. 41(5),
 * 2019): a cost that does not grow with the pulses. Error below 1e-6 of the sum of amplitudes (tests/sensor/test_echo.c).
 * Each channel's sums are in the order of the points, whatever the threads. */
#ifndef SENSOR_RADAR_PULSE_GRID_H
#define SENSOR_RADAR_PULSE_GRID_H

#include "sensor/radar/interval.h"

typedef struct PulsePoint {
    double         per_sample, per_pulse; /* turns; whole ones do not count */
    double complex amplitude[interval_channels];
} PulsePoint;

typedef struct PulseGrid PulseGrid;

/* samples even, from 8; pulses from 1. */
Status pulse_grid_create(PulseGrid **out, int samples, int pulses);
void   pulse_grid_destroy(PulseGrid *grid); /* accepts NULL */
/* Adds to those of earlier calls. pool may be NULL. */
void   pulse_grid_add(PulseGrid *grid, const PulsePoint *point, int count, Pool *pool);
/* sample[channels][pulses][samples] of all that were added; forgets them. */
void   pulse_grid_sum(double complex *sample, PulseGrid *grid, Pool *pool);
void   pulse_grid_forget(PulseGrid *grid);

#endif
