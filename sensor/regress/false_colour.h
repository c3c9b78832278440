/* sensor/regress/false_colour.h: planes as PNG in a page, enlarged so that single pixels are visible. */
#ifndef SENSOR_REGRESS_FALSE_COLOUR_H
#define SENSOR_REGRESS_FALSE_COLOUR_H

#include "pitviper.h"

typedef enum Colours {
    COLOURS_HEAT,   /* dark to bright, by a scale */
    COLOURS_SIGNED, /* blue below 0, red above, white at it */
    COLOURS_IDS,    /* a colour per id; 0 is dark */
} Colours;

typedef struct Scale {
    double low, high;
} Scale;

/* From the 0.5th to the 99.5th percentile of both together; a plane of one value gets a width. */
Scale scale_of(const float *a, const float *b, size_t count);
/* -most .. most: the largest of the finite differences but one in two hundred of those that are not 0, at least
 * `least`. */
Scale scale_of_difference(const float *difference, size_t count, double least);

/* Into the page, as <img>. plane: one, or three for red, green, blue of COLOURS_HEAT. scratch: a file that may be
 * written. Pixels that are not finite are violet. False, and nothing written, when it cannot be made. */
bool picture_put(FILE *page, const float *const *plane, int planes, int width, int height, Colours colours, Scale scale,
                 int wanted_width, const char *scratch, const char *alt);
/* A bar of the colours with the numbers at its ends. */
bool legend_put(FILE *page, Colours colours, Scale scale, const char *unit, const char *scratch);

#endif
