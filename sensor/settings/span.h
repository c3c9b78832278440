/* sensor/settings/span.h: a time in a recording as given by the user: 3471.5, +12 or -5.
 *
 * A plain number is exercise time, as `pitviper inspect` shows it; with a + it is seconds after the start of the
 * recording, with a - seconds before its end. */
#ifndef SENSOR_SETTINGS_SPAN_H
#define SENSOR_SETTINGS_SPAN_H

#include "pitviper.h"

enum { span_text_size = 32 };

/* Empty is valid: no limit. */
bool   span_good(const char *text);
/* NaN: empty, or not a time. */
double span_time_s(const char *text, double first_s, double last_s);
/* Whether `from` is after `to` in every recording: both are of one kind. */
bool   span_backward(const char *from, const char *to);
/* Whether a recording of that span holds nothing at or after `from`, or nothing up to `to`: logged, with the span. */
bool   span_outside(const char *from, const char *to, double first_s, double last_s);

#endif
