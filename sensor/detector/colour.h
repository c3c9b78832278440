/* sensor/detector/colour.h: three bands of light to the colours of a screen: white balance of the day and a matrix.
 *
 * The bands are rectangles, 0.6-0.7, 0.5-0.6 and 0.4-0.5 um; an eye's and a camera's responses are none. White balance
 * divides each band by what white, level ground under the day's sun and sky sends up, so that it shows as white at any
 * height of the sun; a matrix then leads to linear sRGB (IEC 61966-2-1, white point D65). It is for displays alone:
 * radiance in files, and raw counts, stay what they are.
 *
 * The matrix minimises the sum of the squared CIEDE2000 differences of 24 colours, with rows that add up to 1 (white
 * stays white). Reflectances: ColorChecker, N. Ohta 1997, as the colour-science package 0.4.7 has them, 400-700 nm by
 * 10 nm; observer CIE 1931, 2 degrees; light D65, of which the bands take their shares by the trapezoidal rule. Left
 * over: CIEDE2000 3.0 on average over the 24, 7.2 at most (white balance alone: 4.4, 9.8); over grass, loam, paint and
 * their like, which the matrix has not seen, 1.5 and 3.6 (2.3, 4.1): tests/sensor/test_colour.c. Three rectangles tell
 * no more: a peak within a band is not seen, and a green paint of hue 145 degrees shows at 134. */
#ifndef SENSOR_DETECTOR_COLOUR_H
#define SENSOR_DETECTOR_COLOUR_H

#include "pitviper.h"

typedef struct DisplayColour {
    double zero;         /* value of no light: 0 of radiance, the dark level of counts */
    double gain[3];      /* R G B; the mean of the three whites stays what it is */
    double white;        /* that mean, above zero: what a white surface shows with in all three */
    double most;         /* after gain: where the first channel saturates; INFINITY: none does */
} DisplayColour;

/* white: of each channel R G B, above zero, in its unit. Not all of them positive: no light, and gains of 1.
 * full: where a channel saturates, above zero; INFINITY: nowhere. */
void display_colour(DisplayColour *out, const double white[3], double zero, double full);

/* Linear sRGB in the unit of the planes, at the same zero. Colours that no screen can show, with a negative part, go
 * straight towards the grey of their luminance until they can: the hue stays. A channel beyond `most` is there. A pixel
 * with a value that is not finite stays as it is. May be in place. */
void display_colour_apply(float *const out[3], const float *const in[3], size_t count, const DisplayColour *colour);

#endif
