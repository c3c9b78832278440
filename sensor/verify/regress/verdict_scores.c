/* sensor/verify/regress/verdict_scores.c: the scores of a recogniser's answers against those of the baseline. */
#include "sensor/verify/regress/verdict.h"

/* A rate of scores.json, with its bounds and what it counts. */
typedef struct RateRow {
    const char *name, *low, *high, *of, *all, *said, *counted, *top; /* top: the object that has it for all bands */
    size_t      tolerance;
} RateRow;

static const RateRow rates[] = {
    {"detection", "detection_low", "detection_high", "found", "chances", "detection rate", "targets", "all.",
     offsetof(Tolerance, detection)},
    {"false_alarms_per_frame", "false_alarms_low", "false_alarms_high", "false_alarms", "frames",
     "false alarms per frame", "frames", "all.", offsetof(Tolerance, false_alarms)},
    {"ap", "", "", "", "", "AP", "", "", offsetof(Tolerance, ap)},
    {"ap50", "", "", "", "", "AP50", "", "", offsetof(Tolerance, ap)},
};
enum { rate_count = sizeof rates / sizeof *rates };

/* A number of an object, ("all.", "bands.lwir."); NaN: absent. */
static double number(const JsonValues *values, const char *head, const char *name)
{
    char path[96];
    snprintf(path, sizeof path, "%s%s", head, name);
    const JsonValue *value = *name ? json_values_find(values, path) : NULL;
    return value ? value->number : NAN;
}

/* "0.5 (0.3 .. 0.7; 6 of 12 targets)". */
static void say(char out[128], const JsonValues *values, const char *band, const RateRow *row)
{
    const char  *head = *band ? band : row->top;
    const double value = number(values, head, row->name), low = number(values, head, row->low),
                 high = number(values, head, row->high), of = number(values, head, row->of),
                 all = number(values, head, row->all);
    size_t n = (size_t)snprintf(out, 128, isnan(value) ? "none" : "%.4g", value);
    if (isnan(of) || isnan(all)) return;
    n += (size_t)snprintf(out + n, 128 - n, " (");
    if (!isnan(low) && !isnan(high)) n += (size_t)snprintf(out + n, 128 - n, "%.3g .. %.3g; ", low, high);
    snprintf(out + n, 128 - n, "%.0f of %.0f %s)", of, all, row->counted);
}

/* head: of a band; "": of all. */
static void compare(ChannelResult *r, const JsonValues *expected, const JsonValues *got, const char *head,
                    const RateRow *row, const Tolerance *tolerance)
{
    const char  *object = *head ? head : row->top;
    const double was = number(expected, object, row->name), is = number(got, object, row->name);
    char         said[2][128];
    double       limit;
    memcpy(&limit, (const char *)tolerance + row->tolerance, sizeof limit);
    if (isnan(was) && isnan(is)) return;
    if (fabs(is - was) <= limit * (1 + 1e-12)) return;
    r->failed = true;
    if (r->diffs++) return;
    say(said[0], got, head, row);
    say(said[1], expected, head, row);
    const char *band = *head ? head + strlen("bands.") : "";
    snprintf(r->line, sizeof r->line, "%.*s%s%s %s, was %s", (int)strcspn(band, "."), band, *band ? ": " : "",
             row->said, said[0], said[1]);
}

/* The next band in one of them after `head`, in the order of their paths. */
static bool next_band(char head[64], const JsonValues *expected, const JsonValues *got)
{
    char next[64] = "";
    for (int side = 0; side < 2; side++) {
        const JsonValues *values = side ? got : expected;
        for (int i = 0; i < values->count; i++) {
            char        one[64];
            const char *path = values->value[i].path,
                       *end = strncmp(path, "bands.", 6) == 0 ? strchr(path + 6, '.') : NULL;
            if (!end || end - path > 50) continue;
            snprintf(one, sizeof one, "%.*s", (int)(end - path) + 1, path);
            if (strcmp(one, head) > 0 && (!*next || strcmp(one, next) < 0)) strcpy(next, one);
        }
    }
    strcpy(head, next);
    return *next;
}

void verdict_scores(ChannelResult *result, const JsonValues *expected, const JsonValues *got,
                    const Tolerance *tolerance)
{
    char head[64] = "", said[3][128];
    result->there = true;
    for (int i = 0; i < rate_count; i++) compare(result, expected, got, "", &rates[i], tolerance);
    while (next_band(head, expected, got))
        for (int i = 0; i < rate_count; i++) compare(result, expected, got, head, &rates[i], tolerance);
    if (result->failed) return;
    for (int i = 0; i < 3; i++) say(said[i], got, "", &rates[i]);
    snprintf(result->line, sizeof result->line, "detection rate %s, false alarms per frame %s, AP %s", said[0], said[1],
             said[2]);
}
