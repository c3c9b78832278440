/* sensor/settings/choice_lines.c: lines of automatic choices. */
#include "sensor/settings/choice_lines.h"

#include <stdarg.h>
#include <stdio.h>

void choice_add(Choices *choices, const char *format, ...)
{
    if (choices->count >= choices_capacity) return;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(choices->line[choices->count++], choice_text_size, format, arguments);
    va_end(arguments);
}
