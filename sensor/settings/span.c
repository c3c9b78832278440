/* sensor/settings/span.c: checks --from and --to against the span of a recording. */
#include "sensor/settings/span.h"

static bool parse(double *number, char *kind, const char *text)
{
    if (!text_to_double(number, text)) return false;
    *kind = *text == '+' || *text == '-' ? *text : ' ';
    return true;
}

bool span_good(const char *text)
{
    double number;
    char   kind;
    return !*text || parse(&number, &kind, text);
}

double span_time_s(const char *text, double first_s, double last_s)
{
    double number;
    char   kind;
    if (!parse(&number, &kind, text)) return NAN;
    return number + (kind == '+' ? first_s : kind == '-' ? last_s : 0);
}

bool span_backward(const char *from, const char *to)
{
    double a, b;
    char   x, y;
    return parse(&a, &x, from) && parse(&b, &y, to) && x == y && a > b;
}

bool span_outside(const char *from, const char *to, double first_s, double last_s)
{
    const double from_s = span_time_s(from, first_s, last_s), to_s = span_time_s(to, first_s, last_s);
    /* a live node renders frames after the last report until the entities time out; --to may ask for them */
    const bool   late = from_s > last_s + (to_s > last_s ? 60 : 0), early = to_s < first_s, backward = from_s > to_s;
    if (!late && !early && !backward) return false;
    char which[2 * span_text_size + 24];
    if (backward && !late && !early) snprintf(which, sizeof which, "--from %s is after --to %s", from, to);
    else snprintf(which, sizeof which, late ? "--from %s is after its end" : "--to %s is before its "
                                              "start", late ? from : to);
    log_error(
        "replay: %s: the recording runs from %.3f to %.3f s of exercise time, +0 to +%.3f from its start, -%.3f to "
        "-0 from its "
        "end",
        which, first_s, last_s, last_s - first_s, last_s - first_s);
    return true;
}
