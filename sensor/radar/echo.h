/* sensor/radar/echo.h: what a receiver samples of many point echoes over the pulses of a coherent interval.
 *
 * Samples m = 0 .. samples - 1 lie at frequencies centre + (m - samples / 2) step: the samples over time of a
 * deramped chirp or FMCW sweep, or the steps of a stepped waveform. An echo of complex amplitude a whose two-way
 * path is longer by path_m than that to the reference (which the receiver follows) adds
 *
 *     a exp(-j 2 pi f_m path / c)
 *
 * Paths beyond half of c / step, either way, fold over as they do in a real receiver: leave those out that the gate
 * cuts. Over the pulses the path grows evenly: its phase exactly, its delay taken at the middle of the interval, for
 * paths that change by a small part of c / (step samples) in all. Sums are by gridding over delay and Doppler
 * (pulse_grid.h): error below 1e-6 of the sum of amplitudes (tests/sensor/test_echo.c). They are in the order of the
 * echoes, for any number of threads. */
#ifndef SENSOR_RADAR_ECHO_H
#define SENSOR_RADAR_ECHO_H

#include "sensor/radar/interval.h"

#include <complex.h>

typedef struct Echo {
    double path_m, path_per_pulse_m; /* in the middle of the interval; from pulse to pulse */
    double complex amplitude[interval_channels];
} Echo;

typedef struct EchoGrid EchoGrid;

/* For wave->samples 8 .. 65536, pulses 1 .. 4096, at most 2^22 of both. */
Status echo_grid_create(EchoGrid **out, const Waveform *wave);
void   echo_grid_destroy(EchoGrid *grid); /* accepts NULL */
/* Adds to those of earlier calls. pool may be NULL. */
void   echo_add(EchoGrid *grid, const Echo *echo, int count, Pool *pool);
/* sample[channels][pulses][samples] of all that were added; forgets them. */
void   echo_sum(double complex *sample, EchoGrid *grid);
void   echo_forget(EchoGrid *grid);

#endif
