/* sensor/radar/gridding.h: the kernel by which points between those of a grid are spread over it, for sums of complex
 * exponentials by a transform.
 *
 * "Exponential of semicircle", 8 points wide, on a grid of twice the points: Barnett, Magland & af Klinteberg, SIAM J.
 * Sci. Comput. 41(5), 2019. Error below 1e-6 of the sum of amplitudes. */
#ifndef SENSOR_RADAR_GRIDDING_H
#define SENSOR_RADAR_GRIDDING_H

#include "pitviper.h"

enum { gridding_width = 8, gridding_oversampling = 2 };

/* Weights of the points that a place is spread over; returns the first, 0 .. points - 1. They wrap around. turns: of
 * the grid; whole ones do not count. */
int gridding_spread(double weight[gridding_width], double turns, int points);
/* [count], malloc: what makes up for the kernel in number i - count / 2 of the transform over so many points. NULL: no
 * memory. */
double *gridding_corrections(int count, int points);

#endif
