/* sensor/radar/row_grid.h: sums of echoes row by row of an interval, each in the delay that it has there.
 *
 * Each echo is spread over 8 points of a delay grid of twice the samples in each row (gridding.h). Within a row a rate
 * adds a phase q u^2, u = -1 .. 1 over the samples: a shift of the delay is its linear part; this rest is a series
 * of Bessel functions times Chebyshev polynomials in 2 u^2 - 1 (Jacobi and Anger; Abramowitz & Stegun 9.1.42 .. 47),
 * each a grid of its own, as many as |q| needs. For any rate, at a cost that grows with the rows. Sums are in the
 * order of the echoes, for any number of threads. */
#ifndef SENSOR_RADAR_ROW_GRID_H
#define SENSOR_RADAR_ROW_GRID_H

#include "sensor/radar/interval.h"

/* One echo: echo.h says what it adds. */
typedef struct Echo {
    double path_m, path_per_pulse_m; /* in the middle of the interval; from row to row */
    double complex amplitude[interval_channels];
} Echo;

typedef struct RowGrid RowGrid;

Status row_grid_create(RowGrid **out, const Waveform *wave);
void   row_grid_destroy(RowGrid *grid); /* accepts NULL */
/* Adds to those of earlier calls. pool may be NULL. STATUS_NO_MEMORY: sums are wrong until it is made to forget. */
Status row_grid_add(RowGrid *grid, const Echo *echo, int count, Pool *pool);
/* Adds all that were added to sample[channels][pulses][samples]; forgets them. */
void   row_grid_sum(double complex *sample, RowGrid *grid);
void   row_grid_forget(RowGrid *grid);

#endif
