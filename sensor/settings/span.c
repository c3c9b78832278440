/* sensor/settings/span.c: --from and --to against what a recording holds. */
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
    /* a live node makes frames after its last report, until the entities time out; with --to they are asked for */
    const bool   late = from_s > last_s + (to_s > last_s ? 60 : 0), early = to_s < first_s, backward = from_s > to_s;
    if (!late && !early && !backward) return false;
    char which[2 * span_text_size + 24];
    if (backward && !late && !early) snprintf(which, sizeof which, "--from %s is after --to %s", from, to);
    else snprintf(which, sizeof which, late ? "--from %s is after its end" : "--to %s is before its beginning", late ? from : to);
    log_error("replay: %s: the recording goes from %.3f to %.3f s of exercise time, which is +0 to +%.3f from its beginning and "
              "-%.3f to -0 from its end", which, first_s, last_s, last_s - first_s, last_s - first_s);
    return true;
}
