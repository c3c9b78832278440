/* sensor/settings/choice_lines.h: automatic choices where the settings are open: a line for each, with the key that
 * changes it. */
#ifndef SENSOR_SETTINGS_CHOICE_LINES_H
#define SENSOR_SETTINGS_CHOICE_LINES_H

#include "pitviper.h"

enum { choices_capacity = 32, choice_text_size = 200 };

typedef struct Choices {
    int  count;
    char line[choices_capacity][choice_text_size];
} Choices;

/* Dropped when the list is full. */
void choice_add(Choices *choices, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
