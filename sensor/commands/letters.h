/* sensor/commands/letters.h: words in pictures: digits, small letters, the capitals of units and a few signs of five by seven dots. */
#ifndef SENSOR_COMMANDS_LETTERS_H
#define SENSOR_COMMANDS_LETTERS_H

#include "pitviper.h"

enum { letters_wide = 12, letters_high = 14 };

/* White on black at twice the size of the dots, of rgb [height][width][3]; what is outside is left out. */
void letters_write(uint8_t *rgb, int width, int height, int x, int y, const char *text);

#endif
