/* sensor/radar/echo.h: what a receiver samples of many point echoes over the pulses of a coherent interval.
 *
 * Samples m = 0 .. samples - 1 lie at frequencies centre + (m - samples / 2) step: the samples over time of a deramped chirp or
 * FMCW sweep, or the steps of a stepped waveform. An echo of complex amplitude a whose two-way path is longer by path_m than that to
 * the reference (which the receiver follows) adds
 *
 *     a exp(-j 2 pi f_m path / c)
 *
 * Paths beyond half of c / step, either way, fold over as they do in a real receiver: leave those out that the gate cuts.
 * Sums are by gridding: each echo is spread over 8 points of a delay grid of twice the samples, which is transformed and divided by the
 * kernel's transform ("exponential of semicircle": Barnett, Magland & af Klinteberg, SIAM J. Sci. Comput. 41(5), 2019). Error
 * below 1e-6 of the sum of amplitudes (tests/sensor/test_echo.c). Sums are in the order of the calls. */
#ifndef SENSOR_RADAR_ECHO_H
#define SENSOR_RADAR_ECHO_H

#include "pitviper.h"

#include <complex.h>

typedef struct EchoGrid EchoGrid;

/* samples: even, 8 .. 65536; pulses 1 .. 4096; at most 2^24 of both. */
Status echo_grid_create(EchoGrid **out, int samples, int pulses, double centre_hz, double step_hz);
void   echo_grid_destroy(EchoGrid *grid); /* accepts NULL */
/* Forgets all echoes. */
void   echo_grid_clear(EchoGrid *grid);
/* One echo in one pulse. */
void   echo_add(EchoGrid *grid, int pulse, double path_m, double complex amplitude);
/* The same echo in all pulses, its path growing by path_per_pulse_m, with the delay of the middle pulse in all: for paths that change
 * by a small part of c / (step samples) in all. Phases are exact. */
void   echo_add_train(EchoGrid *grid, double path_m, double path_per_pulse_m, double complex amplitude);
/* out[pulses][samples]. */
void   echo_voltages(double complex *out, EchoGrid *grid);

#endif
