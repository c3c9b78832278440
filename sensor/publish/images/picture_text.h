/* sensor/publish/images/picture_text.h: words and boxes in pictures: ASCII letters, digits and a few signs of five by
 * seven dots. */
#ifndef SENSOR_PUBLISH_IMAGES_PICTURE_TEXT_H
#define SENSOR_PUBLISH_IMAGES_PICTURE_TEXT_H

#include "pitviper.h"

enum { letters_wide = 12, letters_high = 14 }; /* at twice the size of the dots */

/* White on black at twice the size of the dots, of rgb [height][width][3]; what is outside is left out. */
void letters_write(uint8_t *rgb, int width, int height, int x, int y, const char *text);

/* A picture to draw in: [height][width][planes] of octets, or of 16 bits with values to `full`. */
typedef struct Drawing {
    void *pixels;
    int   width, height, planes;
    bool  wide;        /* 16 bits */
    int   full;        /* white */
    int   left, right; /* columns that may be drawn in, half open */
} Drawing;

/* times: the size of a dot; a letter takes 6 times that, and 7 down. */
void drawing_text(const Drawing *drawing, int x, int y, int times, const char *text);
/* Draws a white line of 1 px just outside [x0, x1) x [y0, y1), with a black line around it. */
void drawing_box(const Drawing *drawing, const int box[4]);

#endif
