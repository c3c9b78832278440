/* sensor/radar/echo_private.h: the two kinds of grids by which echo.c sums echoes, and the kernel that spreads
 * points over them. */
#ifndef SENSOR_RADAR_ECHO_PRIVATE_H
#define SENSOR_RADAR_ECHO_PRIVATE_H

#include "sensor/radar/echo.h"

/* ---- the kernel ------------------------------------------------------------------------------------ */

/* By it points between those of a grid are spread over the grid, for sums of complex exponentials by a transform.
 *
 * "Exponential of semicircle", 8 points wide, on a grid of twice the points: Barnett, Magland & af Klinteberg, SIAM J.
 * Sci. Comput. 41(5), 2019. Error below 1e-6 of the sum of amplitudes. */
enum { gridding_width = 8, gridding_oversampling = 2 };

/* Weights of the points that a place is spread over; returns the first, 0 .. points - 1. They wrap around. turns: of
 * the grid; whole ones do not count. */
int gridding_spread(double weight[gridding_width], double turns, int points);
/* [count], malloc: what makes up for the kernel in number i - count / 2 of the transform over so many points. NULL: no
 * memory. */
double *gridding_corrections(int count, int points);

/* ---- pulse_grid.c: delay and Doppler --------------------------------------------------------------- */

/* Sums of many complex exponentials over the pulses and samples of an interval, by gridding.
 *
 * With u = -1 .. 1 over the samples and v = -1 .. 1 over the pulses, both 0 in the middle, a point adds to sample m of
 * pulse p
 *
 *     amplitude exp(-j 2 pi (per_sample (m - samples / 2) + per_pulse (p - (pulses - 1) / 2))) s(growth t),
 *     t = u ((1 - bend) v + bend u)
 *
 * where s is the first `terms` terms of the power series of exp(-j growth t): delay that grows over the pulses and
 * within one. A point is spread over 8 x 8 points of a grid of twice the pulses and samples, one for each term,
 * which is transformed and divided by the kernel's transform (the kernel above): a cost that does not grow with the
 * pulses. Error below 1e-6 of the sum of amplitudes, besides the series' (tests/sensor/test_echo.c). Each channel's
 * sums are in the order of the points, whatever the threads. */
enum { pulse_terms_most = 8 };

typedef struct PulsePoint {
    double         per_sample, per_pulse; /* turns; whole ones do not count */
    double         growth_rad;
    int            terms; /* 0: it is left out; up to pulse_terms_most */
    double complex amplitude[interval_channels];
} PulsePoint;

typedef struct PulseGrid PulseGrid;

/* samples: even, from 8; pulses: from 1; bend: 0 .. 1. */
Status pulse_grid_create(PulseGrid **out, int samples, int pulses, double bend);
void   pulse_grid_destroy(PulseGrid *grid); /* accepts NULL */
/* Adds to those of earlier calls. pool may be NULL. STATUS_NO_MEMORY: sums are wrong until it is made to forget. */
Status pulse_grid_add(PulseGrid *grid, const PulsePoint *point, int count, Pool *pool);
/* sample[channels][pulses][samples] of all that were added; forgets them. */
void pulse_grid_sum(double complex *sample, PulseGrid *grid, Pool *pool);
void pulse_grid_forget(PulseGrid *grid);

/* ---- row_grid.c: delay, row by row ------------------------------------------------------------------ */

/* Sums of echoes row by row of an interval, each in the delay that it has there.
 *
 * Each echo is spread over 8 points of a delay grid of twice the samples in each row (the kernel above). Within a
 * row a rate adds a phase q u^2, u = -1 .. 1 over the samples: a shift of the delay is its linear part; this rest
 * is a series of Bessel functions times Chebyshev polynomials in 2 u^2 - 1 (Jacobi and Anger; Abramowitz & Stegun
 * 9.1.42 .. 47), each a grid of its own, as many as |q| needs. For any rate, at a cost that grows with the rows.
 * Sums are in the order of the echoes, for any number of threads. */
typedef struct RowGrid RowGrid;

Status row_grid_create(RowGrid **out, const Waveform *wave);
void   row_grid_destroy(RowGrid *grid); /* accepts NULL */
/* Adds to those of earlier calls. pool may be NULL. STATUS_NO_MEMORY: sums are wrong until it is made to forget. */
Status row_grid_add(RowGrid *grid, const Echo *echo, int count, Pool *pool);
/* Adds all that were added to sample[channels][pulses][samples]; forgets them. */
void row_grid_sum(double complex *sample, RowGrid *grid);
void row_grid_forget(RowGrid *grid);

#endif
