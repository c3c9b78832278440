/* sensor/detector/display_values.h: electrons to raw counts, values to display values, and bands to display colours.
 *
 * Pure functions on planes, no allocation. NaN and -inf give 0, +inf full scale. */
#ifndef SENSOR_DETECTOR_DISPLAY_VALUES_H
#define SENSOR_DETECTOR_DISPLAY_VALUES_H

#include "sensor/detector/level.h"

/* The converter: counts are value / step, rounded to nearest, 0 .. full. */
void detector_counts(uint16_t *out, const float *in, size_t count, double step, uint16_t full);

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
void                detector_display_db(void *out, const float *power, size_t count, double dynamic_range_db, int bits);

/* ---- colours ------------------------------------------------------------------------------------ */

/* Three visible bands to display colours: white balance and a root polynomial.
 *
 * The bands are rectangles, 0.6-0.7, 0.5-0.6 and 0.4-0.5 um; unlike the responses of an eye or a camera. White balance
 * divides each band by the radiance of white horizontal ground under the present sun and sky, so that it is white at
 * any elevation of the sun; R, G, B and the roots of RG, GB, RB then add up to linear sRGB (IEC 61966-2-1, white point
 * D65), so that twice the light is twice the colour, and grey stays grey (Finlayson, Mackiewicz & Hurlbert, IEEE Trans.
 * Image Process. 24, 1460, 2015). For display images only: radiance in files and raw counts are not changed.
 *
 * The coefficients are fitted to patches, leaves, soils, skies and lamps under D65 for the observer CIE 1931, 2
 * degrees: etc/colour/make/correction.py, which says how. CIEDE2000 on average and at the 95th percentile, of what is
 * not in the fit (in brackets by a matrix fitted to the ColorChecker, and by white balance alone): the 99 test surfaces
 * of CIE 224:2017 4.7, 9.3 (5.0, 10.0; 6.4, 11.6); the ColorChecker 2.4, 5.5 (2.9, 6.4; 4.4, 8.8); grass, loam, paint
 * and similar spectra 1.5, 3.3 (1.5, 3.2; 2.3, 3.9). Three rectangular bands resolve little more: 3.9 and 8.7 if fitted
 * to the 99 themselves, since where in a band a spectrum rises is lost; a green paint of hue 145 degrees is displayed
 * at 132. Light of 0.5-0.6 um alone is 15 off.
 *
 * An output rises with its own band where no band is more than 30 times another. The noise of a grey is 0.99, 1.16,
 * 1.17 that of a band (R, G, B); it is at most 1.4 times that where bands are within 3 of each other, 2.3 within 10 (R
 * of saturated colours). Negative values, of noise, have no root: R of a grey is 2 % low at a signal of 3 times its
 * noise and 13 % at 1. tests/sensor/test_colour.c, tests/system/test_colour_judge.sh. */
typedef struct DisplayColour {
    double zero;    /* value of zero light: 0 for radiance, the dark level for counts */
    double gain[3]; /* R G B; preserves the mean of the three whites */
    double white;   /* that mean, above zero: value of a white surface in all three channels */
    double most;    /* after gain: value at which the first channel saturates; INFINITY: none */
} DisplayColour;

/* white: value of each channel R G B above zero, in its unit; unless all are positive, gains are 1.
 * full: value at which a channel saturates, above zero; INFINITY: none. */
void display_colour(DisplayColour *out, const double white[3], double zero, double full);

/* Linear sRGB in the unit of the planes, at the same zero. Out-of-gamut colours, with a negative component, are
 * desaturated towards the grey of their luminance, preserving hue. A channel beyond `most` is set to it. A pixel
 * with a value that is not finite is unchanged. May be in place. */
void display_colour_apply(float *const out[3], const float *const in[3], size_t count, const DisplayColour *colour);

#endif
