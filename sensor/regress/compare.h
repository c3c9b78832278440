/* sensor/regress/compare.h: comparison of two planes. Pure functions, no allocation.
 *
 * A pixel is beyond when not |got - expected| <= limit; equal infinities, and NaN against NaN, differ by 0; one that is
 * finite against one that is not by infinity. */
#ifndef SENSOR_REGRESS_COMPARE_H
#define SENSOR_REGRESS_COMPARE_H

#include "pitviper.h"

typedef struct PlaneVerdict {
    size_t compared, beyond;
    double share;              /* beyond / compared; 0 of none */
    double max;                /* of the difference; infinity when anything finite met what is not */
    double rms;                /* of the differences that are finite */
    size_t unmatched;          /* those where only one is finite, or infinities or NaN differ */
    int    column, row;        /* first pixel with this max; -1: nothing differs */
    double expected, got;      /* there */
} PlaneVerdict;

/* limit: absolute + relative |expected|. difference: got - expected [height][width], may be NULL. ignored: pixels left
 * out where not 0, may be NULL; their difference is 0. */
void compare_numbers(PlaneVerdict *out, float *difference, const float *expected, const float *got, int width,
                     int height, double absolute, double relative, const uint8_t *ignored);
/* Every difference counts as beyond, with max 1. allowed: pixels that may differ and are only counted in *edges (which
 * may be NULL); NULL: none. */
void compare_ids(PlaneVerdict *out, size_t *edges, const uint32_t *expected, const uint32_t *got, int width, int height,
                 const uint8_t *allowed);
/* 1 where one of the four neighbours has another id, in either plane; adds to what is there. Returns how many are 1. */
size_t mark_edges(uint8_t *edge, const uint32_t *expected, const uint32_t *got, int width, int height);

/* Lower bound of apparent temperatures, also for zero radiance: the radiance of a body of 100 K in 8-12 um is
 * 1e-4 of one of 300 K (in 3-5 um 1.3e-9), below any detector's noise, and no radiance has no temperature. */
static const double apparent_floor_k = 100;
/* Radiance to apparent temperature, K, apparent_floor_k at least; NaN of what is no radiance (NaN, infinite, below 0).
 * low_m .. high_m: the band. */
void plane_to_kelvin(float *out, const float *radiance_w_m2_sr, size_t count, double low_m, double high_m);
/* Power to dB relative to `full`, at least -span_db. */
void plane_to_db(float *out, const float *power, size_t count, double full, double span_db);

#endif
