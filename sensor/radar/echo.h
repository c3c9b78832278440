/* sensor/radar/echo.h: what a receiver samples of many point echoes over the rows of a coherent interval.
 *
 * An echo of complex amplitude a, whose two-way path is longer by path_m than that to the reference and grows by
 * path_per_pulse_m from row to row, adds to sample m of row n, at the frequency f and the time t of interval.h,
 *
 *     a exp(-j 2 pi f(m) (path + path_per_pulse repeat t(m, n)) / c)
 *
 * times what its Doppler leaves of it within one sample, where a pulse has a single frequency: sinc(f rate pulse / c).
 * Paths fold over at half of c / step in frequency, either way, as they do in a real receiver, and by the range from
 * pulse to pulse (waveform_fold_m): leave those out that the receiver cuts off.
 *
 * Sums are by gridding. An echo whose delay and smear change little over the interval goes onto a grid over delay
 * and Doppler (echo_private.h), with as many terms of a series for that change as it needs: up to pulses / 8 of them,
 * and 8. Others, and those that fold over within the interval, go onto grids over delay row by row (echo_private.h).
 * Which of both follows from the echo and the waveform alone. Error below 1e-6 of the sum of amplitudes for echoes
 * that keep their paths; for others 3e-3 of their amplitude at the band's ends, 1e-4 in its middle; for |q| up to 70
 * (echo_private.h; tests/sensor/test_echo.c). On each grid sums are in the order of the echoes, whatever the threads.
 */
#ifndef SENSOR_RADAR_ECHO_H
#define SENSOR_RADAR_ECHO_H

#include "sensor/radar/interval_private.h"

/* One echo; its samples are given above. */
typedef struct Echo {
    double         path_m, path_per_pulse_m; /* in the middle of the interval; from row to row */
    double complex amplitude[interval_channels];
} Echo;

typedef struct EchoGrid EchoGrid;

/* Makes a grid for wave->samples of 8 .. 65536 and pulses of 1 .. 4096, whose product is at most 2^22. */
Status echo_grid_create(EchoGrid **out, const Waveform *wave);
void   echo_grid_destroy(EchoGrid *grid); /* accepts NULL */
/* Adds to those of earlier calls. pool may be NULL. */
void echo_add(EchoGrid *grid, const Echo *echo, int count, Pool *pool);
/* sample[channels][pulses][samples] of all that were added; forgets them. */
void echo_sum(double complex *sample, EchoGrid *grid);
void echo_forget(EchoGrid *grid);
/* Of echoes added from here on: growth of the reference's own two-way path from row to row that the receiver does not
 * follow, so that it is in every echo. 0 at first; while nothing is added. */
void echo_unfollowed(EchoGrid *grid, double path_per_pulse_m);
/* Number of terms for an echo whose path grows so, on the grid over delay and Doppler; 0: it is added row by row. */
int echo_terms(const EchoGrid *grid, double path_per_pulse_m);
/* STATUS_NO_MEMORY once a grid could not be had: sums since are wrong. */
Status echo_status(const EchoGrid *grid);

#endif
