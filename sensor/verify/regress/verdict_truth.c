/* sensor/verify/regress/verdict_truth.c: fields of truth.jsonl and run.json, each by the tolerance of its row. */
#include "sensor/verify/regress/verdict.h"

#include "sensor/frame/record_fields.h"
#include "sensor/node/run/run_record.h"

static const Channel channel_of[FIELD_CHANNELS] = {
    [FIELD_TIME] = CHANNEL_TIME,         [FIELD_POSE] = CHANNEL_POSE,       [FIELD_SUN] = CHANNEL_SUN,
    [FIELD_MOTION] = CHANNEL_MOTION,     [FIELD_TARGETS] = CHANNEL_TARGETS, [FIELD_TEMP] = CHANNEL_TEMP,
    [FIELD_SIGNALS] = CHANNEL_SIGNALS,   [FIELD_ERROR] = CHANNEL_ERROR,     [FIELD_RADAR] = CHANNEL_RADAR,
    [FIELD_COUNTERS] = CHANNEL_COUNTERS,
};

static void value_text(char out[96], const JsonValue *value)
{
    if (!value) snprintf(out, 96, "absent");
    else if (value->text) snprintf(out, 96, "%.80s", value->text);
    else snprintf(out, 96, "%.10g", value->number);
}

/* The first difference of each channel is reported, the others are counted. */
static void differs(ChannelResult *result, int frame, const char *path, const JsonValue *expected, const JsonValue *got)
{
    char was[96], is[96], place[40] = "";
    result->failed = true;
    if (result->diffs++) return;
    value_text(was, expected);
    value_text(is, got);
    if (frame >= 0) snprintf(place, sizeof place, " in frame %d", frame);
    snprintf(result->line, sizeof result->line, "%.160s is %s, was %s%s", path, is, was, place);
    result->frame = frame;
}

static bool equal(const JsonValue *expected, const JsonValue *got, const Field *field, double factor)
{
    if (expected->text || got->text) return expected->text && got->text && strcmp(expected->text, got->text) == 0;
    if (isnan(expected->number) && isnan(got->number)) return true;
    const double limit = field && field->held ? factor * (field->absolute + field->relative * fabs(expected->number))
                                              : 1e-6 * fabs(expected->number);
    return fabs(got->number - expected->number) <= limit;
}

/* Older baselines state errors of the pseudo-radar, which are no longer given. */
static bool is_of_old(const char *path) { return strncmp(path, "error.radar.", 12) == 0; }

/* Both lists are sorted by path: merges them. */
void verdict_fields(ChannelResult result[CHANNEL_COUNT], int frame, const JsonValues *expected, const JsonValues *got,
                    const FieldRule *rule)
{
    const bool exact = rule->exact;
    int        i = 0, k = 0;
    while (i < expected->count || k < got->count) {
        const JsonValue *was = i < expected->count ? &expected->value[i] : NULL;
        const JsonValue *is = k < got->count ? &got->value[k] : NULL;
        const int        order = !was ? 1 : !is ? -1 : strcmp(was->path, is->path);
        const char      *path = order <= 0 ? was->path : is->path;
        FieldChannel     channel = rule->channel;
        if (order > 0) was = NULL;
        if (order < 0) is = NULL;
        i += order <= 0;
        k += order >= 0;
        const Field *field = field_find(&channel, rule->table, path);
        if (channel == FIELD_APART || is_of_old(path)) continue;
        ChannelResult *to = &result[channel_of[channel]];
        to->there = true;
        if (!was && (!field || !field->held || field->newer) && !exact) continue; /* a new field */
        const bool same = was && is && (exact ? was->number == is->number : equal(was, is, field, rule->factor));
        if (!same) differs(to, frame, path, was, is);
    }
}

void verdict_truth(ChannelResult result[CHANNEL_COUNT], int frame, const JsonValues *expected, const JsonValues *got,
                   double factor)
{
    verdict_fields(result, frame, expected, got, &(FieldRule){&record_frame_fields, FIELD_POSE, false, factor});
}

void verdict_counters(ChannelResult result[CHANNEL_COUNT], const JsonValues *expected, const JsonValues *got)
{
    verdict_fields(result, -1, expected, got, &(FieldRule){&run_record_fields, FIELD_APART, true, 0});
}
