/* sensor/detector/quantise.h: electrons to raw counts, and values to display values.
 *
 * Pure functions on planes, no allocation. NaN and -inf give 0, +inf full scale. */
#ifndef SENSOR_DETECTOR_QUANTISE_H
#define SENSOR_DETECTOR_QUANTISE_H

#include "sensor/detector/level.h"

/* The converter: value / step, rounded to nearest, 0 .. full. */
void quantise_counts(uint16_t *out, const float *in, size_t count, double step, uint16_t full);

/* Quantisation to config->bits: monotone, saturating, rounding to nearest. out: uint8_t or uint16_t [count]. */
void detector_display(void *out, const float *in, size_t count, const DetectorConfig *config, DetectorLevel level);
/* Three planes to RGB interleaved. The level is that of their mean; the colour ratios of a pixel are preserved (a
 * black level subtracted per channel would colour haze), also beyond full scale. out: uint8_t or uint16_t [3 *
 * count]. */
void detector_display_rgb(void *out, const float *const in[3], size_t count, const DetectorConfig *config,
                          DetectorLevel level);

/* Radar: decibels below the brightest finite pixel. 0 dB is full scale, -dynamic_range_db and below is 0, as
 * is any pixel <= 0 or NaN. Power in, linear; bits 8 or 16. */
static const double detector_radar_range_db = 60;
void detector_display_db(void *out, const float *power, size_t count, double dynamic_range_db, int bits);

#endif
