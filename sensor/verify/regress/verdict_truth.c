/* sensor/verify/regress/verdict_truth.c: fields of truth.jsonl and run.json, each by its own tolerance. */
#include "sensor/verify/regress/verdict_private.h"

/* Tolerances by the last key of the path. Angles: the resolution of a seeker; what follows from pixels (number,
 * radiance): the tolerances of the planes. A field that is not listed may be added, but not removed or changed beyond
 * 1e-6. */
static const struct Field {
    const char *name;
    double      absolute, relative;
} fields[] = {
    {"time_s", 1e-6, 0}, /* stamps of DIS step by 1.7 us */
    {"ecef_m", 1e-3, 0},
    {"lat_deg", 1e-8, 0},
    {"lon_deg", 1e-8, 0}, /* 1 mm */
    {"height_m", 1e-3, 0},
    {"psi_deg", 1e-4, 0},
    {"theta_deg", 1e-4, 0},
    {"phi_deg", 1e-4, 0},
    {"speed_mps", 1e-3, 0},
    {"azimuth_deg", 0.005, 0},
    {"elevation_deg", 0.005, 0}, /* a hundredth of the sun's disc: below the variation of refraction */
    {"hfov_deg", 1e-6, 0},
    {"vfov_deg", 1e-6, 0},
    {"ecef_from_cam", 2e-6, 0}, /* 1e-4 degree */
    {"range_m", 1e-3, 1e-6},
    {"closing_mps", 1e-3, 1e-6},
    {"aspect_deg", 1e-3, 0},
    {"depression_deg", 1e-4, 0},
    {"los_az_deg", 1e-4, 0},
    {"los_el_deg", 1e-4, 0},
    {"los_rate_dps", 1e-3, 1e-5},
    {"boresight_error_deg", 1e-4, 0},
    {"pixels", 0.02, 0.005},
    {"visible_fraction", 0.005, 0},
    {"amodal_box_px", 0.02, 0},
    {"foliage_fraction", 0.005, 0},
    {"dt_k", 0.05, 0},
    {"patch_temp_k", 0.05, 0}, /* as temperatures of pixels */
    {"box_px", 0, 0},
    {"age_s", 1e-5, 0},
    {"position_error_m", 1e-3, 1e-3},
    {"contrast_k", 0.05, 0.01},
    {"dt_rss_k", 0.05, 0.01},
    {"contrast", 0.01, 0.01},
    {"snr", 0.05, 0.02},
    {"veil_transmittance", 0.002, 0},
    {"intensity_w_sr", 1e-4, 0.01},
    {"intensity_error_w_sr", 1e-4, 0.05}, /* an estimate: only its size */
    {"error_px", 0.01, 0.05},
    {"error_rms_k", 0.05, 0.05},
    {"error_median_k", 0.05, 0.05},
    {"median_k", 0.05, 0.05},
    {"beyond_1k", 0.01, 0.05},
    {"sampling", 1e-3, 0.05},
    {"level_of_detail", 1e-3, 0.05},
    {"table", 1e-3, 0.05},
    {"heat", 1e-3, 0.05},
    {"heat_k", 0.05, 0.05},
    {"dead_reckoning", 1e-3, 0.05},
    {"total", 1e-3, 0.05},
    {"sampling_k", 0.05, 0.05},
    {"level_of_detail_k", 0.05, 0.05},
    {"table_k", 0.05, 0.05},
    {"dead_reckoning_k", 0.05, 0.05},
    {"total_k", 0.05, 0.05},
    {"width_px", 0, 0},
    {"height_px", 0, 0},
    {"entity", 0, 0},
    {"marking", 0, 0},
    {"type", 0, 0},
    {"model", 0, 0},
    {"occluded_by", 0, 0},
    {"gimbal_at_limit", 0, 0},
    {"name", 0, 0},
    {"bands", 0, 0},
    {"frame", 0, 0},
    {"scene_rate_px_s", 0.01, 1e-5},
    /* fields of a radar with phase: tolerances are a hundredth of a cell, and the scatter by the grid of tubes of a
       look */
    {"preset", 0, 0},
    {"reference_m", 1e-3, 1e-6},
    {"reference_rate_mps", 1e-3, 1e-6},
    {"air_db", 1e-3, 1e-3},
    {"noise_dbw", 0.01, 0},
    {"saturated", 0, 0},
    {"ground_cells", 0, 0.001},
    {"ground_hidden", 0, 0.01},
    {"detections_in_all", 0, 0},
    {"range_rate_mps", 0.01, 1e-5},
    {"az_deg", 0.005, 0},
    {"el_deg", 0.005, 0},
    {"snr_db", 0.1, 0},
    {"rcs_dbsm", 0.1, 0},
    {"hh", 0.1, 0},
    {"vv", 0.1, 0},
    {"hv", 0.5, 0},
    {"centres", 0, 0.01},
    {"rcs_vv_dbsm", 0.1, 0},
    {"body_m", 0.01, 0},
    {"bounces", 0, 0},
    {"part", 0, 0},
};

/* Whether a field with a tolerance is one that older baselines lack. */
static bool is_newer(const struct Field *field)
{
    static const char *const names[] = {"error_px", "error_rms_k", "error_median_k", "median_k", "beyond_1k"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strcmp(field->name, names[i]) == 0) return true;
    return false;
}

/* The last key of the path, without its index in a list. */
static const struct Field *field_of(const char *path)
{
    const char *dot = NULL;
    for (const char *at = path; *at; at++) {
        if (*at == '[') at += strcspn(at, "]"); /* ids hold no dots, types might */
        if (!*at) break;
        if (*at == '.') dot = at;
    }
    const char  *word = dot ? dot + 1 : path;
    const size_t length = strcspn(word, "[");
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++)
        if (strlen(fields[i].name) == length && strncmp(fields[i].name, word, length) == 0) return &fields[i];
    return NULL;
}

static bool ends_with(const char *path, const char *word)
{
    const char *found = strstr(path, word);
    return found && (!found[strlen(word)] || found[strlen(word)] == '[');
}

/* Fields of a target: from planes of ids, from planes of radiance, and the rest, which is known before any ray is
 * traced. */
static Channel channel_of_target(const char *path)
{
    static const char *const seen[] = {"].pixels",        "].visible_fraction", "].box_px",
                                       "].amodal_box_px", "].occluded_by",      "].foliage_fraction"};
    if (strstr(path, "].error_") || strstr(path, ".error_median_k") || strstr(path, ".error_rms_k"))
        return CHANNEL_ERROR;
    if (strstr(path, "].bands.")) return CHANNEL_SIGNALS;
    if (ends_with(path, "].dt_k") || ends_with(path, "].patch_temp_k")) return CHANNEL_TEMP;
    for (size_t i = 0; i < sizeof seen / sizeof *seen; i++)
        if (ends_with(path, seen[i])) return CHANNEL_TARGETS;
    return CHANNEL_MOTION;
}

static Channel channel_of(const char *path)
{
    if (strncmp(path, "time_s", 6) == 0) return CHANNEL_TIME;
    if (strncmp(path, "sun", 3) == 0) return CHANNEL_SUN;
    if (strncmp(path, "targets", 7) == 0) return channel_of_target(path);
    if (strncmp(path, "error", 5) == 0) return CHANNEL_ERROR;
    if (strncmp(path, "radar.", 6) == 0) return CHANNEL_RADAR;
    if (ends_with(path, "].scene_rate_px_s")) return CHANNEL_TARGETS; /* depends on the range along the boresight */
    return CHANNEL_POSE;
}

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

static bool equal(const JsonValue *expected, const JsonValue *got, const struct Field *field, double factor)
{
    if (expected->text || got->text) return expected->text && got->text && strcmp(expected->text, got->text) == 0;
    if (isnan(expected->number) && isnan(got->number)) return true;
    const double limit =
        field ? factor * (field->absolute + field->relative * fabs(expected->number)) : 1e-6 * fabs(expected->number);
    return fabs(got->number - expected->number) <= limit;
}

/* Which values of two records are compared, and how. */
typedef struct WalkRule {
    Channel (*of)(const char *path);
    bool (*concerns)(const char *path);
    bool   exact; /* numbers are equal; else within a tolerance, times this factor: */
    double factor;
} WalkRule;

/* Both lists are sorted by path: merges them. */
static void walk(ChannelResult result[CHANNEL_COUNT], int frame, const JsonValues *expected, const JsonValues *got,
                 const WalkRule *rule)
{
    const bool exact = rule->exact;
    int        i = 0, k = 0;
    while (i < expected->count || k < got->count) {
        const JsonValue *was = i < expected->count ? &expected->value[i] : NULL;
        const JsonValue *is = k < got->count ? &got->value[k] : NULL;
        const int        order = !was ? 1 : !is ? -1 : strcmp(was->path, is->path);
        const char      *path = order <= 0 ? was->path : is->path;
        if (order > 0) was = NULL;
        if (order < 0) is = NULL;
        i += order <= 0;
        k += order >= 0;
        if (!rule->concerns(path)) continue;
        const struct Field *field = exact ? NULL : field_of(path);
        result[rule->of(path)].there = true;
        if (!was && (!field || is_newer(field)) && !exact) continue; /* a new field */
        const bool same = was && is && (exact ? was->number == is->number : equal(was, is, field, rule->factor));
        if (!same) differs(&result[rule->of(path)], frame, path, was, is);
    }
}

/* Hashes are compared separately. Older baselines state errors of the pseudo-radar, which are no longer
 * given. */
static bool is_truth(const char *path)
{
    return strncmp(path, "error.radar.", 12) != 0 && strcmp(path, "frame_sha256") != 0 &&
           strcmp(path, "radar.map_sha256") != 0;
}

void verdict_truth(ChannelResult result[CHANNEL_COUNT], int frame, const JsonValues *expected, const JsonValues *got,
                   double factor)
{
    walk(result, frame, expected, got, &(WalkRule){channel_of, is_truth, false, factor});
}

static Channel to_counters(const char *path)
{
    (void)path;
    return CHANNEL_COUNTERS;
}

static bool is_counter(const char *path)
{
    static const char *const heads[] = {
        "counters.datagrams", "counters.pdus.",     "counters.dropped.", "counters.packets_without_datagram",
        "counters.own",       "counters.entities.", "counters.effects."};
    for (size_t i = 0; i < sizeof heads / sizeof *heads; i++)
        if (strncmp(path, heads[i], strlen(heads[i])) == 0) return true;
    return false;
}

void verdict_counters(ChannelResult result[CHANNEL_COUNT], const JsonValues *expected, const JsonValues *got)
{
    walk(result, -1, expected, got, &(WalkRule){to_counters, is_counter, true, 0});
}
