/* sensor/regress/verdict.c: compares a run with its baseline: sizes, inputs, counters, truth, planes, range profile. */
#include "sensor/regress/verdict.h"

#include "sensor/detector/preset.h"

#include <stdarg.h>
#include <stdlib.h>

enum { file_most = 64 << 20 };

static const struct ChannelRow {
    const char *name, *about, *unit;
    FramePlane  plane[4];
    int         planes;
} rows[CHANNEL_COUNT] = {
    [CHANNEL_SIZE] = {"size", "size of the images and of the range profile", "", {0}, 0},
    [CHANNEL_COUNTERS] = {"counters", "PDUs, drops, entities and effects, over the whole log", "", {0}, 0},
    [CHANNEL_TIME] = {"time", "number and time of the frames", "", {0}, 0},
    [CHANNEL_POSE] = {"pose", "position and attitude of the sensor", "", {0}, 0},
    [CHANNEL_SUN] = {"sun", "direction of the sun, from the sensor", "", {0}, 0},
    [CHANNEL_MOTION] = {"motion", "which entities there are, and their dead-reckoned positions", "", {0}, 0},
    [CHANNEL_ENTITY] = {"entity", "entity of each pixel", "", {FRAME_ENTITY}, 1},
    [CHANNEL_PART] = {"part", "part of the model of each pixel", "", {FRAME_PART}, 1},
    [CHANNEL_RANGE] = {"range", "range of the surface of each pixel", "m", {FRAME_RANGE}, 1},
    [CHANNEL_NORMAL] = {"normal", "normal of the surface of each pixel", "", {FRAME_NX, FRAME_NY, FRAME_NZ}, 3},
    [CHANNEL_TARGETS] = {"targets", "visible fraction and box of each target, and what occludes it", "", {0}, 0},
    [CHANNEL_MATERIAL] = {"material", "material of each pixel", "", {FRAME_MATERIAL}, 1},
    [CHANNEL_TEMP] = {"temperature", "temperature of the surface of each pixel", "K", {FRAME_TEMP}, 1},
    [CHANNEL_OPTICAL] = {"optical",
                         "radiance at the sensor",
                         "W/(m2 sr)",
                         {FRAME_OPTICAL_R, FRAME_OPTICAL_G, FRAME_OPTICAL_B, FRAME_OPTICAL_Y},
                         4},
    [CHANNEL_MWIR] = {"mwir", "radiance at the sensor as apparent temperature, 3.4-4.8 um", "K", {FRAME_MWIR}, 1},
    [CHANNEL_LWIR] = {"lwir", "radiance at the sensor as apparent temperature, 8-12 um", "K", {FRAME_LWIR}, 1},
    [CHANNEL_RADAR] = {"radar", "of the band, power of each pixel, relative to the brightest of the baseline; of "
                       "radar.preset, detections and truth", "dB", {FRAME_RADAR}, 1},
    [CHANNEL_PROFILE] = {"radar profile", "radar power over range, relative to the largest of the "
                         "baseline", "dB", {0}, 0},
    [CHANNEL_SIGNALS] = {"target signals", "contrast, signal-to-noise ratio and intensity of each target", "", {0}, 0},
    [CHANNEL_ERROR] = {"error budget", "the run's estimate of its own error", "", {0}, 0},
};

const char *channel_name(Channel channel) { return rows[channel].name; }
const char *channel_about(Channel channel) { return rows[channel].about; }

void channel_value(char out[64], Channel channel, double value, int digits)
{
    const char *unit    = rows[channel].unit, *space = *unit ? " " : "";
    const bool  thermal = channel == CHANNEL_MWIR || channel == CHANNEL_LWIR;
    if (isnan(value)) snprintf(out, 64, "not a number");
    else if (isinf(value)) snprintf(out, 64, channel == CHANNEL_RANGE && value > 0 ? "no surface" : "out of range");
    else if (thermal && value <= apparent_floor_k) snprintf(out, 64, "below %.0f K", apparent_floor_k);
    else snprintf(out, 64, "%.*g%s%s", digits, value, space, unit);
}

/* ---- units ----------------------------------------------------------------------------------- */

/* Largest finite value: the reference of dB. */
static double largest(const float *value, size_t count)
{
    double most = 0;
    for (size_t i = 0; i < count; i++)
        if (isfinite(value[i]) && (double)value[i] > most) most = (double)value[i];
    return most;
}

/* A plane in the unit of its tolerance. full: largest value of the expected plane, the reference of dB. */
static void to_unit(float *out, const float *value, size_t count, FramePlane plane, double full, const Tolerance *t)
{
    double low_m, high_m;
    if (plane == FRAME_MWIR || plane == FRAME_LWIR) {
        preset_band(&low_m, &high_m, plane == FRAME_MWIR ? BAND_MWIR : BAND_LWIR, OPTICAL_PAN, -1);
        plane_to_kelvin(out, value, count, low_m, high_m);
    } else if (plane == FRAME_RADAR) {
        plane_to_db(out, value, count, full, t->radar_span_db);
    } else {
        memcpy(out, value, count * sizeof *out);
    }
}

static void limits_of(double *absolute, double *relative, FramePlane plane, const Tolerance *t)
{
    *absolute = *relative = 0;
    switch (plane) {
    case FRAME_RANGE: *relative = t->range_rel; break;
    case FRAME_NX:
    case FRAME_NY:
    case FRAME_NZ: *absolute = t->normal; break;
    case FRAME_TEMP: *absolute = t->temp_k; break;
    case FRAME_MWIR: *absolute = t->mwir_k; break;
    case FRAME_LWIR: *absolute = t->lwir_k; break;
    case FRAME_RADAR: *absolute = t->radar_db; break;
    case FRAME_OPTICAL_R:
    case FRAME_OPTICAL_G:
    case FRAME_OPTICAL_B:
    case FRAME_OPTICAL_Y:
        *absolute = t->optical_w_m2_sr;
        *relative = t->optical_rel;
        break;
    default: break;
    }
    /* both were rounded to floats: a difference of exactly the limit is accepted */
    *absolute *= 1 + 1e-6;
    *relative *= 1 + 1e-6;
}

/* ---- one plane ------------------------------------------------------------------------------- */

/* Keeps the worse: a failure, then the larger share, then the larger difference. */
static void keep_worse(ChannelResult *result, const ChannelResult *found)
{
    const bool worse = !result->there || found->failed > result->failed ||
                       (found->failed == result->failed &&
                        (found->verdict.share > result->verdict.share ||
                         (found->verdict.share == result->verdict.share && found->verdict.max > result->verdict.max)));
    if (worse) *result = *found;
}

/* A plane that only the baseline (recorded) or only the run has. */
static void one_sided(ChannelResult *result, Channel channel, FramePlane plane, int frame, bool recorded)
{
    ChannelResult found = {.there = true, .failed = true, .frame = frame, .plane = plane,
                           .verdict = {.share = 1, .max = INFINITY}};
    snprintf(found.line, sizeof found.line, "%s of frame %d is %s", plane < FRAME_PLANES ? frame_plane_name(plane)
             : rows[channel].name, frame, recorded ? "in the baseline and not in the run" : "not in the baseline");
    keep_worse(result, &found);
}

static bool is_geometry(Channel channel) { return channel == CHANNEL_RANGE || channel == CHANNEL_NORMAL; }

static void write_line(ChannelResult *r, Channel channel)
{
    const PlaneVerdict *v = &r->verdict;
    char                limit[64], worst[160], plane[24] = "", was[64], is[64];
    const char         *unit = rows[channel].unit, *space = *unit ? " " : "";
    const bool          floor = (channel == CHANNEL_MWIR || channel == CHANNEL_LWIR) &&
                       (v->expected <= apparent_floor_k || v->got <= apparent_floor_k);
    channel_value(was, channel, v->expected, 4);
    channel_value(is, channel, v->got, 4);
    if (channel == CHANNEL_RANGE) snprintf(limit, sizeof limit, "%.3g relative", r->relative);
    else if (channel == CHANNEL_OPTICAL) snprintf(limit, sizeof limit, "%.3g %%", 100 * r->relative);
    else snprintf(limit, sizeof limit, "%.3g%s%s", r->limit, space, unit);
    if (channel == CHANNEL_OPTICAL && isfinite(v->max) && v->expected > 0)
        snprintf(worst, sizeof worst, "%.3g %%", 100 * v->max / v->expected);
    else if (isfinite(v->max) && !floor) snprintf(worst, sizeof worst, "%.3g%s%s", v->max, space, unit);
    else snprintf(worst, sizeof worst, "%s became %s", was, is);
    if (rows[channel].planes > 1) snprintf(plane, sizeof plane, "%s: ", frame_plane_name(r->plane));
    snprintf(r->line, sizeof r->line, "%s%.3g %% of pixels beyond %s, worst %s at frame %d (%d, %d)", plane,
             100 * v->share, limit, worst, r->frame, v->column, v->row);
}

typedef struct FramePair {
    const RecordFrame *expected, *got;
    const Tolerance   *tolerance;
    uint8_t           *edge, *other;  /* NULL: ids must be equal */
    float             *scratch;       /* [3][count] */
    size_t             count, edges;
} FramePair;

static void compare_plane(ChannelResult *result, const FramePair *h, Channel channel, FramePlane plane)
{
    const float *was = h->expected->number_plane[plane], *is = h->got->number_plane[plane];
    if (!was && !is) return;
    if (!was || !is) {
        one_sided(result, channel, plane, h->got->number, was != NULL);
        return;
    }
    const double  full  = plane == FRAME_RADAR ? largest(was, h->count) : 0;
    ChannelResult found = {.there = true, .picture = true, .frame = h->got->number, .plane = plane,
                           .unit = rows[channel].unit};
    limits_of(&found.limit, &found.relative, plane, h->tolerance);
    to_unit(h->scratch, was, h->count, plane, full, h->tolerance);
    to_unit(h->scratch + h->count, is, h->count, plane, full, h->tolerance);
    compare_numbers(&found.verdict, NULL, h->scratch, h->scratch + h->count, h->got->width, h->got->height, found.limit,
                    found.relative, h->other);
    found.allowed = is_geometry(channel) ? 0 : h->tolerance->share;
    found.failed  = found.verdict.share > found.allowed;
    if (found.verdict.column >= 0) write_line(&found, channel);
    keep_worse(result, &found);
}

static void compare_id_plane(ChannelResult *result, const FramePair *h, Channel channel, FramePlane plane)
{
    const uint32_t *was = h->expected->id_plane[plane], *is = h->got->id_plane[plane];
    size_t          at_edges = 0;
    if (!was && !is) return;
    if (!was || !is) {
        one_sided(result, channel, plane, h->got->number, was != NULL);
        return;
    }
    ChannelResult found = {.there = true, .picture = true, .frame = h->got->number, .plane = plane, .unit = ""};
    compare_ids(&found.verdict, &at_edges, was, is, h->got->width, h->got->height, h->edge);
    const PlaneVerdict *v = &found.verdict;
    found.failed = v->beyond > 0 || (double)at_edges > h->tolerance->edge_share * (double)h->edges;
    if (v->beyond > 0)
        snprintf(found.line, sizeof found.line,
                 "%.3g %% of pixels have a different %s, first at frame %d (%d, %d): %.0f, was "
                 "%.0f",
                 100 * v->share, rows[channel].name, found.frame, v->column, v->row, v->got, v->expected);
    else if (at_edges > 0)
        snprintf(found.line, sizeof found.line, "%zu of %zu edge pixels have a different %s in frame %d, allowed %.3g "
                                                "%%",
                 at_edges, h->edges, rows[channel].name, found.frame, 100 * h->tolerance->edge_share);
    for (size_t i = 0; h->other && i < h->count; i++) h->other[i] |= was[i] != is[i];
    keep_worse(result, &found);
}

/* Sum of the bounces: a profile's bins share one scale. */
static void compare_profile(ChannelResult *result, const FramePair *h)
{
    const RecordFrame *was = h->expected, *is = h->got;
    if (was->bins == 0 && is->bins == 0) return;
    if (was->bins > 0 && is->bins > 0 && was->bins != is->bins) return; /* reported by CHANNEL_SIZE */
    if (was->bins != is->bins) {
        one_sided(result, CHANNEL_PROFILE, FRAME_PLANES, is->number, was->bins > 0);
        return;
    }
    double full = 0;
    for (int b = 0; b < frame_bounces; b++) full = fmax(full, largest(was->profile[b], (size_t)was->bins));
    float *db = malloc(2 * (size_t)was->bins * sizeof *db);
    for (int b = 0; db && b < frame_bounces; b++) {
        ChannelResult found = {.there = true, .frame = is->number, .plane = FRAME_PLANES, .bounce = b, .unit = "dB",
                               .limit = h->tolerance->profile_db * (1 + 1e-6), .allowed = h->tolerance->share};
        PlaneVerdict *v = &found.verdict;
        plane_to_db(db, was->profile[b], (size_t)was->bins, full, h->tolerance->radar_span_db);
        plane_to_db(db + was->bins, is->profile[b], (size_t)was->bins, full, h->tolerance->radar_span_db);
        compare_numbers(v, NULL, db, db + was->bins, was->bins, 1, found.limit, 0, NULL);
        found.failed = v->share > h->tolerance->share;
        if (v->column >= 0)
            snprintf(found.line, sizeof found.line,
                     "bounce %d: %.3g %% of bins beyond %.3g dB, worst %.3g dB at frame %d, "
                     "%.1f m",
                     b + 1, 100 * v->share, found.limit, v->max, is->number, was->near_m + v->column * was->bin_m);
        if (b == 0 && fabs(was->near_m - is->near_m) > 0.01 * was->bin_m) {
            found.failed = true;
            snprintf(found.line, sizeof found.line, "begins at %.3f m, was %.3f m in frame %d", is->near_m, was->near_m,
                     is->number);
        }
        keep_worse(result, &found);
    }
    free(db);
}

void verdict_frame(ChannelResult result[CHANNEL_COUNT], const RecordFrame *expected, const RecordFrame *got,
                   const Tolerance *tolerance, bool edges_allowed)
{
    const size_t count = (size_t)got->width * (size_t)got->height;
    FramePair    h = {.expected = expected, .got = got, .tolerance = tolerance, .count = count};
    h.scratch = malloc(2 * count * sizeof *h.scratch);
    if (edges_allowed) {
        h.edge  = calloc(count, 1);
        h.other = calloc(count, 1);
    }
    if (h.scratch && (!edges_allowed || (h.edge && h.other))) {
        for (int p = 0; p < FRAME_PLANES && h.edge; p++)
            if (expected->id_plane[p] && got->id_plane[p])
                h.edges = mark_edges(h.edge, expected->id_plane[p], got->id_plane[p], got->width, got->height);
        /* ids first: pixels of different entities are left out of the comparison of numbers */
        for (int pass = 0; pass < 2; pass++)
            for (int c = 0; c < CHANNEL_COUNT; c++)
                for (int i = 0; i < rows[c].planes; i++) {
                    const FramePlane plane = rows[c].plane[i];
                    if (frame_plane_is_id(plane) != (pass == 0)) continue;
                    if (pass == 0) compare_id_plane(&result[c], &h, (Channel)c, plane);
                    else compare_plane(&result[c], &h, (Channel)c, plane);
                }
        compare_profile(&result[CHANNEL_PROFILE], &h);
    } else {
        one_sided(&result[CHANNEL_TIME], CHANNEL_TIME, FRAME_PLANES, got->number, true);
        snprintf(result[CHANNEL_TIME].line, sizeof result->line, "out of memory at frame %d", got->number);
    }
    free(h.scratch);
    free(h.edge);
    free(h.other);
}

bool channel_planes(ChannelPlanes *out, const ChannelResult *r, const RecordFrame *expected, const RecordFrame *got,
                    const Tolerance *tolerance)
{
    const size_t  count = (size_t)got->width * (size_t)got->height;
    PlaneVerdict  verdict;
    ChannelPlanes p = {.width = got->width, .height = got->height, .expected = malloc(count * sizeof(float)),
                       .got = malloc(count * sizeof(float)), .difference = malloc(count * sizeof(float))};
    const bool    ids = frame_plane_is_id(r->plane);
    const bool    there = ids ? expected->id_plane[r->plane] && got->id_plane[r->plane]
                              : expected->number_plane[r->plane] && got->number_plane[r->plane];
    if (!p.expected || !p.got || !p.difference || !there) {
        free(p.expected);
        free(p.got);
        free(p.difference);
        return false;
    }
    if (ids) {
        for (size_t i = 0; i < count; i++) {
            p.expected[i] = (float)expected->id_plane[r->plane][i];
            p.got[i]      = (float)got->id_plane[r->plane][i];
        }
    } else {
        const double full = r->plane == FRAME_RADAR ? largest(expected->number_plane[r->plane], count) : 0;
        to_unit(p.expected, expected->number_plane[r->plane], count, r->plane, full, tolerance);
        to_unit(p.got, got->number_plane[r->plane], count, r->plane, full, tolerance);
    }
    compare_numbers(&verdict, p.difference, p.expected, p.got, p.width, p.height, 0, 0, NULL);
    *out = p;
    return true;
}

/* ---- all of it ------------------------------------------------------------------------------- */

__attribute__((format(printf, 2, 3))) static void remark(Verdict *v, const char *format, ...)
{
    const size_t n = strlen(v->remarks);
    va_list      arguments;
    va_start(arguments, format);
    if (n + 2 < sizeof v->remarks) {
        vsnprintf(v->remarks + n, sizeof v->remarks - n - 1, format, arguments);
        strcat(v->remarks, "\n");
    }
    va_end(arguments);
}

static Status read_json(JsonValues *out, const Case *c, const char *folder, const char *name)
{
    char   path[case_path_size + 32], *text = NULL;
    size_t octets;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    Status status = text_read_file(&text, &octets, "regress", path, file_most);
    if (status == STATUS_OK) status = case_relative(&text, c);
    if (status == STATUS_OK) status = json_values_read(out, text, strlen(text), "regress", path);
    free(text);
    return status;
}

static const char *text_of(const JsonValues *values, const char *path)
{
    const JsonValue *value = json_values_find(values, path);
    return value && value->text ? value->text : "";
}

static bool begins(const char *text, const char *head) { return strncmp(text, head, strlen(head)) == 0; }

/* Each value below `head` that differs: tables by their hash, settings by their text. */
static int remark_group(Verdict *v, const JsonValues *was, const JsonValues *is, const char *head, bool hashes)
{
    const char *const what = hashes ? "table" : "setting";
    const size_t      skip = strlen(head);
    int               count = 0;
    for (int i = 0; i < is->count; i++) {
        const JsonValue *now = &is->value[i], *then = json_values_find(was, now->path);
        if (!begins(now->path, head) || !now->text) continue;
        if (then && then->text && strcmp(then->text, now->text) == 0) continue;
        count++;
        if (!then) remark(v, "%s %s is new", what, now->path + skip);
        else if (hashes)
            remark(v, "%s %s: SHA-256 %.8s..., was %.8s...", what, now->path + skip, now->text,
                   then->text ? then->text : "?");
        else
            remark(v, "%s %s is '%.200s', was "
                      "'%.200s'", what, now->path + skip, now->text, then->text ? then->text : "?");
    }
    for (int i = 0; i < was->count; i++)
        if (begins(was->value[i].path, head) && !json_values_find(is, was->value[i].path)) {
            remark(v, "%s %s was removed", what, was->value[i].path + skip);
            count++;
        }
    return count;
}

static bool has_group(const JsonValues *values, const char *head)
{
    for (int i = 0; i < values->count; i++)
        if (begins(values->value[i].path, head)) return true;
    return false;
}

/* Inputs: tables, settings, log. */
static void remark_inputs(Verdict *v, const JsonValues *was, const JsonValues *is)
{
    if (has_group(was, "tables_sha256.")) remark_group(v, was, is, "tables_sha256.", true);
    if (has_group(was, "settings.")) remark_group(v, was, is, "settings.", false);
    /* where it lists them, their hash says no more: it is of absolute paths */
    if (!has_group(was, "settings.") && strcmp(text_of(was, "config_sha256"), text_of(is, "config_sha256")) != 0)
        remark(v, "settings are not those of the baseline (config_sha256), which does not list them");
    v->other_log = strcmp(text_of(was, "log_sha256"), text_of(is, "log_sha256")) != 0;
    if (v->other_log) remark(v, "the log is not that of the baseline (log_sha256)");
}

/* Version, ISA, libraries, automatic choices. */
static void remark_runs(Verdict *v, const JsonValues *was, const JsonValues *is)
{
    remark_inputs(v, was, is);
    static const char *const build[] = {"pitviper", "isa"};
    v->same_build = true;
    for (int i = 0; i < 2; i++)
        if (strcmp(text_of(was, build[i]), text_of(is, build[i])) != 0) {
            v->same_build = false;
            remark(v, "%s is %s, was %s in the baseline", build[i], text_of(is, build[i]), text_of(was, build[i]));
        }
    for (int i = 0; i < is->count; i++) {
        const char *path = is->value[i].path;
        if (strncmp(path, "libraries.", 10) != 0 || !is->value[i].text) continue;
        if (strcmp(text_of(was, path), is->value[i].text) == 0) continue;
        v->same_build = false;
        remark(v, "%s is %s, was %s in the baseline", path + 10, is->value[i].text, text_of(was, path));
    }
    for (int i = 0; i < is->count; i++) {
        const char *path = is->value[i].path;
        if (strncmp(path, "choices[", 8) == 0 && is->value[i].text &&
            strcmp(text_of(was, path), is->value[i].text) != 0)
            remark(v, "chosen: %s; was: %s", is->value[i].text, text_of(was, path));
    }
}

static void remark_hashes(Verdict *v, const JsonValues *was, const JsonValues *is)
{
    int differ = 0, count = 0;
    for (int i = 0; i < is->count; i++) {
        if (strncmp(is->value[i].path, "frame_sha256[", 13) != 0 || !is->value[i].text) continue;
        count++;
        differ += strcmp(text_of(was, is->value[i].path), is->value[i].text) != 0;
    }
    if (differ == 0 || !v->same_build) return;
    remark(v, v->first < 0 ? "bits differ in %d of %d frames, within tolerance" : "bits differ in %d of %d frames",
           differ, count);
}

/* Line of this frame, flattened. STATUS_IO when there is none. */
static Status truth_of(JsonValues *out, const char *folder, int frame)
{
    char   path[case_path_size + 32], source[case_path_size + 64], *text;
    size_t octets;
    snprintf(path, sizeof path, "%s/truth.jsonl", folder);
    Status status = text_read_file(&text, &octets, "regress", path, file_most);
    if (status != STATUS_OK) return status;
    status   = STATUS_IO;
    int line = 1;
    for (char *at = text; *at && status == STATUS_IO; line++) {
        const size_t length = strcspn(at, "\n");
        JsonValues   values;
        snprintf(source, sizeof source, "%s:%d", path, line);
        if (length > 0) {
            const Status read = json_values_read(&values, at, length, "regress", source);
            if (read != STATUS_OK) status = read;
            else {
                const JsonValue *number = json_values_find(&values, "frame");
                if (number && number->number == frame) {
                    *out   = values;
                    status = STATUS_OK;
                } else {
                    json_values_free(&values);
                }
            }
        }
        at += length + (at[length] == '\n');
    }
    if (status == STATUS_IO) log_error("regress: %s: has no line of frame %d", path, frame);
    free(text);
    return status;
}

/* False: images or profiles differ in size, which is reported in the result; or the baseline cannot be read
 * (*status). */
static bool same_size(Status *status, Verdict *v, const char *record, const RecordFrame *got)
{
    ChannelResult *r = &v->channel[CHANNEL_SIZE];
    FrameSize      size;
    *status  = frame_record_size(&size, record, got->number);
    r->there = true;
    if (*status != STATUS_OK) return false;
    const bool picture = size.width == got->width && size.height == got->height;
    const bool profile = size.bins == got->bins || size.bins == 0 || got->bins == 0;
    if (picture && profile) return true;
    r->frame = got->number;
    if (!r->failed && !picture)
        snprintf(r->line, sizeof r->line,
                 "expected %d x %d pixels, actual %d x %d, from frame %d on (sensor.width_px, sensor.height_px); "
                 "nothing "
                 "else is compared in such a frame", size.width, size.height, got->width, got->height, got->number);
    else if (!r->failed)
        snprintf(r->line, sizeof r->line,
                 "expected %d range bins, actual %d, from frame %d on (radar.bins); nothing else is compared in such "
                 "a frame",
                 size.bins, got->bins, got->number);
    r->failed = true;
    return false;
}

static Status compare_frame(Verdict *v, const Case *c, const char *record, const char *run, int number)
{
    RecordFrame expected = {0}, got = {0};
    JsonValues  was = {0}, is = {0};
    Status      status = frame_from_run(&got, run, number);
    if (status == STATUS_OK && !same_size(&status, v, record, &got)) {
        frame_free(&got);
        return status;
    }
    if (status == STATUS_OK) status = frame_from_record(&expected, record, &got);
    if (status == STATUS_OK) status = frame_rename_materials(&got, &expected);
    if (status == STATUS_OK) status = truth_of(&was, record, number);
    if (status == STATUS_OK) status = truth_of(&is, run, number);
    if (status == STATUS_OK) {
        verdict_truth(v->channel, number, &was, &is, c->tolerance.truth);
        verdict_frame(v->channel, &expected, &got, &c->tolerance, !v->same_build);
    }
    json_values_free(&was);
    json_values_free(&is);
    frame_free(&expected);
    frame_free(&got);
    return status;
}

Status verdict_of(Verdict *out, const Case *c, const char *record, const char *run)
{
    JsonValues was = {0}, is = {0};
    *out = (Verdict){.first = -1};
    Status status = read_json(&was, c, record, "run.json");
    if (status == STATUS_OK) status = read_json(&is, c, run, "run.json");
    if (status == STATUS_OK) {
        remark_runs(out, &was, &is);
        verdict_counters(out->channel, &was, &is);
        if (strcmp(text_of(&was, "hosts[0]"), text_of(&is, "hosts[0]")) != 0) {
            out->channel[CHANNEL_POSE] = (ChannelResult){.there = true, .failed = true, .diffs = 1, .frame = -1};
            snprintf(out->channel[CHANNEL_POSE].line, sizeof out->channel->line, "the host is %.100s, was %.100s",
                     text_of(&is, "hosts[0]"), text_of(&was, "hosts[0]"));
        }
        out->channel[CHANNEL_TIME].there = true;
    }
    for (int i = 0; i < c->frames.count && status == STATUS_OK; i++)
        status = compare_frame(out, c, record, run, (int)c->frames.number[i]);
    for (int k = 0; k < CHANNEL_COUNT; k++) {
        ChannelResult *r = &out->channel[k];
        if (r->diffs > 1) {
            const size_t n = strlen(r->line);
            snprintf(r->line + n, sizeof r->line - n, ", and %d more", r->diffs - 1);
        }
        if (r->failed && out->first < 0) out->first = k;
    }
    if (status == STATUS_OK) remark_hashes(out, &was, &is);
    json_values_free(&was);
    json_values_free(&is);
    return status;
}
