/* sensor/publish/images/picture_text.h: words in a font of equal widths, printable ASCII, and boxes, in
 * pictures. Without the font there are no words, and one warning. */
#ifndef SENSOR_PUBLISH_IMAGES_PICTURE_TEXT_H
#define SENSOR_PUBLISH_IMAGES_PICTURE_TEXT_H

#include "pitviper.h"

enum { picture_text_wide = 12, picture_text_high = 14 }; /* of picture_text_write; 4 rows more may hang below */

/* White on black, in rgb [height][width][3]; what is outside is left out. */
void picture_text_write(uint8_t *rgb, int width, int height, int x, int y, const char *text);

/* A picture to draw in: [height][width][planes] of octets, or of 16 bits with values to `full`. */
typedef struct Drawing {
    void *pixels;
    int   width, height, planes;
    bool  wide;        /* 16 bits */
    int   full;        /* white */
    int   left, right; /* columns that may be drawn in, half open */
} Drawing;

/* times: 1 .. 8, how many pixels a dot has; a letter takes 6 dots, a capital stands 7 high, and letters as `g` hang 2
 * below. Safe from several threads. */
void picture_text_draw(const Drawing *drawing, int x, int y, int times, const char *text);
/* White, 1 px, just outside [x0, x1) x [y0, y1), with a black line around it. */
void picture_text_box(const Drawing *drawing, const int box[4]);

#endif
